"""Motions by collocation steps against DOP853 and closed forms: orders, constraints, invariants, control, failures."""

from __future__ import annotations

from dataclasses import replace

import casadi as ca
import numpy as np
import pytest
from moving import (
    DUFFING,
    PENDULUM,
    PENDULUM_ANGLE,
    Top,
    TurningPair,
    duffing_force,
    explicit,
    pendulum_force,
    pendulum_state,
    reference,
)
from numpy.testing import assert_allclose
from scipy.integrate import solve_ivp
from scipy.special import erf

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.numerics import broyden
from cosserat_casadi.numerics.collocation import Collocation, gauss, radau
from cosserat_casadi.numerics.consistent_start import consistent_start
from cosserat_casadi.numerics.integration import Integration, StepOutcome, StepSettings
from cosserat_casadi.numerics.motion_equations import Instant, MotionEquations
from cosserat_casadi.numerics.stage_newton import SecantUpdates
from cosserat_casadi.numerics.step_control import StepControl
from cosserat_casadi.numerics.step_run import ITERATIONS_OF_GIVEN_STEP
from cosserat_casadi.numerics.time_steps import integrate

METHODS = [radau(1), radau(2), radau(3), gauss(1), gauss(2), gauss(3)]


def by_name(method: Collocation) -> str:
    return method.name


def start_at(equations: MotionEquations, x: FloatArray, v: FloatArray, time: float = 0.0) -> Instant:
    return consistent_start(equations, time, x, v, interval=0.02).instant


def fixed(
    equations: MotionEquations, start: Instant, end: float, method: Collocation, size: float, error: float = 1e-13
) -> Integration:
    """Equal steps, their equations solved to rounding."""
    tolerance = np.full(equations.size, error)
    integration = integrate(equations, start, end, method, StepSettings(tolerance, size=size, newton=1.0))
    assert integration.outcome is StepOutcome.COMPLETED
    return integration


def controlled(
    equations: MotionEquations, start: Instant, end: float, tolerance: float, method: Collocation | None = None
) -> Integration:
    settings = StepSettings(np.full(equations.size, tolerance))
    integration = integrate(equations, start, end, method or radau(3), settings)
    assert integration.outcome is StepOutcome.COMPLETED
    return integration


def rates(errors: list[float] | FloatArray) -> FloatArray:
    """Orders from errors at halved steps."""
    values = np.asarray(errors)
    return np.asarray(np.log2(values[:-1] / values[1:]))


# Orders


@pytest.mark.parametrize("method", METHODS, ids=by_name)
@pytest.mark.parametrize("equations", [DUFFING, PENDULUM_ANGLE], ids=["duffing", "pendulum"])
def test_smooth_equations_have_the_order_of_the_table(equations: MotionEquations, method: Collocation) -> None:
    force = duffing_force if equations is DUFFING else pendulum_force
    x = np.array([1.0])
    v = np.array([0.3])
    exact = reference(force, x, v, 0.0, 2.0)
    errors = []
    for size in (0.2, 0.1, 0.05):
        end = fixed(equations, start_at(equations, x, v), 2.0, method, size).end
        errors.append(float(np.linalg.norm(np.stack([end.x, end.v]) - exact)))
    measured = rates(errors)
    # Gauss's third stage comes near rounding, and Euler is not yet asymptotic.
    assert_allclose(measured[-1], method.order, rtol=0, atol=0.6 if method.order == 6 else 0.15)


@pytest.mark.parametrize("method", [radau(2), radau(3), gauss(2)], ids=by_name)
def test_dense_output_has_one_order_more_than_its_polynomial(method: Collocation) -> None:
    x = np.array([1.0])
    v = np.array([0.3])
    start = start_at(PENDULUM_ANGLE, x, v)
    errors = []
    for size in (0.1, 0.05, 0.025):
        # One step from exact values, so that only the polynomial is seen.
        step = fixed(PENDULUM_ANGLE, start, size, method, size).steps[0]
        # The error has zeros in the step: the largest of several.
        differences = []
        for time in size * np.array([0.2, 0.5, 0.8]):
            between = step.at(time)
            differences.append(np.stack([between.x, between.v]) - reference(pendulum_force, x, v, 0.0, time))
        errors.append(np.abs(differences).max(axis=(0, 2)))
    measured = rates(np.array(errors))[-1]
    assert_allclose(measured, [method.stages + 2, method.stages + 1], rtol=0, atol=0.15)


def test_dense_output_joins_the_steps() -> None:
    integration = controlled(PENDULUM, start_at(PENDULUM, *pendulum_state(1.2, 0.4)), 2.0, 1e-6)
    for step in integration.steps:
        for instant in (step.start, step.end):
            between = step.at(instant.time * (1 - 1e-15))
            assert_allclose(between.x[:2], instant.x[:2], rtol=0, atol=1e-13)
            assert_allclose(between.v, instant.v, rtol=0, atol=1e-13)
        after = step.at(step.end.time + 1e-12)
        assert_allclose(after.x, step.end.x, rtol=0, atol=1e-10)
        assert_allclose(after.a, step.end.a, rtol=0, atol=1e-10)


# Stiff, massless, constrained


