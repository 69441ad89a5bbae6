"""Sweeps of concentric tubes: rows against `solve`, how they end, stability, refusals."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Outcome, SceneError, parse_scene, read_scene, read_sweep, solve, sweep
from cosserat_casadi.codegen.rows import row_results
from cosserat_casadi.scene.writing import scene_text
from cosserat_casadi.sweeps.outcome_table import LABELS
from cosserat_casadi.sweeps.row_model import result_row
from tests.commands import cosserat

EXAMPLES = Path(__file__).parents[2] / "examples"

SCENE = read_scene(EXAMPLES / "concentric_tubes.toml")

MOMENT = """
[[loads]]
name = "twist"
kind = "tip_wrench"
rod = "inner"
moment = [0.0, 0.0, 0.001]
"""


@pytest.mark.slow
def test_rows_are_what_solve_finds() -> None:
    turns = [0.0, 1.3, np.pi, -2.0]
    reaches = [0.2, 0.13, 0.2, 0.05]
    swept = sweep(SCENE, {"inner.rotation": turns, "inner.translation": reaches}, cores=1, stability=True)
    assert swept.holds
    assert swept.posed == ["outer", "inner"]
    for row, (turn, reach) in enumerate(zip(turns, reaches, strict=True)):
        solution = solve(SCENE, {"inner.rotation": turn, "inner.translation": reach})
        for tube in swept.posed:
            assert_allclose(swept.positions(tube)[row], solution.tip(tube).position, rtol=0, atol=1e-15)
            quaternion = [swept[f"{tube}.{part}"][row] for part in ("qw", "qx", "qy", "qz")]
            assert_allclose(quaternion, solution.tip(tube).quaternion, rtol=0, atol=1e-15)
        assert_allclose(swept["energy"][row], solution.energy, rtol=1e-12, atol=0)
        assert swept["iterations"][row] == solution.iterations
        assert swept["falling_directions"][row] == solution.stability.falling
        assert_allclose(swept["determinant"][row], solution.stability.determinant, rtol=1e-12, atol=0)
        assert swept["stable"][row] == solution.stable
    # Opposed tubes that come from straight ones are not stable; the others are.
    assert swept["stable"].tolist() == [1.0, 1.0, 0.0, 1.0]


@pytest.mark.slow
def test_other_numbers_of_tubes_are_swept_beside_inputs() -> None:
    curvatures = [10.0, 18.0, 18.0]
    turns = [1.0, 1.0, 2.0]
    swept = sweep(SCENE, {"inner.curvature": curvatures, "inner.rotation": turns}, cores=1)
    assert swept.record["parameters"] == ["inner.curvature"]
    for row, (curvature, turn) in enumerate(zip(curvatures, turns, strict=True)):
        bent = read_scene(EXAMPLES / "concentric_tubes.toml", [f"inner.curvature={curvature}"])
        solution = solve(bent, {"inner.rotation": turn})
        assert_allclose(swept.positions("inner")[row], solution.tip("inner").position, rtol=0, atol=1e-15)


@pytest.mark.slow
def test_loads_are_swept_and_moments_leave_stability_open() -> None:
    scene = parse_scene(scene_text(SCENE) + MOMENT)
    swept = sweep(scene, {"twist.moment.z": [0.0, 2e-3]}, cores=1, stability=True)
    expected = solve(scene, {"twist.moment": [0.0, 0.0, 2e-3]})
    assert_allclose(swept.positions("inner")[1], expected.tip("inner").position, rtol=0, atol=1e-15)
    assert np.isnan(swept["stable"]).all()
    assert np.isnan(swept["falling_directions"]).all()
    assert np.isfinite(swept["determinant"]).all()


@pytest.mark.parametrize(
    ("outcome", "label"), [(Outcome.LOAD_STALLED, "load_stalled"), (Outcome.UNRESOLVED, "unresolved")]
)
def test_what_did_not_converge_has_no_poses(outcome: Outcome, label: str) -> None:
    names = row_results(SCENE, stability=True)
    solution = replace(solve(SCENE), outcome=outcome)
    row = result_row(solution, len(names), solution)
    assert LABELS[int(row[0])] == label
    assert np.isfinite(row[:3]).all()
    assert np.isnan(row[3:]).all()


def test_refusals_name_all_rows_and_columns() -> None:
    with pytest.raises(SceneError) as refused:
        sweep(SCENE, {"inner.rotatoin": [0.0]})
    assert "row 1, inner.rotatoin: unknown key (did you mean 'rotation'?)" in str(refused.value)
    with pytest.raises(SceneError) as refused:
        sweep(SCENE, {"inner.straight": [0.18, -0.1]})
    assert "row 2, inner.straight: must be >= 0, got -0.1" in str(refused.value)
    with pytest.raises(SceneError) as refused:
        sweep(SCENE, {"inner.translation": [0.1, 0.4, -0.1]})
    assert "row 2: inner.translation must be from 0 to the length of the tube" in str(refused.value)
    assert "row 3: inner.translation" in str(refused.value)
    with pytest.raises(SceneError, match="row 1: tubes no tube stands out of the plate"):
        sweep(SCENE, {"inner.translation": [0.0], "outer.translation": [0.0]})
    # A tube that is shorter in a row has a range of its own there.
    with pytest.raises(SceneError, match=r"row 2: inner\.translation must be .* length of the tube, 0\.25 m, got 0\.3"):
        sweep(SCENE, {"inner.translation": [0.3, 0.3], "inner.straight": [0.18, 0.11]})


def test_on_the_command_line(tmp_path: Path) -> None:
    grid = tmp_path / "grid.toml"
    grid.write_text("inner.rotation = [0.5, 1.0]\nouter.translation = 0.1\n", encoding="utf-8")
    scene = str(EXAMPLES / "concentric_tubes.toml")
    command = ("sweep", scene, "--over", "grid.toml", "--output", "rows.csv", "--cores", "1")
    ended = cosserat(*command, cwd=tmp_path)
    assert ended.returncode == 0, ended.stderr
    assert "as many steps as the tolerance 1e-06 asks for" in ended.stdout
    rows = read_sweep(tmp_path / "rows.csv")
    assert rows.outcome == ["converged", "converged"]
    record = json.loads((tmp_path / "rows.csv.json").read_text(encoding="utf-8"))
    assert record["tubes"] == ["outer", "inner"]
    again = cosserat(*command, cwd=tmp_path)
    assert "already holds this sweep" in again.stdout
    refused = cosserat(*command[:-4], "--output", "other.csv", "--set", "accuracy.modes=3", cwd=tmp_path)
    assert refused.returncode == 2
