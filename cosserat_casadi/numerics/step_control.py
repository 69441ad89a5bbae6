"""The error of a step, and the size of the next one.

The error is the difference to an embedded formula of order s, which takes the start of the step as a node beside the
stages: γh times what the polynomial through the stages misses of the acceleration, and of the velocity, at the start.
It is filtered by the real eigenvalue γ of the method (for two stages by the real part of the complex one), so that
stiff directions, constraints and massless directions do not spoil it. The step law is Gustafsson's predictive one. E.
Hairer, G. Wanner, *Solving Ordinary Differential Equations II*, 2nd ed., Springer 1996, section IV.8.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.numerics.motion_equations import Instant, MotionEquations
from cosserat_casadi.numerics.stage_newton import NewtonBounds
from cosserat_casadi.numerics.step_matrices import Deviation, StepMatrices

MOST_ITERATIONS = 25
"""Most Newton iterations of a step whose size is controlled: beyond them a shorter one is cheaper."""

SAFETY = 0.9
"""Share of the step that would just meet the tolerance."""

GROWTH = 5.0
"""Most by which a step may grow over the one before."""

SHRINKAGE = 0.125
"""Least that is left of a step after an error too large."""

FIRST_SHRINKAGE = 0.1
"""Factor of a first step whose error is too large."""

WORTH_GROWING = 1.2
"""Growth below which a step keeps its size, and with it its factorised matrices."""

WORTH_SHRINKING = 0.85
"""Shrinkage above which a step keeps its size, and with it its matrices: its error leaves room for that."""

SMALLEST_ERROR = 1e-10
"""Error over tolerance below which a step grows by the most in any case."""

REMEMBERED_ERROR = 1e-2
"""Least error over tolerance that counts in a trend: smaller ones say little about the next."""


def deviation_of(matrices: StepMatrices, start: Instant, unknowns: FloatArray) -> Deviation:
    """Difference between the embedded formula and the step, not filtered.

    Args:
        matrices: of the step.
        start: where the step begins, with the acceleration that the motion has there.
        unknowns: of the stages, shape (s, n).
    """
    method = matrices.method
    scale = matrices.step * float(method.eigenvalues[0].real)
    at_start = method.values_at(0.0)
    # v at the stages is v₀ + hAa, so that v₀ itself cancels. Columns of mass and damping leave algebraic entries out.
    missed_velocity = -matrices.step * (at_start @ method.matrix) @ unknowns
    missed_acceleration = start.a - at_start @ unknowns
    return Deviation(scale * missed_velocity, scale * missed_acceleration)


def estimated_error(
    matrices: StepMatrices, start: Instant, unknowns: FloatArray, bounds: NewtonBounds, after_a_jump: bool
) -> float:
    """Estimated error of a step over its tolerance: of the positions, and of the velocities times h.

    Args:
        matrices: of the step.
        start: where the step begins, with the acceleration that the motion has there.
        unknowns: of the stages, shape (s, n).
        bounds: weights of the entries.
        after_a_jump: whether the step follows no accepted one. What stiff directions then have of a deviation is
            taken out twice, where once leaves too much: it would be resolved instead of damped.
    """
    deviation = deviation_of(matrices, start, unknowns)
    filtered = matrices.filtered(deviation)
    error = _size(filtered, matrices.step, bounds)
    if after_a_jump and error > 1.0:
        filtered = matrices.filtered(filtered)
        error = _size(filtered, matrices.step, bounds)
    return error


def overlooked_error(
    equations: MotionEquations,
    matrices: StepMatrices,
    begin: float,
    middle: Instant,
    kinks: Sequence[float],
    bounds: NewtonBounds,
    pace: float,
) -> float:
    """Error over tolerance by what a step does not see of the equations between its stages.

    At one state F depends on the time alone. Its difference from the polynomial through its values at the stages is
    a force that the step leaves out; it is taken to be linear between the kinks. With its integral I₀ over the step and
    the moment I₁ about its end, the velocities at the end miss h M⁻¹ I₀ and the positions h² M⁻¹ I₁. The dynamic
    stiffness at the real eigenvalue γ stands for M/(γh)², so that stiff directions answer as they do. A missed velocity
    moves on after the step: it counts for a time in which the motion changes.

    Args:
        equations: the equations.
        matrices: of the step.
        begin: time at which the step begins, s.
        middle: the state in its middle.
        kinks: times inside the step, ascending, s.
        bounds: weights of the entries.
        pace: a time in which the motion changes, not below h, s.
    """
    method = matrices.method
    size = matrices.step
    times = np.array([begin, *kinks, begin + size])
    shares = (times - begin) / size

    def forces(at: FloatArray) -> FloatArray:
        rows = [equations.residual(float(time), middle.x, middle.v, middle.a) for time in at]
        return np.array(rows)

    seen = method.values_at(shares) @ forces(begin + method.nodes * size)
    missed = forces(times) - seen
    to_end = (1.0 - shares)[:, None]
    impulse = np.asarray(np.trapezoid(missed, shares, axis=0))
    moment = np.asarray(np.trapezoid(to_end * missed, shares, axis=0))
    inertia = float(method.eigenvalues[0].real) ** -2
    moved = inertia * matrices.answer(moment)
    moving_on = inertia * pace / size * matrices.answer(impulse)
    return max(bounds.length(moved), bounds.length(moving_on))


def _size(deviation: Deviation, step: float, bounds: NewtonBounds) -> float:
    """Weighted size of a deviation."""
    positions = bounds.length(deviation.position)
    velocities = bounds.length(step * deviation.velocity)
    return max(positions, velocities)


@dataclass
class StepControl:
    """Control of the size of the next step, from the errors of the last ones.

    Attributes:
        stages: number of stages s, the order of the estimate.
        longest: longest step, s.
        wanted: size of the next step, s.
        refused: whether the last step tried was refused.
        last_size: size of the last step taken, s; 0 before the first.
        last_error: its error over tolerance.
    """

    stages: int
    longest: float
    wanted: float
    refused: bool = False
    last_size: float = 0.0
    last_error: float = 0.0

    def refuse(self, size: float, factor: float) -> None:
        """Ask for a share of the step that was tried."""
        self.refused = True
        self.wanted = factor * size

    def refuse_error(self, size: float, error: float, iterations: int) -> None:
        """Ask for a shorter step after one whose error was too large, or no number.

        Args:
            size: of the step tried, s.
            error: its error over tolerance.
            iterations: of Newton's method.
        """
        factor = FIRST_SHRINKAGE
        # Before the first step nothing says how the error goes with the size.
        if self.last_size and np.isfinite(error):
            factor = self._factor(error, iterations)
        self.refuse(size, factor)

    def accept(self, size: float, error: float, iterations: int) -> None:
        """Choose the size of the next step after one that is taken.

        Args:
            size: of the step, s.
            error: its error over tolerance, at most one.
            iterations: of Newton's method.
        """
        factor = self._factor(error, iterations)
        if self.last_size:
            factor = min(factor, self._predicted_factor(size, error))
        if self.refused:
            factor = min(factor, 1.0)
        # Little more or less would not pay for new matrices.
        if WORTH_SHRINKING <= factor < WORTH_GROWING:
            factor = 1.0
        following = factor * size
        # A step cut short by the end of the piece says nothing against the one that was wanted.
        if size < self.wanted:
            following = max(following, self.wanted)
        self.wanted = min(following, self.longest)
        self.refused = False
        self.remember(size, error)

    def remember(self, size: float, error: float) -> None:
        """Take note of the last step: its size, s, and its error over tolerance."""
        self.last_size = size
        self.last_error = max(error, REMEMBERED_ERROR)

    def _factor(self, error: float, iterations: int) -> float:
        """Factor of a step for the next to meet the tolerance; many iterations call for caution."""
        safety = SAFETY * (2 * MOST_ITERATIONS + 1) / (2 * MOST_ITERATIONS + iterations)
        factor = safety * max(error, SMALLEST_ERROR) ** (-1.0 / (self.stages + 1))
        return float(np.clip(factor, SHRINKAGE, GROWTH))

    def _predicted_factor(self, size: float, error: float) -> float:
        """Factor of a step that the trend of the last two errors allows (Gustafsson)."""
        current = max(error, SMALLEST_ERROR)
        trend = (self.last_error / current**2) ** (1.0 / (self.stages + 1))
        factor = SAFETY * size / self.last_size * trend
        return float(np.clip(factor, SHRINKAGE, GROWTH))
