"""Catalogue (h): a helical spring of ten turns."""

from __future__ import annotations

import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import solve
from tests.catalogue import cases
from tests.catalogue.checks import fine_model, initial_value_error, solved

FREE = cases.TURNS * cases.PITCH
"""Height of the unloaded spring."""


def test_soft_pull_vs_love() -> None:
    """A millionth of EI/R²: linear theory to four digits."""
    found = solve(fine_model(cases.spring(1e-6), 40, 100))
    assert found.converged, found.message
    assert_allclose(found.tip().position[2] - FREE, 1e-6 * cases.love_compliance(), rtol=1e-4, atol=0)


@pytest.mark.parametrize("force", [3e-3, *(pytest.param(f, marks=pytest.mark.slow) for f in (-3e-3, 0.02, -0.01))])
def test_spring_vs_initial_value(force: float) -> None:
    """The wire is 63 radii long; its tip is met to 1e-8 of that."""
    found = solve(fine_model(cases.spring(force), 56, 140))
    assert found.converged, found.message
    assert initial_value_error(found) < 1e-8
    assert (found.tip().position[2] - FREE) * force > 0


@pytest.mark.slow
@pytest.mark.parametrize("force", [3e-3, -3e-3])
def test_spring_to_a_tolerance(force: float) -> None:
    """Sixty-three radians in one element, found by the ladder itself."""
    found = solved(cases.spring(force), 1e-6)
    fine = solve(fine_model(cases.spring(force), 56, 140))
    assert_allclose(found.tip().position, fine.tip().position, rtol=0, atol=1e-6 * cases.spring_length())