def stiff_spring(stiffness: float, mass: float) -> MotionEquations:
    """A pendulum x₀ that a stiff spring couples to x₁ = x₀² (an elastic direction, without mass if so given)."""

    def residual(t: float, x: FloatArray, v: FloatArray, a: FloatArray) -> FloatArray:
        stretch = x[1] - x[0] ** 2
        return np.array([a[0] + np.sin(x[0]) - 2 * stiffness * x[0] * stretch, mass * a[1] + stiffness * stretch])

    def jacobians(t: float, x: FloatArray, v: FloatArray, a: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        stretch = x[1] - x[0] ** 2
        own = np.cos(x[0]) + stiffness * (4 * x[0] ** 2 - 2 * stretch)
        coupling = -2 * stiffness * x[0]
        matrix = np.array([[own, coupling], [coupling, stiffness]])
        return matrix, np.zeros((2, 2)), np.diag([1.0, mass])

    return MotionEquations(np.ones(2, dtype=bool), residual, jacobians)


def test_direction_without_mass_follows_its_balance() -> None:
    # Without mass the spring is never stretched: x₀ is the free pendulum.
    equations = stiff_spring(50.0, 0.0)
    start = consistent_start(equations, 0.0, np.array([1.0, 1.0]), np.array([0.3, 0.6]), 0.02)
    assert start.massless == 0
    exact = reference(pendulum_force, np.array([1.0]), np.array([0.3]), 0.0, 2.0)
    errors = []
    for size in (0.2, 0.1, 0.05):
        end = fixed(equations, start.instant, 2.0, radau(3), size).end
        assert_allclose(end.x[1], end.x[0] ** 2, rtol=0, atol=1e-12)
        errors.append(abs(end.x[0] - exact[0, 0]))
    assert_allclose(rates(errors)[-1], 5.0, rtol=0, atol=0.3)


def elastic_pendulum(stiffness: float) -> MotionEquations:
    """A mass on a stiff spring of length one, by its angle and the stretch: as in rods, the stiff entry is x₁."""

    def residual(t: float, x: FloatArray, v: FloatArray, a: FloatArray) -> FloatArray:
        angle, stretch = x
        length = 1 + stretch
        turning = length**2 * a[0] + 2 * length * v[0] * v[1] + length * np.sin(angle)
        pulling = a[1] - length * v[0] ** 2 - np.cos(angle) + stiffness * stretch
        return np.array([turning, pulling])

    def jacobians(t: float, x: FloatArray, v: FloatArray, a: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        angle, stretch = x
        length = 1 + stretch
        by_stretch = 2 * length * a[0] + 2 * v[0] * v[1] + np.sin(angle)
        by_position = np.array([[length * np.cos(angle), by_stretch], [np.sin(angle), stiffness - v[0] ** 2]])
        by_velocity = np.array([[2 * length * v[1], 2 * length * v[0]], [-2 * length * v[0], 0.0]])
        return by_position, by_velocity, np.diag([length**2, 1.0])

    return MotionEquations(np.ones(2, dtype=bool), residual, jacobians)


@pytest.mark.parametrize("stages", [2, 3])
def test_stiff_spring_costs_no_order(stages: int) -> None:
    # Frequency 1e5, steps of 1e4 of its time: the stretch follows the pull, and the angle is that of the pendulum.
    stiffness = 1e10
    equations = elastic_pendulum(stiffness)
    exact = reference(pendulum_force, np.array([1.2]), np.array([0.4]), 0.0, 2.0)
    stretch = (0.4**2 + np.cos(1.2)) / stiffness
    start = Instant(0.0, np.array([1.2, stretch]), np.array([0.4, 0.0]), np.array([-np.sin(1.2), 0.0]))
    errors = []
    for size in (0.4, 0.2, 0.1):
        end = fixed(equations, start, 2.0, radau(stages), size).end
        errors.append(float(np.linalg.norm([end.x[0] - exact[0, 0], end.v[0] - exact[1, 0]])))
        pull = exact[1, 0] ** 2 + np.cos(exact[0, 0])
        assert_allclose(end.x[1] * stiffness, pull, rtol=0, atol=10 * size**stages)
    assert_allclose(rates(errors)[-1], 2 * stages - 1, rtol=0, atol=0.3)


@pytest.mark.parametrize("stages", [2, 3])
def test_stiff_spring_does_not_shorten_the_steps(stages: int) -> None:
    counts = []
    for stiffness in (1e2, 1e6, 1e10):
        equations = elastic_pendulum(stiffness)
        stretch = (0.4**2 + np.cos(1.2)) / stiffness
        start = start_at(equations, np.array([1.2, stretch]), np.array([0.4, 0.0]))
        counts.append(controlled(equations, start, 2.0, 1e-5, radau(stages)).statistics.steps)
    assert counts[2] <= counts[0]


@pytest.mark.parametrize("stages", [2, 3])
def test_constraint_keeps_the_orders_of_index_3(stages: int) -> None:
    # Orders 2s − 1, s, s − 1 of positions, velocities and multipliers.
    start = start_at(PENDULUM, *pendulum_state(1.2, 0.4))
    end_angle = reference(pendulum_force, np.array([1.2]), np.array([0.4]), 0.0, 2.0)
    exact_x, exact_v = pendulum_state(end_angle[0, 0], end_angle[1, 0])
    errors = []
    for size in (0.1, 0.05, 0.025):
        integration = fixed(PENDULUM, start, 2.0, radau(stages), size)
        end = integration.end
        position_error = np.linalg.norm(end.x[:2] - exact_x[:2])
        velocity_error = np.linalg.norm(end.v - exact_v)
        errors.append([position_error, velocity_error, abs(end.x[2] - exact_x[2])])
        gaps = [step.end.x[:2] @ step.end.x[:2] - 1 for step in integration.steps]
        assert_allclose(gaps, 0.0, rtol=0, atol=1e-12)
    measured = rates(np.array(errors))
    # The last position of three stages is near the accuracy of the reference.
    assert_allclose(measured[0], [2 * stages - 1, stages, stages - 1], rtol=0, atol=0.25)
    assert_allclose(measured[-1, 1:], [stages, stages - 1], rtol=0, atol=0.1)


@pytest.mark.parametrize("stages", [2, 3])
def test_free_top_in_quaternions(stages: int) -> None:
    top = Top(np.array([1.0, 2.0, 2.7]))
    q = np.array([1.0, 0.0, 0.0, 0.0])
    v = top.left(q).T @ np.array([0.2, 1.5, 0.1]) / 4
    exact = top.reference(q, v, 4.0)
    start = start_at(top.equations, q, v)
    errors = []
    for size in (0.4, 0.2, 0.1):
        integration = fixed(top.equations, start, 4.0, radau(stages), size)
        errors.append(float(np.linalg.norm(integration.end.x - exact)))
        norms = [step.end.x @ step.end.x for step in integration.steps]
        assert_allclose(norms, 1.0, rtol=0, atol=1e-12)
    assert_allclose(rates(errors)[-1], 2 * stages - 1, rtol=0, atol=0.15)


def test_massless_and_turning_ones_are_controlled_too() -> None:
    spring = stiff_spring(50.0, 0.0)
    spring_start = start_at(spring, np.array([1.0, 1.0]), np.array([0.3, 0.6]))
    angle = reference(pendulum_force, np.array([1.0]), np.array([0.3]), 0.0, 2.0)[0, 0]
    top = Top(np.array([1.0, 2.0, 2.7]))
    q = np.array([1.0, 0.0, 0.0, 0.0])
    v = top.left(q).T @ np.array([0.2, 1.5, 0.1]) / 4
    turned = top.reference(q, v, 4.0)
    for tolerance in (1e-3, 1e-5, 1e-7):
        spring_end = controlled(spring, spring_start, 2.0, tolerance).end
        assert abs(spring_end.x[0] - angle) < tolerance
        top_end = controlled(top.equations, start_at(top.equations, q, v), 4.0, tolerance).end
        assert np.abs(top_end.x - turned).max() < tolerance


# Symmetry and energy of Gauss


@pytest.mark.parametrize("stages", [1, 2, 3])
def test_gauss_comes_back_when_time_is_reversed(stages: int) -> None:
    equations = PENDULUM_ANGLE
    start = start_at(equations, np.array([2.0]), np.array([0.3]))
    there = fixed(equations, start, 5.0, gauss(stages), 0.1, error=1e-15).end
    assert abs(there.x[0] - 2.0) > 0.5
    turned = Instant(0.0, there.x, -there.v, there.a)
    back = fixed(equations, turned, 5.0, gauss(stages), 0.1, error=1e-15).end
    assert_allclose(back.x, [2.0], rtol=0, atol=5e-12)
    assert_allclose(back.v, [-0.3], rtol=0, atol=5e-12)


def test_radau_does_not_come_back() -> None:
    start = start_at(PENDULUM_ANGLE, np.array([2.0]), np.array([0.3]))
    there = fixed(PENDULUM_ANGLE, start, 5.0, radau(2), 0.1).end
    back = fixed(PENDULUM_ANGLE, Instant(0.0, there.x, -there.v, there.a), 5.0, radau(2), 0.1).end
    assert abs(back.x[0] - 2.0) > 1e-6


@pytest.mark.slow
def test_gauss_keeps_a_quadratic_energy() -> None:
    oscillator = explicit(lambda t, x, v: -x, lambda t, x, v: -np.eye(1), lambda t, x, v: np.zeros((1, 1)))
    start = start_at(oscillator, np.ones(1), np.zeros(1))
    steps = fixed(oscillator, start, 500.0, gauss(2), 0.1).steps
    energies = [(step.end.x @ step.end.x + step.end.v @ step.end.v) / 2 for step in steps]
    assert_allclose(energies, 0.5, rtol=0, atol=1e-12)


@pytest.mark.slow
def test_energy_of_gauss_stays_near_that_of_the_start() -> None:
    start = start_at(PENDULUM_ANGLE, np.array([2.0]), np.zeros(1))
    steps = fixed(PENDULUM_ANGLE, start, 1000.0, gauss(2), 0.2).steps
    energies = np.array([step.end.v[0] ** 2 / 2 - np.cos(step.end.x[0]) for step in steps])
    away = np.abs(energies + np.cos(2.0))
    # No drift: the last tenth of 120 periods is no worse than the first.
    assert away.max() < 1e-4
    assert away[-500:].max() < 1.01 * away[:500].max()


# Control of the step


@pytest.mark.parametrize(
    ("equations", "x", "v", "exact"),
    [
        (DUFFING, [1.0], [0.3], reference(duffing_force, np.array([1.0]), np.array([0.3]), 0.0, 2.0)[0]),
        (
            PENDULUM,
            *pendulum_state(1.2, 0.4),
            pendulum_state(reference(pendulum_force, np.array([1.2]), np.array([0.4]), 0.0, 2.0)[0, 0], 0.0)[0],
        ),
    ],
    ids=["duffing", "constrained"],
)
def test_error_is_within_the_tolerance(
    equations: MotionEquations, x: FloatArray, v: FloatArray, exact: FloatArray
) -> None:
    start = start_at(equations, np.array(x), np.array(v))
    moving = equations.differential
    errors = []
    counts = []
    for tolerance in (1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8):
        integration = controlled(equations, start, 2.0, tolerance)
        error = float(np.abs(integration.end.x - exact)[moving].max())
        assert error < tolerance
        errors.append(error)
        counts.append(integration.statistics.steps)
        assert integration.statistics.rejected <= 8
    # Work and precision: the tolerance costs its fourth root in steps, and each power of ten buys digits.
    assert np.all(np.diff(errors) < 0.0)
    assert np.all(np.diff(counts) >= 0)
    assert counts[-1] / counts[-3] < 2 * 100**0.25
    assert errors[-1] < 1e-4 * errors[0]


def test_two_stages_are_controlled_too() -> None:
    start = start_at(DUFFING, np.array([1.0]), np.array([0.3]))
    exact = reference(duffing_force, np.array([1.0]), np.array([0.3]), 0.0, 2.0)
    for tolerance in (1e-3, 1e-5, 1e-7):
        end = controlled(DUFFING, start, 2.0, tolerance, radau(2)).end
        assert abs(end.x[0] - exact[0, 0]) < 5 * tolerance


@pytest.mark.slow
def test_van_der_pol_costs_no_more_than_radau_of_scipy() -> None:
    mu = 1000.0
    equations = explicit(
        lambda t, x, v: mu * (1 - x**2) * v - x,
        lambda t, x, v: np.diag(-2 * mu * x * v - 1),
        lambda t, x, v: np.diag(mu * (1 - x**2)),
    )

    def rate(t: float, y: FloatArray) -> list[float]:
        return [y[1], mu * (1 - y[0] ** 2) * y[1] - y[0]]

    fine = solve_ivp(rate, (0, 2000), [2.0, 0.0], method="Radau", rtol=1e-10, atol=1e-12).y[0, -1]
    scipy = solve_ivp(rate, (0, 2000), [2.0, 0.0], method="Radau", rtol=1e-4, atol=1e-4)
    integration = controlled(equations, start_at(equations, np.array([2.0]), np.zeros(1)), 2000.0, 1e-4)
    assert abs(integration.end.x[0] - fine) < 1e-4
    assert integration.statistics.steps < len(scipy.t)
    assert integration.statistics.jacobians < integration.statistics.steps


def test_a_blow_shorter_than_errors_of_position_tell_is_right_in_its_velocity() -> None:
    """A blow of a microsecond gives a mass the speed 1: in positions of the blow 1e-6 is all that is to be seen."""
    width = 1e-6

    def blow(t: float, x: FloatArray, v: FloatArray) -> FloatArray:
        return np.exp(-(((t - 3 * width) / width) ** 2)) / (width * np.sqrt(np.pi)) + 0.0 * x

    equations = explicit(blow, lambda t, x, v: np.zeros((1, 1)), lambda t, x, v: np.zeros((1, 1)))
    start = Instant(0.0, np.zeros(1), np.zeros(1), blow(0.0, np.zeros(1), np.zeros(1)))
    errors = []
    for lasting in (0.0, 1e-3):
        settings = StepSettings(np.array([1e-6]), first=1e-7, lasting=lasting)
        motion = integrate(equations, start, 1.0, radau(3), settings)
        assert motion.outcome is StepOutcome.COMPLETED
        errors.append(abs(motion.end.v[0] - 0.5 * (1.0 + erf(3.0))))
    assert errors[1] < 1e-3
    assert errors[1] < 0.1 * errors[0]


def test_short_steps_leave_no_speed_that_lasts() -> None:
    """With a mass that is wrong in the Jacobian Newton's method stops where positions are right, and velocities not."""
    width = 1e-6
    signs = np.array([1.0, -1.0, 1.0, 2.0])

    def blow(t: float, x: FloatArray, v: FloatArray) -> FloatArray:
        return signs * np.exp(-(((t - 3 * width) / width) ** 2)) / (width * np.sqrt(np.pi))

    none = np.zeros((4, 4))
    exact = explicit(blow, lambda t, x, v: none, lambda t, x, v: none, 4)
    equations = replace(exact, jacobians=lambda t, x, v, a: (none, none, np.diag([1.3, 0.8, 0.6, 1.6])))
    start = Instant(0.0, np.zeros(4), np.zeros(4), blow(0.0, np.zeros(4), np.zeros(4)))
    errors = []
    for drifting in (0.0, 1e-3, 1.0):
        settings = StepSettings(np.full(4, 1e-6), first=1e-7, longest=2e-7, drifting=drifting)
        motion = integrate(equations, start, 1e-5, radau(3), settings)
        errors.append(np.abs(motion.end.v - 0.5 * (erf(7.0) + erf(3.0)) * signs).max())
    assert errors[0] > 1e-3
    assert errors[1] < 1e-5
    assert errors[2] < 1e-8


@pytest.mark.parametrize("until", [0.5, 0.6, 0.7])
def test_equal_steps_that_go_on_from_within_a_step_are_as_long_as_they_say(until: float) -> None:
    """A parabola is met exactly: a step whose length differs from the time it is said to take leaves it."""
    equations = explicit(
        lambda t, x, v: -2.0 + 0.0 * x, lambda t, x, v: np.zeros((1, 1)), lambda t, x, v: np.zeros((1, 1))
    )
    first = fixed(equations, Instant(0.0, np.zeros(1), np.ones(1), np.full(1, -2.0)), until, radau(3), 0.25)
    settings = StepSettings(np.full(1, 1e-13), size=0.25, newton=1.0)
    second = integrate(equations, first.end, 2.0, radau(3), settings, memory=first.memory)
    third = integrate(equations, second.end, 2.6, radau(3), settings, memory=second.memory)
    assert len(third.steps) == 3
    for step in (*second.steps, *third.steps):
        assert_allclose(step.end.time - step.start.time, step.size, rtol=0, atol=1e-14)
        time = step.end.time
        assert_allclose(step.end.x, time - time**2, rtol=0, atol=1e-13)
        assert_allclose(step.end.v, 1.0 - 2.0 * time, rtol=0, atol=1e-13)


def test_pieces_are_chained_over_a_jump() -> None:
    # A force that goes from 1 to −1 at t = 1: parabolas, which collocation meets exactly, and no step is refused.
    def pushed(force: float) -> MotionEquations:
        return explicit(lambda t, x, v: np.full(1, force), lambda *_: np.zeros((1, 1)), lambda *_: np.zeros((1, 1)))

    before = controlled(pushed(1.0), start_at(pushed(1.0), np.zeros(1), np.zeros(1)), 1.0, 1e-10)
    middle = before.end
    after = controlled(pushed(-1.0), start_at(pushed(-1.0), middle.x, middle.v, 1.0), 2.0, 1e-10)
    assert_allclose(after.end.x, [1.0], rtol=0, atol=1e-14)
    assert_allclose(after.end.v, [0.0], rtol=0, atol=1e-14)
    assert before.statistics.rejected + after.statistics.rejected == 0


def test_given_size_is_divided_evenly() -> None:
    start = start_at(DUFFING, np.array([1.0]), np.array([0.3]))
    integration = fixed(DUFFING, start, 1.0, radau(2), 0.3)
    assert len(integration.steps) == 4
    assert_allclose([step.size for step in integration.steps], 0.25, rtol=0, atol=0)
    assert integration.end.time == 1.0
    assert len(fixed(DUFFING, start, 1.0, radau(2), 0.1).steps) == 10


def test_no_tiny_step_is_left_at_the_end() -> None:
    start = start_at(DUFFING, np.array([1.0]), np.array([0.3]))
    settings = StepSettings(np.full(1, 1e-2), first=0.099, longest=0.099)
    integration = integrate(DUFFING, start, 1.0, radau(3), settings)
    sizes = [step.size for step in integration.steps]
    assert len(sizes) == 11
    assert_allclose(sizes[-2:], (1.0 - 9 * 0.099) / 2, rtol=1e-12, atol=0)
    assert_allclose(integration.next_size, 0.099, rtol=1e-15, atol=0)


def test_tolerance_below_rounding_is_met_to_rounding() -> None:
    x, v = pendulum_state(1.2, 0.4)
    to_rounding = fixed(PENDULUM, start_at(PENDULUM, x, v), 2.0, radau(3), 0.1, error=1e-25).end
    closely = fixed(PENDULUM, start_at(PENDULUM, x, v), 2.0, radau(3), 0.1, error=1e-13).end
    assert_allclose(to_rounding.x[:2], closely.x[:2], rtol=0, atol=1e-12)


def test_jacobian_that_grew_too_old_is_replaced() -> None:
    # Springs that are up to a million times stiffer after t = 1, where a step ends: the Jacobian from before is no
    # use, and they are too many to be learnt by secant updates.
    grown = np.geomspace(10.0, 1e6, 30)

    def stiffness(t: float, jump: float) -> FloatArray:
        return np.ones(30) if t < jump else grown

    springs = explicit(
        lambda t, x, v: 1.0 - stiffness(t, 1.0 + 1e-9) * x,
        lambda t, x, v: np.diag(-stiffness(t, 1.0 - 1e-9)),
        lambda *_: np.zeros((30, 30)),
        size=30,
    )
    start = start_at(springs, np.ones(30), np.zeros(30))
    integration = fixed(springs, start, 2.0, radau(3), 0.1, error=1e-10)
    assert integration.statistics.jacobians == 2
    # The attempt with the old one is given up before it has all its iterations.
    in_vain = integration.statistics.iterations - sum(step.iterations for step in integration.steps)
    assert 0 < in_vain < ITERATIONS_OF_GIVEN_STEP


def test_light_direction_that_turns_costs_no_steps() -> None:
    # One Jacobian alone contracts so badly that most steps, far shorter than their error asks for, are refused.
    pair = TurningPair(light=1e-4)
    x = np.array([0.0, 0.0, 0.0, 0.02, 0.01])
    v = np.array([0.0, 0.0, 4.0, 0.0, 0.0])
    exact = reference(pair.acceleration, x, v, 0.0, 0.3)
    integration = controlled(pair.equations, start_at(pair.equations, x, v), 0.3, 1e-4)
    assert_allclose(integration.end.x, exact[0], rtol=0, atol=1e-4)
    statistics = integration.statistics
    assert statistics.steps < 60
    assert statistics.rejected < 5
    # With Jacobians at the start of the steps there are 16 for each.
    assert statistics.iterations < 15 * statistics.steps


def test_all_stages_may_be_evaluated_at_once() -> None:
    def residuals(t: FloatArray, x: FloatArray, v: FloatArray, a: FloatArray) -> FloatArray:
        return a + np.sin(x)

    at_once = MotionEquations(
        PENDULUM_ANGLE.differential, PENDULUM_ANGLE.residual, PENDULUM_ANGLE.jacobians, residuals=residuals
    )
    start = start_at(PENDULUM_ANGLE, np.array([2.0]), np.array([0.3]))
    one_by_one = controlled(PENDULUM_ANGLE, start, 2.0, 1e-6)
    together = controlled(at_once, start, 2.0, 1e-6)
    assert_allclose(together.end.x, one_by_one.end.x, rtol=0, atol=0)


# What fails, and how it is told


def test_motion_without_continuation_names_the_time() -> None:
    # ẍ = 6 x² with x = 1/(1 − t)².
    equations = explicit(lambda t, x, v: 6 * x**2, lambda t, x, v: np.diag(12 * x), lambda *_: np.zeros((1, 1)))
    start = start_at(equations, np.ones(1), np.full(1, 2.0))
    settings = StepSettings(np.full(1, 1e-4), shortest=1e-7)
    integration = integrate(equations, start, 2.0, radau(3), settings)
    assert integration.outcome is StepOutcome.STEP_TOO_SMALL
    assert_allclose(integration.end.time, 1.0, rtol=0, atol=1e-3)
    assert integration.next_size < 2e-7


def test_region_without_numbers_ends_the_motion() -> None:
    # √(1 − x) for x beyond 1, which x = t reaches at t = 1.
    equations = explicit(lambda t, x, v: 0.0 * np.sqrt(1 - x), lambda *_: np.zeros((1, 1)), lambda *_: np.zeros((1, 1)))
    start = start_at(equations, np.zeros(1), np.ones(1))
    integration = integrate(equations, start, 2.0, radau(3), StepSettings(np.full(1, 1e-6)))
    assert integration.outcome is StepOutcome.NOT_FINITE
    assert_allclose(integration.end.time, 1.0, rtol=0, atol=1e-8)
    given = integrate(equations, start, 2.0, radau(3), StepSettings(np.full(1, 1e-6), size=0.25))
    assert given.outcome is StepOutcome.NOT_FINITE
    assert given.end.time == 1.0


@pytest.mark.parametrize("size", [None, 0.1])
def test_constraint_given_twice_is_singular(size: float | None) -> None:
    def residual(t: float, x: FloatArray, v: FloatArray, a: FloatArray) -> FloatArray:
        return np.array([a[0] + x[1] + x[2], x[0], x[0]])

    stiffness = np.array([[0.0, 1.0, 1.0], [1.0, 0.0, 0.0], [1.0, 0.0, 0.0]])
    mass = np.diag([1.0, 0.0, 0.0])
    equations = MotionEquations(
        np.array([True, False, False]), residual, lambda *_: (stiffness, np.zeros((3, 3)), mass)
    )
    start = Instant(0.0, np.zeros(3), np.zeros(3), np.zeros(3))
    integration = integrate(equations, start, 1.0, radau(3), StepSettings(np.full(3, 1e-6), size=size))
    assert integration.outcome is StepOutcome.SINGULAR
    assert integration.steps == ()
    assert integration.end is start


def test_given_step_too_long_to_be_solved_is_told() -> None:
    equations = explicit(lambda t, x, v: 6 * x**2, lambda t, x, v: np.diag(12 * x), lambda *_: np.zeros((1, 1)))
    start = start_at(equations, np.ones(1), np.full(1, 2.0))
    integration = integrate(equations, start, 2.0, radau(3), StepSettings(np.full(1, 1e-6), size=0.25))
    assert integration.outcome is StepOutcome.NOT_SOLVED


def test_interruption_keeps_what_was_computed() -> None:
    reached: list[float] = []

    def stop_after_half(time: float, size: float) -> None:
        reached.append(time)
        if time > 1.0:
            raise KeyboardInterrupt

    start = start_at(DUFFING, np.array([1.0]), np.array([0.3]))
    settings = StepSettings(np.full(1, 1e-6))
    integration = integrate(DUFFING, start, 2.0, radau(3), settings, stop_after_half)
    assert integration.outcome is StepOutcome.INTERRUPTED
    assert [step.end.time for step in integration.steps] == reached
    assert integration.end.time == reached[-1]


def test_bad_settings_are_refused_all_at_once() -> None:
    start = Instant(1.0, np.zeros(3), np.zeros(3), np.zeros(3))
    settings = StepSettings(np.array([1.0, 0.0, 0.0]))
    with pytest.raises(ValueError, match=r"end: .*tolerance: .*size: .*method: "):
        integrate(PENDULUM, start, 0.5, gauss(2), settings)


def test_motion_that_crawls_is_given_up_by_name() -> None:
    """A spring that vibrates a million times: no step fails, and there is no end of them."""
    spring = explicit(
        lambda t, x, v: -((2e6 * np.pi) ** 2) * x,
        lambda t, x, v: np.diag([-((2e6 * np.pi) ** 2)]),
        lambda *_: np.zeros((1, 1)),
    )
    start = start_at(spring, np.ones(1), np.zeros(1))
    integration = integrate(spring, start, 1.0, radau(3), StepSettings(np.full(1, 1e-8)))
    assert integration.outcome is StepOutcome.TOO_MANY_STEPS
    assert 900 < integration.statistics.steps < 1100
    assert 0.0 < integration.end.time < 1e-2


# Kinks that steps reach over


def pulse_force(t: float, x: FloatArray, v: FloatArray) -> FloatArray:
    """An oscillator that rests until a triangular pulse of 2 ms."""
    return -x + np.interp(t, [0.499, 0.5, 0.501], [0.0, 100.0, 0.0])


PULSED = explicit(pulse_force, lambda t, x, v: -np.eye(1), lambda t, x, v: np.zeros((1, 1)))


@pytest.mark.parametrize("tolerance", [1e-3, 1e-5])
def test_a_pulse_between_the_stages_is_seen_at_its_kinks(tolerance: float) -> None:
    start = start_at(PULSED, np.zeros(1), np.zeros(1))
    overlooked = controlled(PULSED, start, 1.0, tolerance)
    assert_allclose(overlooked.end.x, 0.0, rtol=0, atol=1e-12)
    seen = controlled(replace(PULSED, kinks=(0.499, 0.5, 0.501)), start, 1.0, tolerance)
    # An impulse of 0.1 at t = 0.5.
    assert_allclose(seen.end.x, 0.1 * np.sin(0.5), rtol=0, atol=10.0 * tolerance)
    assert len(seen.steps) < 100


def test_kinks_that_tell_nothing_new_cost_no_step() -> None:
    start = start_at(DUFFING, np.array([0.5]), np.zeros(1))
    plain = controlled(DUFFING, start, 3.0, 1e-6)
    kinks = tuple(np.linspace(0.0, 3.0, 301))
    kinked = controlled(replace(DUFFING, kinks=kinks), start, 3.0, 1e-6)
    # The force between the stages is smooth, and missed by the order of the stages.
    assert len(kinked.steps) <= 1.5 * len(plain.steps)
    assert_allclose(kinked.end.x, plain.end.x, rtol=0, atol=1e-5)


# The estimated error of a step, and what it makes of the size of the next one.


@pytest.mark.parametrize("stages", [1, 2, 3])
def test_estimate_is_of_one_order_more_than_the_stages(stages: int) -> None:
    start = Instant(0.0, np.array([1.0]), np.array([0.3]), -np.sin([1.0]))
    errors = []
    for size in (0.1, 0.05, 0.025):
        settings = StepSettings(np.ones(1), first=size)
        errors.append(integrate(PENDULUM_ANGLE, start, 1.0, radau(stages), settings).steps[0].error)
    orders = np.log2(np.array(errors[:-1]) / np.array(errors[1:]))
    assert_allclose(orders[-1], stages + 1, rtol=0, atol=0.25)


def test_steady_error_keeps_the_step() -> None:
    control = StepControl(stages=3, longest=1.0, wanted=0.1)
    for _ in range(3):
        control.accept(0.1, 0.6, iterations=1)
    assert control.wanted == 0.1


def test_error_that_grows_is_foreseen() -> None:
    # From one step to the next the error has grown by 100: the next step would be too long by that trend alone.
    steady = StepControl(stages=3, longest=1.0, wanted=0.1, last_size=0.1, last_error=0.5)
    growing = StepControl(stages=3, longest=1.0, wanted=0.1, last_size=0.1, last_error=0.01)
    steady.accept(0.1, 0.5, iterations=1)
    growing.accept(0.1, 0.5, iterations=1)
    assert steady.wanted == 0.1
    assert_allclose(growing.wanted, 0.1 * 0.9 * (0.01 / 0.5**2) ** 0.25, rtol=1e-14, atol=0)


def test_growth_is_bounded() -> None:
    control = StepControl(stages=3, longest=1.0, wanted=0.1)
    control.accept(0.1, 0.0, iterations=1)
    assert_allclose(control.wanted, 0.5, rtol=1e-15, atol=0)
    control.accept(0.5, 0.0, iterations=1)
    assert control.wanted == 1.0


def test_refused_step_is_not_followed_by_a_longer_one() -> None:
    control = StepControl(stages=3, longest=1.0, wanted=0.1, last_size=0.1, last_error=0.5)
    control.refuse_error(0.1, 16.0, iterations=1)
    assert_allclose(control.wanted, 0.045, rtol=1e-14, atol=0)
    control.accept(0.045, 1e-6, iterations=1)
    assert_allclose(control.wanted, 0.045, rtol=1e-14, atol=0)
    control.refuse_error(0.045, float("nan"), iterations=1)
    assert control.wanted < 0.01


def test_step_cut_at_the_end_of_a_piece_leaves_the_wanted_one() -> None:
    control = StepControl(stages=3, longest=1.0, wanted=0.1, last_size=0.1, last_error=0.5)
    control.accept(0.03, 0.5, iterations=1)
    assert control.wanted == 0.1


# Secant updates of the inverse against Broyden's formula for the matrix itself.


WEIGHTS = np.array([1.0, 1e3, 20.0, 0.0])
"""Of four entries; the last one is algebraic."""

STAGES = 3
SIZE = STAGES * len(WEIGHTS)


def equations(unknowns: FloatArray) -> FloatArray:
    """Nonlinear equations of all stages, whose Jacobian at zero is the identity, shape (s, n)."""
    turned = np.roll(unknowns, 1, axis=0) * np.roll(unknowns, 2, axis=1)
    return unknowns + 0.3 * np.sin(unknowns) * unknowns + 0.4 * turned - 0.1


def test_corrections_are_those_of_the_updated_matrix() -> None:
    # Broyden: B₊ = B + (y − B s) sᵀW/(sᵀW s), with y what F changed by, and W the weighted changes of velocity squared.
    method = radau(STAGES)
    to_velocities = np.kron(method.matrix, np.eye(len(WEIGHTS)))
    squares = to_velocities.T @ np.diag(np.tile(WEIGHTS, STAGES) ** 2) @ to_velocities
    updates = SecantUpdates(method.matrix, WEIGHTS)
    matrix = np.eye(SIZE)
    unknowns = np.zeros((STAGES, len(WEIGHTS)))
    for _ in range(5):
        before = equations(unknowns)
        expected = np.linalg.solve(matrix, -before.ravel())
        corrections = updates.applied_to(-before)
        assert_allclose(corrections.ravel(), expected, rtol=1e-9, atol=1e-15)
        updates.take(corrections)
        unknowns = unknowns + corrections
        changed = (equations(unknowns) - before).ravel()
        missed = changed - matrix @ expected
        matrix = matrix + np.outer(missed, squares @ expected) / (expected @ squares @ expected)


def test_linear_equations_of_few_directions_are_solved() -> None:
    # F = (1 + u wᵀ) y − b: one direction is not known to the first inverse, and two updates learn it.
    random = np.random.default_rng(7)
    u, w, b = random.normal(size=(3, STAGES, 4))
    weights = np.ones(4)
    updates = SecantUpdates(radau(STAGES).matrix, weights)
    unknowns = np.zeros((STAGES, 4))
    lengths = []
    for _ in range(4):
        residuals = unknowns + u * np.vdot(w, unknowns) - b
        corrections = updates.applied_to(-residuals)
        lengths.append(np.abs(corrections).max())
        updates.take(corrections)
        unknowns = unknowns + corrections
    assert lengths[1] > 0.1
    assert_allclose(unknowns + u * np.vdot(w, unknowns), b, rtol=0, atol=1e-12)


def test_correction_without_effect_is_not_finite() -> None:
    # The same F before and after a correction: no secant goes through zero.
    updates = SecantUpdates(radau(STAGES).matrix, WEIGHTS)
    corrections = np.ones((STAGES, 4))
    updates.take(corrections)
    assert not np.all(np.isfinite(updates.applied_to(corrections)))


def test_a_sparse_jacobian_is_factorised_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Steps and a response of the same Jacobian, dense and sparse."""
    random = np.random.default_rng(3)
    matrix = np.eye(6) + 0.2 * random.normal(size=(6, 6))
    factorised = []
    of_package = broyden.sparse_factors
    monkeypatch.setattr(broyden, "sparse_factors", lambda jacobian: factorised.append(1) or of_package(jacobian))
    found = []
    for jacobian in (ca.DM(matrix), matrix):
        updated = broyden.UpdatedJacobian(jacobian)
        for residual in np.random.default_rng(4).normal(size=(3, 6)):
            step = updated.step(residual)
            assert step is not None
            updated.steps.append(step)
        found.append([*updated.steps, updated.response(np.ones(6), np.full(6, 0.1))])
    assert_allclose(found[0], found[1], rtol=1e-11, atol=0)
    assert len(factorised) == 1
