"""Guards end a motion where they vanish, and impacts close what they guard: a stone on a string of length one."""

from __future__ import annotations

import numpy as np
import pytest
from moving import PENDULUM, explicit
from numpy.testing import assert_allclose

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.numerics.collocation import Collocation, gauss, radau
from cosserat_casadi.numerics.consistent_start import consistent_start, impact
from cosserat_casadi.numerics.guards import WATCHED, Guards, crossing, remembering
from cosserat_casadi.numerics.integration import Integration, StepOutcome, StepSettings
from cosserat_casadi.numerics.motion_equations import Instant, MotionEquations
from cosserat_casadi.numerics.time_steps import integrate

FLIGHT = MotionEquations(
    PENDULUM.differential,
    lambda t, x, v, a: np.array([a[0] + x[2] * x[0], a[1] + x[2] * x[1] + 1.0, x[2]]),
    lambda t, x, v, a: (
        np.array([[x[2], 0.0, x[0]], [0.0, x[2], x[1]], [0.0, 0.0, 1.0]]),
        np.zeros((3, 3)),
        np.diag([1.0, 1.0, 0.0]),
    ),
)
"""The same stone while its string is slack: the multiplier is zero."""


def sag(instant: Instant) -> FloatArray:
    return np.array([1.0 - instant.x[0] ** 2 - instant.x[1] ** 2])


def tension(instant: Instant) -> FloatArray:
    return instant.x[2:]


def until(
    equations: MotionEquations, x: FloatArray, v: FloatArray, guards: Guards, method: Collocation, size: float | None
) -> Integration:
    begin = consistent_start(equations, 0.0, x, v, interval=0.02).instant
    return integrate(equations, begin, 10.0, method, StepSettings(np.full(3, 1e-9), size=size), guards=guards)


def landing() -> float:
    """Time at which the parabola from (0.3, 0) at the speed (0.4, 0.5) meets the circle."""
    # (0.3 + 0.4 t)² + (0.5 t − t²/2)² = 1.
    roots = np.roots([0.25, -0.5, 0.41, 0.24, 0.09 - 1.0])
    return float(min(root.real for root in roots if abs(root.imag) < 1e-12 and root.real > 0.0))


@pytest.mark.parametrize("size", [None, 0.03], ids=["controlled", "given"])
def test_flight_ends_where_the_string_is_taut(size: float | None) -> None:
    flight = until(FLIGHT, np.array([0.3, 0.0, 0.0]), np.array([0.4, 0.5, 0.0]), sag, radau(3), size)
    assert flight.outcome is StepOutcome.GUARDED
    assert flight.guard == 0
    time = landing()
    assert_allclose(flight.end.time, time, rtol=0, atol=1e-10)
    assert_allclose(flight.end.x[:2], [0.3 + 0.4 * time, 0.5 * time - time**2 / 2], rtol=0, atol=1e-10)
    # A parabola is exact in any step: nothing is left of the sag either.
    assert abs(sag(flight.end)[0]) < 1e-13


def test_impact_takes_the_speed_along_the_string() -> None:
    angle = 0.7
    along = np.array([np.sin(angle), -np.cos(angle)])
    across = np.array([np.cos(angle), np.sin(angle)])
    v = np.array([*(0.8 * along - 0.3 * across), 0.0])
    after, impulses = impact(PENDULUM, 0.0, np.array([*along, 0.0]), v, interval=0.02)
    assert_allclose(after[:2], -0.3 * across, rtol=0, atol=1e-10)
    # The multiplier times x is the force: its impulse is the momentum lost.
    assert_allclose(impulses, [0.0, 0.0, 0.8], rtol=0, atol=1e-10)


def test_impact_of_a_constraint_that_moves() -> None:
    """A mass that sits on a path x = sin 3t afterwards has its speed."""
    stiffness = np.array([[0.0, 1.0], [1.0, 0.0]])
    path = MotionEquations(
        np.array([True, False]),
        lambda t, x, v, a: np.array([2.0 * a[0] + x[1], x[0] - np.sin(3 * t)]),
        lambda *_: (stiffness, np.zeros((2, 2)), np.diag([2.0, 0.0])),
    )
    v, impulses = impact(path, 0.2, np.array([np.sin(0.6), 0.0]), np.array([5.0, 0.0]), interval=0.02)
    assert_allclose(v[0], 3 * np.cos(0.6), rtol=0, atol=1e-10)
    assert_allclose(impulses[1], 2.0 * (5.0 - 3 * np.cos(0.6)), rtol=0, atol=1e-9)


def test_string_goes_slack_where_its_tension_vanishes() -> None:
    """From the lowest point at the speed √(7/2): ω² + cos θ = 0 where cos θ = −1/2."""
    swing = until(PENDULUM, np.array([0.0, -1.0, 0.0]), np.array([np.sqrt(3.5), 0.0, 0.0]), tension, radau(3), None)
    assert swing.outcome is StepOutcome.GUARDED
    assert_allclose(swing.end.x[1], 0.5, rtol=0, atol=1e-5)
    assert abs(swing.end.x[2]) < 1e-9
    # Radau's last stage is the end: the string has its length there.
    assert abs(sag(swing.end)[0]) < 1e-9


