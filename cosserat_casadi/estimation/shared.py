"""Numbers that all rows share and a prior knows roughly, such as a modulus: found beside what each row feels.

With these numbers p held, row i has its least cost C_i(p) at u_i(p), with the information H_i of (u_i, p) there. What
the data say of p, whatever the rows feel, is by Laplace's approximation of the integral over u_i, with A = H_uu,

    −log p(data | p) = Σ C_i(p) + ½ log det A_i(p).

Without the second term, the volume of what a row may feel, p would drift to where forces are small, the farther the
more rows there are (J. Neyman, E. L. Scott, Econometrica 16, 1948, 1-32). The sum with the cost of the prior is least
by Gauss and Newton's method, the volumes differentiated by differences of p; with B = H_up of a row

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
"""Gauss–Newton steps of the shared numbers, in each of which all rows are found again."""

MOST_TRIALS = 10
"""Halvings of one step."""

SETTLED = 1e-6
"""Decrease of the cost, in squared deviations, that a step must promise to be worth taking."""

ASIDE = 0.2
"""Deviations of the prior to either side by which volumes are differentiated."""

Searched = tuple[Estimates, SecondBest | None]


@dataclass(frozen=True)
class SharedNumbers:
    """Estimates of the numbers that all rows share.

    Attributes:
        labels: their names.
        units: of these.
        values: the maxima a posteriori, shape (q,).
        covariance: shape (q, q).
        settled: whether no step within the bounds would lessen the cost.
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


def find_shared(
    search: Callable[[FloatArray], Searched],
    limits: Limits,
    labels: tuple[str, ...],
    units: tuple[str, ...],
    own: tuple[FloatArray, FloatArray],
) -> tuple[Searched, SharedNumbers, FloatArray]:
    """Estimate the numbers that all rows share, and the rows with them.

    Args:
        search: shared numbers ↦ the rows with these held; their own numbers stand before the shared ones.
        limits: bounds and priors of the shared numbers; each has a prior.
        labels: names of the shared numbers.
        units: of these.
        own: least and largest values of the numbers of each row.

    Returns:
        the rows; the shared numbers; what their uncertainty adds to the covariances of the rows, shape (cases, k, k).
    """
    weights = limits.weight**2
    values = limits.clipped(limits.mean.copy())
    found = search(values)
    settled = False
    for _ in range(MOST_ROUNDS):
        slope, curvature, moves = _expansion(search, limits, values, found, own)
        slope = slope + weights * (values - limits.mean)
        curvature = curvature + np.diag(weights)
        step = _step(curvature, slope, limits.held(values, slope))
        if -(slope @ step) <= SETTLED:
            settled = True
            break
        better = _tried(search, limits, values, step, found, own)
        if better is None:
            break
        values, found = better
    _, curvature, moves = _expansion(search, limits, values, found, own)
    covariance = np.asarray(np.linalg.inv(curvature + np.diag(weights)), dtype=np.float64)
    added = np.einsum("cij,jk,clk->cil", moves, covariance, moves)
    return found, SharedNumbers(labels, units, values, covariance, settled), added


def _step(curvature: FloatArray, slope: FloatArray, held: npt.NDArray[np.bool_]) -> FloatArray:
    """Gauss and Newton's step, shape (q,), of the numbers that no bound holds."""
    step = np.zeros_like(slope)
    step[~held] = -np.linalg.solve(curvature[np.ix_(~held, ~held)], slope[~held])
    return step


