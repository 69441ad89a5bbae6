"""The stability of every row of a sweep: in C and in Python, beside Euler's load, and empty where it has no meaning."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from cosserat_casadi import read_sweep, sweep
from tests.families import mostly_slow
from tests.scenes import push, rod, scene

pytestmark = pytest.mark.usefixtures("few_checked")

COLUMN = {"name": "rod", "length": 1.0, "stiffness": {"bending_y": 1.0}}
FIXED = {"modes": 6, "nodes": 12, "tolerance": 1e-4}
CRITICAL = np.pi**2 / 4
STIFFNESSES = {"rod.stiffness.bending_y": [1.0, 1.0, 2.0, 2.0]}
THRUSTS = {"push.force.z": [-0.99 * CRITICAL, -1.01 * CRITICAL, -1.99 * CRITICAL, -2.01 * CRITICAL]}


@pytest.mark.parametrize("compiled_from", mostly_slow([1, 1000], quick=[1]))
def test_stability_of_every_row_vs_euler(compiled_from: int, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr("cosserat_casadi.sweeps.arguments.COMPILED_FROM", compiled_from)
    upright = scene(push(force=[0.0, 0.0, 0.0]), rods=[{**COLUMN, "strain": "planar"}], accuracy=FIXED)
    file = tmp_path / "rows.csv"
    found = sweep(upright, {**STIFFNESSES, **THRUSTS}, file, stability=True)
    assert found.converged.all()
    assert found.columns[-2:] == ("smallest_eigenvalue", "stable")
    assert_array_equal(found["stable"], [1.0, 0.0, 1.0, 0.0])
    # In units of the scene's EI/ℓ: twice the stiffness, of which half the share is left.
    margins = found["smallest_eigenvalue"]
    assert_allclose(margins[:2], [-margins[1], -margins[0]], rtol=0.05, atol=0)
    assert_allclose(margins[2:], margins[:2], rtol=0.05, atol=0)
    rows = list(csv.DictReader(file.read_text().splitlines()))
    assert [row["stable"] for row in rows] == ["true", "false", "true", "false"]
    assert_array_equal(read_sweep(file).values, found.values)
    again = sweep(upright, {**STIFFNESSES, **THRUSTS})
    assert again.columns == found.columns[:-2]
    assert_array_equal(again.values, found.values[:, :-2])


@pytest.mark.slow
def test_eigenvalues_are_counted_in_the_scene_compiled_or_not(monkeypatch: pytest.MonkeyPatch) -> None:
    """Stiffness and length of rods that are bent: a small table in Python has the numbers of a large one in C."""
    bent = scene(push(force=[0.3, 0.0, -0.4]), rods=[{**COLUMN, "strain": "planar"}], accuracy={**FIXED, "modes": 4})
    varied = {"rod.stiffness.bending_y": [0.7, 1.6, 1.0, 1.3], "rod.length": [1.0, 1.2, 0.8, 1.1]}
    in_python = sweep(bent, varied, stability=True)
    monkeypatch.setattr("cosserat_casadi.sweeps.arguments.COMPILED_FROM", 1)
    compiled = sweep(bent, varied, stability=True)
    assert in_python.converged.all()
    eigenvalues = in_python["smallest_eigenvalue"]
    assert_allclose(eigenvalues, compiled["smallest_eigenvalue"], rtol=1e-6, atol=0)
    # And not in those of their own, of which the second has another.
    assert eigenvalues[1] / eigenvalues[0] > 1.6


@pytest.mark.slow
def test_rows_without_a_potential_are_not_judged(tmp_path: Path) -> None:
    """A force that turns with the rod has none, unless it is zero."""
    turning = scene(push(force=[0.0, 0.0, 0.0], frame="body"), rods=[rod("planar")], accuracy={**FIXED, "modes": 3})
    file = tmp_path / "rows.parquet"
    found = sweep(turning, {"push.force.x": [0.0, 0.5, 0.0, -0.5]}, file, stability=True)
    assert found.converged.all()
    assert_array_equal(found["stable"], [1.0, np.nan, 1.0, np.nan])
    assert_array_equal(np.isnan(found["smallest_eigenvalue"]), [False, True, False, True])
    assert_array_equal(read_sweep(file).values, found.values)
