"""Modes that constraints lock are not chosen, however right the equilibrium at the scene's own inputs is."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import build, discretise, read_scene, solve
from cosserat_casadi.accuracy.preview import LEAST_COMPLIANCE, Preview
from cosserat_casadi.equilibrium.locking import locked_inputs, residual_by_inputs
from cosserat_casadi.model.build import Model
from tests.conftest import AWAY
from tests.derivatives import central_differences
from tests.scenes import push, scene

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
    legs = read_scene(AWAY / "platform_locks.toml")
    return build(legs, discretise(legs, 4, 8))


@pytest.mark.slow
def test_modes_that_lock_are_beyond_all_bounds(platform: Model) -> None:
    preview = Preview(solve(platform, estimate_error=False))
    locked = dict.fromkeys(platform.discretisation, (2, 2, 1))
    free = dict.fromkeys(platform.discretisation, (4, 2, 1))
    assert np.all(np.isinf(preview.mode_shift(locked)))
    assert np.all(np.isfinite(preview.mode_shift(free)))


def test_cables_of_given_length_take_freedom_too() -> None:
    """Where modes are dropped as where they are chosen: two bending modes and two cables leave nothing to move."""
    cables = [
        {"name": name, "kind": "tendon", "rod": "rod", "length": 0.79, "offset": [x, 0.0]}
        for name, x in (("east", 0.02), ("west", -0.02))
    ]
    strains = ["bending_y", "extension"]
    wire = scene(push(force=[0.0, 0.0, 0.0]), strain=strains, actuators=cables, inputs=["push.force"])
    preview = Preview(solve(build(wire, discretise(wire, 4, 10)), estimate_error=False))
    assert np.all(np.isinf(preview.mode_shift({"rod": (1, 1)})))
    assert np.all(np.isfinite(preview.mode_shift({"rod": (3, 3)})))


def test_derivatives_by_inputs_are_those_of_differences(platform: Model) -> None:
    solution = solve(platform, PUSH, estimate_error=False)
    derivatives = residual_by_inputs(platform, solution.x, solution.inputs)
    differences = central_differences(lambda u: platform.path_residual(solution.x, u, 1.0), solution.inputs, 1e-6)
    assert np.all(np.any(derivatives, axis=0))
    assert_allclose(derivatives, differences, rtol=0, atol=1e-7)


def test_a_scene_without_inputs_is_not_locked() -> None:
    held = {"rod": "rod", "kind": "clamped", "position": [0.0, 0.0, 0.8], "quaternion": [1.0, 0.0, 0.0, 0.0]}
    bare = scene(push(force=[0.0, 0.0, 0.0]), strain="planar", supports=[held], inputs=[], accuracy={"modes": 1})
    solution = solve(build(bare), estimate_error=False)
    assert solution.converged
    assert residual_by_inputs(solution.model, solution.x, solution.inputs).shape == (solution.model.size, 0)
    assert locked_inputs(solution) == ()


@pytest.mark.slow
def test_platform_moves_on_the_modes_that_its_scene_chooses(platform: Model) -> None:
    chosen = solve(platform.scene).model.discretisation
    assert moved_by_push(build(platform.scene, chosen)) > LEAST_COMPLIANCE * moved_by_push(platform)
