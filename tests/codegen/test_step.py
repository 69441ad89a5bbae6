"""A step of a motion in C: against the same step in Python, bounded, and honest where it fails."""

from __future__ import annotations

import ctypes
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi.codegen.compiled_motion import StepOptions, StepState
from cosserat_casadi.codegen.motion_parts import motion_in_c
from cosserat_casadi.codegen.names import Names
from cosserat_casadi.codegen.status import MotionStatus
from cosserat_casadi.model.unknowns import BlockKind
from cosserat_casadi.numerics.consistent_start import consistent_start
from tests import moving_scenes
from tests.codegen.libraries import Exported
from tests.codegen.motions import (
    EXACT,
    Drive,
    MotionLibrary,
    MovingRecipe,
    accelerated,
    compiled_steps,
    drive,
    equations,
    python_steps,
    start_of,
)

CABLE = pytest.param("given length", marks=pytest.mark.slow)
DRIVEN = pytest.param("driven and held", marks=pytest.mark.slow)
FREE = pytest.param("free with body", marks=pytest.mark.slow)

RELAXING = pytest.param("relaxing joints", marks=pytest.mark.slow)
DISKS = pytest.param("disks drawn out", marks=pytest.mark.slow)

JOINTED = pytest.param("fixed joint", marks=pytest.mark.slow)
FAMILIES = ["planar", "planar held", "kirchhoff", JOINTED, FREE, CABLE, DRIVEN, DISKS, "relaxing", RELAXING]
"""Rods alone, held and jointed, a floating base, a cable, a moving base with a length that changes, disks, and relaxing
stress."""


@pytest.mark.parametrize("family", FAMILIES)
def test_steps_vs_python(motion_library: MotionLibrary, family: str) -> None:
    """The same discrete motion to rounding."""
    made = motion_library(family)
    assert_same_steps(made, drive(made.model, 2e-3, 8))


@pytest.mark.parametrize("family", ["relaxing", RELAXING])
def test_systems_of_a_step_meet_in_no_flows(family: str) -> None:
    """Flows of relaxing stress are eliminated first; of one rod each block is the flows of one strain in one branch."""
    model = MovingRecipe(family).model()
    order = motion_in_c(model, Names("moving", ("a", "b"))).order
    ((_, flows), *_) = model.discrete.unknowns.of_kind(BlockKind.FLOW)
    assert order.separate
    assert set(order.interface).isdisjoint(range(flows.start, model.size))
    if family == "relaxing":
        assert order.interface == list(range(flows.start))
        assert [len(front.members) for front in order.fronts] == [2, 2]


@pytest.mark.parametrize("family", ["kirchhoff", CABLE, DRIVEN])
def test_steps_with_accelerations_of_inputs_vs_python(motion_library: MotionLibrary, family: str) -> None:
    """Forces, a cable, a base and a length along a path of second degree in each step."""
    made = motion_library(family)
    driven = accelerated(made.model, 2e-3, 4)
    assert_same_steps(made, driven)
    # The path matters: without the accelerations the rods are elsewhere, by ten thousand times what the steps agree to
    # even where only a force is accelerated.
    straight = compiled_steps(made, start_of(made.model), replace(driven, accelerations=0.0 * driven.accelerations))
    end = compiled_steps(made, start_of(made.model), driven)[-1].state
    assert np.abs(straight[-1].state.x - end.x).max() > 1e-8


def assert_same_steps(made: Exported, driven: Drive) -> None:
    """Positions to 1e-12, their rates and accelerations to as much over the step and over its square."""
    start = start_of(made.model)
    steps = python_steps(made.model, start, driven)
    taken = compiled_steps(made, start, driven)
    differential = made.model.discrete.unknowns.differential
    for theirs, ours in zip(steps, taken, strict=True):
        assert ours.parts == 1
        # Rounding of positions, over the step and over its square.
        for name, tolerance in (("x", 1e-12), ("v", 1e-13 / driven.dt), ("a", 1e-13 / driven.dt**2)):
            wanted = getattr(theirs.end, name)
            found = getattr(ours.state, name)
            size = 1.0 + np.abs(wanted[differential]).max()
            assert_allclose(found[differential], wanted[differential], rtol=0, atol=tolerance * size, err_msg=name)
        # Multipliers belong to accelerations: they have as many digits.
        others = theirs.end.x[~differential]
        size = 1.0 + np.abs(others).max(initial=0.0)
        assert_allclose(ours.state.x[~differential], others, rtol=0, atol=1e-9 * size)