def _expansion(
    search: Callable[[FloatArray], Searched],
    limits: Limits,
    values: FloatArray,
    found: Searched,
    own: tuple[FloatArray, FloatArray],
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """The rows' cost in the shared numbers to second order: slope, curvature; and how the rows move with them."""
    slope, curvature, moves = _reduced(found[0], own)
    for k in range(len(values)):
        aside = []
        for sign in (-1.0, 1.0):
            shifted = values.copy()
            shifted[k] += sign * ASIDE / limits.weight[k]
            shifted = limits.within_step(values).clipped(shifted)
            aside.append((shifted[k] - values[k], search(shifted)[0]))
        (before, less), (after, more) = aside
        # At a bound there is one side alone, and the volumes count for nothing.
        if before == 0.0 or after == 0.0:
            continue
        changes = [_volumes(rows, own) - _volumes(found[0], own) for rows in (less, more)]
        down, up = (float(np.nansum(change)) for change in changes)
        rates = (down / before, up / after)
        slope[k] += (rates[0] * after - rates[1] * before) / (after - before)
        bend = 2 * (rates[1] - rates[0]) / (after - before)
        # Volumes may bend down; the sum must have a minimum all the same.
        curvature[k, k] += max(bend, -(curvature[k, k] + limits.weight[k] ** 2) / 2)
    return slope, curvature, moves


def _volumes(found: Estimates, own: tuple[FloatArray, FloatArray]) -> FloatArray:
    """Half the logarithm of det A of each row, what stays at a bound left out, shape (cases,); NaN where not found."""
    volumes = np.full(len(found.outcome), np.nan)
    rows = found.outcome == 0
    matrices, _ = _of_own(found, own)
    sign, logarithm = np.linalg.slogdet(matrices)
    volumes[rows] = np.where(sign > 0, logarithm / 2, np.nan)
    return volumes


def _of_own(found: Estimates, own: tuple[FloatArray, FloatArray]) -> tuple[FloatArray, npt.NDArray[np.bool_]]:
    """Information of rows with an estimate on their numbers, and which of these numbers are at no bound."""
    k = len(own[0])
    rows = found.outcome == 0
    free = ~_at_bound(found.unknowns[rows, :k], own)
    matrices = found.information[rows, :k, :k] * free[:, :, None] * free[:, None, :]
    return matrices + np.eye(k) * np.where(free, 0.0, 1.0)[:, :, None], free


def _tried(
    search: Callable[[FloatArray], Searched],
    limits: Limits,
    values: FloatArray,
    step: FloatArray,
    found: Searched,
    own: tuple[FloatArray, FloatArray],
) -> tuple[FloatArray, Searched] | None:
    """Values and rows a step on, or a part of it, where all costs together are less; None where they nowhere are."""
    reach = limits.within_step(values)
    for trial in range(MOST_TRIALS):
        ahead = reach.clipped(values + step / 2**trial)
        rows = search(ahead)
        if _total(rows, found, limits, ahead, own) < _total(found, rows, limits, values, own):
            return ahead, rows
    return None


def _total(
    one: Searched, other: Searched, limits: Limits, values: FloatArray, own: tuple[FloatArray, FloatArray]
) -> float:
    """Costs and volumes of the rows that both have found, and the cost of the prior."""
    of_rows = one[0].cost + _volumes(one[0], own)
    both = np.isfinite(of_rows) & np.isfinite(_volumes(other[0], own))
    apart = limits.weight * (values - limits.mean)
    return float(of_rows[both].sum() + apart @ apart / 2)


def _reduced(found: Estimates, own: tuple[FloatArray, FloatArray]) -> tuple[FloatArray, FloatArray, FloatArray]:
    """The least costs of rows as functions of the shared numbers, to second order, each row with its own at their best.

    Returns:
        slope, the sum of their derivatives, shape (q,); the sum of their second derivatives, shape (q, q); and how the
        numbers of each row move with the shared ones, shape (cases, k, q), 0 where not found.
    """
    k = len(own[0])
    cases, numbers = found.unknowns.shape
    q = numbers - k
    rows = found.outcome == 0
    information = found.information[rows]
    # What stays at a bound does not move.
    of_own, free = _of_own(found, own)
    coupling = information[:, :k, k:] * free[:, :, None]
    moved = -_solved(of_own, coupling)
    curvature = information[:, k:, k:] + np.swapaxes(coupling, 1, 2) @ moved
    moves = np.zeros((cases, k, q))
    moves[rows] = moved
    return found.gradient[rows, k:].sum(axis=0), curvature.sum(axis=0), moves


def _at_bound(values: FloatArray, limits: tuple[FloatArray, FloatArray]) -> npt.NDArray[np.bool_]:
    lower, upper = limits
    return (values <= lower) | (values >= upper)


def _solved(matrices: FloatArray, columns: FloatArray) -> FloatArray:
    """Solutions by the pseudo-inverse: a direction that neither data nor priors see does not move."""
    sizes = np.sqrt(np.maximum(np.diagonal(matrices, axis1=1, axis2=2), np.finfo(float).tiny))
    scaled = matrices / (sizes[:, :, None] * sizes[:, None, :])
    inverse = np.linalg.pinv(scaled, rcond=1e-10, hermitian=True)
    return (inverse @ (columns / sizes[:, :, None])) / sizes[:, :, None]
