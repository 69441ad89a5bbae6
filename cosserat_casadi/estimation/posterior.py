"""Mean squared deviations of posteriors that are not normal distributions, by importance sampling.

Around each estimate steps are drawn from a normal distribution, somewhat wider than the covariance of the linearised
model, and weighted with the posterior there, for which the equilibrium is solved. A second round draws from the mean
and the covariance of the first, if enough of its draws count: O. Cappé, A. Guillin, J. M. Marin, C. P. Robert,
*Population Monte Carlo*, J. Comput. Graph. Stat. 13, 2004, 907-929. All rows have equal normalised draws, with exact
mean 0 and covariance 1, in pairs z, −z.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from statistics import NormalDist

import numpy as np
import numpy.typing as npt

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.load_cases import additive_recurrence

WIDENED = (1.2, 1.1)
"""Factor by which the draws of each round are wider than the known covariance."""

LEAST_EFFECTIVE = 3.0
"""Least effective draws for each unknown; with fewer, a row keeps the covariance of the linearised model."""

Costs = Callable[[FloatArray], FloatArray]
"""Steps from the estimates, shape (cases, draws, k) ↦ costs there, shape (cases, draws)."""


@dataclass(frozen=True)
class Sampled:
    """Moments of draws from the posteriors of rows, in the unknowns' units.

    Attributes:
        covariance: mean products of the deviations from the estimates, shape (cases, k, k).
        effective: effective number of draws, shape (cases,).
    """

    covariance: FloatArray
    effective: FloatArray

    @property
    def sound(self) -> npt.NDArray[np.bool_]:
        """Mask of the rows with enough effective draws for the covariance, shape (cases,)."""
        return np.asarray(self.effective >= LEAST_EFFECTIVE * self.covariance.shape[1])


def sampled(costs: Costs, least: FloatArray, covariance: FloatArray, draws: int) -> Sampled:
    """Compute mean squared deviations from estimates by draws around them.

    Args:
        costs: function of steps from the estimates ↦ costs.
        least: costs of the estimates, shape (cases,).
        covariance: covariance of the linearised model, shape (cases, k, k).
        draws: number of draws in each round; at least four for each unknown are made.
    """
    cases, k, _ = covariance.shape
    z = normal_draws(max(draws, 4 * k), k)
    # In coordinates in which the covariance of the linearised model is 1.
    to_units = np.linalg.cholesky(covariance)
    mean = np.zeros((cases, k))
    spread = np.broadcast_to(np.eye(k), covariance.shape)
    effective = np.zeros(cases)
    for wider in WIDENED:
        factors = wider * np.linalg.cholesky(spread)
        steps = mean[:, None] + np.einsum("cij,sj->csi", factors, z)
        differences = costs(np.einsum("cij,csj->csi", to_units, steps)) - least[:, None]
        weights = _weights(np.sum(z**2, axis=1) / 2 - differences)
        effective = _effective(weights)
        # A few draws within narrow bounds span less than the posterior: the next round would not leave them.
        enough = effective >= LEAST_EFFECTIVE * k
        drawn_mean = np.einsum("cs,csi->ci", weights, steps)
        apart = steps - drawn_mean[:, None]
        drawn_spread = np.einsum("cs,csi,csj->cij", weights, apart, apart)
        mean = np.where(enough[:, None], drawn_mean, mean)
        spread = np.where(enough[:, None, None], drawn_spread, spread)
    about_estimate = spread + mean[:, :, None] * mean[:, None, :]
    return Sampled(to_units @ about_estimate @ np.swapaxes(to_units, 1, 2), effective)


def _weights(logarithms: FloatArray) -> FloatArray:
    """Weights whose sum is 1, shape (cases, draws); all are 0 if no draw has an equilibrium within the bounds."""
    largest = logarithms.max(axis=1, keepdims=True)
    weights = np.exp(logarithms - np.where(np.isfinite(largest), largest, 0.0))
    total = weights.sum(axis=1, keepdims=True)
    return np.asarray(np.divide(weights, total, out=np.zeros_like(weights), where=total > 0.0))


def _effective(weights: FloatArray) -> FloatArray:
    """Effective number of weighted draws, shape (cases,); 0 if all weights are 0."""
    squares = np.sum(weights**2, axis=1)
    return np.asarray(np.divide(1.0, squares, out=np.zeros_like(squares), where=squares > 0.0))


def normal_draws(count: int, k: int) -> FloatArray:
    """Draws of a normal distribution in pairs z, −z, with exact mean 0 and covariance 1, shape (count, k).

    They are evenly spread by the additive recurrence with powers of the root of g^(k+1) = g + 1: M. Roberts, 2018.

    Args:
        count: number of draws, at least 2 k; an odd number is increased by one.
        k: number of entries of each draw.
    """
    # The corner of all ones comes first, where a normal distribution has no number.
    shares = additive_recurrence((count + 1) // 2 + 1, k)[1:]
    half = np.vectorize(NormalDist().inv_cdf)(shares)
    spread = half.T @ half / len(half)
    half = np.linalg.solve(np.linalg.cholesky(spread), half.T).T
    return np.vstack([half, -half])
