"""The check of some rows: how far results lie from a solution, and what that says of the sweep."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import build, solve
from cosserat_casadi.sweeps.choice import pose_difference
from cosserat_casadi.sweeps.outcome_table import Sweep
from cosserat_casadi.sweeps.row_model import solved_poses
from tests.sweep.conftest import PLANAR

FINE = {"row": 0, "error_estimate": 2e-5, "difference": 1e-12, "stable": True}


def test_difference_of_a_row_from_a_solution() -> None:
    """Distances count over the length, 0.8 m; a quaternion and its negative are one rotation."""
    solution = solve(build(PLANAR), raise_on_failure=True)
    row = solved_poses(solution)
    position, quaternion = slice(0, 3), slice(3, 7)
    moved = row.copy()
    moved[position] += [0.004, 0.0, 0.003]
    assert_allclose(pose_difference(moved, solution), 0.005 / 0.8, rtol=1e-12, atol=0)
    w, x, y, z = row[quaternion]
    turned = row.copy()
    # Turned on by 0.02 rad about the axis y of the section.
    c, s = np.cos(0.01), np.sin(0.01)
    turned[quaternion] = [c * w - s * y, c * x - s * z, c * y + s * w, c * z + s * x]
    assert_allclose(pose_difference(turned, solution), 0.02, rtol=1e-12, atol=0)
    turned[quaternion] *= -1
    assert_allclose(pose_difference(turned, solution), 0.02, rtol=1e-12, atol=0)
    assert pose_difference(row, solution) == 0.0


@pytest.mark.parametrize(
    ("chosen", "checked", "outcomes", "holds"),
    [
        (3e-5, [FINE], [0, 0], True),
        (None, [], [0, 3], True),
        (3e-5, [], [3, 3], False),
        (3e-3, [FINE], [0, 0], False),
        (3e-5, [FINE, FINE | {"error_estimate": 2e-3}], [0, 0], False),
        (3e-5, [FINE, FINE | {"difference": 2e-3}], [0, 0], False),
        (3e-5, [FINE, FINE | {"error_estimate": None, "difference": None}], [0, 0], False),
        (np.nan, [FINE], [0, 0], False),
    ],
)
def test_a_sweep_holds_where_nothing_that_was_looked_at_misses(
    chosen: float | None, checked: list[dict[str, Any]], outcomes: list[int], holds: bool
) -> None:
    record = {"tolerance": 1e-4, "chosen": {"error_estimate": chosen}, "checked": checked}
    assert Sweep(("a.b",), ("iterations",), np.zeros((2, 2)), np.array(outcomes), record).holds is holds
