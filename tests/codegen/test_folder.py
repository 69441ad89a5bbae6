"""An exported folder is written whole or not at all, and never over what someone else put there."""

from __future__ import annotations

import getpass
import json
import os
import re
import tempfile
from datetime import UTC, datetime
from pathlib import Path

import pytest

import cosserat_casadi
from cosserat_casadi import ExportError, Model, build, discretise
from cosserat_casadi.codegen import folder as folder_module
from cosserat_casadi.codegen.export import check_export, folder_files
from cosserat_casadi.codegen.folder import check_folder, write_folder
from cosserat_casadi.codegen.manifest import MANIFEST
from tests.families import mostly_slow
from tests.scenes import push, scene


def small(force: float = 0.9) -> Model:
    wanted = scene(push(force=[force, 0, 0]), strain="planar", title="A strip")
    return build(wanted, discretise(wanted, 1, 2))


@pytest.fixture(scope="module")
def model() -> Model:
    return small()


def export(model: Model, directory: str | Path, name: str | None = None) -> Path:
    """Export without estimates of errors: the folder is written as any other, in half of the time."""
    return cosserat_casadi.export(model, directory, name, estimate_errors=False)


def contents(directory: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in directory.iterdir()}


def refusal(directory: Path, name: str = "strip") -> tuple[str, str, str]:
    """Where, problem and remedy of the only fault."""
    with pytest.raises(ExportError) as caught:
        check_export(directory, name)
    (problem,) = caught.value.problems
    assert problem.remedy
    return problem.where, problem.problem, problem.remedy


# Refusals


def test_a_new_folder_and_an_empty_one_are_accepted(tmp_path: Path) -> None:
    assert check_folder(tmp_path / "new") == set()
    assert check_folder(tmp_path) == set()
    assert list(tmp_path.iterdir()) == []


def test_a_file_is_no_folder(tmp_path: Path) -> None:
    (tmp_path / "out").write_text("mine")
    assert refusal(tmp_path / "out") == ("--output", f"{tmp_path / 'out'} is no folder", "name one")
    assert (tmp_path / "out").read_text() == "mine"


def test_a_dangling_link_is_no_folder(tmp_path: Path) -> None:
    (tmp_path / "out").symlink_to(tmp_path / "nowhere")
    assert "is no folder" in refusal(tmp_path / "out")[1]


def test_missing_parent(tmp_path: Path) -> None:
    where, problem, remedy = refusal(tmp_path / "no" / "out")
    assert (where, remedy) == ("--output", "make it first")
    assert problem == f"the folder {tmp_path / 'no'} does not exist"


def test_parent_that_is_a_file(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    assert "does not exist" in refusal(tmp_path / "file" / "out")[1]


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() == 0, reason="nothing is read-only for this user")
@pytest.mark.parametrize("inside", [True, False])
def test_read_only_folder(tmp_path: Path, inside: bool) -> None:
    tmp_path.chmod(0o555)
    try:
        assert "cannot be written to" in refusal(tmp_path / "out" if inside else tmp_path)[1]
    finally:
        tmp_path.chmod(0o755)


