"""Random legal scenes: each ends in a true outcome, and what converged is within its estimate."""

from __future__ import annotations

import numpy as np
import pytest

from cosserat_casadi import build, discretise, solve, solve_scene
from tests.random_scenes import random_scene


def check(seed: int) -> bool:
    """Solve one scene; whether it converged. What did not must say so, what did must be right."""
    wanted = random_scene(seed, tolerance=1e-4)
    solution = solve_scene(wanted)
    assert np.all(np.isfinite(solution.x))
    if not solution.converged:
        assert solution.message.startswith(("No equilibrium", "An equilibrium of the discrete model"))
        return False
    assert solution.error_estimate is not None
    assert solution.error_estimate <= 1e-4
    coarse = solution.model.discretisation["rod"]
    modes, nodes = min(coarse.modes[0] + 6, 70), coarse.nodes + 14
    fine = solve(build(wanted, discretise(wanted, modes, nodes, "magnus8")))
    if fine.converged:
        distance = np.abs(fine.tip().position - solution.tip().position).max() / wanted.rods[0].length
        assert distance <= 10 * solution.error_estimate
    return True


@pytest.mark.parametrize("first", [4, 8, 12])
def test_random_scenes_end_truly(first: int) -> None:
    assert sum(check(seed) for seed in range(first, first + 4)) >= 3


@pytest.mark.slow
@pytest.mark.parametrize("first", range(20, 220, 10))
def test_many_random_scenes_end_truly(first: int) -> None:
    assert sum(check(seed) for seed in range(first, first + 10)) >= 8
