"""Texts in C are kept under a key of what they are made from: what changes the key, what has none, what is kept."""

from __future__ import annotations

import errno
import multiprocessing
import os
import pickle
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, ClassVar, Literal

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_array_equal

import cosserat_casadi
from cosserat_casadi import Model, build, discretise, scene_from_dict
from cosserat_casadi.codegen import rows
from cosserat_casadi.codegen import stage as stage_module
from cosserat_casadi.codegen.rows import row_library
from cosserat_casadi.codegen.stage import compiled_stage
from cosserat_casadi.compiling import cache, description
from cosserat_casadi.compiling.cache import kept_texts
from cosserat_casadi.compiling.description import key_of
from cosserat_casadi.errors import WriteError
from cosserat_casadi.files import sources_hash
from cosserat_casadi.loads.load import Load
from cosserat_casadi.scene.load_records import LoadRecord
from tests.codegen.test_load import needs_compiler
from tests.registration import registered
from tests.scenes import WEIGHT, push, rod, scene

TEXTS = {"a.c": "int a(void) { return 1; }\n", "a.h": "int a(void);\n"}


@pytest.fixture
def kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty folder of texts and libraries, and sources that no one edits while the tests run."""
    monkeypatch.setenv("COSSERAT_CASADI_CACHE", str(tmp_path / "kept"))
    monkeypatch.setattr(cosserat_casadi, "IMPORTED", time.time() + 3600)
    description.hash_at_first_use.cache_clear()
    return tmp_path / "kept"


def strip(force: float = 0.9, modes: int = 3, **changes: Any) -> Model:
    wanted = scene(push(force=[force, 0.5, -0.4]), WEIGHT, strain="planar", inputs=["push.force"], **changes)
    return build(wanted, discretise(wanted, modes, 6))


class DragRecord(LoadRecord):
    """A load that comes from outside the package."""

    kind: Literal["test_drag"]
    rod: str
    force: float

    example: ClassVar[str] = ""


class Drag(Load[DragRecord]):
    """Its mechanics, of which the package knows nothing."""

    record = DragRecord


def test_the_same_description_has_the_same_key(kept: Path) -> None:
    key = key_of(strip(), "stage", {"rod": [0.5]})
    assert key is not None
    assert key == key_of(strip(), "stage", {"rod": [0.5]})
    assert key == key_of(pickle.loads(pickle.dumps(strip())), "stage", {"rod": [0.5]})


def bound(stiffness: float) -> Model:
    tables = {"schema": 1, "parameters": ["rod.length"], "rods": [rod("planar")], "loads": [push()]}
    return build(scene_from_dict(tables)).at({"rod.length": stiffness})


def test_whatever_differs_has_another_key(kept: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    others = [
        (strip(),),
        (strip(force=np.nextafter(0.9, 1.0)),),
        (strip(modes=4),),
        (strip(accuracy={"rotation": "magnus8"}),),
        (strip(), True),
        (strip(), 1),
        (strip(), "True"),
        (strip(), {"rod": [0.5]}),
        (strip(), {"rod": (0.5,)}),
        (strip(), {"rod": [0.5, 0.75]}),
        (strip(), np.array([0.5])),
        (strip(), np.array([[0.5]])),
        (strip(), 0.0),
        (strip(), -0.0),
        (bound(0.8),),
        (bound(0.9),),
        (bound(0.9).discrete.nominal,),
    ]
    keys = {key_of(*made_from) for made_from in others}
    assert None not in keys
    monkeypatch.setattr(ca, "__version__", "3.99.0")
    keys |= {key_of(strip())}
    monkeypatch.setattr(description, "hash_at_first_use", lambda: "other sources")
    keys |= {key_of(strip())}
    assert len(keys) == len(others) + 2


def test_what_is_no_data_has_no_key(kept: Path) -> None:
    class Foreign(Model):
        pass

    assert key_of(ca.MX.sym("x")) is None
    assert key_of(lambda: None) is None
    assert key_of(np.array([object()])) is None
    assert key_of(strip(), [Path("file")]) is None
    assert key_of(Foreign(strip().discrete)) is None
    with registered(Drag):
        drag = {"name": "drag", "kind": "test_drag", "rod": "rod", "force": 1.0}
        assert key_of(scene(drag, strain="planar")) is None
    assert key_of(scene(push(), strain="planar")) is not None


def test_a_changed_source_changes_the_hash(kept: Path, tmp_path: Path) -> None:
    folder = tmp_path / "sources"
    (folder / "inner").mkdir(parents=True)
    assert sources_hash(folder) is None
    first, template = folder / "first.py", folder / "inner" / "template.c.in"
    first.write_text("a = 1\n")
    template.write_text("int a;\n")
    hashes = [sources_hash(folder)]
    for change in (
        lambda: first.write_text("a = 2\n"),
        lambda: template.write_text("int b;\n"),
        lambda: template.rename(folder / "template.c.in"),
        lambda: (folder / "second.py").write_text(""),
    ):
        change()
        hashes.append(sources_hash(folder))
    (folder / "notes.txt").write_text("no source\n")
    assert sources_hash(folder) == hashes[-1]
    assert len(set(hashes)) == 5
    assert None not in hashes


def test_sources_that_changed_since_the_import_have_no_key(kept: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """What this process runs is not what lies on the disk."""
    assert kept_texts("a", ("made from",), lambda: TEXTS) == TEXTS
    monkeypatch.setattr(cosserat_casadi, "IMPORTED", 0.0)
    description.hash_at_first_use.cache_clear()
    assert key_of("made from") is None
    assert kept_texts("a", ("made from",), lambda: {"b.c": ""}) == {"b.c": ""}


def test_sources_that_change_while_texts_are_written_keep_none(kept: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def write() -> dict[str, str]:
        monkeypatch.setattr(cosserat_casadi, "IMPORTED", 0.0)
        return TEXTS

    assert kept_texts("a", ("made from",), write) == TEXTS
    assert not kept.exists()


def refuse() -> dict[str, str]:
    raise AssertionError("texts are written that are kept already")


def test_texts_are_written_once(kept: Path) -> None:
    assert kept_texts("a", ("made from", 1), lambda: TEXTS) == TEXTS
    assert kept_texts("a", ("made from", 1), refuse) == TEXTS
    assert kept_texts("a", ("made from", 2), lambda: {}) == {}
    files = sorted(kept.iterdir())
    assert [file.suffix for file in files] == [".texts", ".texts"]
    assert all(cache.OURS.fullmatch(file.name) for file in files)


@pytest.mark.parametrize("damage", [lambda content: content[:-9], lambda content: b"", lambda content: content + b"x"])
def test_a_torn_file_is_written_anew(kept: Path, damage: Callable[[bytes], bytes]) -> None:
    kept_texts("a", ("made from",), lambda: TEXTS)
    (file,) = kept.iterdir()
    file.write_bytes(damage(file.read_bytes()))
    assert kept_texts("a", ("made from",), lambda: {**TEXTS, "new.c": ""}) == {**TEXTS, "new.c": ""}
    assert len(kept_texts("a", ("made from",), refuse)) == 3


def test_a_full_disk_keeps_nothing(kept: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(path: Path, content: bytes) -> None:
        raise WriteError(path, OSError(errno.ENOSPC, os.strerror(errno.ENOSPC)))

    monkeypatch.setattr(cache, "write_atomically", full)
    assert kept_texts("a", ("made from",), lambda: TEXTS) == TEXTS
    assert not list(kept.iterdir())


@pytest.mark.skipif(sys.platform == "win32", reason="processes are forked")
def test_two_processes_at_once(kept: Path) -> None:
    def write() -> dict[str, str]:
        time.sleep(0.2)
        return {"a.c": "int a;" * 100_000}

    def work(count: int) -> None:
        assert kept_texts("a", ("made from",), write) == write()

    forked = multiprocessing.get_context("fork")
    processes = [forked.Process(target=work, args=(count,)) for count in range(2)]
    for process in processes:
        process.start()
    for process in processes:
        process.join(60)
    assert [process.exitcode for process in processes] == [0, 0]
    assert len(list(kept.iterdir())) == 1
    work(2)


def no_functions(*arguments: Any) -> Iterator[ca.Function]:
    raise AssertionError("a function is written in C that is kept already")


@needs_compiler
def test_a_stage_starts_from_what_is_kept(kept: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    first = compiled_stage(strip(), sections={"rod": [0.5]})
    files = set(kept.iterdir())
    monkeypatch.setattr(stage_module, "stage_functions", no_functions)
    second = compiled_stage(strip(), sections={"rod": [0.5]})
    assert {file.suffix for file in files} == {".so", ".texts"}
    assert set(kept.iterdir()) == files
    at = [np.full(first.numel_in(0), 0.1), np.array([0.9, 0.5, -0.4])]
    for expected, found in zip(first.call(at), second.call(at), strict=True):
        assert_array_equal(found.full(), expected.full())
    with pytest.raises(AssertionError, match="kept already"):
        compiled_stage(strip(), sections={"rod": [0.25]})


@needs_compiler
def test_rows_are_written_once(kept: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    first = row_library(strip(), lanes=True)
    assert first.in_lanes
    monkeypatch.setattr(rows, "assembled", no_functions)
    assert row_library(strip(), lanes=True) == first
    with pytest.raises(AssertionError, match="kept already"):
        row_library(strip())