@pytest.mark.parametrize("family", ["kirchhoff", "planar held", JOINTED])
def test_steps_to_the_default_tolerance_are_as_near_as_they_say(motion_library: MotionLibrary, family: str) -> None:
    made = motion_library(family)
    driven = drive(made.model, 1e-3, 8)
    start = start_of(made.model)
    exact = compiled_steps(made, start, driven)
    near = compiled_steps(made, start, driven, None)
    differential = made.model.discrete.unknowns.differential
    assert all(step.error_left <= 1e-11 for step in near)
    apart = np.abs(near[-1].state.x - exact[-1].state.x)[differential]
    assert apart.max() < 1e-9
    # One Jacobian serves several steps.
    assert sum(step.jacobians for step in near) < len(near)
    assert sum(step.iterations for step in near) < sum(step.iterations for step in exact)


@pytest.mark.parametrize("family", ["planar held", JOINTED, DRIVEN, CABLE])
def test_loops_stay_closed(motion_library: MotionLibrary, family: str) -> None:
    """After 200 steps, constraints are open by no more than 1e-10 of the length."""
    made = motion_library(family)
    driven = drive(made.model, 2e-3, 200)
    end = compiled_steps(made, start_of(made.model), driven, None)[-1].state
    inputs = driven.inputs[-1] + driven.dt * driven.rates[-1]
    held = moving_scenes.constrained_rows(made.model)
    if made.model.discrete.cables:
        held[[made.model.discrete.tension(cable).start for cable in made.model.discrete.cables]] = True
    gaps = made.model.residual(end.x, inputs).full().ravel()[held]
    assert gaps.size > 0
    assert np.abs(gaps).max() <= 1e-10


def test_inputs_are_held_where_no_rate_is_given(motion_library: MotionLibrary) -> None:
    made = motion_library("kirchhoff")
    start = start_of(made.model)
    inputs = made.model.pack()
    nothing = np.zeros_like(inputs)
    held = made.compiled.step(start, 1e-3, inputs)
    with_zeros = made.compiled.step(start, 1e-3, inputs, nothing, nothing)
    assert_allclose(held.state.x, with_zeros.state.x, rtol=0, atol=0)


@pytest.mark.parametrize("dt", [0.0, -1e-3, np.nan, np.inf])
def test_bad_length_of_a_step(motion_library: MotionLibrary, dt: float) -> None:
    made = motion_library("kirchhoff")
    start = start_of(made.model)
    taken = made.compiled.step(start, dt, made.model.pack())
    assert taken.status is MotionStatus.BAD_STEP
    assert taken.iterations == 0
    assert_allclose(taken.state.x, start.x, rtol=0, atol=0)


def test_numbers_that_are_not_finite_are_refused_and_leave_the_memory_of_use(motion_library: MotionLibrary) -> None:
    made = motion_library("kirchhoff")
    start = start_of(made.model)
    inputs = made.model.pack()
    memory = made.compiled.step_memory()
    first = made.compiled.step(start, 1e-3, inputs, memory=memory)
    spoilt = StepState(np.where(np.arange(made.model.size) == 1, np.nan, start.x), start.v, start.a)
    for state, given, rate, acceleration in (
        (spoilt, inputs, None, None),
        (first.state, inputs * np.inf, None, None),
        (first.state, inputs, inputs * np.nan, None),
        (first.state, inputs, None, inputs * np.nan),
        (first.state, inputs, inputs, inputs * np.inf),
    ):
        taken = made.compiled.step(state, 1e-3, given, rate, acceleration, memory=memory)
        assert taken.status is MotionStatus.NOT_FINITE
        assert taken.iterations == 0
        assert_allclose(taken.state.v, state.v, rtol=0, atol=0)
    assert made.compiled.step(first.state, 1e-3, inputs, memory=memory).done


