"""Rods with waves along them: what is claimed to a tolerance, against an integration that shares no polynomial."""

from __future__ import annotations

import pytest

from cosserat_casadi import scene_from_dict, solve
from tests.families import mostly_slow
from tests.reference.routed_scenes import Table, miss, rich_scene, routed_scene

GRANTED = 1.01
"""Factor on an estimate by which the true error may exceed it."""

ROUTED = (0, 1, 10, 14, 15, 23, 55, 61)
RICH = (0, 1, 10, 19)
"""Seeds of which most missed the tolerance, or their estimate, while levels could be blind to waves."""


def check(tables: Table) -> bool:
    """Solve one scene; whether it converged. What did must be right."""
    scene = scene_from_dict(tables)
    solution = solve(scene)
    if not solution.converged:
        assert solution.message
        return False
    error = miss(scene, solution)
    assert solution.error_estimate is not None
    assert error.tip <= scene.accuracy.tolerance
    assert error.cable <= scene.accuracy.tolerance
    assert error.tip <= GRANTED * solution.error_estimate
    assert error.cable <= GRANTED * solution.error_estimate
    return True


@pytest.mark.parametrize("seed", mostly_slow(ROUTED, quick=ROUTED[:1]))
def test_routed_tendons_are_within_the_tolerance(seed: int) -> None:
    assert check(routed_scene(seed))


@pytest.mark.slow
@pytest.mark.parametrize("seed", RICH)
def test_rich_curvatures_and_loads_are_within_the_tolerance(seed: int) -> None:
    assert check(rich_scene(seed))


@pytest.mark.slow
@pytest.mark.parametrize("first", range(0, 300, 10))
def test_many_routed_tendons_are_within_the_tolerance(first: int) -> None:
    assert sum(check(routed_scene(seed)) for seed in range(first, first + 10)) >= 8


@pytest.mark.slow
@pytest.mark.parametrize("first", range(0, 60, 10))
def test_many_rich_curvatures_and_loads_are_within_the_tolerance(first: int) -> None:
    assert sum(check(rich_scene(seed)) for seed in range(first, first + 10)) >= 8
