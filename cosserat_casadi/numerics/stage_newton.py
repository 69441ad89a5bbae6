"""Newton's method for the stages of one step, with one Jacobian and Broyden's updates of it.

One Jacobian serves all stages and all iterations, and further steps while few iterations suffice. Secant updates make
up for what changes of it within the step: where coordinates are anchored at the base of a rod, some motions move next
to no mass, and along them a small turn of the rod changes the Jacobian by more than its own size. What counts as
converged is the error that is left in the positions, and in h times the velocities, as the contraction of the
corrections foretells it. E. Hairer, G. Wanner, *Solving Ordinary Differential Equations II*, 2nd ed., Springer 1996,
section IV.8.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from enum import Enum, auto

import numpy as np

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.numerics.motion_equations import Instant, MotionEquations
from cosserat_casadi.numerics.step import StepPolynomial
from cosserat_casadi.numerics.step_matrices import StepMatrices

ROUNDING = 16.0 * float(np.finfo(np.float64).eps)
"""Change of position, relative to the largest, that is rounding and not a correction."""

LEAST_CONTRACTION = 0.1
"""Contraction that is counted on at best: a smaller one tells of the directions in which the Jacobian is good."""

DIVERGING = 10.0
"""Growth of a correction over the one before that secant updates do not make up for."""


class StageOutcome(Enum):
    """How Newton's method ended in one step."""

    CONVERGED = auto()
    DIVERGED = auto()
    NOT_FINITE = auto()


@dataclass(frozen=True)
class StageSolution:
    """Where Newton's method ended in one step.

    Attributes:
        unknowns: unknowns of the stages, as in :class:`Step`, shape (s, n).
        outcome: how it ended.
        iterations: corrections computed.
        contraction: ratio of the last two corrections; 0 where there was but one.
        residual: largest entry of F before the last correction.
    """

    unknowns: FloatArray
    outcome: StageOutcome
    iterations: int
    contraction: float
    residual: float


@dataclass(frozen=True)
class NewtonBounds:
    """When Newton's method stops.

    Attributes:
        weights: what each entry of an error is multiplied by before the largest counts; 0 for algebraic ones, (n,).
        error: weighted error that may be left.
        iterations: most corrections of one step.
    """

    weights: FloatArray
    error: float
    iterations: int

    def length(self, change: FloatArray) -> float:
        """Largest weighted entry of changes of position, shape (…, n); not finite where a change is not."""
        return float((np.abs(change) * self.weights).max(initial=0.0))


def solve_stages(
    equations: MotionEquations, matrices: StepMatrices, start: Instant, guess: FloatArray, bounds: NewtonBounds
) -> StageSolution:
    """Solve for the stages of a step.

    Args:
        equations: the equations of motion.
        matrices: the factorised linear system, which knows the method and the step h.
        start: where the step begins.
        guess: first iterate of the unknowns, shape (s, n).
        bounds: when to stop.
    """
    method = matrices.method
    updates = SecantUpdates(method.matrix, bounds.weights)
    to_unknowns = np.where(equations.differential, matrices.step**-2, 1.0)
    rounding = ROUNDING * bounds.length(start.x)
    allowed = max(bounds.error, rounding)
    unknowns = guess
    length_before = np.inf
    longest = np.inf
    contraction = 0.0
    for iteration in range(1, bounds.iterations + 1):
        stages = StepPolynomial(method, equations.differential, start, matrices.step, unknowns).stages
        residuals = equations.residual_of_stages(stages.times, stages.x, stages.v, stages.a)
        largest = float(np.abs(residuals).max(initial=0.0))
        corrections = updates.applied_to(matrices.corrections(residuals))
        # A h²a is h times the change of v; that of x, A² h²a, is never larger, as no row of |A| has a sum above one.
        length = bounds.length(method.matrix @ corrections)
        if not math.isfinite(length + largest):
            return StageSolution(unknowns, StageOutcome.NOT_FINITE, iteration, contraction, largest)
        unknowns = unknowns + to_unknowns * corrections
        if iteration > 1:
            contraction = length / length_before
        outcome = _outcome(length, longest, contraction, allowed)
        if outcome is not None:
            return StageSolution(unknowns, outcome, iteration, contraction, largest)
        updates.take(corrections)
        length_before = length
        longest = length if iteration == 1 else max(longest, length)
    return StageSolution(unknowns, StageOutcome.DIVERGED, bounds.iterations, contraction, largest)


def _outcome(length: float, longest: float, contraction: float, allowed: float) -> StageOutcome | None:
    """How the iteration ends with a correction; None where another one is due.

    Args:
        length: of the correction, weighted.
        longest: of the corrections before, weighted; infinite for the first.
        contraction: ratio to the one before; 0 for the first.
        allowed: weighted error that may be left.
    """
    # Where corrections shrink, what is left after this one is shorter than it; where they do not, it is rounding.
    if length <= allowed:
        return StageOutcome.CONVERGED
    # Beside the longest one: after a very short correction one of the usual length is no sign of anything.
    if length >= DIVERGING * longest:
        return StageOutcome.DIVERGED
    # Corrections may grow for once while the updates learn a direction; then, and at first, nothing is foretold.
    if contraction == 0.0 or contraction >= 1.0:
        return None
    expected = max(contraction, LEAST_CONTRACTION)
    left = length * expected / (1.0 - expected)
    if left <= allowed:
        return StageOutcome.CONVERGED
    return None


@dataclass
class SecantUpdates:
    """Broyden's rank-one updates of the linear system of all stages of one step.

    Each makes the inverse B⁻¹ agree with what the last correction did to F, and leaves it as it was across that
    correction: B₊⁻¹ = (1 + s₊ ŝᵀ) B⁻¹ with the correction s, the one that followed it, s₊, and ŝ the dual of s. Across
    is meant in weighted changes of velocity, so that units play no part. The updates are never formed. C. T. Kelley,
    *Iterative Methods for Linear and Nonlinear Equations*, SIAM 1995, section 7.3; :mod:`broyden` has them for
    equilibria.

    Attributes:
        matrix: A of the collocation method, shape (s, s): changes of h² a to changes of h v.
        weights: what each entry of a change of h v is multiplied by, 0 for algebraic ones, shape (n,).
        taken: corrections taken so far, each of shape (s, n).
        duals: of each correction s the ŝ with ŝ·s = 1, orthogonal to all vectors across s, each of shape (s, n).
    """

    matrix: FloatArray
    weights: FloatArray
    taken: list[FloatArray] = field(default_factory=list)
    duals: list[FloatArray] = field(default_factory=list)

    def applied_to(self, corrections: FloatArray) -> FloatArray:
        """Corrections with all updates; not finite where the last one says that F would not change along them.

        Args:
            corrections: solution of the linear system before any update, with F after the last correction, (s, n).
        """
        with np.errstate(all="ignore"):
            for dual, following in zip(self.duals, self.taken[1:], strict=False):
                corrections = corrections + np.vdot(dual, corrections) * following
            if self.duals:
                # The last update contains what it is to be applied for: s₊ = z + s₊ (ŝ·z), solved for s₊.
                corrections = corrections / (1.0 - np.vdot(self.duals[-1], corrections))
        return corrections

    def take(self, corrections: FloatArray) -> None:
        """Add the update of corrections that are taken, shape (s, n), of which some differential entry is not zero."""
        weighted = (self.matrix @ corrections) * self.weights
        dual = self.matrix.T @ (weighted * self.weights)
        self.taken.append(corrections)
        self.duals.append(dual / np.vdot(weighted, weighted))