def test_a_step_too_long_is_cut_and_says_so(motion_library: MotionLibrary) -> None:
    """What it ends with are the parts, taken one by one; where it may not be cut, nothing moves."""
    made = motion_library("planar")
    start = start_of(made.model)
    inputs = 4.0 * made.model.pack()
    dt = 0.2
    refused = made.compiled.step(start, dt, inputs, options=StepOptions(iterations=5, parts=1))
    assert refused.status is MotionStatus.NOT_SOLVED
    assert_allclose(refused.state.x, start.x, rtol=0, atol=0)
    cut = made.compiled.step(start, dt, inputs, options=StepOptions(tolerance=1e-12, iterations=5, parts=32))
    assert cut.done
    assert cut.parts > 1
    state = start
    for _ in range(cut.parts):
        state = made.compiled.step(state, dt / cut.parts, inputs, options=StepOptions(1e-12, 20, 1)).state
    assert_allclose(cut.state.x, state.x, rtol=0, atol=1e-10)
    assert_allclose(cut.state.v, state.v, rtol=0, atol=1e-8)


@pytest.mark.parametrize(
    ("family", "dt", "iterations"),
    [("planar", 0.2, 4), pytest.param("driven and held", 0.02, 8, marks=pytest.mark.slow)],
)
def test_parts_begin_where_the_inputs_have_moved_to(
    motion_library: MotionLibrary, family: str, dt: float, iterations: int
) -> None:
    """With the rates that they have there."""
    made = motion_library(family)
    start = start_of(made.model)
    inputs, rate, acceleration = next(accelerated(made.model, dt, 1).steps)
    short = StepOptions(tolerance=1e-12, iterations=iterations, parts=32)
    cut = made.compiled.step(start, dt, inputs, rate, acceleration, options=short)
    assert cut.done
    assert cut.parts > 1
    part = dt / cut.parts
    state = start
    for k in range(cut.parts):
        t = k * part
        path = (inputs + t * rate + t**2 / 2.0 * acceleration, rate + t * acceleration, acceleration)
        taken = made.compiled.step(state, part, *path, options=StepOptions(1e-12, 20, 1))
        assert taken.done
        state = taken.state
    differential = made.model.discrete.unknowns.differential
    assert_allclose(cut.state.x[differential], state.x[differential], rtol=0, atol=1e-10)
    assert_allclose(cut.state.v, state.v, rtol=0, atol=1e-8)


@pytest.mark.parametrize("family", FAMILIES)
def test_tolerance_zero_is_rounding(motion_library: MotionLibrary, family: str) -> None:
    made = motion_library(family)
    path = next(accelerated(made.model, 2e-3, 1).steps)
    start = start_of(made.model)
    taken = made.compiled.step(start, 2e-3, *path, options=StepOptions(tolerance=0.0))
    assert taken.done
    exact = made.compiled.step(start, 2e-3, *path, options=EXACT)
    differential = made.model.discrete.unknowns.differential
    assert_allclose(taken.state.x[differential], exact.state.x[differential], rtol=0, atol=1e-12)


@pytest.mark.parametrize("share", [0.0, 1e-12, 1e-9, 1e-6, 1e-3])
@pytest.mark.parametrize("family", ["planar", "kirchhoff"])
def test_tolerance_zero_of_a_rod_that_is_hardly_bent(motion_library: MotionLibrary, family: str, share: float) -> None:
    """Let go under a small share of its loads: corrections are rounding of the length, not of its small unknowns."""
    made = motion_library(family)
    inputs = share * made.model.pack()
    state = made.compiled.rest(inputs)
    assert state is not None
    for _ in range(3):
        taken = made.compiled.step(state, 2e-3, inputs, options=StepOptions(tolerance=0.0))
        assert taken.done
        assert taken.parts == 1
        state = taken.state
    assert np.abs(state.x).max() <= share