@pytest.mark.parametrize("inside", [True, False])
def test_folder_that_the_system_calls_read_only(tmp_path: Path, inside: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(os, "access", lambda path, mode: False)
    where, problem, remedy = refusal(tmp_path / "out" if inside else tmp_path)
    assert (where, remedy) == ("--output", "name another")
    assert problem == f"the folder {tmp_path} cannot be written to"


def test_foreign_files(tmp_path: Path, model: Model) -> None:
    (tmp_path / "thesis.tex").write_text("mine")
    with pytest.raises(ExportError):
        export(model, tmp_path, "strip")
    where, problem, remedy = refusal(tmp_path)
    assert (where, remedy) == ("--output", "name a new or an empty folder")
    assert problem == f"the folder {tmp_path} holds files that no export wrote: thesis.tex"
    assert contents(tmp_path) == {"thesis.tex": b"mine"}


def test_many_foreign_files_are_told_in_one_line(tmp_path: Path) -> None:
    for i in range(9):
        (tmp_path / f"{i}.txt").write_text("")
    assert refusal(tmp_path)[1].endswith("no export wrote: 0.txt, 1.txt, 2.txt, 3.txt, 4.txt …")


def test_a_foreign_file_beside_an_earlier_export(tmp_path: Path, model: Model) -> None:
    export(model, tmp_path, "strip")
    (tmp_path / "strip_test.c").write_text("mine")
    before = contents(tmp_path)
    assert refusal(tmp_path)[1].endswith("no export wrote: strip_test.c")
    with pytest.raises(ExportError):
        export(small(2.0), tmp_path, "strip")
    assert contents(tmp_path) == before


def test_a_folder_in_the_place_of_a_listed_file(tmp_path: Path, model: Model) -> None:
    export(model, tmp_path, "strip")
    (tmp_path / "strip.c").unlink()
    (tmp_path / "strip.c").mkdir()
    assert refusal(tmp_path)[1].endswith("no export wrote: strip.c")


MANIFESTS = {
    "empty": "",
    "cut": '{"schema": 1, "files": ["notes.txt", "manifest.json"',
    "not UTF-8": b'{"files": ["notes.txt", "\xff"]}',
    "too deep": "[" * 100_000,
    "a list": '["notes.txt", "manifest.json"]',
    "no files": '{"versions": {"cosserat_casadi": "0.1.0"}}',
    "files is text": '{"versions": {"cosserat_casadi": "0.1.0"}, "files": "notes.txt manifest.json"}',
    "files is a table": '{"versions": {"cosserat_casadi": "0.1.0"}, "files": {"notes.txt": 1, "manifest.json": 1}}',
    "someone else's": '{"name": "site", "files": ["notes.txt", "manifest.json"]}',
    "someone else's versions": '{"versions": ["cosserat_casadi"], "files": ["notes.txt", "manifest.json"]}',
}


@pytest.mark.parametrize("text", MANIFESTS.values(), ids=MANIFESTS)
def test_damaged_and_foreign_manifests(tmp_path: Path, text: str | bytes, model: Model) -> None:
    (tmp_path / "notes.txt").write_text("mine")
    (tmp_path / MANIFEST).write_bytes(text if isinstance(text, bytes) else text.encode())
    before = contents(tmp_path)
    assert refusal(tmp_path)[1].endswith("no export wrote: manifest.json, notes.txt")
    with pytest.raises(ExportError):
        export(model, tmp_path, "strip")
    assert contents(tmp_path) == before


def test_every_fault_at_once_and_nothing_written(tmp_path: Path, model: Model) -> None:
    (tmp_path / "thesis.tex").write_text("mine")
    for name in ("int", "2fast", "math"):
        with pytest.raises(ExportError) as caught:
            export(model, tmp_path, name)
        assert [problem.where for problem in caught.value.problems] == ["--name", "--output"]
        assert all(problem.problem and problem.remedy for problem in caught.value.problems)
        assert len(str(caught.value).splitlines()) == 2
    with pytest.raises(ExportError):
        export(model, tmp_path / "new", "int")
    assert contents(tmp_path) == {"thesis.tex": b"mine"}


def test_scene_that_gives_two_things_one_name_writes_nothing(tmp_path: Path) -> None:
    wanted = scene(push(), push(name="Push"), strain="planar")
    with pytest.raises(ExportError, match="differ in case alone"):
        export(build(wanted, discretise(wanted, 2, 4)), tmp_path / "out")
    assert list(tmp_path.iterdir()) == []


# Writing


@pytest.mark.parametrize(("folder", "name"), [("strip", "strip"), ("my arm", "my_arm"), ("arm-2.1", "arm_2_1")])
def test_name_of_the_folder_is_that_of_the_library(tmp_path: Path, model: Model, folder: str, name: str) -> None:
    assert export(model, tmp_path / folder) == tmp_path / folder
    assert (tmp_path / folder / f"{name}.h").exists()


def test_the_folder_may_be_given_relative_to_where_one_is(
    tmp_path: Path, model: Model, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "strip" / "inner").mkdir(parents=True)
    monkeypatch.chdir(tmp_path / "strip" / "inner")
    export(model, ".")
    assert (tmp_path / "strip" / "inner" / "inner.h").exists()
    for path in (tmp_path / "strip" / "inner").iterdir():
        path.unlink()
    (tmp_path / "strip" / "inner").rmdir()
    monkeypatch.chdir(tmp_path)
    export(model, "strip/../strip")
    assert (tmp_path / "strip" / "strip.h").exists()


def test_files_are_those_listed_and_readable(tmp_path: Path, model: Model) -> None:
    folder = export(model, tmp_path / "strip")
    listed = json.loads((folder / MANIFEST).read_text())["files"]
    assert listed == sorted(path.name for path in folder.iterdir())
    assert {path.stat().st_mode & 0o777 for path in folder.iterdir()} == {0o644}
    for path in folder.iterdir():
        text = path.read_text(encoding="utf-8")
        assert text.endswith("\n")
        assert "\r" not in text
        assert "@{" not in text


def test_exporting_twice_gives_the_same_bytes(tmp_path: Path) -> None:
    one, other = export(small(), tmp_path / "a", "strip"), export(small(), tmp_path / "b", "strip")
    before = contents(one)
    assert contents(other) == before
    export(small(), one, "strip")
    assert contents(one) == before


def test_an_earlier_export_is_replaced_and_its_stale_files_removed(tmp_path: Path) -> None:
    export(small(1.0), tmp_path / "out", "first")
    export(small(2.0), tmp_path / "out", "second")
    assert contents(tmp_path / "out") == contents(export(small(2.0), tmp_path / "other", "second"))
    assert not list((tmp_path / "out").glob("first*"))


def test_a_file_of_an_earlier_export_may_be_missing(tmp_path: Path, model: Model) -> None:
    folder = export(model, tmp_path / "strip")
    before = contents(folder)
    (folder / "README.md").unlink()
    export(model, folder)
    assert contents(folder) == before


def test_nothing_beyond_the_folder_is_removed(tmp_path: Path, model: Model) -> None:
    """A manifest that lists paths elsewhere does not lead there."""
    (tmp_path / "precious.txt").write_text("mine")
    folder = export(model, tmp_path / "strip")
    described = json.loads((folder / MANIFEST).read_text())
    described["files"] += ["../precious.txt", str(tmp_path / "precious.txt")]
    (folder / MANIFEST).write_text(json.dumps(described))
    export(model, folder)
    assert (tmp_path / "precious.txt").read_text() == "mine"


def test_nothing_in_the_files_tells_where_when_and_by_whom(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for variable in ("LOGNAME", "USER", "LNAME", "USERNAME"):
        monkeypatch.setenv(variable, "zaphod")
    folder = export(small(), tmp_path / "strip")
    places = {tmp_path.name, str(tmp_path), str(Path.home()), str(Path.cwd()), tempfile.gettempdir()} - {"/"}
    words = {*places, getpass.getuser(), "__FILE__", "__DATE__", "__TIME__"}
    year, months = datetime.now(UTC).year, "Jan|Feb|Mar|Apr|May|Jun|Jul|Aug|Sep|Oct|Nov|Dec"
    date = re.compile(
        rf"\b{year}[-/.]\d|\d[-/.]{year}\b|({months})\w* +(\d+,? +)?(\d+:\d+:\d+ +)?{year}|(©|\(c\)).*{year}"
    )
    for path in folder.iterdir():
        text = path.read_text(encoding="utf-8")
        found = [word for word in words if word in text]
        assert not found, f"{path.name}: {found}"
        assert not date.search(text), path.name
        if path.suffix not in (".c", ".json"):
            assert not re.search(rf"\b{year}\b", text), path.name


# Failures in the middle


@pytest.fixture
def failing(monkeypatch: pytest.MonkeyPatch) -> type[BaseException]:
    """Writing fails once, at the third file."""
    calls = iter(range(1, 1000))
    write = folder_module.write_atomically

    def fail(path: Path, content: bytes) -> None:
        if next(calls) == 3:
            raise KeyboardInterrupt
        write(path, content)

    monkeypatch.setattr(folder_module, "write_atomically", fail)
    return KeyboardInterrupt


def test_interrupted_export_leaves_no_new_folder(tmp_path: Path, model: Model, failing: type[BaseException]) -> None:
    with pytest.raises(failing):
        export(model, tmp_path / "strip")
    assert list(tmp_path.iterdir()) == []


def test_interrupted_export_leaves_an_empty_folder_empty(
    tmp_path: Path, model: Model, failing: type[BaseException]
) -> None:
    with pytest.raises(failing):
        export(model, tmp_path, "strip")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("name", mostly_slow(["strip", "renamed"], quick=["renamed"]))
def test_interrupted_export_leaves_the_old_one(tmp_path: Path, request: pytest.FixtureRequest, name: str) -> None:
    folder = export(small(1.0), tmp_path / "strip")
    before = contents(folder)
    failing = request.getfixturevalue("failing")
    with pytest.raises(failing):
        export(small(2.0), folder, name)
    assert contents(folder) == before


def test_failure_to_remove_a_stale_file_leaves_the_old_export(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = export(small(1.0), tmp_path / "strip")
    before, unlink = contents(folder), Path.unlink

    def refuse(self: Path, missing_ok: bool = False) -> None:
        if self.name == "strip_demo.c":
            raise PermissionError(self.name)
        unlink(self, missing_ok=missing_ok)

    monkeypatch.setattr(Path, "unlink", refuse)
    with pytest.raises(PermissionError):
        export(small(2.0), folder, "renamed")
    assert contents(folder) == before


def test_write_folder_writes_the_manifest_last(tmp_path: Path, model: Model, monkeypatch: pytest.MonkeyPatch) -> None:
    """As long as the old manifest stands, the folder is known as that of an export."""
    written: list[str] = []
    monkeypatch.setattr(folder_module, "write_atomically", lambda path, content: written.append(path.name))
    write_folder(tmp_path / "strip", folder_files(model, "strip"), set())
    assert written[-1] == MANIFEST
