"""The reference cases, from a cold start with default settings."""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Solution, read_scene, solve
from tests.conftest import case_files
from tests.families import mostly_slow
from tests.pose_errors import angle_between, distance_between
from tests.shooting_near import integrate

RODS = case_files("rods")
pytestmark = pytest.mark.skipif(not RODS, reason="the reference cases are not beside this checkout")


@cache
def solved(path: Path) -> Solution:
    return solve(read_scene(path))


def reference(path: Path) -> dict[str, Any]:
    found: dict[str, Any] = json.loads(path.with_suffix(".json").read_text())
    return found


def true_tip_error(path: Path) -> float:
    case, tip = reference(path), solved(path).tip()
    wanted = case["expected"]["tip"]
    error = distance_between(tip.position, wanted["position"]) / case["length"]
    if "rotation" in wanted:
        error = max(error, angle_between(tip.rotation, wanted["rotation"]))
    return error


EACH = pytest.mark.parametrize("path", mostly_slow(RODS, quick=RODS[::3]), ids=lambda path: path.stem)
"""Half of the cases every time: those of a family follow each other."""


@EACH
def test_tip_and_base_wrench_vs_independent_solvers(path: Path) -> None:
    case, solution = reference(path), solved(path)
    assert solution.converged, solution.message
    tolerance, wanted = case["position_tolerance_relative_to_length"], case["expected"]
    assert true_tip_error(path) <= tolerance
    if "base_wrench" in wanted:
        base = solution.base_wrench()
        force, moment = (np.asarray(wanted["base_wrench"][k], dtype=float) for k in ("force", "moment"))
        largest = max(np.abs(force).max(), np.abs(moment).max())
        assert_allclose(base.force, force, rtol=0, atol=tolerance * largest)
        assert_allclose(base.moment, moment, rtol=0, atol=tolerance * largest)


@EACH
def test_error_estimate_vs_true_error(path: Path) -> None:
    """The estimate is honest (true error at most ten times it) and sharp (at most a hundred times the truth)."""
    estimate, true = solved(path).error_estimate, true_tip_error(path)
    assert estimate is not None
    assert true <= 10 * estimate
    # The references carry errors of their own, up to 1e-11; below that nothing can be said of sharpness.
    assert estimate <= 100 * max(true, 1e-11)


@pytest.mark.parametrize("tolerance", mostly_slow([1e-3, 1e-5, 1e-7], quick=[1e-5]))
@pytest.mark.parametrize("path", mostly_slow(RODS[::3], quick=RODS[::12]), ids=lambda path: path.stem)
def test_error_vs_tolerance_asked_for(path: Path, tolerance: float) -> None:
    solution = solve(read_scene(path, (f"accuracy.tolerance={tolerance}",)))
    case, tip = reference(path), solution.tip()
    error = distance_between(tip.position, case["expected"]["tip"]["position"]) / case["length"]
    assert solution.converged, solution.message
    assert error <= tolerance


HELD = case_files("supports")


@pytest.mark.slow
@pytest.mark.parametrize("path", HELD, ids=lambda path: path.stem)
def test_held_rod_from_a_cold_start_is_stable_and_meets_its_pose(path: Path) -> None:
    """Any stable equilibrium counts: integrated from its base wrench it must end at the prescribed pose."""
    case, solution = reference(path), solved(path)
    assert solution.converged, solution.message
    assert solution.stable is True
    base = solution.base_wrench()
    tip = integrate(solution.model.scene, base.force, base.moment)
    # The integration multiplies the errors of the base wrench by the rod's flexibility.
    assert_allclose(tip.position, case["expected"]["tip"]["position"], rtol=0, atol=1e-6 * case["length"])
    assert_allclose(tip.rotation, case["expected"]["tip"]["rotation"], rtol=0, atol=1e-5)
