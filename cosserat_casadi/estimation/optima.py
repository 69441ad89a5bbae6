"""Several searches for each row, and their minima: the best, the second best, and the certainty of the choice.

If a place along the rod is unknown, the misfit may have several minima: a small force far out bends a rod much like a
large one near its base. Each search finds one; different minima are weighted by the mass of the posterior around them,
each as a normal distribution: D. J. C. MacKay, *Information Theory, Inference, and Learning Algorithms*, Cambridge
University Press 2003, chapter 27.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from cosserat_casadi.codegen.estimator import Estimates
from cosserat_casadi.maths.typing import FloatArray

SAME = 0.1
"""Distance, in deviations, up to which two searches count as having found one minimum."""

SEED = 16
"""Seed of the order in which several unknown places are combined, so that equal scenes have equal starts."""


@dataclass(frozen=True)
class SecondBest:
    """The second best minimum of each row.

    Attributes:
        values: unknowns of the second best minimum, shape (cases, k); NaN if the searches found a single one.
        cost: cost of the second best minimum, shape (cases,); NaN if the searches found a single one.
        share: share of the best minimum in the posterior mass of all minima, shape (cases,); NaN if none was found.
    """

    values: FloatArray
    cost: FloatArray
    share: FloatArray


def spread_starts(lower: FloatArray, upper: FloatArray, count: int) -> FloatArray:
    """Spread starts of searches, shape (count, n), with one in each of ``count`` equal parts of every range.

    Args:
        lower: least values, shape (n,).
        upper: largest values, shape (n,).
        count: number of starts, at least 1.
    """
    shares = (np.arange(count) + 0.5) / count
    rng = np.random.default_rng(SEED)
    columns = [shares, *(rng.permutation(shares) for _ in lower[1:])]
    return lower + np.column_stack(columns) * (upper - lower)


def best_of(runs: Sequence[Estimates], own: int) -> tuple[Estimates, SecondBest]:
    """Select the best and the second best minimum of each row from several searches.

    Args:
        runs: searches for the cases, each from other values.
        own: number of estimated unknowns in each row; the unknowns after these are held.
    """
    cases = len(runs[0].outcome)
    rows = np.arange(cases)
    found = np.array([run.outcome == 0 for run in runs])
    costs = np.where(found, [run.cost for run in runs], np.inf)
    order = np.argsort(costs, axis=0, kind="stable")
    ranked = [Estimates.chosen(runs, chosen) for chosen in order]
    best = ranked[0]
    minima: list[tuple[Estimates, npt.NDArray[np.bool_]]] = []
    second = np.full((cases, own), np.nan)
    second_cost = np.full(cases, np.nan)
    mass = np.zeros(cases)
    for rank, run in enumerate(ranked):
        is_new = found[order[rank], rows]
        for earlier, counted in minima:
            is_new &= ~(counted & (_distance(run, earlier) < SAME))
        is_second = is_new & np.isnan(second_cost) & (rank > 0)
        second[is_second] = run.unknowns[is_second, :own]
        second_cost[is_second] = run.cost[is_second]
        mass[is_new] += np.exp(_log_mass(run, is_new, own) - _log_mass(best, is_new, own))
        minima.append((run, is_new))
    share = np.divide(1.0, mass, out=np.full(cases, np.nan), where=mass > 0.0)
    return best, SecondBest(second, second_cost, share)


def _distance(one: Estimates, other: Estimates) -> FloatArray:
    """Distance of two minima, in deviations of the second, shape (cases,); NaN if one was not found."""
    apart = one.unknowns - other.unknowns
    squares: FloatArray = np.einsum("ci,cij,cj->c", apart, other.information, apart)
    return np.sqrt(np.maximum(squares, 0.0))


def _log_mass(run: Estimates, rows: npt.NDArray[np.bool_], own: int) -> FloatArray:
    """Logarithm of the posterior mass around the minima of some rows, up to a constant, by Laplace's method."""
    _, log_determinant = np.linalg.slogdet(run.information[rows, :own, :own])
    return np.asarray(-run.cost[rows] - log_determinant / 2.0)
