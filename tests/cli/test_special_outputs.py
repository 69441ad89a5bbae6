"""Outputs that are no regular files: devices and pipes are written to, links are followed, and none is replaced."""

from __future__ import annotations

import json
import os
import stat
import sys
import threading
from pathlib import Path

import pytest

from cosserat_casadi.errors import WriteError
from cosserat_casadi.files import write_atomically
from tests.commands import WIRE, cosserat

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="pipes and links of a POSIX system")

SCENE = f"schema = 1\naccuracy = {{ modes = 2, nodes = 4, tolerance = 0.05 }}\n{WIRE}"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "wire.toml").write_text(SCENE)
    return tmp_path


def test_a_pipe_is_written_to_and_stays_a_pipe(folder: Path) -> None:
    pipe = folder / "pipe"
    os.mkfifo(pipe)
    received: list[bytes] = []
    reader = threading.Thread(target=lambda: received.append(pipe.read_bytes()), daemon=True)
    reader.start()
    ended = cosserat("solve", "wire.toml", "--output", "pipe", cwd=folder)
    reader.join(timeout=60.0)
    assert ended.returncode == 0, ended.stderr
    assert json.loads(received[0])["converged"]
    assert stat.S_ISFIFO(pipe.lstat().st_mode)
    assert sorted(path.name for path in folder.iterdir()) == ["pipe", "wire.toml"]


@pytest.mark.parametrize("there", [True, False])
def test_links_are_followed(folder: Path, there: bool) -> None:
    (folder / "far").mkdir()
    if there:
        (folder / "far" / "result.json").write_text("old")
    link = folder / "link.json"
    link.symlink_to(Path("far") / "result.json")
    ended = cosserat("solve", "wire.toml", "--output", "link.json", cwd=folder)
    assert ended.returncode == 0, ended.stderr
    assert link.is_symlink()
    assert json.loads((folder / "far" / "result.json").read_text())["converged"]


@pytest.mark.parametrize("folder_is_closed", [False, True])
def test_a_device_stays_one_and_needs_no_folder_that_takes_files(
    folder: Path, monkeypatch: pytest.MonkeyPatch, folder_is_closed: bool
) -> None:
    # Through a link: were it replaced, the machine of the tests would not lose its device.
    link = folder / "nothing"
    link.symlink_to(os.devnull)
    access = os.access
    if folder_is_closed:
        monkeypatch.setattr(os, "access", lambda path, mode: str(path) != "/dev" and access(path, mode))
    ended = cosserat("solve", "wire.toml", "--output", "nothing", cwd=folder)
    assert ended.returncode == 0, ended.stderr
    assert link.is_symlink()
    assert stat.S_ISCHR(Path(os.devnull).stat().st_mode)


def test_a_link_to_itself_is_refused(folder: Path) -> None:
    link = folder / "link.json"
    link.symlink_to("link.json")
    ended = cosserat("solve", "wire.toml", "--output", "link.json", cwd=folder)
    assert ended.returncode == 2
    assert "--output: link.json is a link that leads to itself" in ended.stderr
    assert link.is_symlink()


def test_a_device_that_is_full_is_told(folder: Path) -> None:
    if not Path("/dev/full").exists():
        pytest.skip("has no /dev/full")
    link = folder / "full"
    link.symlink_to("/dev/full")
    with pytest.raises(WriteError, match="full could not be written: No space left on device"):
        write_atomically(link, b"text")
    assert link.is_symlink()
