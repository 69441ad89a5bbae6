"""Uncertainty of the unknowns: covariance, and the directions that the data do not determine.

Near the optimum the misfit is linear: the covariance of the estimate is the inverse of the information JᵀJ, where J is
the Jacobian in standard deviations, including the rows of the priors. G. A. F. Seber, C. J. Wild, *Nonlinear
Regression*, Wiley 1989, chapters 2 and 3. Unknowns of single cases are eliminated first, so that their uncertainty
counts.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import Enum

import numpy as np
import numpy.typing as npt
from scipy.special import stdtrit

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.numerics.arrow_least_squares import ArrowStep

BLIND = 1e-10
"""Singular value, over the largest one, below which it is rounding, and the data do not see the direction."""

NORMAL_95 = 1.959963984540054
"""Deviations from the mean, to both sides, within which a normal distribution has 95 %."""

SMALL_PART = 1e-3
"""Largest component of an unknown that is left out of the description of a direction."""


class NoiseFrom(Enum):
    """Source of the noise of the data, for intervals."""

    SIGMA = "what was stated"
    RESIDUALS = "what the residuals are"
    BOTH = "the larger of the two"


@dataclass(frozen=True)
class Direction:
    """A combination of unknowns that the data do not determine.

    Attributes:
        parts: components of the direction in sizes of the unknowns, by name; the largest is positive.
        deviation: standard deviation along it, in these units, by the data alone; None if they do not see it.
    """

    parts: dict[str, float]
    deviation: float | None


@dataclass(frozen=True)
class Statistics:
    """Statistics of the shared unknowns.

    Attributes:
        covariance: covariance, shape (n, n); NaN in rows of undetermined unknowns, zero for unknowns held at a bound.
        determined: whether data and priors determine each unknown, and no bound holds it, shape (n,).
        unseen: directions that the data alone do not determine.
        settled: whether data and priors together determine every direction.
        noise: factor on the stated standard deviations: 1, or the one that follows from the residuals.
        quantile: number of deviations for 95 %.
        own: standard deviations of the unknowns of each case, shape (cases, k); NaN if undetermined.
    """

    covariance: FloatArray
    determined: npt.NDArray[np.bool_]
    unseen: tuple[Direction, ...]
    settled: bool
    noise: float
    quantile: float
    own: FloatArray

    @property
    def sigma(self) -> FloatArray:
        """Standard deviations, shape (n,); NaN if undetermined, zero for unknowns held at a bound."""
        return np.sqrt(np.where(self.determined, np.diagonal(self.covariance), np.nan))

    @property
    def correlation(self) -> FloatArray:
        """Correlations, shape (n, n); NaN without a standard deviation."""
        return self.covariance / np.outer(self.sigma, self.sigma)


def statistics(
    arrow: ArrowStep,
    labels: tuple[str, ...],
    scales: tuple[FloatArray, FloatArray],
    *,
    freedom: int,
    squares: float,
    noise_from: NoiseFrom,
) -> Statistics:
    """Compute the statistics of the unknowns at the optimum.

    Args:
        arrow: the misfit there, linear in the unknowns.
        labels: names of the shared unknowns.
        scales: sizes for comparison: of shared unknowns, shape (n,), and of a case's unknowns, shape (k,).
        freedom: number of data less number of unknowns.
        squares: sum of the squares of the residuals, or its equivalent under a robust loss.
        noise_from: source of the noise of the data.
    """
    n = arrow.shared
    shared_scales, own_scales = scales
    left, eliminations = arrow.eliminated(np.zeros_like(arrow.weights))
    free = ~arrow.held[:n]
    data = left[:, :n] * shared_scales
    prior = np.diag(np.where(free, arrow.weights[:n], 0.0) * shared_scales)
    by_data = _directions(data[:, free])
    by_both = _directions(np.vstack([data, prior])[:, free])
    free_labels = [label for label, is_free in zip(labels, free, strict=True) if is_free]
    unseen = tuple(by_data.told(free_labels))
    noise = 1.0
    quantile = NORMAL_95
    if noise_from is not NoiseFrom.SIGMA and freedom > 0:
        noise = math.sqrt(squares / freedom)
        # Student's distribution applies: the noise is estimated from the data.
        quantile = float(stdtrit(freedom, 0.975))
    if noise_from is NoiseFrom.BOTH and noise < 1.0:
        noise = 1.0
        quantile = NORMAL_95
    scaled = _with_noise(by_both.covariance(), prior[np.ix_(free, free)], noise)
    covariance = np.zeros((n, n))
    covariance[np.ix_(free, free)] = scaled * np.outer(shared_scales[free], shared_scales[free])
    determined = free & np.isfinite(np.diagonal(covariance))
    settled = not np.any(by_both.open)
    own = _own_deviations(arrow, eliminations, covariance, own_scales, noise)
    return Statistics(covariance, determined, unseen, settled, noise, quantile, own)


@dataclass(frozen=True)
class _Directions:
    """Singular directions of an information matrix.

    Attributes:
        singular: inverse standard deviation along each direction, shape (n,), descending.
        vectors: the directions, as rows.
    """

    singular: FloatArray
    vectors: FloatArray

    @property
    def blind(self) -> npt.NDArray[np.bool_]:
        """Mask of the directions that are not seen at all."""
        return np.asarray(self.singular <= BLIND * self.singular.max(initial=0.0))

    @property
    def open(self) -> npt.NDArray[np.bool_]:
        """Mask of the undetermined directions, whose deviation is as large as the unknowns themselves."""
        return self.blind | (self.singular < 1.0)

    def told(self, labels: list[str]) -> list[Direction]:
        """The undetermined directions, in words."""
        directions = []
        rows = zip(self.vectors, self.singular, self.blind, self.open, strict=True)
        for vector, singular, is_blind, is_open in rows:
            if not is_open:
                continue
            largest = vector[np.argmax(np.abs(vector))]
            parts = {
                label: float(part)
                for label, part in zip(labels, vector * np.sign(largest), strict=True)
                if abs(part) > SMALL_PART
            }
            directions.append(Direction(parts, None if is_blind else float(1 / singular)))
        return directions

    def covariance(self) -> FloatArray:
        """Inverse of the information; NaN for unknowns with a component in unseen directions."""
        seen = ~self.blind
        scaled = self.vectors[seen] / self.singular[seen, None]
        covariance: FloatArray = scaled.T @ scaled
        touched = np.any(np.abs(self.vectors[~seen]) > SMALL_PART, axis=0)
        covariance[touched] = np.nan
        covariance[:, touched] = np.nan
        return covariance


def _with_noise(covariance: FloatArray, prior: FloatArray, noise: float) -> FloatArray:
    """Covariance if data, but not priors, deviate by a larger factor than assumed in the fit.

    With the information A = D + P of data and priors, the covariance is A⁻¹ (noise² D + P) A⁻¹.

    Args:
        covariance: A⁻¹, NaN for unseen unknowns, shape (n, n).
        prior: weights of the priors, the square root of P, shape (n, n).
        noise: the factor.
    """
    # A prior determines this direction: it is not NaN.
    seen = np.nan_to_num(covariance)
    by_prior = prior @ seen
    return noise**2 * covariance + (1 - noise**2) * by_prior.T @ by_prior


def _directions(rows: FloatArray) -> _Directions:
    """Singular values and directions of rows, as many as there are columns."""
    count = rows.shape[1]
    padded = np.vstack([rows, np.zeros((count, count))])
    _, singular, vectors = np.linalg.svd(padded, full_matrices=False)
    return _Directions(singular[:count], vectors[:count])


def _own_deviations(
    arrow: ArrowStep, eliminations: list[FloatArray], covariance: FloatArray, scales: FloatArray, noise: float
) -> FloatArray:
    """Standard deviations of the unknowns of each case, including that by shared ones; NaN if undetermined."""
    n, k = arrow.shared, arrow.own
    deviations = np.full((len(eliminations), k), np.nan)
    for block, elimination in enumerate(eliminations):
        held = arrow.of_blocks(arrow.held)[block]
        rows = arrow.derivatives[arrow.offsets[block] : arrow.offsets[block + 1], n:]
        seen = np.any(rows != 0.0, axis=0) | (arrow.of_blocks(arrow.weights)[block] > 0.0)
        free = seen & ~held
        deviations[block, held] = 0.0
        # Unknowns without a datum have a row of their own in the triangle, and a column that is zero elsewhere.
        triangle = elimination[:, :k] * scales
        known = _directions(triangle[:, free])
        undetermined = np.isnan(np.diagonal(known.covariance()))
        inverse = np.linalg.pinv(triangle[:, free], rcond=BLIND)
        by_shared = inverse @ elimination[:, k : k + n]
        spread = noise**2 * inverse @ inverse.T + by_shared @ covariance @ by_shared.T
        sizes = np.sqrt(np.diagonal(spread)) * scales[free]
        deviations[block, free] = np.where(undetermined, np.nan, sizes)
    return deviations
