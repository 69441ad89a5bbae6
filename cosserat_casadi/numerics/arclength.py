"""One step along a curve of equilibria: tangent predictor, bordered Newton corrector, pseudo-arclength.

The unknowns x and the load factor are one vector y = (x, factor); g(y) = 0 is a curve in n + 1 dimensions, and a fold
in the factor is a point like any other: H. B. Keller, *Numerical solution of bifurcation and nonlinear eigenvalue
problems*, in P. Rabinowitz (ed.), Applications of Bifurcation Theory, Academic Press 1977.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.numerics.broyden import dense
from cosserat_casadi.numerics.continuation import Path
from cosserat_casadi.numerics.newton import relative_norm

SINGULAR = 1e-9
"""A singular value below this share of the largest is zero to rounding."""


@dataclass(frozen=True)
class ArcSettings:
    """Limits of a path in arclength; x counts in its 2-norm, about one radian of bending a unit, the factor as it is.

    Attributes:
        first: first step.
        longest: longest step.
        share: largest change of the factor in a step.
        shortest: step below which the path counts as stalled.
        steps: most steps, taken or refused.
        tolerance: bound on the relative norm of the residual.
        aim: norm at which a correction stops; between it and the tolerance steps go on while they help.
        quick: corrections after which the next step grows.
        slow: corrections beyond which a step is refused.
        bend: smallest cosine between the tangents at the ends of a step.
        stray: largest correction relative to the step.
    """

    first: float = 0.02
    longest: float = 0.25
    share: float = 0.1
    shortest: float = 1e-7
    steps: int = 2000
    tolerance: float = 1e-11
    aim: float = 1e-13
    quick: int = 4
    slow: int = 8
    bend: float = 0.95
    stray: float = 0.3


@dataclass(frozen=True)
class Monitor:
    """Numbers that change sign where branches meet.

    Attributes:
        values: (jacobian n×n, bordered (n+1)×(n+1)) ↦ real numbers in ascending order.
        feels_limits: whether one of them changes sign at a limit point too.
    """

    values: Callable[[FloatArray, FloatArray], FloatArray]
    feels_limits: bool


@dataclass(frozen=True)
class ArcPoint:
    """A point of the curve.

    Attributes:
        y: unknowns and factor, shape (n + 1,).
        tangent: of length one, in the direction of travel, shape (n + 1,).
        length: arclength from the start of the curve, steps added up.
        spectrum: the monitor's values, ascending.
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
    def factor(self) -> float:
        """Load factor."""
        return float(self.y[-1])

    @property
    def factor_rate(self) -> float:
        """The d(factor)/d(arclength); zero at a limit point."""
        return float(self.tangent[-1])


@dataclass(frozen=True)
class Plane:
    """A hyperplane normal·y = level that cuts the curve at the point looked for.

    Attributes:
        normal: shape (n + 1,).
        level: the right side.
    """

    normal: FloatArray
    level: float


@dataclass(frozen=True)
class Curve:
    """A path with what is watched along it.

    Attributes:
        path: equations that depend on a factor.
        monitor: what is watched.
        settings: limits.
    """

    path: Path
    monitor: Monitor
    settings: ArcSettings

    def residual(self, y: FloatArray) -> FloatArray:
        """The g(y), shape (n,)."""
        return self.path.residual(y[:-1], float(y[-1]))

    def derivative(self, y: FloatArray) -> FloatArray:
        """∂g/∂y, shape (n, n + 1)."""
        x, factor = y[:-1], float(y[-1])
        return np.column_stack([dense(self.path.jacobian(x, factor)), self.path.rate(x, factor)])

    def point(self, y: FloatArray, direction: FloatArray, length: float) -> ArcPoint | None:
        """The point at y, its tangent on the side of a direction; None where a number is not finite."""
        derivative = self.derivative(y)
        tangent = tangent_along(derivative, direction)
        if tangent is None:
            return None
        spectrum = self.monitor.values(derivative[:, :-1], np.vstack([derivative, tangent]))
        return ArcPoint(y, tangent, length, spectrum)

    def correct(self, start: FloatArray, plane: Plane) -> tuple[FloatArray, int] | None:
        """Where the curve meets a plane near a start, and the steps it took; None where Newton does not converge.

        Steps of minimum norm: along a direction in which the equations are neutral nothing moves.
        """
        y, before, norm = start, np.inf, np.inf
        for steps in range(self.settings.slow + 1):
            residual = np.append(self.residual(y), plane.normal @ y - plane.level)
            norm = relative_norm(residual, y)
            done = norm <= self.settings.tolerance
            if not np.isfinite(norm):
                return None
            if norm <= self.settings.aim or (done and norm > 0.5 * before):
                return y, steps
            step = _shortest_step(np.vstack([self.derivative(y), plane.normal]), residual)
            if step is None:
                return None
            y, before = y + step, norm
        return (y, self.settings.slow) if norm <= self.settings.tolerance else None

    def bounded(self, here: ArcPoint, step: float) -> float:
        """A step, cut to what the settings allow at a point."""
        return min(step, self.settings.longest, self.settings.share / max(abs(here.factor_rate), 1e-3))

    def advance(self, here: ArcPoint, step: float) -> tuple[ArcPoint, int] | None:
        """The next point, one step on, and the corrections it took; None where it may lie on another branch."""
        predicted = here.y + step * here.tangent
        found = self.correct(predicted, Plane(here.tangent, float(here.tangent @ predicted)))
        if found is None or np.linalg.norm(found[0] - predicted) > self.settings.stray * step:
            return None
        there = self.point(found[0], here.tangent, here.length + step)
        if there is None or there.tangent @ here.tangent < self.settings.bend:
            return None
        return there, found[1]


def tangent_along(derivative: FloatArray, direction: FloatArray) -> FloatArray | None:
    """Unit tangent of g(y) = 0: the direction, projected on the null space of ∂g/∂y.

    Where branches meet, or a symmetry leaves a neutral direction, that space has more than one dimension: the
    projection goes straight on and does not drift.

    Args:
        derivative: shape (n, n + 1).
        direction: shape (n + 1,).
    """
    basis = null_space(derivative)
    if basis is None:
        return None
    projected = basis @ (basis.T @ direction)
    size = float(np.linalg.norm(projected))
    return projected / size if size > 0.0 else None


def null_space(derivative: FloatArray) -> FloatArray | None:
    """Orthonormal basis of the null space of ∂g/∂y to rounding, shape (n + 1, k) with k ≥ 1; None if not finite."""
    if not np.all(np.isfinite(derivative)):
        return None
    _, singular, rows = np.linalg.svd(derivative)
    largest = float(singular[0]) if len(singular) else 0.0
    rank = int(np.sum(singular > SINGULAR * max(largest, 1e-300)))
    return np.asarray(rows[rank:].T)


def _shortest_step(matrix: FloatArray, residual: FloatArray) -> FloatArray | None:
    """Newton's step; singular values at rounding are left out, so that a neutral direction is not moved along."""
    if not np.all(np.isfinite(matrix)):
        return None
    step = np.asarray(np.linalg.lstsq(matrix, -residual, rcond=SINGULAR)[0])
    return step if np.all(np.isfinite(step)) else None
