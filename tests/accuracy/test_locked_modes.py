"""Modes that constraints lock are not chosen, however right the equilibrium at the scene's own inputs is."""

from __future__ import annotations

import numpy as np
import pytest

from cosserat_casadi import build, discretise, read_scene, solve, solve_scene
from cosserat_casadi.accuracy.preview import LEAST_COMPLIANCE, Preview
from cosserat_casadi.model.build import Model
from tests.conftest import CASES

PUSH = {"load.force": [0.3, 0.2, 0.1]}


def moved_by_push(model: Model) -> float:
    """Distance that a small push moves the platform, m."""
    still = solve(model, {"load.force": [0.0, 0.0, 0.0]}, estimate_error=False)
    pushed = solve(model, PUSH, estimate_error=False)
    assert still.converged
    assert pushed.converged
    return float(np.linalg.norm(pushed.body().position - still.body().position))


@pytest.fixture(scope="module")
def platform() -> Model:
    scene = read_scene(CASES / "away" / "platform_locks.toml")
    return build(scene, discretise(scene, 4, 8))


def test_modes_that_lock_are_beyond_all_bounds(platform: Model) -> None:
    preview = Preview(solve(platform, estimate_error=False))
    locked = dict.fromkeys(platform.discretisation, (2, 2, 1))
    free = dict.fromkeys(platform.discretisation, (4, 2, 1))
    assert np.all(np.isinf(preview.mode_shift(locked)))
    assert np.all(np.isfinite(preview.mode_shift(free)))


@pytest.mark.slow
def test_platform_moves_on_the_modes_that_its_scene_chooses(platform: Model) -> None:
    chosen = solve_scene(platform.scene).model.discretisation
    assert moved_by_push(build(platform.scene, chosen)) > LEAST_COMPLIANCE * moved_by_push(platform)
