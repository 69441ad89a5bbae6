"""From tables to cases: what is joined, what is left out, and what is refused."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Model, SceneError, build
from cosserat_casadi.identification.measured_cases import Case, Datum, read_cases
from cosserat_casadi.identification.measured_rows import by_instant
from cosserat_casadi.scene import read_scene, scene_from_dict

ROD: dict[str, Any] = {
    "name": "rod",
    "length": 0.2,
    "strain": "planar",
    "stiffness": {"bending_x": 1.0, "bending_y": 1.0, "torsion": 1.0},
}
PUSH = {"name": "push", "kind": "tip_wrench", "rod": "rod", "force": [0.1, 0, 0]}
POSITION = {"quantity": "position", "file": "a.csv", "rod": "rod", "columns": ["x", "", "z"], "sigma": 1e-3}
WRENCH = {
    "quantity": "base_wrench",
    "file": "a.csv",
    "rod": "rod",
    "columns": ["F", "", "", "", "", ""],
    "sigma": 1e-2,
}
STIFFNESS = {"parameter": "rod.stiffness.bending_y"}
SETS = {"push.force.x": "load"}


def cases_of(
    measurements: list[dict[str, Any]], data: dict[str, Any], unknown: dict[str, Any] = STIFFNESS
) -> list[Case]:
    tables = {"schema": 1, "accuracy": {"modes": 2, "nodes": 4}, "rods": [ROD], "loads": [PUSH]}
    scene = scene_from_dict({**tables, "measurements": measurements, "unknowns": [unknown]}).with_unknowns()
    model: Model = build(scene)
    return read_cases(scene, model.inputs, data)


TABLE: dict[str, list[Any]] = {
    "load": [0.1, 0.1, 0.2, 0.3],
    "X": [0.5, 1.0, 1.0, 1.0],
    "x": [1.0, 2.0, 3.0, np.nan],
    "z": [4.0, np.nan, 5.0, np.nan],
    "F": [np.nan, 7.0, np.nan, 8.0],
    "phase": ["rest", "rest", "moved", "moved"],
    "shape": ["a", "", "b", "b"],
}


def test_rows_of_equal_inputs_are_one_case() -> None:
    cases = cases_of([{**POSITION, "inputs": SETS, "at": "X"}], {"a.csv": TABLE})
    assert [len(case.data[0]) for case in cases] == [2, 1]
    first, second = cases[0].data[0]
    assert (first.at, second.at) == (0.5, 1.0)
    # A column that is not named is not measured, nor is an empty cell.
    assert_allclose(first.values, [1.0, np.nan, 4.0], rtol=0, atol=0)
    assert_allclose(second.values, [2.0, np.nan, np.nan], rtol=0, atol=0)
    assert [case.inputs[0] for case in cases] == [0.1, 0.2]


def test_measurements_of_one_file_share_what_its_rows_are_under() -> None:
    cases = cases_of([{**POSITION, "inputs": SETS}, WRENCH], {"a.csv": TABLE})
    assert [case.inputs[0] for case in cases] == [0.1, 0.2, 0.3]
    assert [sorted(case.data) for case in cases] == [[0, 1], [0], [1]]


def test_rows_are_cases_where_unknowns_are_of_each() -> None:
    force = {"input": "push.force.x", "per_row": True}
    assert len(cases_of([POSITION], {"a.csv": TABLE}, force)) == 3
    joined = cases_of([{**POSITION, "case": "phase"}], {"a.csv": TABLE}, force)
    assert [len(case.data[0]) for case in joined] == [2, 1]


def test_rows_are_chosen_and_cells_scaled() -> None:
    sets = {"push.force.x": {"column": "load", "scale": -2.0, "shift": 1.0}, "push.force.z": 0.25}
    measurement = {**POSITION, "inputs": sets, "where": {"phase": "moved"}, "scale": 1e-3, "shift": [0.5, 0.0, 0.0]}
    (case,) = cases_of([measurement], {"a.csv": TABLE})
    assert_allclose(case.inputs[:3], [0.6, 0.0, 0.25], rtol=1e-15, atol=0)
    assert_allclose(case.data[0][0].values, [0.503, np.nan, 0.005], rtol=1e-15, atol=0)
    (case,) = cases_of([{**POSITION, "inputs": SETS, "where": {"load": 0.2}}], {"a.csv": TABLE})
    assert case.where == "a.csv, line 3"


REFUSED: dict[str, tuple[dict[str, Any], str]] = {
    "column": ({"columns": ["x", "y", "z"]}, "a.csv: has no column 'y' (columns: load, X, x, z, F, phase, shape)"),
    "text": ({"columns": ["phase", "", ""]}, "a.csv, line 1: phase must be a finite number, or empty"),
    "abscissa": ({"at": "load_X"}, "a.csv: has no column 'load_X'"),
    "far": ({"at": "x"}, "a.csv, line 2: x must be an abscissa from 0 to 1, got 2"),
    "nothing": ({"where": {"phase": "sleep"}}, "nothing was measured in any row"),
    "part": ({"inputs": {"push.force": "load"}}, "push.force has several numbers (one of push.force.x"),
    "label": ({"case": "shape"}, "a.csv, line 2: shape is empty, but says which case"),
    "empty": ({"inputs": {"push.force.x": "F"}}, "a.csv, line 1: F is empty, but sets push.force.x"),
}


@pytest.mark.parametrize("change, sentence", REFUSED.values(), ids=REFUSED)
def test_a_faulty_table_is_refused(change: dict[str, Any], sentence: str) -> None:
    with pytest.raises(SceneError) as refusal:
        cases_of([{**POSITION, "inputs": SETS, **change}], {"a.csv": TABLE})
    assert sentence in str(refusal.value)
    assert refusal.value.page == "identify"


def test_rows_of_one_case_agree_on_its_inputs() -> None:
    with pytest.raises(SceneError, match=r"line 4: sets push\.force\.x to 0\.3, but a\.csv, line 3 sets it to 0\.2"):
        cases_of(
            [{**WRENCH, "inputs": SETS, "case": "phase", "columns": ["load", "", "", "", "", ""]}], {"a.csv": TABLE}
        )


def test_unknown_names_and_lengths_of_columns_are_refused() -> None:
    with pytest.raises(SceneError, match=r"b.csv: is no measurement of this scene"):
        cases_of([POSITION], {"a.csv": TABLE, "b.csv": TABLE})
    with pytest.raises(SceneError, match=r"must have columns of one length, got x \(2,\), z \(1,\)"):
        cases_of([POSITION], {"a.csv": {"x": [1.0, 2.0], "z": [1.0]}})


def test_a_file_lies_beside_its_scene(tmp_path: Path) -> None:
    (tmp_path / "scene.toml").write_text(
        'schema = 1\n[accuracy]\nmodes = 2\nnodes = 4\n[[rods]]\nname = "rod"\nlength = 0.2\nstrain = "planar"\n'
        "stiffness = { bending_x = 1.0, bending_y = 1.0, torsion = 1.0 }\n"
        '[[measurements]]\nquantity = "position"\nfile = "a.csv"\nrod = "rod"\ncolumns = ["x", "", "z"]\nsigma = 1e-3\n'
        '[[unknowns]]\nparameter = "rod.stiffness.bending_y"\n'
    )
    scene = read_scene(tmp_path / "scene.toml").with_unknowns()
    layout = build(scene).inputs
    with pytest.raises(SceneError, match=r"a\.csv: cannot be read: No such file"):
        read_cases(scene, layout)
    (tmp_path / "a.csv").write_text("x,note,z\n0.1,first,\n,,\n nan ,,0.2\n")
    (case,) = read_cases(scene, layout)
    assert [datum.where for datum in case.data[0]] == [f"{tmp_path / 'a.csv'}, line 2", f"{tmp_path / 'a.csv'}, line 4"]
    (tmp_path / "a.csv").write_text("x,x,z\n0.1,0.2\n")
    with pytest.raises(SceneError) as refusal:
        read_cases(scene, layout)
    assert "has the column 'x' twice" in str(refusal.value)
    assert "line 2: has 2 values for 3 columns" in str(refusal.value)


def test_sections_of_one_equilibrium_or_instant_stand_together() -> None:
    def row(time: float) -> Datum:
        return Datum("somewhere", 0.5, np.zeros(3), time)

    at_rest = by_instant([(0, [row(float("nan")), row(float("nan"))]), (1, [row(float("nan"))])])
    assert [(case, len(data)) for case, data in at_rest] == [(0, 2), (1, 1)]
    moving = by_instant([(0, [row(0.1), row(0.2), row(0.1)])])
    assert [(case, len(data)) for case, data in moving] == [(0, 2), (0, 1)]
