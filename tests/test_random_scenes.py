"""Random legal scenes: each ends in a true outcome, and what converged is within its estimate."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Scene, build, discretise, scene_from_dict, solve
from tests.families import mostly_slow
from tests.pose_errors import distance_between, pose_error
from tests.reference.random_scenes import random_scene
from tests.reference.shooting import NoEquilibriumError, solve_by_shooting


def with_tolerance(seed: int, tolerance: float) -> Scene:
    return scene_from_dict({**random_scene(seed), "accuracy": {"tolerance": tolerance}})


def check(seed: int) -> bool:
    """Solve one scene; whether it converged. What did not must say so, what did must be right."""
    wanted = with_tolerance(seed, 1e-4)
    solution = solve(wanted)
    assert np.all(np.isfinite(solution.x))
    if not solution.converged:
        assert solution.message.startswith(("No equilibrium", "An equilibrium of the discrete model"))
        return False
    assert solution.error_estimate is not None
    assert solution.error_estimate <= 1e-4
    coarse = next(iter(solution.model.discretisation.values()))
    modes, nodes = min(coarse.modes[0] + 6, 70), coarse.nodes + 14
    fine = solve(build(wanted, discretise(wanted, modes, nodes, "magnus8")))
    if fine.converged:
        distance = distance_between(fine.tip().position, solution.tip().position) / wanted.rods[0].length
        assert distance <= 10 * solution.error_estimate
    return True


@pytest.mark.slow
@pytest.mark.parametrize("first", [4, 6, 8, 10, 12, 14])
def test_random_scenes_end_truly(first: int) -> None:
    assert sum(check(seed) for seed in range(first, first + 2)) >= 1


@pytest.mark.slow
@pytest.mark.parametrize("first", range(20, 220, 10))
def test_many_random_scenes_end_truly(first: int) -> None:
    assert sum(check(seed) for seed in range(first, first + 10)) >= 8


@pytest.mark.parametrize("seed", mostly_slow(range(12), quick=range(2)))
def test_random_scenes_vs_shooting(seed: int) -> None:
    """Tip and base wrench against an oracle that shares no code: rotation matrices, DOP853, shooting."""
    try:
        oracle = solve_by_shooting(random_scene(seed))
    except NoEquilibriumError:
        pytest.skip("the oracle finds no equilibrium")
    wanted = with_tolerance(seed, 1e-9)
    solution = solve(wanted)
    assert solution.converged, solution.message
    length, tip, base = wanted.rods[0].length, solution.tip(), solution.base_wrench()
    error = pose_error((tip.position, tip.rotation), (oracle.tip_position, oracle.tip_rotation), length)
    assert error <= 2e-9
    size = np.abs(oracle.base_force).max() + np.abs(oracle.base_moment).max() / length
    assert_allclose(base.force, oracle.base_force, rtol=0, atol=1e-8 * size)
    assert_allclose(base.moment, oracle.base_moment, rtol=0, atol=1e-8 * size * length)
