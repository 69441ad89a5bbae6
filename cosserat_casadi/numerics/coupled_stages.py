"""Damped Newton's method for the stages of one step with a Jacobian at each stage, for steps that move far.

One Jacobian for all stages, as in :mod:`stage_newton`, suffices if a step moves little. A step of a given size may turn
a rod by a large angle between its stages: no single Jacobian is near all stages, and a full correction diverges. Here
each stage has its own Jacobian; the systems are coupled by the tables of the method, and corrections are shortened
until the next one would be shorter: P. Deuflhard, *Newton Methods for Nonlinear Problems*, Springer 2004, section 3.3
(natural monotonicity).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.numerics.collocation import Collocation
from cosserat_casadi.numerics.motion_equations import Instant, MotionEquations
from cosserat_casadi.numerics.stage_newton import ROUNDING, NewtonBounds, StageOutcome, StageSolution
from cosserat_casadi.numerics.step import StepPolynomial
from cosserat_casadi.numerics.step_matrices import scaled_inverse

ITERATIONS = 12
"""Most corrections."""

LEAST_SHARE = 2.0**-5
"""Smallest share of a correction that is taken."""

DECREASE = 0.25
"""Least decrease of the corrections by a share λ of one, over λ."""


@dataclass(frozen=True)
class CoupledStages:
    """The equations of all stages of one step.

    Attributes:
        equations: the equations of motion.
        method: the collocation method.
        start: state at the start of the step.
        size: step size h, s.
    """

    equations: MotionEquations
    method: Collocation
    start: Instant
    size: float

    def residuals(self, unknowns: FloatArray) -> FloatArray:
        """F at the stages for their unknowns; both of shape (s, n)."""
        stages = StepPolynomial(self.method, self.equations.differential, self.start, self.size, unknowns).stages
        return self.equations.residual_of_stages(stages.times, stages.x, stages.v, stages.a)

    def jacobian(self, unknowns: FloatArray) -> FloatArray:
        """Derivatives of all residuals by h² a of differential entries and by the values of algebraic ones.

        Args:
            unknowns: unknowns of the stages, shape (s, n).

        Returns:
            the Jacobian, shape (s n, s n).
        """
        differential = self.equations.differential
        stages = StepPolynomial(self.method, differential, self.start, self.size, unknowns).stages
        count, size = unknowns.shape
        blocks = np.zeros((count, size, count, size))
        for i in range(count):
            instant = Instant(float(stages.times[i]), stages.x[i], stages.v[i], stages.a[i])
            linear = self.equations.linearised(instant)
            for j in range(count):
                block = self.method.matrix_squared[i, j] * linear.stiffness
                block = block + self.method.matrix[i, j] / self.size * linear.damping
                own = np.zeros_like(block)
                if i == j:
                    block = block + linear.mass / self.size**2
                    own = linear.stiffness
                blocks[i, :, j, :] = np.where(differential, block, own)
        return blocks.reshape(count * size, count * size)


@dataclass(frozen=True)
class Taken:
    """A share of a correction that brings a decrease.

    Attributes:
        share: share of the whole correction.
        unknowns: unknowns after it, shape (s, n).
        residuals: F there, shape (s, n).
        following: weighted length of the next correction with this Jacobian; after a whole one, the remaining error.
    """

    share: float
    unknowns: FloatArray
    residuals: FloatArray
    following: float


def solve_coupled_stages(stages: CoupledStages, guess: FloatArray, bounds: NewtonBounds) -> StageSolution:
    """Solve for the stages of a step.

    Args:
        stages: equations of the stages.
        guess: first iterate of the unknowns, shape (s, n).
        bounds: weights and largest error; the number of corrections is a constant of this module.
    """
    allowed = max(bounds.error, ROUNDING * bounds.length(stages.start.x))
    unknowns = guess
    residuals = stages.residuals(unknowns)
    largest = float(np.max(np.abs(residuals), initial=0.0))
    for iteration in range(1, ITERATIONS + 1):
        inverse = scaled_inverse(stages.jacobian(unknowns))
        if inverse is None:
            return StageSolution(unknowns, StageOutcome.DIVERGED, iteration, 0.0, largest)
        corrections = _corrections(inverse, residuals)
        length = bounds.length(stages.method.matrix @ corrections)
        if not np.isfinite(length + largest):
            return StageSolution(unknowns, StageOutcome.NOT_FINITE, iteration, 0.0, largest)
        taken = _shortened(stages, unknowns, corrections, inverse, bounds)
        if taken is None:
            return StageSolution(unknowns, StageOutcome.DIVERGED, iteration, 0.0, largest)
        unknowns = taken.unknowns
        if taken.share == 1.0 and taken.following <= allowed:
            contraction = taken.following / length if length > 0.0 else 0.0
            return StageSolution(unknowns, StageOutcome.CONVERGED, iteration, contraction, largest)
        residuals = taken.residuals
        largest = float(np.max(np.abs(residuals), initial=0.0))
    return StageSolution(unknowns, StageOutcome.DIVERGED, ITERATIONS, 0.0, largest)


def _shortened(
    stages: CoupledStages, unknowns: FloatArray, corrections: FloatArray, inverse: FloatArray, bounds: NewtonBounds
) -> Taken | None:
    """Largest share of a correction, by halving, after which the next one is shorter; None if there is none.

    Args:
        stages: the equations.
        unknowns: unknowns to be corrected, shape (s, n).
        corrections: corrections of h² a and of algebraic values, shape (s, n).
        inverse: inverse of the Jacobian, shape (s n, s n).
        bounds: weights of the unknowns.
    """
    matrix = stages.method.matrix
    length = bounds.length(matrix @ corrections)
    changes = np.where(stages.equations.differential, stages.size**-2, 1.0) * corrections
    share = 1.0
    while share >= LEAST_SHARE:
        tried = unknowns + share * changes
        residuals = stages.residuals(tried)
        following = bounds.length(matrix @ _corrections(inverse, residuals))
        # A length that is not a number is no decrease.
        if following <= (1.0 - DECREASE * share) * length:
            return Taken(share, tried, residuals, following)
        share /= 2.0
    return None


def _corrections(inverse: FloatArray, residuals: FloatArray) -> FloatArray:
    """Compute the corrections of all stages, shape (s, n)."""
    return np.asarray(-(inverse @ residuals.ravel()).reshape(residuals.shape))