def test_work_is_bounded(motion_library: MotionLibrary) -> None:
    made = motion_library("kirchhoff")
    inputs = 1e9 * made.model.pack()
    for iterations, parts in ((1, 1), (3, 2), (5, 8), (0, 0), (1000, 1000)):
        taken = made.compiled.step(start_of(made.model), 10.0, inputs, options=StepOptions(0.0, iterations, parts))
        most = min(max(iterations, 1), 20)
        cuts = 2 * min(max(parts, 1), 32) - 1
        assert not taken.done
        assert taken.iterations <= 2 * most * cuts
        assert taken.jacobians <= cuts


# A start


def test_rest_in_equilibrium(motion_library: MotionLibrary) -> None:
    """Nothing moves: neither at the start nor in steps."""
    made = motion_library("kirchhoff")
    inputs = made.model.pack()
    solved = made.compiled.solve(inputs)
    state = made.compiled.rest(inputs, solved.x)
    assert state is not None
    assert not state.v.any()
    assert not state.a.any()
    end = made.compiled.step(state, 1e-2, inputs)
    assert_allclose(end.state.x, solved.x, rtol=0, atol=1e-10)


@pytest.mark.parametrize("family", ["kirchhoff", "planar held", JOINTED, FREE])
def test_rest_out_of_balance_vs_python(motion_library: MotionLibrary, family: str) -> None:
    """Let go from a shape with closed constraints: accelerations and multipliers are those of Python's start."""
    made = motion_library(family)
    model = made.model
    x = moving_scenes.consistent_state(model).x
    inputs = model.pack()
    nothing = np.zeros_like(inputs)
    system = equations(model, inputs, nothing, nothing)
    wanted = consistent_start(system, 0.0, x, np.zeros(model.size), 1e-3)
    state = made.compiled.rest(inputs, x)
    assert state is not None
    assert_allclose(state.a, wanted.instant.a, rtol=0, atol=1e-7 * np.abs(wanted.instant.a).max())
    assert_allclose(state.x, wanted.instant.x, rtol=0, atol=1e-7 * np.abs(wanted.instant.x).max())
    assert np.abs(made.compiled.inverse_dynamics(state, inputs)).max() < 1e-7


@pytest.mark.slow
def test_rest_where_a_support_is_open(motion_library: MotionLibrary) -> None:
    made = motion_library("driven and held")
    assert made.compiled.rest() is None


# The equations


@pytest.mark.parametrize("family", FAMILIES)
def test_equations_of_motion_vs_python(motion_library: MotionLibrary, family: str) -> None:
    made = motion_library(family)
    drawn = moving_scenes.drawn_state(made.model)
    state = StepState(drawn.x, drawn.v, drawn.a)
    stiffness, damping, mass, residual = made.model.dynamics_jacobian(*drawn.all)
    found = made.compiled.inverse_dynamics(state, drawn.inputs, drawn.inputs_rate, drawn.inputs_acceleration)
    size = np.abs(residual.full()).max()
    assert_allclose(found, residual.full().ravel(), rtol=0, atol=1e-13 * size)
    stiffness, damping, mass, _ = made.model.dynamics_jacobian(*drawn.all[:5], 0 * drawn.inputs)
    linear = made.compiled.linearise(state, drawn.inputs, drawn.inputs_rate)
    for matrix, wanted in ((linear.stiffness, stiffness), (linear.damping, damping), (linear.mass, mass)):
        assert_allclose(matrix, wanted.full(), rtol=0, atol=1e-13 * np.abs(wanted.full()).max())
    energies = made.compiled.energies(*drawn.velocities)
    for ours, theirs in zip(energies, made.model.energies(*drawn.velocities), strict=True):
        assert_allclose(ours.full(), theirs.full(), rtol=1e-12, atol=1e-14)


