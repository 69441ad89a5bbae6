"""Error estimate of a step, and choice of the size of the next one.

The error is the difference from an embedded formula of order s, which takes the start of the step as a further node:
γh times the deviation of the polynomial through the stages from the acceleration, and from the velocity, at the start.
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
"""Most Newton iterations of a step of controlled size; with more, a shorter step is cheaper."""

SAFETY = 0.9
"""Safety factor on the step that would just meet the tolerance."""

GROWTH = 5.0
"""Largest ratio of a step to the one before."""

SHRINKAGE = 0.125
"""Least factor of a step after an error that is too large."""

FIRST_SHRINKAGE = 0.1
"""Factor of a first step after an error that is too large."""

WORTH_GROWING = 1.2
"""Growth below which a step keeps its size, and with it its factorised matrices."""

WORTH_SHRINKING = 0.85
"""Shrinkage above which a step keeps its size, and with it its matrices, within the margin of its error."""

SMALLEST_ERROR = 1e-10
"""Error over tolerance below which a step always grows by the largest ratio."""

REMEMBERED_ERROR = 1e-2
"""Least error over tolerance in a trend, as smaller ones say little about the next."""


def deviation_of(matrices: StepMatrices, start: Instant, unknowns: FloatArray) -> Deviation:
    """Compute the difference between the embedded formula and the step, without filter.

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
    """Estimate the error of a step over its tolerance, of the positions and of h times the velocities.

    Args:
        matrices: of the step.
        start: where the step begins, with the acceleration that the motion has there.
        unknowns: of the stages, shape (s, n).
        bounds: weights of the entries.
        after_a_jump: whether the step follows no accepted one. The part of a deviation in stiff directions is then
            filtered twice, as once leaves so much that it would be resolved instead of damped.
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
    """Estimate the error over tolerance by the change of the equations between the stages of a step.

    At a fixed state F depends on time alone. Its difference from the polynomial through its values at the stages is a
    force that the step omits; it is taken to be linear between kinks. With its integral I₀ over the step and the moment
    I₁ about the end, the velocities at the end err by h M⁻¹ I₀ and the positions by h² M⁻¹ I₁. The dynamic stiffness at
    the real eigenvalue γ replaces M/(γh)², so that stiff directions respond as they do. An error of velocity acts on
    after the step: it counts for a time in which the motion changes.

    Args:
        equations: the equations.
        matrices: linear systems of the step.
        begin: start time of the step, s.
        middle: state in the middle of the step.
        kinks: times of kinks inside the step, ascending, s.
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
        last_size: size of the last accepted step, s; 0 before the first.
        last_error: error over tolerance of that step.
    """

    stages: int
    longest: float
    wanted: float
    refused: bool = False
    last_size: float = 0.0
    last_error: float = 0.0

    def refuse(self, size: float, factor: float) -> None:
        """Reduce the next step to a share of the one that was tried."""
        self.refused = True
        self.wanted = factor * size

    def refuse_error(self, size: float, error: float, iterations: int) -> None:
        """Reduce the next step after one whose error was too large, or not a number.

        Args:
            size: size of the step tried, s.
            error: error of that step over tolerance.
            iterations: number of Newton iterations.
        """
        factor = FIRST_SHRINKAGE
        # Before the first step nothing says how the error goes with the size.
        if self.last_size and np.isfinite(error):
            factor = self._factor(error, iterations)
        self.refuse(size, factor)

    def accept(self, size: float, error: float, iterations: int) -> None:
        """Choose the size of the next step after an accepted one.

        Args:
            size: size of the step, s.
            error: error of the step over tolerance, at most one.
            iterations: number of Newton iterations.
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
        """Record the last step: its size, s, and its error over tolerance."""
        self.last_size = size
        self.last_error = max(error, REMEMBERED_ERROR)

    def _factor(self, error: float, iterations: int) -> float:
        """Factor with which the next step meets the tolerance; it is more cautious after many iterations."""
        safety = SAFETY * (2 * MOST_ITERATIONS + 1) / (2 * MOST_ITERATIONS + iterations)
        factor = safety * max(error, SMALLEST_ERROR) ** (-1.0 / (self.stages + 1))
        return float(np.clip(factor, SHRINKAGE, GROWTH))

    def _predicted_factor(self, size: float, error: float) -> float:
        """Factor of the next step by the trend of the last two errors (Gustafsson)."""
        current = max(error, SMALLEST_ERROR)
        trend = (self.last_error / current**2) ** (1.0 / (self.stages + 1))
        factor = SAFETY * size / self.last_size * trend
        return float(np.clip(factor, SHRINKAGE, GROWTH))
