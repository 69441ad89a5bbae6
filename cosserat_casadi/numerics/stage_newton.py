"""Newton's method for the stages of one step, with one Jacobian and its Broyden updates.

One Jacobian serves all stages and all iterations, and further steps as long as few iterations suffice. Secant updates
compensate for its change within the step: with coordinates anchored at the base of a rod, some motions move almost no
mass, and along them a small rotation of the rod changes the Jacobian by more than its own size. Convergence is judged
by the remaining error of the positions, and of h times the velocities, predicted from the contraction of the
corrections. E. Hairer, G. Wanner, *Solving Ordinary Differential Equations II*, 2nd ed., Springer 1996, section IV.8.
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
"""Change of position, over the largest one, that counts as rounding."""

LEAST_CONTRACTION = 0.1
"""Contraction that is counted on at best: a smaller one tells of the directions in which the Jacobian is good."""

DIVERGING = 10.0
"""Growth of a correction over the one before at which the iteration counts as diverging, despite secant updates."""


class StageOutcome(Enum):
    """Outcomes of Newton's method in one step."""

    CONVERGED = auto()
    DIVERGED = auto()
    NOT_FINITE = auto()


@dataclass(frozen=True)
class StageSolution:
    """Result of Newton's method in one step.

    Attributes:
        unknowns: unknowns of the stages, shape (s, n).
        outcome: outcome of the iteration.
        iterations: number of corrections.
        contraction: ratio of the last two corrections; 0 after a single one.
        residual: largest entry of F before the last correction.
    """

    unknowns: FloatArray
    outcome: StageOutcome
    iterations: int
    contraction: float
    residual: float


@dataclass(frozen=True)
class NewtonBounds:
    """Stopping criteria of Newton's method.

    Attributes:
        weights: weights of the entries of an error, of which the largest counts; 0 for algebraic ones, shape (n,).
        error: largest remaining weighted error.
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
        matrices: the factorised linear system, with the method and the step size h.
        start: state at the start of the step.
        guess: first iterate of the unknowns, shape (s, n).
        bounds: stopping criteria.
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
    """Outcome of the iteration after a correction; None if another one is due.

    Args:
        length: weighted length of the correction.
        longest: largest weighted length of the corrections before; infinite for the first.
        contraction: ratio to the correction before; 0 for the first.
        allowed: largest remaining weighted error.
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
    return StageOutcome.CONVERGED if left <= allowed else None


@dataclass
class SecantUpdates:
    """Broyden's rank-one updates of the linear system of all stages of one step.

    Each update makes the inverse B⁻¹ agree with the change of F by the last correction, and does not change it
    orthogonally to that correction: B₊⁻¹ = (1 + s₊ ŝᵀ) B⁻¹ with the correction s, the next one s₊, and the dual ŝ of s.
    Orthogonality refers to weighted changes of velocity, so that units do not matter. The updates are never formed.
    C. T. Kelley, *Iterative Methods for Linear and Nonlinear Equations*, SIAM 1995, section 7.3; :mod:`broyden` is for
    equilibria.

    Attributes:
        matrix: matrix A of the collocation method, from changes of h² a to changes of h v, shape (s, s).
        weights: weights of the entries of a change of h v, 0 for algebraic ones, shape (n,).
        taken: corrections so far, each of shape (s, n).
        duals: dual ŝ of each correction s, with ŝ·s = 1, zero on all vectors orthogonal to s, each of shape (s, n).
    """

    matrix: FloatArray
    weights: FloatArray
    taken: list[FloatArray] = field(default_factory=list)
    duals: list[FloatArray] = field(default_factory=list)

    def applied_to(self, corrections: FloatArray) -> FloatArray:
        """Apply all updates to corrections; the result is not finite if, by the last one, F does not change along them.

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
        """Add the update of accepted corrections, shape (s, n), with some nonzero differential entry."""
        weighted = (self.matrix @ corrections) * self.weights
        dual = self.matrix.T @ (weighted * self.weights)
        self.taken.append(corrections)
        self.duals.append(dual / np.vdot(weighted, weighted))
