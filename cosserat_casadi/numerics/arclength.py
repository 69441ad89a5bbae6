"""One step along a curve of equilibria: tangent predictor, bordered Newton corrector, pseudo-arclength.

The unknowns x and the load factor λ are one vector y = (x, λ); g(y) = 0 is a curve in n + 1 dimensions, and a fold in
λ is a point like any other: H. B. Keller, *Numerical solution of bifurcation and nonlinear eigenvalue problems*, in
P. Rabinowitz (ed.), Applications of Bifurcation Theory, Academic Press 1977. See docs/theory.md, section 12.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.numerics.broyden import dense, newton_step, regular_step
from cosserat_casadi.numerics.continuation import Path
from cosserat_casadi.numerics.neutral import kept_by
from cosserat_casadi.numerics.newton import relative_norm

SINGULAR = 1e-9
"""A singular value below this share of the largest is zero to rounding."""

BEHIND = 1e-4
"""Distance behind a corner at which a path goes on: growth of the side of a pair that was zero before it."""

STILL_HELPS = 0.5
"""Largest ratio of residuals after and before a step below the tolerance at which steps still help."""


@dataclass(frozen=True)
class ArcSettings:
    """Limits of a path in arclength, in the 2-norm of (x, λ); one unit of x is about one radian of bending.

    Attributes:
        first: first step.
        longest: longest step.
        load_factor_change: largest change of λ in a step.
        shortest: step below which the path counts as stalled.
        steps: most steps, taken or refused.
        tolerance: bound on the relative norm of the residual.
        aim: norm at which a correction stops; between it and the tolerance, steps go on while they help.
        grow_below: most corrections after which the next step grows.
        reject_above: most corrections of an accepted step.
        min_cosine: smallest cosine between the tangents at the ends of a step.
        max_distance: largest distance from prediction to correction, relative to the step.
    """

    first: float = 0.02
    longest: float = 0.25
    load_factor_change: float = 0.1
    shortest: float = 1e-7
    steps: int = 2000
    tolerance: float = 1e-11
    aim: float = 1e-13
    grow_below: int = 4
    reject_above: int = 8
    min_cosine: float = 0.95
    max_distance: float = 0.3


@dataclass(frozen=True)
class Monitor:
    """Test functions that change sign where branches meet.

    Attributes:
        values: (y of length n + 1, jacobian n×n, bordered (n+1)×(n+1)) ↦ real numbers in ascending order.
        feels_limits: whether one of these numbers also changes sign at a limit point.
    """

    values: Callable[[FloatArray, FloatArray, FloatArray], FloatArray]
    feels_limits: bool


@dataclass(frozen=True)
class ArcPoint:
    """A point of the curve.

    Attributes:
        y: unknowns and load factor, shape (n + 1,).
        tangent: unit tangent in the direction of travel, shape (n + 1,).
        length: arclength from the start of the curve, as the sum of steps.
        spectrum: values of the monitor, ascending.
    """

    y: FloatArray
    tangent: FloatArray
    length: float
    spectrum: FloatArray

    @property
    def x(self) -> FloatArray:
        """Unknowns, shape (n,)."""
        return self.y[:-1]

    @property
    def load_factor(self) -> float:
        """Load factor λ."""
        return float(self.y[-1])

    @property
    def load_factor_rate(self) -> float:
        """Derivative dλ/ds by the arclength; zero at a limit point."""
        return float(self.tangent[-1])


@dataclass(frozen=True)
class Curve:
    """A path with the monitor that is evaluated along it.

    Attributes:
        path: equations that depend on a load factor.
        monitor: functions whose zeros are the events of the path.
        settings: limits.
        rows: scale factor of each equation in linear systems, shape (n,); None for equations of equal size. Residuals
            are measured without scaling.
        singular: share of the largest singular value below which one counts as zero.
        pairs: complementarity equations, whose curve has a corner where the zero side of a pair changes.
    """

    path: Path
    monitor: Monitor
    settings: ArcSettings
    rows: FloatArray | None = None
    singular: float = SINGULAR
    pairs: tuple[int, ...] = ()

    def residual(self, y: FloatArray) -> FloatArray:
        """Residual g(y), shape (n,)."""
        x = y[:-1]
        load_factor = float(y[-1])
        return self.path.residual(x, load_factor)

    def derivative(self, y: FloatArray) -> FloatArray:
        """Derivative ∂g/∂y with scaled rows, shape (n, n + 1)."""
        x = y[:-1]
        load_factor = float(y[-1])
        jacobian = dense(self.path.jacobian(x, load_factor))
        rate = self.path.rate(x, load_factor)
        derivative = np.column_stack([jacobian, rate])
        if self.rows is None:
            return derivative
        return np.asarray(self.rows[:, None] * derivative)

    def point(self, y: FloatArray, direction: FloatArray, length: float) -> ArcPoint | None:
        """Make the point at y, with the tangent nearest to a direction; None if a number is not finite."""
        derivative = self.derivative(y)
        tangent = tangent_along(derivative, direction, self.singular)
        if tangent is None:
            return None
        jacobian = derivative[:, :-1]
        bordered = np.vstack([derivative, tangent])
        spectrum = self.monitor.values(y, jacobian, bordered)
        return ArcPoint(y, tangent, length, spectrum)

    def correct(
        self, start: FloatArray, normal: FloatArray, level: float | None = None
    ) -> tuple[FloatArray, int] | None:
        """Find where the curve meets a hyperplane normal·y = level near a start.

        The steps have minimum norm, so that nothing moves along neutral directions.

        Args:
            start: shape (n + 1,).
            normal: normal of the plane, shape (n + 1,).
            level: level of the plane, by default the level at the start.

        Returns:
            unknowns and load factor, shape (n + 1,), and the number of steps; None if Newton's method does not
            converge.
        """
        limits = self.settings
        if level is None:
            level = float(normal @ start)
        y = start
        norm = np.inf
        norm_before = np.inf
        for steps in range(limits.reject_above + 1):
            off_plane = normal @ y - level
            off_curve = self.residual(y)
            norm = relative_norm(np.append(off_curve, off_plane), y)
            if not np.isfinite(norm):
                return None
            within_tolerance = norm <= limits.tolerance
            # Below the tolerance a step that no longer halves the residual is at rounding.
            helps_no_more = within_tolerance and norm > STILL_HELPS * norm_before
            if norm <= limits.aim or helps_no_more:
                return y, steps
            bordered = np.vstack([self.derivative(y), normal])
            if self.rows is not None:
                off_curve = self.rows * off_curve
            step = newton_step(bordered, np.append(off_curve, off_plane), singular=self.singular)
            if step is None:
                return None
            y = y + step
            norm_before = norm
        if norm > limits.tolerance:
            return None
        return y, limits.reject_above

    def at(self, start: FloatArray, load_factor: float) -> FloatArray | None:
        """Find the unknowns at a load factor near a start, both of shape (n,); None if no steps converge."""
        across_loads = np.append(np.zeros_like(start), 1.0)
        corrected = self.correct(np.append(start, load_factor), across_loads)
        return None if corrected is None else corrected[0][:-1]

    def bounded(self, current: ArcPoint, step: float) -> float:
        """Limit a step to the largest one that the settings allow at a point."""
        limits = self.settings
        # Near a limit point λ stands still and bounds nothing.
        rate = max(abs(current.load_factor_rate), 1e-3)
        within_load = limits.load_factor_change / rate
        return min(step, limits.longest, within_load)

    def advance(self, current: ArcPoint, step: float) -> tuple[ArcPoint, int] | None:
        """Make the point one step on, and count its corrections; None if it may be on another branch."""
        predicted = current.y + step * current.tangent
        corrected = self.correct(predicted, current.tangent)
        if corrected is None:
            return None
        y, steps = corrected
        distance = np.linalg.norm(y - predicted)
        # So far from the prediction the corrected point may lie on another branch.
        if distance > self.settings.max_distance * step:
            return None
        point = self.point(y, current.tangent, current.length + step)
        if point is None:
            return None
        cosine = point.tangent @ current.tangent
        # Round a corner events would be passed unseen.
        if cosine < self.settings.min_cosine:
            return None
        return point, steps

    def round_corner(self, current: ArcPoint) -> ArcPoint | None:
        """Find the point just behind a corner next to a point; None if there is no corner.

        The gradient of a pair's equation is that of its zero side; behind the corner this side grows.
        """
        derivative = self.derivative(current.y)
        for number in self.pairs:
            across = derivative[number] / np.linalg.norm(derivative[number])
            predicted = current.y + BEHIND * across
            corrected = self.correct(predicted, across)
            if corrected is None:
                continue
            y, _ = corrected
            distance = float(np.linalg.norm(y - current.y))
            point = self.point(y, across, current.length + distance)
            after = self.derivative(y)[number]
            turned = abs(after @ across) < self.settings.min_cosine * np.linalg.norm(after)
            if point is not None and turned and distance < self.settings.longest:
                return point
        return None


def tangent_along(derivative: FloatArray, direction: FloatArray, singular: float = SINGULAR) -> FloatArray | None:
    """Unit tangent of g(y) = 0: the direction, projected on the null space of ∂g/∂y.

    Where branches meet, or with a neutral direction by symmetry, that space has more than one dimension: the
    projection goes straight on and does not drift.

    Args:
        derivative: shape (n, n + 1).
        direction: shape (n + 1,).
        singular: share of the largest singular value below which one counts as zero.

    Returns:
        the tangent, shape (n + 1,); None if a number is not finite, or the direction is orthogonal to the null space.
    """
    if not np.all(np.isfinite(derivative)):
        return None
    # A space of one dimension needs no singular values.
    along = np.append(np.zeros(len(derivative)), -1.0)
    projected = regular_step(np.vstack([derivative, direction]), along, singular)
    if projected is None:
        basis = kept_by(derivative, singular)
        projected = basis @ (basis.T @ direction)
    length = float(np.linalg.norm(projected))
    if not length > 0.0:
        return None
    return projected / length
