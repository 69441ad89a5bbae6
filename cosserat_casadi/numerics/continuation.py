"""Load continuation: from a known equilibrium to the wanted one along a path in the loads.

Natural continuation in t ∈ [0, 1]. The cubic through the last two points and their tangents predicts, Newton corrects:
roughly on the way, to the full tolerance at the end. A step is taken back and halved unless Newton needs few
Jacobians, no damping, and little correction: far from the path it finds some equilibrium, not the one that the growing
load leads to. The last Jacobian of a correction serves for the tangent. The exported C holds the same algorithm.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.numerics.broyden import Jacobian, Secant
from cosserat_casadi.numerics.newton import Equations, NewtonResult, NewtonSettings, length_of, newton
from cosserat_casadi.numerics.outcome import Outcome

MOST_BENT = 0.5
"""Most that the cubic may differ from the tangent, relative to it."""

Progress = Callable[[float], None]
"""Told the t reached."""


@dataclass(frozen=True)
class Path:
    """Equations that change along a path t ∈ [0, 1].

    Attributes:
        residual: (x, t) ↦ g, shape (n,).
        jacobian: (x, t) ↦ ∂g/∂x, n×n, dense or sparse.
        rate: (x, t) ↦ ∂g/∂t, shape (n,).
        start: unknowns at or near the equilibrium at t = 0, shape (n,).
        tangent: dx/dt at the start where it is known beforehand, and with it that the start is in equilibrium.
        shares: how much each unknown counts in the length of a step, shape (n,); None where all count alike.
        first: longest first step in t.
    """

    residual: Callable[[FloatArray, float], FloatArray]
    jacobian: Callable[[FloatArray, float], Jacobian]
    rate: Callable[[FloatArray, float], FloatArray]
    start: FloatArray
    tangent: FloatArray | None = None
    shares: FloatArray | None = None
    first: float = 1.0

    def length(self, step: FloatArray) -> float:
        """How far a change of x, shape (n,), goes."""
        return length_of(step if self.shares is None else self.shares * step)

    def at(self, t: float) -> Equations:
        """The equations at one point of the path."""
        return Equations(lambda x: self.residual(x, t), lambda x: self.jacobian(x, t))


@dataclass(frozen=True)
class ContinuationSettings:
    """Limits of a continuation.

    Attributes:
        newton: limits of the correction at the end of the path.
        rough: error of x that the corrections before it may leave (2-norm).
        longest: longest tangent of a step (2-norm; about one radian of bending a unit).
        shortest: smallest step in t before the path counts as stalled.
        steps: most steps, taken or refused.
        quick: Jacobians up to which the next step grows.
        slow: Jacobians beyond which a step is refused.
    """

    newton: NewtonSettings = field(default_factory=NewtonSettings)
    rough: float = 0.01
    longest: float = 4.0
    shortest: float = 1e-7
    steps: int = 400
    quick: int = 2
    slow: int = 4

    def correction(self, target: float) -> NewtonSettings:
        """Limits of the correction at a point of the path: whatever would not be trusted is given up at once."""
        rough = 0.0 if target == 1.0 else self.rough
        return replace(self.newton, rough=rough, jacobians=self.slow, damping=False)


@dataclass(frozen=True)
class ContinuationResult:
    """Where a continuation ended.

    Attributes:
        x: unknowns at the end of the path, or the last good ones.
        outcome: how it ended.
        residual_norm: relative norm of the residual at x and t.
        iterations: Newton steps of all corrections.
        reached: t that was reached; 1 unless the path stalled.
    """

    x: FloatArray
    outcome: Outcome
    residual_norm: float
    iterations: int
    reached: float


@dataclass(frozen=True)
class _Point:
    """A point of a path.

    Attributes:
        x: unknowns, shape (n,).
        t: where on the path.
        tangent: dx/dt, shape (n,).
        found: the correction that led there.
    """

    x: FloatArray
    t: float
    tangent: FloatArray
    found: NewtonResult


def follow(
    path: Path, settings: ContinuationSettings | None = None, progress: Progress | None = None
) -> ContinuationResult:
    """Follow a path from t = 0 to t = 1.

    Args:
        path: the equations and where they start.
        settings: limits.
        progress: told the t reached after every step.
    """
    limits = settings or ContinuationSettings()
    found, tangent = _depart(path, limits)
    iterations, step = found.iterations, path.first
    if found.outcome is Outcome.CONVERGED and not np.isfinite(length_of(tangent)):
        found = replace(found, outcome=Outcome.NOT_FINITE)
    if found.outcome is not Outcome.CONVERGED:
        return ContinuationResult(found.x, found.outcome, found.residual_norm, iterations, 0.0)
    here, before = _Point(found.x, 0.0, tangent, found), None
    for _ in range(limits.steps):
        step = min(step, 1.0 - here.t, limits.longest / max(path.length(here.tangent), 1e-12))
        if step < min(limits.shortest, 1.0 - here.t):
            break
        target = 1.0 if here.t + step > 1.0 - 1e-12 else here.t + step
        predicted = _predicted(path, here, before, step)
        if not _promising(path, here, predicted, target):
            iterations, step = iterations + 1, step / 2
            continue
        trial = newton(path.at(target), here.x + predicted, limits.correction(target))
        iterations += trial.iterations
        if not _trusted(path, trial, here.x, predicted):
            step /= 2
            continue
        if progress is not None:
            progress(target)
        if target == 1.0:
            return ContinuationResult(trial.x, Outcome.CONVERGED, trial.residual_norm, iterations, 1.0)
        trial = _linearised(path, trial, target)
        here, before = _Point(trial.x, target, _tangent(path, trial, target), trial), here
        step *= 2.0 if trial.jacobians <= limits.quick else 1.0
    return _stalled(path, here, limits, iterations)


def _depart(path: Path, limits: ContinuationSettings) -> tuple[NewtonResult, FloatArray]:
    if path.tangent is not None:
        rest = NewtonResult(path.start, Outcome.CONVERGED, 0.0, 0, 0, False, np.zeros_like(path.start), None)
        return rest, path.tangent
    here = _linearised(path, newton(path.at(0.0), path.start, limits.newton), 0.0)
    return here, _tangent(path, here, 0.0)


def _linearised(path: Path, found: NewtonResult, t: float) -> NewtonResult:
    """A corrected point with a Jacobian, where the correction needed none."""
    return found if found.secant is not None else replace(found, secant=Secant(path.jacobian(found.x, t)))


def _predicted(path: Path, here: _Point, before: _Point | None, step: float) -> FloatArray:
    """Change of x by the cubic through two points; by the tangent where there is one point, or the two differ much."""
    straight = step * here.tangent
    if before is None:
        return straight
    way, moved, share = here.t - before.t, here.x - before.x, step / (here.t - before.t)
    cubic = way * (here.tangent + before.tangent) - 2 * moved
    bent = share**2 * (cubic + way * here.tangent - moved) + share**3 * cubic
    return straight + bent if path.length(bent) <= MOST_BENT * path.length(straight) else straight


def _promising(path: Path, here: _Point, predicted: FloatArray, target: float) -> bool:
    """Whether the Jacobian at hand foresees a correction that can be trusted; a new one costs far more than to ask."""
    if here.found.secant is None:
        return True
    residual = path.residual(here.x + predicted, target)
    foreseen = here.found.secant.response(residual, here.found.residual)
    return foreseen is None or _small(path, foreseen, predicted)


def _trusted(path: Path, trial: NewtonResult, x: FloatArray, predicted: FloatArray) -> bool:
    """Whether a corrected point lies on the path and not on some other."""
    if trial.outcome is not Outcome.CONVERGED or trial.damped:
        return False
    return _small(path, trial.x - x - predicted, predicted)


def _small(path: Path, correction: FloatArray, predicted: FloatArray) -> bool:
    return path.length(correction) <= 0.3 + 0.5 * path.length(predicted)


def _tangent(path: Path, here: NewtonResult, t: float) -> FloatArray:
    """The dx/dt of the path, with the Jacobian that the correction has left."""
    tangent = None if here.secant is None else here.secant.response(path.rate(here.x, t), here.residual)
    return np.zeros_like(here.x) if tangent is None else tangent


def _stalled(path: Path, here: _Point, limits: ContinuationSettings, iterations: int) -> ContinuationResult:
    """The last point, which was found roughly, as near to equilibrium as Newton brings it."""
    end = newton(path.at(here.t), here.x, limits.newton)
    return ContinuationResult(end.x, Outcome.LOAD_STALLED, end.residual_norm, iterations + end.iterations, here.t)
