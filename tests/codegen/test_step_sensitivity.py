"""Derivatives of a step in C: against the implicit function theorem in Python, and against differences."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Model
from cosserat_casadi.codegen.compiled_motion import StepOptions, StepSensitivity, StepState
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.numerics.collocation import radau
from cosserat_casadi.numerics.step import StepPolynomial, TimeStep
from tests.codegen.libraries import Exported
from tests.codegen.motions import EXACT, Drive, MotionLibrary, accelerated, drive, python_steps, start_of

CABLE = pytest.param("given length", marks=pytest.mark.slow)
DRIVEN = pytest.param("driven and held", marks=pytest.mark.slow)
FREE = pytest.param("free with body", marks=pytest.mark.slow)
JOINTED = pytest.param("fixed joint", marks=pytest.mark.slow)

FAMILIES = ["planar", "planar held", "kirchhoff", "relaxing", JOINTED, FREE, CABLE, DRIVEN]

DT = 4e-3


def of_python(model: Model, step: TimeStep, driven: Drive) -> StepSensitivity:
    """The linear system of both stages, dense, in accelerations and multipliers themselves."""
    size, count = model.size, len(driven.inputs[0])
    method = radau(2)
    differential = step.differential
    stages = StepPolynomial(method, differential, step.start, step.size, step.unknowns).stages
    h = step.size
    moves = np.diag(differential.astype(float))
    still = np.eye(size) - moves
    system = np.zeros((2 * size, 2 * size))
    right = np.zeros((2 * size, 2 * size + 3 * count))
    for i in range(2):
        time = method.nodes[i] * h
        rate = driven.rates[0] + time * driven.accelerations[0]
        inputs = driven.inputs[0] + time * driven.rates[0] + time**2 / 2.0 * driven.accelerations[0]
        at = (stages.x[i], stages.v[i], stages.a[i], inputs, rate, driven.accelerations[0])
        stiffness, damping, mass, _ = (matrix.full() for matrix in model.dynamics_jacobian(*at))
        rows = slice(i * size, (i + 1) * size)
        for j in range(2):
            of_shapes = h**2 * method.matrix_squared[i, j] * stiffness + h * method.matrix[i, j] * damping
            columns = slice(j * size, (j + 1) * size)
            system[rows, columns] = (of_shapes + (i == j) * mass) @ moves + (i == j) * stiffness @ still
        residual = model.inverse_dynamics
        by_inputs, by_rate, by_acceleration = (slopes(residual, at, which) for which in (3, 4, 5))
        right[rows, :size] = stiffness @ moves
        right[rows, size : 2 * size] = (method.nodes[i] * h * stiffness + damping) @ moves
        right[rows, 2 * size : 2 * size + count] = by_inputs
        right[rows, 2 * size + count : 2 * size + 2 * count] = time * by_inputs + by_rate
        right[rows, 2 * size + 2 * count :] = time**2 / 2.0 * by_inputs + time * by_rate + by_acceleration
    row_scales = np.abs(system).max(axis=1)[:, None]
    column_scales = np.abs(system / row_scales).max(axis=0)[:, None]
    scaled = system / row_scales / column_scales.T
    changes = -np.linalg.solve(scaled, right / row_scales) / column_scales
    first, second = changes[:size], changes[size:]
    of_x = moves @ (h**2 * (method.matrix_squared[1, 0] * first + method.matrix_squared[1, 1] * second))
    of_x += still @ second
    of_v = moves @ (h * (method.matrix[1, 0] * first + method.matrix[1, 1] * second))
    of_x[:, :size] += moves
    of_x[:, size : 2 * size] += h * moves
    of_v[:, size : 2 * size] += moves
    whole = np.vstack([of_x, of_v])
    ends = 2 * size + count * np.arange(3)
    return StepSensitivity(*np.split(whole, ends, axis=1), np.zeros((2 * size, 0)))


def slopes(function: Callable[..., object], at: tuple[FloatArray, ...], which: int) -> FloatArray:
    """Derivative of a CasADi function by one of its arguments, with the function's own derivatives."""
    forward = function.jacobian()  # type: ignore[attr-defined]
    nothing = np.zeros(function.size1_out(0))  # type: ignore[attr-defined]
    found: FloatArray = forward(*at, nothing)[which].full()
    return found


def taken(
    made: Exported, state: StepState, driven: Drive, options: StepOptions = EXACT
) -> tuple[StepState, StepSensitivity]:
    step, sensitivity = made.compiled.step_sensitivity(state, driven.dt, *next(driven.steps), options=options)
    assert step.done
    assert sensitivity is not None
    return step.state, sensitivity


@pytest.mark.parametrize("family", FAMILIES)
def test_sensitivity_vs_python(motion_library: MotionLibrary, family: str) -> None:
    made = motion_library(family)
    assert_sensitivity_of_python(made, drive(made.model, DT, 1))


@pytest.mark.slow
def test_sensitivity_with_accelerations_of_inputs_vs_python(motion_library: MotionLibrary) -> None:
    made = motion_library("driven and held")
    assert_sensitivity_of_python(made, accelerated(made.model, DT, 1))


def assert_sensitivity_of_python(made: Exported, driven: Drive) -> None:
    start = start_of(made.model)
    (step,) = python_steps(made.model, start, driven)
    wanted = of_python(made.model, step, driven)
    end, found = taken(made, start, driven)
    plain = made.compiled.step(start, driven.dt, *next(driven.steps), options=EXACT)
    assert_allclose(end.x, plain.state.x, rtol=0, atol=0)
    scale = entry_scales(made.model)
    for name in ("by_start", "by_inputs", "by_inputs_rate", "by_inputs_acceleration"):
        ours, theirs = getattr(found, name), getattr(wanted, name)
        rows = scale * (1.0 + np.abs(theirs).max(axis=1))
        assert_allclose(ours / rows[:, None], theirs / rows[:, None], rtol=0, atol=1e-11, err_msg=name)


