"""Motions in C of scenes with parameters: equations and steps against the model's own, derivatives by differences."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Model
from cosserat_casadi.codegen.compiled_motion import StepOptions, StepState
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.numerics.outcome import Outcome
from tests.codegen.libraries import Exported, Recipe
from tests.codegen.motions import EXACT
from tests.codegen.test_parameters_in_c import RECIPES as AT_REST
from tests.derivatives import central_differences

FEW_INPUTS = AT_REST["pwire"].scene.model_copy(update={"inputs": ("push.force", "pull.tension")})

RECIPES = {
    "moving_pwire": Recipe(FEW_INPUTS, 1, 2, dynamics=True),
    "moving_probot": Recipe(AT_REST["probot"].scene, 2, 4, dynamics=True),
}
"""A rod, and an assembly that is eliminated rod after rod."""

STEP = 1e-4
DT = 0.01


@pytest.fixture(scope="module", params=["moving_pwire", pytest.param("moving_probot", marks=pytest.mark.slow)])
def made(request: pytest.FixtureRequest, export_recipe: Callable[[str, Recipe], Exported]) -> Exported:
    return export_recipe(request.param, RECIPES[request.param])


def other_parameters(model: Model) -> FloatArray:
    return 1.03 * model.parameters.pack()


def speeds(model: Model) -> FloatArray:
    """Rates of the inputs."""
    return np.linspace(1.0, 3.0, model.inputs.size)


@pytest.mark.slow
def test_equations_of_motion(made: Exported) -> None:
    model, compiled = made.model, made.compiled
    random = np.random.default_rng(1)
    size = model.size
    state = StepState(0.05 * random.standard_normal(size), random.standard_normal(size), random.standard_normal(size))
    inputs, rate, p = model.inputs.pack(), speeds(model), other_parameters(model)
    at = [state.x, state.v, state.a, inputs, p, rate, 2 * rate]
    residual = compiled.inverse_dynamics(state, inputs, rate, 2 * rate, parameters=p)
    wanted = model.inverse_dynamics(*at).full()[:, 0]
    assert_allclose(residual, wanted, rtol=0, atol=1e-12 * np.abs(wanted).max())
    linear = compiled.linearise(state, inputs, rate, parameters=p)
    matrices = model.dynamics_jacobian(*at[:-1], 0 * rate)[:3]
    for found, expected in zip((linear.stiffness, linear.damping, linear.mass), matrices, strict=True):
        assert_allclose(found, expected.full(), rtol=0, atol=1e-12 * np.abs(expected.full()).max())
    by_each = {
        3: linear.by_inputs,
        4: linear.by_parameters,
        5: linear.by_inputs_rate,
        6: linear.by_inputs_acceleration,
    }
    still = [*at[:-1], 0 * rate]
    for number, found in by_each.items():
        slopes = central_differences(
            lambda moved, k=number: model.inverse_dynamics(*still[:k], moved, *still[k + 1 :]),
            at[number],
            STEP * np.maximum(np.abs(at[number]), 1e-2),
        )
        for column, slope in zip(found.T, slopes.T, strict=True):
            assert_allclose(column, slope, rtol=0, atol=1e-6 * max(np.abs(slope).max(), 1e-2))


def test_steps_and_their_derivatives(made: Exported) -> None:
    """A step is that of the library of the model with these parameters fixed, and derivatives are those of steps."""
    model, compiled = made.model, made.compiled
    inputs, rate, p = model.inputs.pack(), speeds(model), other_parameters(model)
    start = compiled.rest(inputs, compiled.solve(inputs, parameters=p).x, parameters=p)
    assert start is not None

    def end(values: FloatArray) -> FloatArray:
        taken = compiled.step(start, DT, inputs, rate, parameters=values, options=EXACT)
        assert taken.done
        return np.concatenate([taken.state.x, taken.state.v])

    taken, found = compiled.step_sensitivity(start, DT, inputs, rate, parameters=p, options=EXACT)
    assert taken.done
    assert found is not None
    assert_allclose(np.concatenate([taken.state.x, taken.state.v]), end(p), rtol=0, atol=1e-12)
    # Farther out of the plane of planar rods a step is refused.
    slopes = central_differences(end, p, STEP * np.maximum(np.abs(p), 5e-3))
    for column, slope in zip(found.by_parameters.T, slopes.T, strict=True):
        # Differences of multipliers lose digits beside forces that hardly change.
        assert_allclose(column, slope, rtol=0, atol=1e-5 * max(np.abs(slope).max(), 1e-2))


def test_a_step_in_parts_has_the_same_kind_of_derivatives(export_recipe: Callable[[str, Recipe], Exported]) -> None:
    """A step that is cut into parts, as one that asks for too much is."""
    exported = export_recipe("moving_pwire", RECIPES["moving_pwire"])
    model, compiled = exported.model, exported.compiled
    inputs, p = model.inputs.pack(), other_parameters(model)
    start = compiled.rest(inputs, parameters=p)
    assert start is not None
    hasty = StepOptions(tolerance=1e-12, iterations=8, parts=32)
    taken, found = compiled.step_sensitivity(start, 0.1, inputs, parameters=p, options=hasty)
    assert taken.done
    assert taken.parts > 1
    assert found is not None
    change = np.zeros(len(p))
    change[2] = STEP
    ends = [
        compiled.step(start, 0.1, inputs, parameters=p + side * change, options=hasty).state for side in (1.0, -1.0)
    ]
    slope = (np.concatenate([ends[0].x, ends[0].v]) - np.concatenate([ends[1].x, ends[1].v])) / (2 * STEP)
    assert_allclose(found.by_parameters[:, 2], slope, rtol=0, atol=1e-5 * np.abs(slope).max())


def test_parameters_that_are_not_finite_give_a_status(export_recipe: Callable[[str, Recipe], Exported]) -> None:
    exported = export_recipe("moving_pwire", RECIPES["moving_pwire"])
    compiled = exported.compiled
    inputs, p = exported.model.inputs.pack(), other_parameters(exported.model)
    start = compiled.rest(inputs, parameters=p)
    assert start is not None
    p[0] = np.nan
    assert compiled.rest(inputs, parameters=p) is None
    assert not compiled.step(start, DT, inputs, parameters=p).done
    assert compiled.solve(inputs, parameters=p).outcome is Outcome.NOT_FINITE
