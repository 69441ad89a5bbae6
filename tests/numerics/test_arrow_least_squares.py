"""Least squares with shared and own unknowns: closed form, scipy, bounds, priors, robust losses."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt
import pytest
import scipy.optimize
from numpy.testing import assert_allclose, assert_array_equal

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.numerics import arrow_least_squares
from cosserat_casadi.numerics.arrow_least_squares import ArrowFit, Fit, FitOutcome, Limits
from cosserat_casadi.numerics.robust_loss import Loss
from tests.families import mostly_slow

TIMES = np.linspace(0.0, 2.0, 9)


@dataclass
class Point:
    """Residuals at some unknowns.

    Attributes:
        shared: shape (n,).
        own: shape (blocks, k).
        residual: shape (m,).
    """

    shared: FloatArray
    own: FloatArray
    residual: FloatArray


class Decays:
    """Blocks of samples of own · exp(−rate t) + level; rate and level are shared."""

    def __init__(self, amplitudes: FloatArray, noise: FloatArray) -> None:
        self.offsets: npt.NDArray[np.int64] = len(TIMES) * np.arange(len(amplitudes) + 1)
        self.measured = self._model(np.array([1.3, 0.4]), amplitudes[:, None]) + noise

    def _model(self, shared: FloatArray, own: FloatArray) -> FloatArray:
        rate, level = shared
        return np.asarray(own * np.exp(-rate * TIMES) + level).ravel()

    def at(self, shared: FloatArray, own: FloatArray, near: Point) -> Point | None:
        # A rate that grows without end has no state, as a rod that cannot be followed.
        if abs(shared[0]) > 20.0:
            return None
        return self.point(shared, own)

    def point(self, shared: FloatArray, own: FloatArray) -> Point:
        return Point(shared, own, self._model(shared, own) - self.measured)

    def jacobian(self, state: Point) -> FloatArray:
        decay = np.tile(np.exp(-state.shared[0] * TIMES), len(state.own))
        amplitude = np.repeat(state.own[:, 0], len(TIMES))
        by_rate = -np.tile(TIMES, len(state.own)) * amplitude * decay
        return np.stack([by_rate, np.ones_like(by_rate), decay], axis=1)


def free(count: int) -> Limits:
    return Limits(
        lower=np.full(count, -np.inf),
        upper=np.full(count, np.inf),
        mean=np.zeros(count),
        weight=np.zeros(count),
        ratios=np.zeros(count, dtype=bool),
    )


@pytest.fixture
def decays() -> Decays:
    rng = np.random.default_rng(5)
    amplitudes = rng.uniform(0.5, 3.0, 4)
    return Decays(amplitudes, 0.05 * rng.standard_normal(4 * len(TIMES)))


def run(decays: Decays, shared: Limits, own: Limits, loss: Loss | None = None) -> Fit[Point]:
    start = shared.clipped(np.array([0.3, 0.0]))
    first = own.clipped(np.ones((4, 1)))
    fit = ArrowFit(decays, shared, own, loss or Loss())
    return fit.run(start, first, decays.point(start, first))


def stacked(decays: Decays) -> Callable[[FloatArray], FloatArray]:
    """The residuals as scipy takes them."""
    return lambda unknowns: decays.point(unknowns[:2], unknowns[2:, None]).residual


def test_elimination_finds_what_all_unknowns_together_find(decays: Decays) -> None:
    found = run(decays, free(2), free(1))
    assert found.outcome is FitOutcome.CONVERGED
    expected = scipy.optimize.least_squares(stacked(decays), np.ones(6), xtol=1e-14, ftol=1e-14, gtol=1e-14)
    assert_allclose(np.concatenate([found.shared, found.own[:, 0]]), expected.x, rtol=1e-6, atol=0)
    assert_allclose(found.cost, expected.cost, rtol=1e-12, atol=0)


def test_bounds_are_kept_as_by_scipy(decays: Decays) -> None:
    shared = free(2)
    shared.lower[1], shared.upper[1] = 0.8, 2.0
    own = free(1)
    own.upper[0] = 1.5
    found = run(decays, shared, own)
    assert found.outcome is FitOutcome.CONVERGED
    lower = [-np.inf, 0.8, *[-np.inf] * 4]
    upper = [np.inf, 2.0, *[1.5] * 4]
    start = np.array([0.3, 0.9, 1, 1, 1, 1])
    expected = scipy.optimize.least_squares(stacked(decays), start, bounds=(lower, upper), xtol=1e-14, ftol=1e-14)
    assert_allclose(found.cost, expected.cost, rtol=1e-8, atol=0)
    assert_allclose(found.shared, expected.x[:2], rtol=1e-4, atol=0)
    assert found.shared[1] == 0.8
    assert found.own.max() == 1.5


def test_priors_are_rows_of_data(decays: Decays) -> None:
    shared = free(2)
    shared.mean[0], shared.weight[0] = 1.0, 40.0
    own = free(1)
    own.mean[0], own.weight[0] = 2.0, 3.0
    found = run(decays, shared, own)

    def with_priors(unknowns: FloatArray) -> FloatArray:
        rows = [stacked(decays)(unknowns), 40.0 * (unknowns[:1] - 1.0), 3.0 * (unknowns[2:] - 2.0)]
        return np.concatenate(rows)

    expected = scipy.optimize.least_squares(with_priors, np.ones(6), xtol=1e-14, ftol=1e-14, gtol=1e-14)
    assert_allclose(np.concatenate([found.shared, found.own[:, 0]]), expected.x, rtol=1e-6, atol=0)
    assert_allclose(found.cost, expected.cost, rtol=1e-12, atol=0)


@pytest.mark.parametrize("kind", ["huber", "cauchy"])
def test_robust_losses_are_those_of_scipy(decays: Decays, kind: str) -> None:
    decays.measured[[2, 17]] += 1.0
    found = run(decays, free(2), free(1), Loss(kind, 0.1))
    expected = scipy.optimize.least_squares(
        stacked(decays), np.array([1.3, 0.4, 1, 1, 1, 1]), loss=kind, f_scale=0.1, xtol=1e-14, ftol=1e-14, gtol=1e-14
    )
    assert_allclose(found.cost, expected.cost, rtol=1e-9, atol=0)
    assert_allclose(found.shared, expected.x[:2], rtol=1e-4, atol=0)


@pytest.mark.parametrize("kind", ["squares", "huber", "cauchy"])
def test_weights_are_the_slope_of_the_cost(kind: str) -> None:
    loss = Loss(kind, 1.5)
    for residual in (0.0, 0.3, 1.4, 1.6, 20.0):
        ahead, behind = (loss.cost(np.array([residual + step])) for step in (1e-6, -1e-6))
        slope = (ahead - behind) / 2e-6
        assert_allclose(residual * loss.weights(np.array([residual]))[0], slope, rtol=1e-6, atol=1e-9)


@pytest.mark.parametrize("kind", ["squares", "huber", "cauchy"])
def test_noise_under_a_loss_is_the_spread_of_means(kind: str) -> None:
    # A mean of normal numbers: its information is the sum of the weights.
    loss = Loss(kind, 2.0)
    samples = np.random.default_rng(8).standard_normal((8000, 60))
    means = samples.mean(axis=1)
    for _ in range(30):
        weights = loss.weights(samples - means[:, None])
        means = np.sum(weights * samples, axis=1) / np.sum(weights, axis=1)
    told = []
    for row, mean in zip(samples, means, strict=True):
        noise = loss.noise_squares(row - mean) / (len(row) - 1)
        told.append(noise / np.sum(loss.weights(row - mean)))
    assert_allclose(np.mean(told), np.mean(means**2), rtol=0.06)


def test_what_a_bound_holds_takes_no_row_of_others(decays: Decays) -> None:
    shared, own = np.array([1.3, 0.4]), np.ones((4, 1))
    at_bound = replace(free(1), lower=np.ones(1))
    arrow = ArrowFit(decays, free(2), at_bound).linear(shared, own, decays.point(shared, own))
    arrow = replace(arrow, held=np.array([False, False, True, True, True, True]))
    left, _ = arrow.eliminated(np.zeros(6))
    information = left[:, :2].T @ left[:, :2]
    by_shared = arrow.derivatives[:, :2]
    assert_allclose(information, by_shared.T @ by_shared, rtol=1e-12)


def test_a_linear_problem_takes_its_closed_form() -> None:
    """Unknowns of sizes 1e10 and 1e-4 are no obstacle, and nothing is shared with blocks."""
    rng = np.random.default_rng(1)
    sizes = np.array([1e10, 1e-4, 1.0])
    matrix = rng.standard_normal((30, 3)) / sizes
    right = rng.standard_normal(30)

    class Linear:
        offsets = np.array([0, 30])

        def at(self, shared: FloatArray, own: FloatArray, near: Point) -> Point:
            return Point(shared, own, matrix @ shared - right)

        def jacobian(self, state: Point) -> FloatArray:
            return matrix

    start, own = np.zeros(3), np.zeros((1, 0))
    fit = ArrowFit(Linear(), free(3), free(0), Loss()).run(start, own, Point(start, own, -right))
    assert fit.outcome is FitOutcome.CONVERGED
    expected = np.linalg.solve((matrix * sizes).T @ (matrix * sizes), (matrix * sizes).T @ right) * sizes
    assert_allclose(fit.shared, expected, rtol=1e-6, atol=0)


def test_iterations_that_run_out_are_told(decays: Decays, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(arrow_least_squares, "MOST_ITERATIONS", 2)
    start, own = np.array([0.3, 0.0]), np.ones((4, 1))
    few = ArrowFit(decays, free(2), free(1))
    assert few.run(start, own, decays.point(start, own)).outcome is FitOutcome.MAX_ITERATIONS


def test_steps_that_lead_nowhere_are_told(decays: Decays, monkeypatch: pytest.MonkeyPatch) -> None:
    """The search ends where it is, which is no least misfit."""
    start, own = np.array([0.3, 0.0]), np.ones((4, 1))
    monkeypatch.setattr(decays, "at", lambda shared, own, near: None)
    ended = ArrowFit(decays, free(2), free(1)).run(start, own, decays.point(start, own))
    assert ended.outcome is FitOutcome.STALLED
    assert_array_equal(ended.shared, start)
    assert_array_equal(ended.own, own)


def test_what_is_positive_changes_by_half_in_a_step() -> None:
    limits = Limits(np.zeros(1), np.full(1, np.inf), np.zeros(1), np.zeros(1), np.ones(1, dtype=bool))
    box = limits.within_step(np.array([6.0]))
    assert_allclose(box.clipped(np.array([-94.0])), [4.0], rtol=1e-15, atol=0)
    assert_allclose(box.clipped(np.array([106.0])), [9.0], rtol=1e-15, atol=0)


class Linear:
    """One block of data that is linear in the shared unknowns."""

    def __init__(self, matrix: FloatArray, measured: FloatArray) -> None:
        self.offsets: npt.NDArray[np.int64] = np.array([0, len(measured)])
        self.matrix = matrix
        self.measured = measured

    def at(self, shared: FloatArray, own: FloatArray, near: Point) -> Point:
        return self.point(shared, own)

    def point(self, shared: FloatArray, own: FloatArray) -> Point:
        return Point(shared, own, self.matrix @ shared - self.measured)

    def jacobian(self, state: Point) -> FloatArray:
        return self.matrix


@pytest.mark.parametrize("seed", mostly_slow(range(40), quick=range(10)))
def test_bounds_in_narrow_valleys_are_kept_as_by_scipy(seed: int) -> None:
    """Singular values from 1 to 1e-5: where a bound cuts one unknown off, the others must go another way."""
    rng = np.random.default_rng(seed)
    for _ in range(10):
        n = int(rng.integers(2, 6))
        left, _ = np.linalg.qr(rng.standard_normal((n + 3, n)))
        right, _ = np.linalg.qr(rng.standard_normal((n, n)))
        matrix = left @ np.diag(10.0 ** rng.uniform(-5, 0, n)) @ right.T
        measured = matrix @ (3 * rng.standard_normal(n)) + 0.01 * rng.standard_normal(n + 3)
        problem = Linear(matrix, measured)
        shared = replace(free(n), lower=-np.ones(n), upper=np.ones(n))
        start = rng.uniform(-1, 1, n)
        own = np.zeros((1, 0))
        found = ArrowFit(problem, shared, free(0)).run(start, own, problem.point(start, own))
        expected = scipy.optimize.lsq_linear(matrix, measured, (shared.lower, shared.upper), method="bvls", tol=1e-15)
        assert found.outcome is FitOutcome.CONVERGED
        assert_allclose(found.cost, expected.cost, rtol=0, atol=1e-11)


def test_the_step_of_own_unknowns_keeps_bounds_too() -> None:
    """Each block has a narrow valley of its own, which the shared unknown moves."""
    rng = np.random.default_rng(3)
    blocks, rows = 6, 5
    by_shared = rng.standard_normal((blocks * rows, 1))
    by_own = rng.standard_normal((blocks * rows, 1)) + rng.standard_normal((blocks * rows, 2)) * [1.0, 1e-4]
    measured = rng.standard_normal(blocks * rows)

    class Blocks:
        offsets: npt.NDArray[np.int64] = rows * np.arange(blocks + 1)

        def at(self, shared: FloatArray, own: FloatArray, near: Point) -> Point:
            return self.point(shared, own)

        def point(self, shared: FloatArray, own: FloatArray) -> Point:
            of_own = np.sum(by_own * np.repeat(own, rows, axis=0), axis=1)
            return Point(shared, own, by_shared @ shared + of_own - measured)

        def jacobian(self, state: Point) -> FloatArray:
            return np.hstack([by_shared, by_own])

    own = replace(free(2), lower=-0.3 * np.ones(2), upper=0.3 * np.ones(2))
    problem = Blocks()
    start = np.zeros(1), np.zeros((blocks, 2))
    found = ArrowFit(problem, free(1), own).run(*start, problem.point(*start))
    matrix = np.zeros((blocks * rows, 1 + 2 * blocks))
    matrix[:, 0] = by_shared[:, 0]
    for block in range(blocks):
        span = slice(block * rows, (block + 1) * rows)
        matrix[span, 1 + 2 * block : 3 + 2 * block] = by_own[span]
    ends = np.array([np.inf, *[0.3] * (2 * blocks)])
    expected = scipy.optimize.lsq_linear(matrix, measured, (-ends, ends), method="bvls", tol=1e-15)
    assert found.outcome is FitOutcome.CONVERGED
    assert_allclose(found.cost, expected.cost, rtol=0, atol=1e-11)


@pytest.mark.parametrize("slope", [3.0, 0.2])
def test_the_least_sum_may_be_at_a_kink(slope: float) -> None:
    """A curved surface in shared unknowns and those of one block; with a small slope the least sum is beyond it."""

    def beyond(unknowns: FloatArray) -> float:
        x, y, own, _ = unknowns
        return float(x + y + 0.3 * x**2 + 0.5 * np.sin(own) - 1.0)

    def residual(unknowns: FloatArray) -> FloatArray:
        x, y, own, other = unknowns
        over = max(beyond(unknowns), 0.0)
        return np.array([2.0 - x, 1.5 - y * x, own - 0.3, 0.4 + slope * over, other - x, 0.5 * other - 0.1])

    class Kinked:
        offsets = np.array([0, 4, 6])

        def at(self, shared: FloatArray, own: FloatArray, near: Point) -> Point:
            return Point(shared, own, residual(np.concatenate([shared, own[:, 0]])))

        def jacobian(self, state: Point) -> FloatArray:
            (x, y), (own, _) = state.shared, state.own[:, 0]
            is_over = slope * (beyond(np.array([x, y, own, 0.0])) > 0.0)
            by_shared = np.array([[-1, 0], [-y, -x], [0, 0], [is_over * (1 + 0.6 * x), is_over], [-1, 0], [0, 0]])
            return np.column_stack([by_shared, [0.0, 0.0, 1.0, is_over * 0.5 * np.cos(own), 1.0, 0.5]])

    def kinked(state: Point, other: Point) -> npt.NDArray[np.bool_]:
        sides = [beyond(np.concatenate([point.shared, point.own[:, 0]])) > 0.0 for point in (state, other)]
        return np.array([sides[0] != sides[1], False])

    problem = Kinked()
    start, own = np.zeros(2), np.zeros((2, 1))
    fit = ArrowFit(problem, free(2), free(1), kinked=kinked).run(start, own, problem.at(start, own, None))
    found = np.concatenate([fit.shared, fit.own[:, 0]])
    constraint = {"type": "eq" if slope == 3.0 else "ineq", "fun": beyond}
    expected = scipy.optimize.minimize(
        lambda unknowns: residual(unknowns) @ residual(unknowns) / 2, found + 0.1, constraints=constraint, tol=1e-14
    )
    assert fit.outcome is (FitOutcome.AT_KINK if slope == 3.0 else FitOutcome.CONVERGED)
    assert_allclose(fit.cost, expected.fun, rtol=0, atol=1e-8)
    assert_allclose(found, expected.x, rtol=0, atol=1e-4)
    assert (abs(beyond(found)) < 1e-8) == (slope == 3.0)
    assert fit.iterations < 40


def test_a_kink_that_is_left_behind_is_not_told() -> None:
    """Steps meet the kink at 0.47 on the way to the least sum at 1.3, which is smooth."""

    def beyond(x: FloatArray) -> float:
        return float(x[0] - 1.0 + 0.3 * np.sin(3.0 * x[0]))

    def residual(x: FloatArray) -> FloatArray:
        return np.array([x[0] - 2.0, 4.0 + 0.5 * max(beyond(x), 0.0)])

    class Curved:
        offsets = np.array([0, 2])

        def at(self, shared: FloatArray, own: FloatArray, near: Point) -> Point:
            return Point(shared, own, residual(shared))

        def jacobian(self, state: Point) -> FloatArray:
            slope = 0.5 * (beyond(state.shared) > 0.0) * (1.0 + 0.9 * np.cos(3.0 * state.shared[0]))
            return np.array([[1.0], [slope]])

    met: list[bool] = []

    def kinked(state: Point, other: Point) -> npt.NDArray[np.bool_]:
        met.append((beyond(state.shared) > 0.0) != (beyond(other.shared) > 0.0))
        return np.array([met[-1]])

    problem, own = Curved(), np.zeros((1, 0))
    start = problem.at(np.array([-2.0]), own, None)
    fit = ArrowFit(problem, free(1), free(0), kinked=kinked).run(start.shared, own, start)
    least = scipy.optimize.minimize_scalar(lambda x: residual(np.array([x])) @ residual(np.array([x])), (1.0, 1.5))
    assert fit.outcome is FitOutcome.CONVERGED
    assert_allclose(fit.shared, [least.x], rtol=0, atol=1e-4)
    assert any(met)
    assert fit.beyond is None


@pytest.mark.parametrize(("gain", "target"), [(2.0, 3.0), (1.0, 5.0)])
def test_no_kink_is_told_where_linear_models_from_afar_meet(gain: float, target: float) -> None:
    """The sum is least at the root of a curved equation, far from the start; SciPy finds the root."""

    def beyond(x: FloatArray) -> float:
        return float(x[0] - 1.0 + 0.3 * np.sin(x[0]))

    class Curved:
        offsets = np.array([0, 2])

        def at(self, shared: FloatArray, own: FloatArray, near: Point) -> Point:
            return Point(shared, own, np.array([shared[0] - target, 4.0 + gain * max(beyond(shared), 0.0)]))

        def jacobian(self, state: Point) -> FloatArray:
            slope = gain * (beyond(state.shared) > 0.0) * (1.0 + 0.3 * np.cos(state.shared[0]))
            return np.array([[1.0], [slope]])

    def kinked(state: Point, other: Point) -> npt.NDArray[np.bool_]:
        return np.array([(beyond(state.shared) > 0.0) != (beyond(other.shared) > 0.0)])

    problem, own = Curved(), np.zeros((1, 0))
    start = problem.at(np.array([-2.0]), own, None)
    fit = ArrowFit(problem, free(1), free(0), kinked=kinked).run(start.shared, own, start)
    root = scipy.optimize.brentq(lambda x: beyond(np.array([x])), -2.0, 2.0, xtol=1e-14)
    assert fit.outcome is FitOutcome.AT_KINK
    assert_allclose(fit.shared, [root], rtol=0, atol=1e-6)