def entry_scales(model: Model) -> FloatArray:
    """Velocities have as many digits as positions over the step have, multipliers as accelerations."""
    differential = model.discrete.unknowns.differential
    return np.concatenate([np.where(differential, 1.0, 1e3), np.ones(model.size)])


@pytest.mark.parametrize("family", FAMILIES)
def test_sensitivity_vs_differences(motion_library: MotionLibrary, family: str) -> None:
    """Central differences of the step in every direction, with one term of Richardson's extrapolation."""
    made = motion_library(family)
    assert_sensitivity_of_differences(made, drive(made.model, DT, 1))


@pytest.mark.parametrize("family", ["kirchhoff", CABLE, DRIVEN])
def test_sensitivity_with_accelerations_of_inputs_vs_differences(motion_library: MotionLibrary, family: str) -> None:
    made = motion_library(family)
    assert_sensitivity_of_differences(made, accelerated(made.model, DT, 1))


def assert_sensitivity_of_differences(made: Exported, driven: Drive) -> None:
    start = start_of(made.model)
    _, found = taken(made, start, driven)
    size = made.model.size
    moves = np.concatenate([made.model.discrete.unknowns.differential] * 2)
    whole = np.hstack([found.by_start, found.by_inputs, found.by_inputs_rate, found.by_inputs_acceleration])
    given = np.concatenate([start.x, start.v, driven.inputs[0], driven.rates[0], driven.accelerations[0]])

    def end(values: FloatArray) -> FloatArray:
        state = StepState(values[:size], values[size : 2 * size], start.a)
        inputs, rate, acceleration = np.split(values[2 * size :], 3)
        step = made.compiled.step(state, driven.dt, inputs, rate, acceleration, options=EXACT)
        assert step.done
        return np.concatenate([step.state.x, step.state.v])

    draw = np.random.default_rng(1)
    for _ in range(3):
        direction = draw.standard_normal(len(given))
        # Off the constraints a step snaps back to them: its derivative there is exact, and stiff.
        direction[: 2 * size] *= moves
        spans = 1e-5, 2e-5
        near, far = ((end(given + s * direction) - end(given - s * direction)) / (2 * s) for s in spans)
        wanted = (4.0 * near - far) / 3.0
        error = np.abs(whole @ direction - wanted) / (1.0 + np.abs(wanted))
        assert error.max() < 1e-5


def test_multipliers_at_the_start_do_not_matter(motion_library: MotionLibrary) -> None:
    made = motion_library("planar held")
    _, found = taken(made, start_of(made.model), drive(made.model, DT, 1))
    algebraic = ~made.model.discrete.unknowns.differential
    assert algebraic.any()
    assert not found.by_start[:, : made.model.size][:, algebraic].any()
    assert not found.by_start[:, made.model.size :][:, algebraic].any()


def test_sensitivity_of_a_step_in_parts_is_that_of_its_parts(motion_library: MotionLibrary) -> None:
    """The chain rule, with inputs that move in the step."""
    made = motion_library("planar")
    start = start_of(made.model)
    inputs = 4.0 * made.model.pack()
    rate = inputs
    acceleration = -3.0 * inputs
    dt = 0.2
    short = StepOptions(1e-12, 5, 32)
    cut, found = made.compiled.step_sensitivity(start, dt, inputs, rate, acceleration, options=short)
    assert cut.done
    assert cut.parts > 1
    assert found is not None
    part = dt / cut.parts
    state = start
    by_start = np.eye(2 * made.model.size)
    by_inputs = np.zeros((2 * made.model.size, len(inputs)))
    by_rate = by_inputs
    by_acceleration = by_inputs
    for k in range(cut.parts):
        t = k * part
        path = (inputs + t * rate + t**2 / 2.0 * acceleration, rate + t * acceleration, acceleration)
        step, own = made.compiled.step_sensitivity(state, part, *path, options=StepOptions(1e-12, 20, 1))
        assert own is not None
        by_acceleration = own.by_start @ by_acceleration + own.by_inputs_acceleration
        by_acceleration += t * own.by_inputs_rate + t**2 / 2.0 * own.by_inputs
        by_rate = own.by_start @ by_rate + own.by_inputs_rate + t * own.by_inputs
        by_inputs = own.by_start @ by_inputs + own.by_inputs
        by_start = own.by_start @ by_start
        state = step.state
    pairs = [
        (found.by_start, by_start),
        (found.by_inputs, by_inputs),
        (found.by_inputs_rate, by_rate),
        (found.by_inputs_acceleration, by_acceleration),
    ]
    for ours, theirs in pairs:
        assert_allclose(ours, theirs, rtol=0, atol=1e-7 * (1.0 + np.abs(theirs).max()))


def test_a_controller_that_differentiates_evaluates_few_jacobians_beside(motion_library: MotionLibrary) -> None:
    """Those at the stages make the next one: none is evaluated for Newton's method alone after the first step."""
    made = motion_library("kirchhoff")
    driven = drive(made.model, 1e-2, 10)
    memory = made.compiled.step_memory()
    state = start_of(made.model)
    jacobians = 0
    for path in driven.steps:
        step, _ = made.compiled.step_sensitivity(state, driven.dt, *path, memory=memory, options=EXACT)
        assert step.done
        state = step.state
        jacobians += step.jacobians
    assert jacobians <= 2