@pytest.mark.parametrize("method", [radau(2), radau(3), gauss(2)], ids=lambda method: method.name)
def test_last_step_is_a_step_of_the_method(method: Collocation) -> None:
    """Where a guard vanishes the state has the order of the steps, not that of their dense output."""
    spring = explicit(
        lambda t, x, v: -x,
        lambda t, x, v: -np.eye(1),
        lambda *_: np.zeros((1, 1)),
    )
    errors = []
    for size in (0.2, 0.1):
        begin = Instant(0.0, np.ones(1), np.zeros(1), -np.ones(1))
        settings = StepSettings(np.full(1, 1e-14), size=size, newton=1.0)
        swing = integrate(spring, begin, 3.0, method, settings, guards=lambda instant: instant.x)
        assert swing.outcome is StepOutcome.GUARDED
        errors.append(abs(swing.end.time - np.pi / 2) + abs(swing.end.v[0] + 1.0))
    assert np.log2(errors[0] / errors[1]) > method.order - 0.7


def test_guard_that_lies_on_zero_and_falls_ends_at_once() -> None:
    flight = until(FLIGHT, np.array([1.0, 0.0, 0.0]), np.array([1.0, 0.0, 0.0]), sag, radau(3), None)
    assert flight.outcome is StepOutcome.GUARDED
    assert flight.end.time < 1e-9


def test_guard_that_stays_changes_nothing() -> None:
    x = np.array([0.0, -1.0, 0.0])
    v = np.array([0.5, 0.0, 0.0])
    begin = consistent_start(PENDULUM, 0.0, x, v, interval=0.02).instant
    settings = StepSettings(np.full(3, 1e-6))
    watched = integrate(PENDULUM, begin, 3.0, radau(3), settings, guards=tension)
    plain = integrate(PENDULUM, begin, 3.0, radau(3), settings)
    assert watched.outcome is StepOutcome.COMPLETED
    assert_allclose(watched.end.x, plain.end.x, rtol=0, atol=0)


@pytest.mark.parametrize("height", [0.1249, 0.1251])
def test_a_guard_that_dips_between_two_looks_is_found(height: float) -> None:
    """The parabola of a stone culminates at 1/8 above its start, 1e-4 above a ceiling or below it."""

    def below(instant: Instant) -> FloatArray:
        return np.array([height - instant.x[1]])

    flight = MotionEquations(
        PENDULUM.differential, lambda t, x, v, a: np.array([a[0], a[1] + 1.0, x[2]]), FLIGHT.jacobians
    )
    begin = consistent_start(flight, 0.0, np.zeros(3), np.array([0.0, 0.5, 0.0]), interval=0.02).instant
    settings = StepSettings(np.full(3, 1e-9), size=0.9)
    run = integrate(flight, begin, 0.9, radau(3), settings, guards=below)
    if height > 0.125:
        assert run.outcome is StepOutcome.COMPLETED
        return
    assert run.outcome is StepOutcome.GUARDED
    assert_allclose(run.end.time, 0.5 - np.sqrt(0.25 - 2 * height), rtol=0, atol=1e-9)


def test_guards_far_from_zero_are_looked_at_three_times_and_others_all_along() -> None:
    looked_at: list[float] = []

    def watched(level: float) -> Guards:
        def values(instant: Instant) -> FloatArray:
            looked_at.append(instant.time)
            return np.array([level - instant.x[0]])

        return values

    flight = until(FLIGHT, np.array([0.3, 0.0, 0.0]), np.array([0.4, 0.5, 0.0]), watched(100.0), radau(3), 0.5)
    (step, *_) = flight.steps
    times = step.start.time + WATCHED * step.size
    for level, looks in ((100.0, times[::4]), (step.end.x[0] + 0.01, times)):
        looked_at.clear()
        assert crossing(step, watched(level)) is None
        assert set(looks) <= set(looked_at)
        assert level < 1.0 or len(looked_at) == len(looks)


def test_a_place_that_seems_lost_from_afar_is_looked_at_again_from_nearby() -> None:
    """A guard that follows a place tells -1 where it jumped: by half a step it did, by an eighth it slides."""
    flight = until(FLIGHT, np.array([0.3, 0.0, 0.0]), np.array([0.4, 0.5, 0.0]), lambda _: np.ones(1), radau(3), 0.5)
    (step, *_) = flight.steps
    last = step.start.time

    def followed(instant: Instant) -> FloatArray:
        nonlocal last
        if abs(instant.time - last) > 0.2 * step.size:
            return np.array([-1.0])
        last = instant.time
        return np.array([1.0])

    assert crossing(step, followed) is None
    assert last == step.end.time


def test_the_end_of_a_step_is_not_looked_at_again_as_the_start_of_the_next() -> None:
    calls: list[Instant] = []
    guards = remembering(lambda instant: calls.append(instant) or sag(instant))  # type: ignore[func-returns-value]
    here, there = (Instant(0.0, np.array([x, 0.0, 0.0]), np.zeros(3), np.zeros(3)) for x in (0.2, 0.4))
    assert_allclose([guards(one)[0] for one in (here, here, there, here)], [0.96, 0.96, 0.84, 0.96], rtol=1e-15, atol=0)
    assert len(calls) == 3
