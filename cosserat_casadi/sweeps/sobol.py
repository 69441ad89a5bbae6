"""Sobol indices: the share of the variance of a result for which each random column of a sweep accounts.

The first-order index of a column is its share without interactions; the total index is the variance that would remain
if all other columns were known. Two independent draws A and B are solved, and A with one column of B after the other.
First order: A. Saltelli et al., Computer Physics Communications 181, 2010, 259-270, table 2, (b); total: M. J. W.
Jansen, Computer Physics Communications 117, 1999, 35-43. Intervals are percentiles of bootstrap estimates, which draw
the samples anew.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from cosserat_casadi.codegen.rows import ERRORS
from cosserat_casadi.errors import Problem, SceneError
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.result import Result
from cosserat_casadi.sweeps.outcome_table import Sweep

CONFIDENCE = 0.95
"""Share of the bootstrap estimates within an interval."""

RESAMPLES = 1000
"""Number of bootstrap estimates."""

AT_ONCE = 50
"""Number of bootstrap estimates that are computed together: their weights take memory."""

SEED = 21
"""Seed of the bootstrap: the same sweep gives the same intervals."""

CONSTANT = 1e-9
"""Standard deviation over the largest value below which a result is constant to rounding."""


@dataclass(frozen=True)
class Estimates:
    """Sobol indices of one result.

    Attributes:
        mean: mean of the result.
        variance: variance of the result.
        first: first-order index of each column, shape (columns,); NaN for a constant result.
        total: total index of each column, shape (columns,); NaN for a constant result.
        first_interval: bounds of the first-order indices, shape (columns, 2).
        total_interval: bounds of the total indices, shape (columns, 2).
    """

    mean: float
    variance: float
    first: FloatArray
    total: FloatArray
    first_interval: FloatArray
    total_interval: FloatArray


@dataclass(frozen=True, repr=False)
class SobolIndices(Result):
    """Sobol indices of the results of a sweep.

    Attributes:
        factors: the random columns.
        results: estimates by column of the results.
        samples: number of draws for the estimates.
        left_out: number of draws with a row without equilibrium, which the indices leave out.
    """

    factors: tuple[str, ...]
    results: dict[str, Estimates]
    samples: int
    left_out: int


def sobol_indices(sweep: Sweep) -> SobolIndices:
    """Sobol indices of positions and efforts of actuators, from a sweep over :func:`sobol_table`.

    Raises:
        SceneError: the rows of the sweep were not drawn for it, or fewer than two draws have equilibria throughout.
    """
    drawn = sweep.record.get("sobol")
    if drawn is None:
        remedy = "sweep over sobol_table(...), or with --sobol"
        raise SceneError(Problem("sweep", "its rows were not drawn for Sobol indices", remedy))
    factors = tuple(drawn["factors"])
    blocks = len(factors) + 2
    converged = sweep.converged.reshape(blocks, -1)
    whole = np.flatnonzero(converged.all(axis=0))
    draws = converged.shape[1]
    if len(whole) < 2:
        problem = f"of {draws} draws only {len(whole)} have an equilibrium in every row: no variance to share"
        raise SceneError(Problem("--sobol", problem, "narrow the random columns"))
    columns = varied_results(sweep)
    values = {name: sweep[name].reshape(blocks, -1)[:, whole] for name in columns}
    positions = [np.abs(values[name]).max() for name in columns if name[-2:] in POSITION]
    results = {}
    for name in columns:
        own = values[name]
        # Only rounding moves a planar rod out of its plane.
        largest = max(positions) if name[-2:] in POSITION else np.abs(own).max()
        results[name] = estimates(own[0], own[1], own[2:], CONSTANT * float(largest))
    return SobolIndices(factors, results, len(whole), draws - len(whole))


POSITION = (".x", ".y", ".z")
"""Ends of the names of columns with positions."""

UNVARIED = (".qw", ".qx", ".qy", ".qz")
"""Ends of the names of columns without indices: an entry of a unit quaternion has no meaning alone."""


def varied_results(sweep: Sweep) -> list[str]:
    """Columns of results with indices: positions, efforts of actuators, the smallest eigenvalue."""
    judged = ("iterations", "residual", *ERRORS, "stable")
    kept = [name for name in sweep.found if name not in judged and not name.endswith(UNVARIED)]
    # Without a judgement of stability there is no number.
    return [name for name in kept if np.isfinite(sweep[name][sweep.converged]).all()]


def estimates(first_draw: FloatArray, second_draw: FloatArray, mixed: FloatArray, smallest: float = 0.0) -> Estimates:
    """Sobol indices of one result, with their intervals.

    Args:
        first_draw: the result for A, shape (samples,).
        second_draw: the result for B, shape (samples,).
        mixed: the result for A with column i of B, shape (columns, samples).
        smallest: standard deviation up to which the result counts as constant.
    """
    pooled = np.concatenate([first_draw, second_draw])
    mean = float(pooled.mean())
    variance = float(pooled.var())
    columns = len(mixed)
    if np.sqrt(variance) <= smallest:
        unknown = np.full(columns, np.nan)
        no_interval = np.full((columns, 2), np.nan)
        return Estimates(mean, variance, unknown, unknown, no_interval, no_interval)
    # Products of centred results scatter less.
    a = first_draw - mean
    b = second_draw - mean
    c = mixed - mean
    terms = np.vstack([a, b, a**2, b**2, b * (c - a), (a - c) ** 2 / 2.0])
    samples = terms.shape[1]
    first, total = _indices(terms.mean(axis=1)[None, :], columns)
    rng = np.random.default_rng(SEED)
    firsts = []
    totals = []
    for _ in range(0, RESAMPLES, AT_ONCE):
        # Means need only the number of times that each sample is drawn.
        drawn = rng.integers(samples, size=(AT_ONCE, samples))
        weights = np.array([np.bincount(numbers, minlength=samples) for numbers in drawn]) / samples
        again = _indices(weights @ terms.T, columns)
        firsts.append(again[0])
        totals.append(again[1])
    return Estimates(mean, variance, first[0], total[0], _interval(firsts), _interval(totals))


def _indices(means: FloatArray, columns: int) -> tuple[FloatArray, FloatArray]:
    """First-order and total indices from means of the terms, one set a row: (k, columns) each."""
    shift = (means[:, 0] + means[:, 1]) / 2.0
    variance = (means[:, 2] + means[:, 3]) / 2.0 - shift**2
    first = means[:, 4 : 4 + columns] / variance[:, None]
    total = means[:, 4 + columns :] / variance[:, None]
    return first, total


def _interval(estimated: list[npt.NDArray[np.float64]]) -> FloatArray:
    """Bounds of bootstrap estimates, shape (columns, 2)."""
    outside = (1.0 - CONFIDENCE) / 2.0
    return np.quantile(np.vstack(estimated), [outside, 1.0 - outside], axis=0).T
