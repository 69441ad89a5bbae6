"""``cosserat view``: a process that serves until it is stopped."""

from __future__ import annotations

import re
import signal
import socket
import subprocess
import sys
import urllib.request
from pathlib import Path

import pytest

from cosserat_casadi.accuracy.fixing import with_accuracy
from cosserat_casadi.scene.writing import scene_text
from tests.cli.test_locking import LOCKED
from tests.codegen.contact_libraries import over_bar
from tests.commands import cosserat
from tests.conftest import ROOT

PROGRAM = [sys.executable, "-u", "-c", "from cosserat_casadi.cli.main import main; main()", "view"]
STRIP = str(ROOT / "examples" / "planar_strip.toml")


def test_it_serves_the_page_until_it_is_stopped() -> None:
    command = [*PROGRAM, STRIP, "--no-browser"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as running:
        try:
            assert running.stdout is not None
            said = ""
            address = None
            while address is None:
                line = running.stdout.readline()
                assert line, said
                said += line
                address = re.search(r"http://127\.0\.0\.1:\d+/[-\w]+/", line)
            with urllib.request.urlopen(address[0], timeout=30) as answer:
                page = answer.read().decode()
            running.send_signal(signal.SIGINT)
            rest, _ = running.communicate(timeout=30)
        finally:
            running.kill()
    # The modes are those of the sliders, not of the scene's own inputs.
    assert re.search(r"All \d+ load cases are within 1e-06", said)
    assert "turns a rod by about a radian" in said
    assert "<title>Plastic strip" in page
    assert "class ServerRobot" in page
    assert "WebAssembly" not in page
    assert "Ended." in rest
    assert running.returncode == 130


@pytest.mark.slow
def test_a_scene_in_contact_opens_on_the_modes_of_its_own_inputs(tmp_path: Path) -> None:
    """A choice for the sliders would take minutes; every answer in the view tells its error."""
    scene = tmp_path / "bar.toml"
    scene.write_text(scene_text(with_accuracy(over_bar(), tolerance=1e-3)))
    command = [*PROGRAM, str(scene), "--no-browser"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as running:
        try:
            assert running.stdout is not None
            assert "The robot is at" in running.stdout.readline()
        finally:
            running.kill()


@pytest.mark.slow
def test_locked_modes_are_told_before_the_page_is_served(tmp_path: Path) -> None:
    scene = tmp_path / "held.toml"
    scene.write_text(LOCKED)
    command = [*PROGRAM, str(scene), "--no-browser"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as running:
        try:
            assert running.stdout is not None
            assert "The robot is at" in running.stdout.readline()
            running.send_signal(signal.SIGINT)
            _, errors = running.communicate(timeout=30)
        finally:
            running.kill()
    assert "kinematically locked" in " ".join(errors.split())


@pytest.mark.parametrize(
    ("arguments", "environment", "code", "words"),
    [
        (["nowhere.toml"], {}, 2, "nowhere.toml"),
        ([STRIP], {"CC": "no-such-cc"}, 2, "no-such-cc is not a program"),
        ([STRIP, "--port", "65536"], {}, 2, "'--port'"),
    ],
)
def test_what_cannot_be_viewed_is_refused(
    arguments: list[str],
    environment: dict[str, str],
    code: int,
    words: str,
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
) -> None:
    for name, value in environment.items():
        monkeypatch.setenv(name, value)
    done = cosserat("view", *arguments, "--no-browser", cwd=tmp_path)
    assert done.returncode == code
    assert words in " ".join(done.stderr.split())


def test_port_of_another_program_is_refused_before_the_solve(tmp_path: Path) -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        done = cosserat("view", STRIP, "--no-browser", "--port", str(port), cwd=tmp_path)
    assert done.returncode == 2
    assert f"--port: {port} cannot be taken: Address already in use" in " ".join(done.stderr.split())
