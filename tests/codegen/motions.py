"""Scenes in motion as exported folders, and the same steps in Python."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from cosserat_casadi import Model, build, scene_from_dict
from cosserat_casadi.codegen.compiled_motion import CompiledStep, StepOptions, StepState
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.motion.displacement import displacements
from cosserat_casadi.numerics.collocation import radau
from cosserat_casadi.numerics.motion_equations import Instant, MotionEquations
from cosserat_casadi.numerics.stage_newton import NewtonBounds, StageOutcome, solve_stages
from cosserat_casadi.numerics.step import StepPolynomial, TimeStep, extrapolated
from cosserat_casadi.numerics.step_matrices import step_matrices
from tests import moving_scenes
from tests.codegen.libraries import Exported

MotionLibrary = Callable[[str], Exported]

EXACT = StepOptions(tolerance=1e-14, iterations=20)
"""Newton's method to rounding of positions; those of cables that pull hard have a few more."""


FEWEST = {"modes": 1, "nodes": 3}
COARSER = {"kirchhoff": FEWEST, "fixed joint": FEWEST, "relaxing joints": FEWEST}
"""What the compiler would take longest for is exported with fewer unknowns."""


@dataclass(frozen=True)
class MovingRecipe:
    """A family of scenes in motion."""

    family: str
    dynamics: bool = True

    def model(self) -> Model:
        tables = moving_scenes.ALL[self.family]()
        accuracy = COARSER.get(self.family, tables["accuracy"])
        return build(scene_from_dict({**tables, "accuracy": accuracy}), moving=True)


@dataclass(frozen=True)
class Drive:
    """Inputs that move with an acceleration of their own in each of several equal steps.

    Attributes:
        dt: length of a step, s.
        inputs: at the start of each, shape (steps, inputs).
        rates: at the start of each, shape (steps, inputs).
        accelerations: in each, shape (steps, inputs).
    """

    dt: float
    inputs: FloatArray
    rates: FloatArray
    accelerations: FloatArray

    @property
    def steps(self) -> Iterator[tuple[FloatArray, FloatArray, FloatArray]]:
        """Inputs, rates and accelerations of each step."""
        return zip(self.inputs, self.rates, self.accelerations, strict=True)


def drive(model: Model, dt: float, steps: int, seed: int = 0) -> Drive:
    """Forces, lengths and poses that begin to move where the consistent state says, linearly in each step."""
    state = moving_scenes.consistent_state(model, seed)
    times = dt * np.arange(steps + 1)[:, None]
    values = state.inputs + np.sin(2.0 * times) / 2.0 * state.inputs_rate
    rates = np.diff(values, axis=0) / dt
    return Drive(dt, values[:-1], rates, np.zeros_like(rates))


def accelerated(model: Model, dt: float, steps: int) -> Drive:
    """The same with accelerations in the steps, whose ends meet in value and rate."""
    state = moving_scenes.consistent_state(model, 0)
    accelerations = 5.0 * np.cos(200.0 * dt * np.arange(steps))[:, None] * (1.0 + np.abs(state.inputs_rate))
    rates = state.inputs_rate + dt * (np.cumsum(accelerations, axis=0) - accelerations)
    changes = dt * rates + dt**2 / 2.0 * accelerations
    values = state.inputs + np.cumsum(changes, axis=0) - changes
    return Drive(dt, values, rates, accelerations)


def equations(model: Model, inputs: FloatArray, rate: FloatArray, acceleration: FloatArray) -> MotionEquations:
    """The equations of motion in a step that begins at t = 0."""

    def inputs_at(t: float) -> tuple[FloatArray, FloatArray, FloatArray]:
        return inputs + t * rate + t**2 / 2.0 * acceleration, rate + t * acceleration, acceleration

    def residual(t: float, x: FloatArray, v: FloatArray, a: FloatArray) -> FloatArray:
        return np.asarray(model.inverse_dynamics(x, v, a, *inputs_at(t)).full().ravel())

    def jacobians(t: float, x: FloatArray, v: FloatArray, a: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        stiffness, damping, mass, _ = model.dynamics_jacobian(x, v, a, *inputs_at(t))
        return stiffness.full(), damping.full(), mass.full()

    return MotionEquations(model.discrete.unknowns.differential, residual, jacobians)


def python_steps(model: Model, state: StepState, driven: Drive) -> list[TimeStep]:
    """The steps of numerics.time_steps with two stages of Radau IIA, each with a Jacobian of its own, to rounding."""
    differential = model.discrete.unknowns.differential
    method = radau(2)
    bounds = NewtonBounds(np.where(differential, displacements(model), 0.0), 0.0, 40)
    now = Instant(0.0, state.x, state.v, state.a)
    steps = list[TimeStep]()
    for inputs, rate, acceleration in driven.steps:
        system = equations(model, inputs, rate, acceleration)
        guess = np.tile(np.where(differential, now.a, now.x), (2, 1))
        if steps:
            guess = extrapolated(steps[-1].method, steps[-1], driven.dt)
        middle = StepPolynomial(method, differential, now, driven.dt, guess).at_share(0.5, driven.dt / 2.0)
        matrices = step_matrices(method, driven.dt, system.linearised(middle), differential)
        assert matrices is not None
        found = solve_stages(system, matrices, now, guess, bounds)
        assert found.outcome is StageOutcome.CONVERGED
        # Each step has a clock of its own.
        end = StepPolynomial(method, differential, now, driven.dt, found.unknowns).arrival(0.0)
        nothing = {"error": 0.0, "iterations": 0, "residual": 0.0, "contraction": 0.0}
        steps.append(TimeStep(method, differential, now, driven.dt, found.unknowns, end, **nothing))  # type: ignore[arg-type]
        now = end
    return steps


def compiled_steps(
    made: Exported, state: StepState, driven: Drive, options: StepOptions | None = EXACT
) -> Sequence[CompiledStep]:
    """The same steps in C."""
    memory = made.compiled.step_memory()
    taken = list[CompiledStep]()
    for path in driven.steps:
        step = made.compiled.step(state, driven.dt, *path, memory=memory, options=options)
        assert step.done, step.status.value
        state = step.state
        taken.append(step)
    return taken


def start_of(model: Model, seed: int = 0) -> StepState:
    """A state with closed constraints, in motion."""
    state = moving_scenes.consistent_state(model, seed)
    differential = model.discrete.unknowns.differential
    return StepState(state.x, np.where(differential, state.v, 0.0), np.zeros(model.size))
