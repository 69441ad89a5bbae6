"""Result of an estimate: the estimates of each row, their uncertainty, and directions that no sensor sees."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from cosserat_casadi.codegen.estimator import ENDINGS, Estimates, Knowledge
from cosserat_casadi.estimation.consistency import Consistency
from cosserat_casadi.estimation.optima import SecondBest
from cosserat_casadi.estimation.shared import SharedNumbers
from cosserat_casadi.identification.statistics import NORMAL_95
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.result import Result

BLIND = 1e-10
"""Eigenvalue of the information, in typical sizes, over the largest one, below which a direction is undetermined."""

HARDLY_SEEN = 0.01
"""Information of the data, over that of the prior, below which the prior alone determines a direction: its deviation
is narrower by half a percent."""

SHOWN_PART = 0.2
"""Least component of an unknown that is named in the description of a direction."""

SURE = 0.95
"""Share of the posterior mass above which the best minimum represents all."""

NOT_DETERMINED = "not_determined"
"""Word for a row whose unknowns neither data nor priors determine."""

BEHIND = "behind"
"""Word for a row whose search led through a smooth obstacle or a rod."""

UNREACHED = "unreached"
"""Word for a row whose search may have led through one of these, as paths of its loads stall before they show it."""


@dataclass(frozen=True, repr=False)
class Estimate(Result):
    """Estimates of every case.

    Attributes:
        model: the model of the estimates.
        cases: first row of each case in words.
        labels: names of the unknown numbers.
        units: units of the unknown numbers.
        outcomes: outcome of each case: ``found``, or the reason of the failure, see :data:`REASONS`.
        values: the maxima a posteriori, shape (cases, k); NaN without an estimate.
        covariance: covariance of the values, shape (cases, k, k), NaN without an estimate; it includes the uncertainty
            of the shared numbers. With draws it consists of the mean products of deviations from the values.
        cost: half the sum of squares in squared standard deviations, shape (cases,).
        numbers: count of measured numbers in each case, shape (cases,).
        x: unknowns of the equilibria, shape (cases, size).
        inputs: stacked inputs of each case, shape (cases, inputs).
        parameters: stacked parameters of each case, shape (cases, parameters); often none.
        second: second best minima of the rows; None after a single search for each.
        unseen: directions that the data do not see, in words, with the number of cases in which they are unseen.
        consistency: consistency of data, priors and model.
        shared: numbers that all rows share; None if none of these is unknown.
        stable: stability of the equilibrium of each case; None if that has no meaning, and in exact contact.
        checked: cases solved again on a finer discretisation: index of the case, estimated error.
        warnings: sentences on what looks wrong.
    """

    model: Model
    cases: tuple[str, ...]
    labels: tuple[str, ...]
    units: tuple[str, ...]
    outcomes: tuple[str, ...]
    values: FloatArray
    covariance: FloatArray
    cost: FloatArray
    numbers: npt.NDArray[np.int64]
    x: FloatArray
    inputs: FloatArray
    parameters: FloatArray
    second: SecondBest | None
    unseen: dict[str, int]
    consistency: Consistency
    shared: SharedNumbers | None = None
    stable: tuple[bool | None, ...] = ()
    checked: tuple[tuple[int, float | None], ...] = ()
    warnings: tuple[str, ...] = field(default=())

    @property
    def found(self) -> npt.NDArray[np.bool_]:
        """Mask of the cases with an estimate, shape (cases,)."""
        return np.array([outcome == ENDINGS[0] for outcome in self.outcomes])

    @property
    def doubtful(self) -> npt.NDArray[np.bool_]:
        """Mask of the cases with a doubtful estimate: another minimum has a considerable share, shape (cases,)."""
        if self.second is None:
            return np.zeros(len(self.cases), dtype=bool)
        return self.found & (self.second.share < SURE)

    @property
    def sigma(self) -> FloatArray:
        """Standard deviations, shape (cases, k)."""
        return np.sqrt(np.diagonal(self.covariance, axis1=1, axis2=2))

    @property
    def intervals(self) -> FloatArray:
        """Intervals with 95 % of the posterior, shape (cases, k, 2)."""
        half = NORMAL_95 * self.sigma
        return np.stack([self.values - half, self.values + half], axis=2)

    @property
    def counts(self) -> dict[str, int]:
        """Number of cases by outcome."""
        return dict(Counter(self.outcomes))

    @property
    def message(self) -> str:
        """Sentence with the number of cases that have an estimate."""
        return f"{int(np.count_nonzero(self.found))} of {len(self.cases)} rows found."

    @property
    def within_tolerance(self) -> bool | None:
        """Whether every case that was solved again is within the scene's tolerance.

        The value is None if none was, and if no tolerance has a meaning.
        """
        accuracy = self.model.scene.accuracy
        if not self.checked or not accuracy.binds:
            return None
        return all(error is not None and error <= accuracy.tolerance for _, error in self.checked)

    @property
    def holds(self) -> bool:
        """Whether some case has an estimate, and every case that was solved again is within the scene's tolerance."""
        return self.within_tolerance is not False and bool(np.any(self.found))


