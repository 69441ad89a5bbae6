"""Estimation of numbers that all rows share, such as a modulus with a prior, together with the loads of each row.

With these numbers p held, row i has its least cost C_i(p) at u_i(p), with the information H_i of (u_i, p) there. The
marginal likelihood of p follows by Laplace's approximation of the integral over u_i, with A = H_uu,

    −log p(data | p) = Σ C_i(p) + ½ log det A_i(p).

Without the second term, the posterior volume of a row, p would drift to where forces are small, the farther the more
rows there are (J. Neyman, E. L. Scott, Econometrica 16, 1948, 1-32). The sum with the cost of the prior is minimised by
the Gauss–Newton method, with volumes differentiated by differences of p; with B = H_up of a row

    ∂²C_i/∂p² ≈ H_pp − Bᵀ A⁻¹ B,  cov(u_i) = A⁻¹ + G cov(p) Gᵀ  with  G = −A⁻¹ B.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from cosserat_casadi.codegen.estimator import Estimates
from cosserat_casadi.estimation.optima import SecondBest
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.numerics.arrow_least_squares import Limits

MOST_ROUNDS = 20
"""Most Gauss–Newton steps of the shared numbers; each step solves all rows again."""

MOST_TRIALS = 10
"""Most halvings of one step."""

SETTLED = 1e-6
"""Predicted decrease of the cost, in squared deviations, below which the search ends."""

ASIDE = 0.2
"""Offset to either side, in deviations of the prior, of the differences of volumes."""

Searched = tuple[Estimates, SecondBest | None]


@dataclass(frozen=True)
class SharedNumbers:
    """Estimates of the numbers that all rows share.

    Attributes:
        labels: names of the numbers.
        units: units of the numbers.
        values: the maxima a posteriori, shape (q,).
        covariance: covariance of the values, shape (q, q).
        settled: whether no step within the bounds would reduce the cost.
    """

    labels: tuple[str, ...]
    units: tuple[str, ...]
    values: FloatArray
    covariance: FloatArray
    settled: bool

    @property
    def sigma(self) -> FloatArray:
        """Standard deviations, shape (q,)."""
        return np.sqrt(np.diagonal(self.covariance))


@dataclass(frozen=True)
class SharedSearch:
    """The search for the numbers that all rows share.

    Attributes:
        search: shared numbers ↦ rows with these held, where the numbers of a row precede the shared ones.
        limits: bounds and priors of the shared numbers; each has a prior.
        own: bounds and priors of the numbers of each row.
    """

    search: Callable[[FloatArray], Searched]
    limits: Limits
    own: Limits

    def run(self, labels: tuple[str, ...], units: tuple[str, ...]) -> tuple[Searched, SharedNumbers, FloatArray]:
        """Estimate the numbers that all rows share, and the rows with them.

        Args:
            labels: names of the shared numbers.
            units: of these.

        Returns:
            the rows; the shared numbers; the contribution of their uncertainty to covariances of rows, (cases, k, k).
        """
        limits = self.limits
        weights = limits.weight**2
        values = limits.clipped(limits.mean.copy())
        found = self.search(values)
        settled = False
        for _ in range(MOST_ROUNDS):
            slope, curvature, moves = self._expansion(values, found)
            slope = slope + weights * (values - limits.mean)
            curvature = curvature + np.diag(weights)
            step = _step(curvature, slope, limits.held(values, slope))
            if -(slope @ step) <= SETTLED:
                settled = True
                break
            better = self._tried(values, step, found)
            if better is None:
                break
            values, found = better
        _, curvature, moves = self._expansion(values, found)
        covariance = np.asarray(np.linalg.inv(curvature + np.diag(weights)), dtype=np.float64)
        added = np.einsum("cij,jk,clk->cil", moves, covariance, moves)
        return found, SharedNumbers(labels, units, values, covariance, settled), added

    def _expansion(self, values: FloatArray, found: Searched) -> tuple[FloatArray, FloatArray, FloatArray]:
        """The rows' cost in the shared numbers to second order: slope, curvature; and how the rows move with them."""
        slope, curvature, moves = self._reduced(found[0])
        for k in range(len(values)):
            aside = []
            for sign in (-1.0, 1.0):
                shifted = values.copy()
                shifted[k] += sign * ASIDE / self.limits.weight[k]
                shifted = self.limits.within_step(values).clipped(shifted)
                aside.append((shifted[k] - values[k], self.search(shifted)[0]))
            (before, less), (after, more) = aside
            # A bound leaves one side only, where volumes do not count.
            if before == 0.0 or after == 0.0:
                continue
            changes = [self._volumes(rows) - self._volumes(found[0]) for rows in (less, more)]
            down, up = (float(np.nansum(change)) for change in changes)
            rates = (down / before, up / after)
            slope[k] += (rates[0] * after - rates[1] * before) / (after - before)
            bend = 2 * (rates[1] - rates[0]) / (after - before)
            # Volumes may bend down; the sum must have a minimum all the same.
            curvature[k, k] += max(bend, -(curvature[k, k] + self.limits.weight[k] ** 2) / 2)
        return slope, curvature, moves

    def _volumes(self, found: Estimates) -> FloatArray:
        """Half of log det A of each row, without numbers at bounds, shape (cases,); NaN without an estimate."""
        volumes = np.full(len(found.outcome), np.nan)
        rows = found.outcome == 0
        matrices, _ = self._of_own(found)
        sign, logarithm = np.linalg.slogdet(matrices)
        volumes[rows] = np.where(sign > 0, logarithm / 2, np.nan)
        return volumes

    def _of_own(self, found: Estimates) -> tuple[FloatArray, npt.NDArray[np.bool_]]:
        """Information of rows with an estimate on their numbers, and mask of the numbers that are not at a bound."""
        k = len(self.own.lower)
        rows = found.outcome == 0
        free = ~self.own.at_end(found.unknowns[rows, :k])
        matrices = found.information[rows, :k, :k] * free[:, :, None] * free[:, None, :]
        return matrices + np.eye(k) * np.where(free, 0.0, 1.0)[:, :, None], free

    def _tried(self, values: FloatArray, step: FloatArray, found: Searched) -> tuple[FloatArray, Searched] | None:
        """Try a step, or a part of it; return values and rows if the total cost is less, else None."""
        reach = self.limits.within_step(values)
        for trial in range(MOST_TRIALS):
            ahead = reach.clipped(values + step / 2**trial)
            rows = self.search(ahead)
            if self._total(rows, found, ahead) < self._total(found, rows, values):
                return ahead, rows
        return None

    def _total(self, one: Searched, other: Searched, values: FloatArray) -> float:
        """Total cost: costs and volumes of the rows that both searches have found, and the cost of the prior."""
        of_rows = one[0].cost + self._volumes(one[0])
        both = np.isfinite(of_rows) & np.isfinite(self._volumes(other[0]))
        apart = self.limits.residual(values)
        return float(of_rows[both].sum() + apart @ apart / 2)

    def _reduced(self, found: Estimates) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Expand the least costs of rows in the shared numbers to second order, with the numbers of rows eliminated.

        Returns:
            slope, the sum of their derivatives, shape (q,); the sum of their second derivatives, shape (q, q); and
            derivatives of the numbers of each row by the shared ones, shape (cases, k, q), 0 without an estimate.
        """
        k = len(self.own.lower)
        cases, numbers = found.unknowns.shape
        q = numbers - k
        rows = found.outcome == 0
        information = found.information[rows]
        # Unknowns at a bound do not move.
        of_own, free = self._of_own(found)
        coupling = information[:, :k, k:] * free[:, :, None]
        moved = -_solved(of_own, coupling)
        curvature = information[:, k:, k:] + np.swapaxes(coupling, 1, 2) @ moved
        moves = np.zeros((cases, k, q))
        moves[rows] = moved
        return found.gradient[rows, k:].sum(axis=0), curvature.sum(axis=0), moves


def _step(curvature: FloatArray, slope: FloatArray, held: npt.NDArray[np.bool_]) -> FloatArray:
    """Gauss–Newton step, shape (q,), of the numbers that no bound holds."""
    step = np.zeros_like(slope)
    step[~held] = -np.linalg.solve(curvature[np.ix_(~held, ~held)], slope[~held])
    return step


def _solved(matrices: FloatArray, columns: FloatArray) -> FloatArray:
    """Solve by the pseudo-inverse, so that directions without data and priors do not move."""
    sizes = np.sqrt(np.maximum(np.diagonal(matrices, axis1=1, axis2=2), np.finfo(float).tiny))
    scaled = matrices / (sizes[:, :, None] * sizes[:, None, :])
    inverse = np.linalg.pinv(scaled, rcond=1e-10, hermitian=True)
    return (inverse @ (columns / sizes[:, :, None])) / sizes[:, :, None]
