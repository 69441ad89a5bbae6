"""Test whether model, priors and stated noise explain the data of all rows together.

If all assumptions hold, twice the cost of a row is a sum of squares with a chi-square distribution, whose degrees of
freedom are the measurements and priors less the estimated numbers. So is the sum over rows. The differences of each
sensor then have zero mean. Y. Bar-Shalom, X. R. Li, T. Kirubarajan, *Estimation with Applications to Tracking and
Navigation*, Wiley 2001, section 5.4.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.spelling import counted, named

DOUBTED = 4.0
"""Deviations of a normal distribution beyond which chance is no explanation: one-sided, 1 in 30 000."""

ROW_DOUBTED = 5.0
"""Deviations of a normal distribution beyond which a single row is doubted; by chance none in a million rows is."""


@dataclass(frozen=True)
class Consistency:
    """Consistency of data, priors and model.

    Attributes:
        squares: sum of the squares of all deviations from data and priors.
        freedom: expected value of the sum.
        deviations: excess of the sum, in standard deviations of a normal distribution.
        row_deviations: excess of the sum of each row, in that unit, shape (cases,); NaN if the row was not found, or
            has no degrees of freedom.
        bias: mean deviation of each sensor over the rows, in standard deviations of that mean, by its name; for sensors
            that were read in at least two rows, with the largest deviation replaced by the next largest.
    """

    squares: float
    freedom: int
    deviations: float
    row_deviations: FloatArray
    bias: dict[str, float]

    @property
    def holds(self) -> bool:
        """Whether chance explains the residuals."""
        return self.deviations <= DOUBTED and not self.biased and not np.any(self.outlying)

    @property
    def biased(self) -> dict[str, float]:
        """Biased sensors, the worst first."""
        worst = sorted(self.bias.items(), key=lambda item: -abs(item[1]))
        return {name: bias for name, bias in worst if abs(bias) > DOUBTED}

    @property
    def outlying(self) -> npt.NDArray[np.bool_]:
        """Mask of the rows that are outliers by themselves, shape (cases,)."""
        return np.nan_to_num(self.row_deviations, nan=0.0) > ROW_DOUBTED

    def sentences(self, cases: Sequence[str]) -> Iterator[str]:
        """Sentences on the disagreements, for the user."""
        if self.deviations > DOUBTED:
            yield (
                f"Model and priors do not explain the data to the accuracy that sigma states: the squares of all "
                f"deviations sum to {self.squares:.4g} where {self.freedom} are expected. Deviations of what was "
                "found are too small then; give numbers of the scene that are known roughly as unknowns with a prior."
            )
        biased = list(self.biased.items())
        if biased:
            told = named([f"{name} by {bias:+.1f}" for name, bias in biased])
            yield (
                "Model, or means of priors, are off to one side in all rows together, in deviations of the mean: "
                f"{told}. No noise does that."
            )
        rows = [case for case, outlies in zip(cases, self.outlying, strict=True) if outlies]
        # If most rows stand out, their sum does too, and is reported.
        if rows and 2 * len(rows) <= len(cases):
            verb = "stands" if len(rows) == 1 else "stand"
            yield f"{counted(len(rows), 'row')} {verb} out, which chance does not explain: {named(rows)}."


def consistency(
    squares: FloatArray,
    freedom: npt.NDArray[np.int64],
    shared: float,
    residuals: dict[str, FloatArray],
    shared_freedom: int = 0,
) -> Consistency:
    """Judge the consistency of rows with a model.

    Args:
        squares: twice the cost of each row, shape (cases,); NaN if it was not found.
        freedom: number of measurements and priors of each row, less estimated numbers, shape (cases,).
        shared: squared deviations of the shared numbers from their priors; each has a prior, so that they add no
            freedom.
        residuals: deviations of each sensor in all rows where it was measured, by the sensor's name.
        shared_freedom: number of shared numbers held at a bound, which were not fitted, while their priors count.
    """
    found = np.isfinite(squares)
    total = float(squares[found].sum()) + shared
    left = int(freedom[found].sum()) + shared_freedom
    bias = {name: _mean_deviation(values) for name, values in residuals.items() if len(values) > 1}
    by_row = np.array([chi_square_deviations(*row) for row in zip(squares.tolist(), freedom.tolist(), strict=True)])
    return Consistency(total, left, chi_square_deviations(total, left), by_row, bias)


def _mean_deviation(values: FloatArray) -> float:
    """Mean of two deviations or more, in standard deviations of that mean.

    The largest deviation is replaced by the next largest, as a single outlier is no bias.
    """
    limit = np.sort(np.abs(values))[-2]
    return float(np.clip(values, -limit, limit).sum() / np.sqrt(len(values)))


def chi_square_deviations(squares: float, freedom: int) -> float:
    """Deviations of a normal distribution that are as likely as a sum of squares; NaN without degrees of freedom.

    E. B. Wilson, M. M. Hilferty, Proc. Natl. Acad. Sci. 17, 1931, 684-688.
    """
    if freedom < 1 or not np.isfinite(squares):
        return float("nan")
    variance = 2 / (9 * freedom)
    return float(((squares / freedom) ** (1 / 3) - (1 - variance)) / np.sqrt(variance))
