"""Numbers that all rows share and a prior knows roughly, such as a modulus: found beside what each row feels.

With these numbers p held, row i has its least cost C_i(p) at u_i(p), with the information H_i of (u_i, p) there. The
sum of the C_i and the cost of the prior is least by Gauss and Newton's method; with A = H_uu and B = H_up of a row

    ∂²C_i/∂p² ≈ H_pp − Bᵀ A⁻¹ B,  cov(p) = (W² + Σ ∂²C_i/∂p²)⁻¹,  cov(u_i) = A⁻¹ + G cov(p) Gᵀ  with  G = −A⁻¹ B,

the blocks of the inverse of the information of all numbers together: F. Zhang (ed.), *The Schur Complement and Its
Applications*, Springer 2005, section 1.1.
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

Searched = tuple[Estimates, SecondBest | None]


@dataclass(frozen=True)
class SharedNumbers:
    """What was found of the numbers that all rows share.

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


@dataclass(frozen=True)
class SharedLabels:
    """Names and units of the shared numbers."""

    labels: tuple[str, ...]
    units: tuple[str, ...]


@dataclass(frozen=True)
class _Reduced:
    """The least costs of rows as functions of the shared numbers, each row with its own numbers at their best.

    Attributes:
        slope: sum of their derivatives, shape (q,).
        curvature: sum of their second derivatives, shape (q, q).
        moves: how the numbers of each row move with the shared ones, shape (cases, k, q); 0 where not found.
    """

    slope: FloatArray
    curvature: FloatArray
    moves: FloatArray


def find_shared(
    search: Callable[[FloatArray], Searched], limits: Limits, names: SharedLabels, own: tuple[FloatArray, FloatArray]
) -> tuple[Searched, SharedNumbers, FloatArray]:
    """What all rows share, and the rows with it.

    Args:
        search: shared numbers ↦ the rows with these held; their own numbers stand before the shared ones.
        limits: bounds and priors of the shared numbers; each has a prior.
        names: of the shared numbers.
        own: least and largest values of the numbers of each row.

    Returns:
        the rows; the shared numbers; what their uncertainty adds to the covariances of the rows, shape (cases, k, k).
    """
    weights = limits.weight**2
    values = limits.clipped(limits.mean.copy())
    found = search(values)
    settled = False
    for _ in range(MOST_ROUNDS):
        reduced = _reduced(found[0], own)
        slope = reduced.slope + weights * (values - limits.mean)
        step = _step(reduced.curvature + np.diag(weights), slope, limits.held(values, slope))
        if -(slope @ step) <= SETTLED:
            settled = True
            break
        better = _tried(search, limits, values, step, found)
        if better is None:
            break
        values, found = better
    reduced = _reduced(found[0], own)
    covariance = np.asarray(np.linalg.inv(reduced.curvature + np.diag(weights)), dtype=np.float64)
    added = np.einsum("cij,jk,clk->cil", reduced.moves, covariance, reduced.moves)
    return found, SharedNumbers(names.labels, names.units, values, covariance, settled), added


def _step(curvature: FloatArray, slope: FloatArray, held: npt.NDArray[np.bool_]) -> FloatArray:
    """Gauss and Newton's step, shape (q,), of the numbers that no bound holds."""
    step = np.zeros_like(slope)
    step[~held] = -np.linalg.solve(curvature[np.ix_(~held, ~held)], slope[~held])
    return step


def _tried(
    search: Callable[[FloatArray], Searched], limits: Limits, values: FloatArray, step: FloatArray, found: Searched
) -> tuple[FloatArray, Searched] | None:
    """Values and rows a step on, or a part of it, where all costs together are less; None where they nowhere are."""
    reach = limits.within_step(values)
    for trial in range(MOST_TRIALS):
        ahead = reach.clipped(values + step / 2**trial)
        rows = search(ahead)
        if _total(rows, found, limits, ahead) < _total(found, rows, limits, values):
            return ahead, rows
    return None


def _total(one: Searched, other: Searched, limits: Limits, values: FloatArray) -> float:
    """Cost of the rows that both have found, and of the prior."""
    both = (one[0].outcome == 0) & (other[0].outcome == 0)
    apart = limits.weight * (values - limits.mean)
    return float(one[0].cost[both].sum() + apart @ apart / 2)


def _reduced(found: Estimates, own: tuple[FloatArray, FloatArray]) -> _Reduced:
    """The least costs as functions of the shared numbers, to second order."""
    k = len(own[0])
    cases, numbers = found.unknowns.shape
    q = numbers - k
    rows = found.outcome == 0
    information = found.information[rows]
    # What stays at a bound does not move.
    free = ~_at_bound(found.unknowns[rows, :k], own)
    of_own = information[:, :k, :k] * free[:, :, None] * free[:, None, :]
    of_own = of_own + np.eye(k) * np.where(free, 0.0, 1.0)[:, :, None]
    coupling = information[:, :k, k:] * free[:, :, None]
    moved = -_solved(of_own, coupling)
    curvature = information[:, k:, k:] + np.swapaxes(coupling, 1, 2) @ moved
    moves = np.zeros((cases, k, q))
    moves[rows] = moved
    return _Reduced(found.gradient[rows, k:].sum(axis=0), curvature.sum(axis=0), moves)


def _at_bound(values: FloatArray, limits: tuple[FloatArray, FloatArray]) -> npt.NDArray[np.bool_]:
    lower, upper = limits
    at_bound: npt.NDArray[np.bool_] = (values <= lower) | (values >= upper)
    return at_bound


def _solved(matrices: FloatArray, columns: FloatArray) -> FloatArray:
    """Solutions by the pseudo-inverse: a direction that neither data nor priors see does not move."""
    sizes = np.sqrt(np.maximum(np.diagonal(matrices, axis1=1, axis2=2), np.finfo(float).tiny))
    scaled = matrices / (sizes[:, :, None] * sizes[:, None, :])
    inverse = np.linalg.pinv(scaled, rcond=1e-10, hermitian=True)
    solved: FloatArray = (inverse @ (columns / sizes[:, :, None])) / sizes[:, :, None]
    return solved
