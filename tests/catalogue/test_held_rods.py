"""Catalogue (f): rods clamped at both ends, from the straight rod, with default settings."""

from __future__ import annotations

import pytest
from numpy.testing import assert_allclose

from tests.catalogue import cases
from tests.catalogue.checks import initial_value_error, solved
from tests.reference.shooting import solve_by_shooting

PLANAR = list(cases.HELD)


@pytest.mark.parametrize(
    ("name", "strain"),
    [
        (PLANAR[1], "planar"),
        (PLANAR[2], "planar"),
        pytest.param(PLANAR[0], "planar", marks=pytest.mark.slow),
        *(pytest.param(name, "kirchhoff", marks=pytest.mark.slow) for name in PLANAR),
    ],
)
def test_held_rod_vs_initial_value(name: str, strain: str) -> None:
    """From the wrench that the clamp is said to exert, the rod arrives where its tip is held."""
    solution = solved(cases.held(name, strain))
    (position, _) = cases.HELD[name]
    assert_allclose(solution.tip().position, position, rtol=0, atol=1e-10)
    assert initial_value_error(solution) < 1e-8
    assert solution.stable is not None
    assert solution.stable or "unstable" in solution.message


@pytest.mark.slow
@pytest.mark.parametrize("name", PLANAR[1:])
def test_held_rod_vs_shooting(name: str) -> None:
    """The same equilibrium, not only some one."""
    solution, oracle = solved(cases.held(name)), solve_by_shooting(cases.held(name))
    X = [0.25, 0.5, 0.75]
    assert_allclose(solution.pose(X).position, oracle.at(X).position, rtol=0, atol=1e-8)
    assert solution.stable