@pytest.mark.parametrize("family", ["kirchhoff", "planar held", JOINTED, CABLE, DRIVEN])
def test_derivatives_by_inputs_vs_differences(motion_library: MotionLibrary, family: str) -> None:
    made = motion_library(family)
    drawn = moving_scenes.drawn_state(made.model)
    state = StepState(drawn.x, drawn.v, drawn.a)
    linear = made.compiled.linearise(state, drawn.inputs, drawn.inputs_rate)
    by_each = [linear.by_inputs, linear.by_inputs_rate, linear.by_inputs_acceleration]
    for which, matrix in enumerate(by_each):
        for j in range(len(drawn.inputs)):
            given = [drawn.inputs, drawn.inputs_rate, 0.0 * drawn.inputs]
            span = 1e-6 * (1.0 + abs(given[which][j]))
            change = span * (np.arange(len(drawn.inputs)) == j)
            values = []
            for sign in (1, -1):
                moved = [value + sign * change * (k == which) for k, value in enumerate(given)]
                values.append(made.compiled.inverse_dynamics(state, *moved))
            slope = (values[0] - values[1]) / (2 * span)
            assert_allclose(matrix[:, j], slope, rtol=0, atol=1e-7 * (1.0 + np.abs(values[0]).max() / span * 1e-6))


def test_units_of_the_residual(motion_library: MotionLibrary) -> None:
    """In C and in the manifest, beside which unknowns have rates."""
    made = motion_library("kirchhoff")
    units = np.zeros(made.model.size)
    made.handle[f"{made.name}_residual_units"](units.ctypes.data_as(ctypes.c_void_p))
    assert_allclose(units, made.model.discrete.unknowns.units, rtol=0, atol=0)
    described = made.manifest["motion"]
    assert described["residual_units"] == units.tolist()
    assert described["differential"] == made.model.discrete.unknowns.differential.tolist()
    assert described["order"] == 3


@pytest.mark.parametrize("family", ["kirchhoff", CABLE])
def test_several_steps_are_steps_one_by_one(motion_library: MotionLibrary, family: str) -> None:
    """To the last bit, with inputs that move: states, inputs and rates."""
    made = motion_library(family)
    compiled = made.compiled
    start = start_of(made.model)
    driven = accelerated(made.model, 1e-3, 1)
    inputs, rate, acceleration = driven.inputs[0].copy(), driven.rates[0].copy(), driven.accelerations[0]
    several, end, end_rate = compiled.steps(start, 1e-3, 3, inputs, rate, acceleration, memory=compiled.step_memory())
    memory = compiled.step_memory()
    state = start
    for _ in range(3):
        taken = compiled.step(state, 1e-3, inputs, rate, acceleration, memory=memory)
        state = taken.state
        gained = 1e-3 * acceleration
        inputs = inputs + 1e-3 * (rate + gained / 2.0)
        rate = rate + gained
    assert several.done
    for name in ("x", "v", "a"):
        assert_allclose(getattr(several.state, name), getattr(state, name), rtol=0, atol=0)
    assert_allclose(end, inputs, rtol=0, atol=0)
    assert_allclose(end_rate, rate, rtol=0, atol=0)


def test_several_steps_end_at_one_that_is_not_taken(motion_library: MotionLibrary) -> None:
    made = motion_library("planar")
    start = start_of(made.model)
    inputs = made.model.pack()
    refused, end, _ = made.compiled.steps(start, 1.0, 3, inputs, options=StepOptions(iterations=1, parts=1))
    assert not refused.done
    assert_allclose(refused.state.x, start.x, rtol=0, atol=0)
    assert_allclose(end, inputs, rtol=0, atol=0)
    with pytest.raises(ValueError, match="at least 1"):
        made.compiled.steps(start, 1e-3, 0, inputs)