REASONS = {
    "no_equilibrium": "No equilibrium at the first guess: give a prior near the expected values.",
    "singular": "A limit or bifurcation point: no derivatives there.",
    "not_found": "The search found no least misfit.",
    BEHIND: "The search led through an obstacle or a rod, and no load moves the rods past it: give a nearer prior.",
    UNREACHED: "An obstacle or a rod is in the way, and paths of loads stall: rods may be behind it.",
    NOT_DETERMINED: "Neither data nor priors determine the unknowns: give priors, or measure more.",
}
"""Reason for a missing estimate, by outcome."""


def information_of(
    found: Estimates, known: Knowledge, labels: Sequence[str]
) -> tuple[FloatArray, npt.NDArray[np.bool_], dict[str, int]]:
    """Determine the information of data and priors on rows of estimates.

    Directions are expressed in the deviations of the priors, or in typical sizes for unknowns without a prior.

    Returns:
        covariances, shape (cases, k, k), NaN if undetermined; mask of the determined rows, shape (cases,); and the
        directions that the data do not see, as in :class:`Estimate`.
    """
    cases, k = found.unknowns.shape
    has_prior = known.limits.weight > 0.0
    sizes = np.where(has_prior, 1.0 / np.where(has_prior, known.limits.weight, 1.0), known.size)
    covariance = np.full((cases, k, k), np.nan)
    determined = np.zeros(cases, dtype=bool)
    rows = np.flatnonzero(found.outcome == 0)
    if not rows.size:
        return covariance, determined, {}
    scaled = found.information[rows] * np.outer(sizes, sizes)
    eigenvalues, vectors = np.linalg.eigh(scaled)
    is_determined = eigenvalues[:, 0] > BLIND * eigenvalues[:, -1]
    determined[rows] = is_determined
    sound = np.where(is_determined[:, None], eigenvalues, np.nan)
    inverse = np.einsum("cij,cj,ckj->cik", vectors, 1.0 / sound, vectors)
    covariance[rows] = inverse * np.outer(sizes, sizes)
    of_data = scaled - np.diag(np.where(has_prior, 1.0, 0.0))
    return covariance, determined, _unseen(of_data, has_prior, labels)


def _unseen(of_data: FloatArray, has_prior: npt.NDArray[np.bool_], labels: Sequence[str]) -> dict[str, int]:
    """Directions of little information, in words, with the number of cases that have them."""
    eigenvalues, vectors = np.linalg.eigh(of_data)
    least = BLIND * eigenvalues[:, -1:]
    # If every unknown has a prior, directions that data hardly tighten are not seen either.
    limits = np.maximum(least, HARDLY_SEEN) if has_prior.all() else np.broadcast_to(least, (len(least), 1))
    counted: Counter[str] = Counter()
    for case, column in zip(*np.nonzero(eigenvalues <= limits), strict=True):
        counted[_described(vectors[case, :, column], labels)] += 1
    return dict(counted.most_common())


def _described(direction: FloatArray, labels: Sequence[str]) -> str:
    """Describe a direction in words, such as ``0.97 push.force.x − 0.24 push.moment.y``."""
    largest = int(np.argmax(np.abs(direction)))
    signed = direction * np.sign(direction[largest])
    order = np.argsort(-np.abs(signed), kind="stable")
    parts: list[tuple[float, str]] = [(float(signed[i]), labels[i]) for i in order if abs(signed[i]) >= SHOWN_PART]
    if len(parts) == 1:
        return parts[0][1]
    words = []
    for part, label in parts:
        sign = "− " if part < 0 else "+ "
        words.append(f"{sign}{abs(part):.1f} {label}")
    return " ".join(words).removeprefix("+ ")
