"""Curves whose folds and bifurcations are known in closed form."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.numerics.arclength import ArcSettings, Curve, Monitor, tangent_along
from cosserat_casadi.numerics.continuation import Path
from cosserat_casadi.numerics.events import DETERMINANT, bracketed_zero
from cosserat_casadi.numerics.trace import PathOutcome, Trace, crossing_direction, trace

EIGENVALUES = Monitor(lambda _y, jacobian, _: np.linalg.eigvalsh((jacobian + jacobian.T) / 2), feels_limits=True)
MONITORS = pytest.mark.parametrize("monitor", [EIGENVALUES, DETERMINANT], ids=["eigenvalues", "determinant"])


def curve(
    residual: Callable[[FloatArray, float], list[float]],
    jacobian: Callable[[FloatArray, float], list[list[float]]],
    rate: Callable[[FloatArray, float], list[float]],
    start: list[float],
    monitor: Monitor = EIGENVALUES,
    **settings: float,
) -> Curve:
    path = Path(
        lambda x, t: np.array(residual(x, t)),
        lambda x, t: np.array(jacobian(x, t)),
        lambda x, t: np.array(rate(x, t)),
        np.array(start),
    )
    return Curve(path, monitor, ArcSettings(**settings))  # type: ignore[arg-type]


def cubic(monitor: Monitor, load: float = 4.0) -> Curve:
    """x³ − 3x = load · factor: limit points where the right side is ±2."""
    return curve(
        lambda x, t: [x[0] ** 3 - 3 * x[0] - load * t],
        lambda x, t: [[3 * x[0] ** 2 - 3]],
        lambda x, t: [-load],
        [-np.sqrt(3.0)],
        monitor,
    )


def pitchfork(monitor: Monitor) -> Curve:
    """The normal form in turned unknowns: x₁ = 0 bifurcates at factor 0.3 into x₁² = factor − 0.3; x₂ = factor."""
    c, s = np.cos(0.4), np.sin(0.4)
    turn = np.array([[c, -s], [s, c]])

    def residual(x: FloatArray, t: float) -> FloatArray:
        u = turn.T @ x
        return turn @ np.array([u[0] ** 3 - (t - 0.3) * u[0], u[1] - t])

    def jacobian(x: FloatArray, t: float) -> FloatArray:
        u = turn.T @ x
        return turn @ np.diag([3 * u[0] ** 2 - (t - 0.3), 1.0]) @ turn.T

    def rate(x: FloatArray, t: float) -> FloatArray:
        return turn @ np.array([-(turn.T @ x)[0], -1.0])

    return Curve(Path(residual, jacobian, rate, np.zeros(2)), monitor, ArcSettings())


def hat(monitor: Monitor) -> Curve:
    """A pitchfork with a circle of branches, |x|² = factor − 0.3: on them turning the circle is neutral."""

    def jacobian(x: FloatArray, t: float) -> FloatArray:
        return (x @ x - t + 0.3) * np.eye(2) + 2 * np.outer(x, x)

    return Curve(
        Path(lambda x, t: (x @ x - t + 0.3) * x, jacobian, lambda x, t: -x, np.zeros(2)), monitor, ArcSettings()
    )


def events(traced: Trace) -> list[tuple[str, float]]:
    return [(event.kind, event.point.load_factor) for event in traced.events]


@MONITORS
def test_cubic_goes_through_both_folds_and_back(monitor: Monitor) -> None:
    traced = trace(cubic(monitor))
    assert traced.outcome is PathOutcome.CONVERGED
    assert [kind for kind, _ in events(traced)] == ["limit", "limit"]
    assert_allclose([factor for _, factor in events(traced)], [0.5, -0.5], rtol=1e-12, atol=0)
    assert_allclose([event.point.x[0] for event in traced.events], [-1.0, 1.0], rtol=0, atol=1e-9)
    y = np.array([point.y for point in traced.points])
    assert y[-1, 1] == 1.0
    assert_allclose(y[:, 0] ** 3 - 3 * y[:, 0], 4 * y[:, 1], rtol=0, atol=1e-10)
    assert np.all(np.diff(y[:, 0]) > 0)


@MONITORS
def test_pitchfork_is_found_and_gone_straight_through(monitor: Monitor) -> None:
    traced = trace(pitchfork(monitor))
    assert traced.outcome is PathOutcome.CONVERGED
    ((kind, factor),) = events(traced)
    assert kind == "bifurcation"
    assert_allclose(factor, 0.3, rtol=1e-10, atol=0)
    assert_allclose(traced.points[-1].x, [-np.sin(0.4), np.cos(0.4)], rtol=0, atol=1e-11)


@MONITORS
def test_pitchfork_branch_is_switched_to(monitor: Monitor) -> None:
    traced = trace(pitchfork(monitor), branch=True)
    assert traced.outcome is PathOutcome.CONVERGED
    assert traced.branch is not None
    c, s = np.cos(0.4), np.sin(0.4)
    u = np.array([[c * p.x[0] + s * p.x[1], p.load_factor] for p in traced.points[traced.branch :]])
    assert_allclose(u[:, 0] ** 2, u[:, 1] - 0.3, rtol=0, atol=1e-11)
    assert np.all(u[:, 0] > 0)
    assert u[-1, 1] == 1.0


def test_circle_of_branches_is_neutral_and_followed_without_drift() -> None:
    traced = trace(hat(EIGENVALUES), branch=True)
    assert traced.outcome is PathOutcome.CONVERGED
    (event,) = traced.events
    assert event.multiplicity == 2
    assert_allclose(event.point.load_factor, 0.3, rtol=1e-10, atol=0)
    x = np.array([point.x for point in traced.points[traced.branch :]])
    assert_allclose(np.linalg.norm(x[-1]), np.sqrt(0.7), rtol=1e-11, atol=0)
    assert_allclose(x[:, 1] * x[-1, 0], x[:, 0] * x[-1, 1], rtol=0, atol=1e-11)
    assert abs(traced.points[-1].spectrum[0]) < 1e-12


def test_a_double_bifurcation_leaves_the_determinant_alone() -> None:
    """Why eigenvalues are counted where there are some: two cross at once, the sign of the determinant stays."""
    assert events(trace(hat(DETERMINANT))) == []
    assert [kind for kind, _ in events(trace(hat(EIGENVALUES)))] == ["bifurcation"]


@MONITORS
def test_circle_is_closed(monitor: Monitor) -> None:
    """x² + factor² = 0.8²: never at factor 1, back at its start."""
    circle = curve(
        lambda x, t: [x[0] ** 2 + t**2 - 0.64],
        lambda x, t: [[2 * x[0]]],
        lambda x, t: [2 * t],
        [0.8],
        monitor,
    )
    traced = trace(circle)
    assert traced.outcome is PathOutcome.CLOSED
    assert [kind for kind, _ in events(traced)] == ["limit", "limit"]
    assert_allclose([factor for _, factor in events(traced)], [0.8, -0.8], rtol=1e-12, atol=0)
    y = np.array([point.y for point in traced.points])
    assert_allclose(np.linalg.norm(y, axis=1), 0.8, rtol=1e-10, atol=0)


@pytest.mark.parametrize(("apart", "multiplicities"), [(0.01, [1, 1]), (1e-10, [2])])
def test_two_bifurcations_within_one_step_are_told_apart(apart: float, multiplicities: list[int]) -> None:
    """Two modes that lose their stiffness at 0.3 and a little later; what is nearer than rounding is one."""
    later = 0.3 + apart
    both = curve(
        lambda x, t: [(0.3 - t) * x[0] + x[0] ** 3, (later - t) * x[1] + x[1] ** 3],
        lambda x, t: [[0.3 - t + 3 * x[0] ** 2, 0.0], [0.0, later - t + 3 * x[1] ** 2]],
        lambda x, t: [-x[0], -x[1]],
        [0.0, 0.0],
    )
    bifurcations = trace(both).events
    assert [event.multiplicity for event in bifurcations] == multiplicities
    assert_allclose(bifurcations[0].point.load_factor, 0.3, rtol=1e-9, atol=0)
    assert_allclose(bifurcations[-1].point.load_factor, later, rtol=1e-9, atol=0)


def test_events_beyond_factor_one_are_not_told() -> None:
    beyond = curve(
        lambda x, t: [(1.001 - t) * x[0] + x[0] ** 3],
        lambda x, t: [[1.001 - t + 3 * x[0] ** 2]],
        lambda x, t: [-x[0]],
        [0.0],
    )
    traced = trace(beyond)
    assert traced.outcome is PathOutcome.CONVERGED
    assert traced.events == []


def test_transcritical_bifurcation_is_followed_both_ways() -> None:
    """x (x − (factor − 0.4)) = 0: both branches are straight and cross at an angle."""

    def crossing(**settings: float) -> Curve:
        return curve(
            lambda x, t: [x[0] * (x[0] - (t - 0.4))],
            lambda x, t: [[2 * x[0] - (t - 0.4)]],
            lambda x, t: [-x[0]],
            [0.0],
            **settings,
        )

    straight, crossed = trace(crossing()), trace(crossing(), branch=True)
    assert_allclose(events(straight)[0][1], 0.4, rtol=1e-10, atol=0)
    assert_allclose(straight.points[-1].x, 0.0, rtol=0, atol=1e-12)
    assert crossed.outcome is PathOutcome.CONVERGED
    assert_allclose(crossed.points[-1].x, 0.6, rtol=0, atol=1e-11)


def test_steps_run_out_and_stalls_are_said() -> None:
    short = cubic(EIGENVALUES)
    few = Curve(short.path, short.monitor, ArcSettings(steps=5))
    assert trace(few).outcome is PathOutcome.MAX_STEPS
    wall = curve(lambda x, t: [x[0] - t], lambda x, t: [[1.0 if t < 0.5 else np.nan]], lambda x, t: [-1.0], [0.0])
    stalled = trace(wall)
    assert stalled.outcome is PathOutcome.LOAD_STALLED
    assert 0.4 < stalled.points[-1].load_factor < 0.5
    assert np.all(np.isfinite([point.y for point in stalled.points]))


def test_path_that_leads_back_is_said() -> None:
    """x² = 0.5 − factor turns at 0.5 and never comes again."""
    parabola = curve(lambda x, t: [x[0] ** 2 + t - 0.5], lambda x, t: [[2 * x[0]]], lambda x, t: [1.0], [np.sqrt(0.5)])
    traced = trace(parabola)
    assert traced.outcome is PathOutcome.TURNED_BACK
    assert_allclose(events(traced)[0][1], 0.5, rtol=1e-12, atol=0)


def test_a_path_without_bifurcation_has_no_branch() -> None:
    assert trace(cubic(EIGENVALUES), branch=True).outcome is PathOutcome.NO_BIFURCATION


def test_correction_of_least_norm_where_a_direction_is_neutral() -> None:
    """g depends on x₁, and on x₂ by rounding only: the step does not move x₂."""
    neutral = curve(
        lambda x, t: [x[0] ** 2 - 1.0, 1e-13 * (x[1] - 5.0)],
        lambda x, t: [[2 * x[0], 0.0], [0.0, 1e-13]],
        lambda x, t: [0.0, 0.0],
        [0.0, 0.0],
    )
    corrected = neutral.correct(np.array([1.2, 0.7, 0.3]), np.array([0.0, 0.0, 1.0]), 0.3)
    assert corrected is not None
    assert_allclose(corrected[0], [1.0, 0.7, 0.3], rtol=0, atol=1e-12)


def test_a_step_goes_its_length_along_the_tangent_and_not_around_a_corner() -> None:
    """On the unit circle a step of 0.5 turns the tangent by 30°: refused, though Newton would converge."""
    circle = curve(
        lambda x, t: [x[0] ** 2 + t**2 - 1.0], lambda x, t: [[2 * x[0]]], lambda x, t: [2 * t], [1.0], max_distance=0.5
    )
    start = circle.point(np.array([1.0, 0.0]), np.array([0.0, 1.0]), 0.0)
    assert start is not None
    assert circle.advance(start, 0.5) is None
    advanced = circle.advance(start, 0.2)
    assert advanced is not None
    point, _ = advanced
    assert_allclose(point.y, [np.sqrt(0.96), 0.2], rtol=0, atol=1e-13)
    assert_allclose(point.tangent, [-0.2, np.sqrt(0.96)], rtol=0, atol=1e-13)
    assert point.length == 0.2


def test_a_correction_that_strays_is_refused() -> None:
    """A parabola that leaves its tangent by 0.3 where the step is 0.2."""
    parabola = curve(
        lambda x, t: [x[0] - 7.5 * t**2], lambda x, t: [[1.0]], lambda x, t: [-15.0 * t], [0.0], min_cosine=-1.0
    )
    start = parabola.point(np.zeros(2), np.array([0.0, 1.0]), 0.0)
    assert start is not None
    assert parabola.advance(start, 0.2) is None
    assert parabola.advance(start, 0.03) is not None


def test_tangent_is_the_direction_projected_on_the_null_space() -> None:
    # Dependent rows leave a null space of three dimensions.
    derivative = np.array([[1.0, 0.0, 0.0, 0.0]]) * np.array([[1.0], [2.0], [-1.0]])
    tangent = tangent_along(derivative, np.array([5.0, 3.0, 0.0, 4.0]))
    assert tangent is not None
    assert_allclose(tangent, [0.0, 0.6, 0.0, 0.8], rtol=0, atol=1e-15)


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_tangent_spans_a_null_space_of_one_dimension(side: float) -> None:
    derivative = np.array([[1.0, 0.0, -2.0], [0.0, 1.0, 3.0]])
    null_vector = np.array([2.0, -3.0, 1.0]) / np.sqrt(14.0)
    tangent = tangent_along(derivative, side * np.array([0.1, 0.0, 1.0]))
    assert tangent is not None
    assert_allclose(tangent, side * null_vector, rtol=0, atol=1e-15)


def test_crossing_direction_is_across_the_tangent() -> None:
    derivative, tangent = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 0.0]]), np.array([0.0, 0.0, 1.0])
    direction = crossing_direction(derivative, tangent, 1)
    assert_allclose(direction, [1.0, 0.0, 0.0], rtol=0, atol=1e-15)


@pytest.mark.parametrize(("power", "zero"), [(1, 0.3), (3, 0.3), (9, 0.71), (1, 1e-5)])
def test_bracketed_zero_of_powers(power: int, zero: float) -> None:
    def value(s: float) -> float:
        return s**power - zero**power

    located = bracketed_zero(value, (0.0, value(0.0)), (1.0, value(1.0)))
    assert_allclose(located, zero, rtol=0, atol=1e-11)
