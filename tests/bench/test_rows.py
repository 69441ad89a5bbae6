"""Rows of the bench: the grid they come from, the front among them, the files they go into and come back from."""

from __future__ import annotations

import io
import json
from dataclasses import replace
from math import nan
from pathlib import Path

import pytest
from rich.console import Console
from work_precision.grid import METHODS, candidates, distinct_methods, method_problems
from work_precision.measurement import Measurement, front
from work_precision.record import CSV, fingerprint, output_problems, read_rows, write_json, write_rows
from work_precision.session import richer_candidates
from work_precision.table import print_bench

from cosserat_casadi import SceneError
from tests.fine_reference import Reference
from tests.scenes import push, rod, scene


def row(name: str, error: float, cold: float, **changes: object) -> Measurement:
    plain = Measurement(name=name, method="magnus4", position_error=error / 2, rotation_error=error, cold_us=cold)
    return replace(plain, **changes)


A, B, C = row("a", 1e-2, 5.0), row("b", 1e-4, 20.0), row("c", 1e-3, 30.0)


def test_front_holds_what_nothing_beats() -> None:
    assert front([C, B, A]) == [A, B]
    assert front([]) == []


def test_front_leaves_out_equals_other_models_and_what_was_not_timed() -> None:
    twin = replace(A, name="twin")
    richer = row("r", 1e-9, 1.0, strain="reissner")
    untimed = row("u", 1e-12, nan)
    lost = row("l", nan, 0.1)
    assert front([A, twin, richer, untimed, lost]) == [A]


def test_every_point_has_a_name_of_its_own_and_every_method_its_share() -> None:
    every = candidates(METHODS)
    assert len({candidate.name for candidate in every}) == len(every)
    few = candidates(METHODS, 3)
    assert [sum(c.method == method for c in few) for method in METHODS] == [3] * len(METHODS)
    assert {c.method for c in few[: len(METHODS)]} == set(METHODS)


def test_planar_rods_have_one_magnus_method() -> None:
    assert distinct_methods(scene(rods=[rod("planar")]), METHODS) == ["magnus4", "permuted", "dial"]
    assert distinct_methods(scene(), ["dial", "magnus8", "dial"]) == ["dial", "magnus8"]


def test_every_fault_of_the_choice_at_once() -> None:
    assert len(method_problems(["euler", "rk4"], 0)) == 3
    assert method_problems(METHODS, None) == []


def test_richer_model_only_where_its_stiffness_is_given() -> None:
    assert richer_candidates(scene(push())) == []
    (material,) = richer_candidates(
        scene(
            push(),
            rods=[
                {
                    "name": "rod",
                    "length": 0.2,
                    "strain": "kirchhoff",
                    "material": {"youngs_modulus": 60e9, "poisson_ratio": 0.33},
                    "section": {"shape": "circle", "radius": 1e-3},
                }
            ],
        )
    )
    assert material.name == "reissner dial 1e-06"


def test_rows_come_back_from_the_csv(tmp_path: Path) -> None:
    mark = fingerprint(scene(push()))
    rows = [A, replace(B, note='not compiled: "large", 1,000 operations', unknowns=7)]
    write_rows(tmp_path, mark, rows)
    found = read_rows(tmp_path, mark)
    assert repr(found) == repr(rows)
    assert [p.name for p in tmp_path.iterdir()] == [CSV]


def test_csv_of_another_scene_is_refused(tmp_path: Path) -> None:
    write_rows(tmp_path, fingerprint(scene(push())), [A])
    with pytest.raises(SceneError, match="another scene"):
        read_rows(tmp_path, fingerprint(scene(push(force=[0.0, 0.1, 0.0]))))


@pytest.mark.parametrize("content", [b"a,b\n1,2\n", b"\xff\xfe", b"", b"\x00"])
def test_csv_that_is_none_of_a_bench_is_refused(tmp_path: Path, content: bytes) -> None:
    (tmp_path / CSV).write_bytes(content)
    with pytest.raises(SceneError, match="--output"):
        read_rows(tmp_path, "mark")


def test_tolerance_and_title_do_not_make_another_scene() -> None:
    assert fingerprint(scene(push())) == fingerprint(scene(push(), title="x", accuracy={"tolerance": 1e-3}))


def test_json_is_strict_and_names_the_front(tmp_path: Path) -> None:
    write_json(tmp_path, scene(push()), [A, B, C, row("d", nan, nan)], {"reference": {"method": "shooting"}})
    text = (tmp_path / "bench.json").read_text()
    assert "NaN" not in text
    content = json.loads(text)
    assert content["schema"] == 1
    assert content["front"] == ["a", "b"]
    assert content["rows"][3]["cold_us"] is None


def test_folder_that_cannot_take_files_is_refused_before_any_work(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    assert output_problems(tmp_path) == []
    assert output_problems(tmp_path / "new") == []
    assert "is a file" in str(output_problems(tmp_path / "file")[0])
    assert "does not exist" in str(output_problems(tmp_path / "no" / "such")[0])


def test_table_of_a_narrow_terminal_is_whole() -> None:
    reference = Reference("a far finer discretisation", {})
    for width, heading in ((80, "pose error"), (180, "VM solve, µs")):
        console = Console(record=True, width=width, file=io.StringIO())
        sized = replace(A, name="reissner dial 1e-06", modes="12 12 12 4 4 4", unknowns=48, jacobian_operations=3e5)
        print_bench(console, "", reference, [sized, replace(B, note="not compiled: too large")])
        text = console.export_text()
        assert heading in text
        assert "…" not in text
        assert "b: not compiled: too large" in text
