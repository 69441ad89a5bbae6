"""Load continuation: from a known equilibrium to the wanted one along a path in the loads.

Natural continuation in t ∈ [0, 1] with a tangent predictor. A step is taken back and halved unless Newton needs
few Jacobians, no damping, and little correction: far from the path Newton finds some equilibrium, not the one that
the growing load leads to.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.solver.newton import Equations, NewtonResult, NewtonSettings, length_of, newton
from cosserat_casadi.solver.outcome import Outcome
from cosserat_casadi.solver.secant import Jacobian, newton_step

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
    """

    residual: Callable[[FloatArray, float], FloatArray]
    jacobian: Callable[[FloatArray, float], Jacobian]
    rate: Callable[[FloatArray, float], FloatArray]
    start: FloatArray
    tangent: FloatArray | None = None

    def at(self, t: float) -> Equations:
        """The equations at one point of the path."""
        return Equations(lambda x: self.residual(x, t), lambda x: self.jacobian(x, t))


@dataclass(frozen=True)
class ContinuationSettings:
    """Limits of a continuation.

    Attributes:
        newton: limits of each correction.
        longest: longest predicted change of x in a step (2-norm; about one radian of bending a unit).
        shortest: smallest step in t before the path counts as stalled.
        steps: most steps, taken or refused.
        quick: Jacobians up to which the next step grows.
        slow: Jacobians beyond which a step is refused.
    """

    newton: NewtonSettings = field(default_factory=NewtonSettings)
    longest: float = 4.0
    shortest: float = 1e-7
    steps: int = 400
    quick: int = 2
    slow: int = 4


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
    here, tangent = _depart(path, limits)
    iterations, t, step = here.iterations, 0.0, 1.0
    if here.outcome is Outcome.CONVERGED and not np.isfinite(length_of(tangent)):
        here = replace(here, outcome=Outcome.NOT_FINITE)
    if here.outcome is not Outcome.CONVERGED:
        return ContinuationResult(here.x, here.outcome, here.residual_norm, iterations, t)
    for _ in range(limits.steps):
        step = min(step, 1.0 - t, limits.longest / max(length_of(tangent), 1e-12))
        if step < min(limits.shortest, 1.0 - t):
            break
        target = 1.0 if t + step > 1.0 - 1e-12 else t + step
        trial = newton(path.at(target), here.x + step * tangent, limits.newton)
        iterations += trial.iterations
        if _trusted(trial, here.x, step * tangent, limits):
            here, t = trial, target
            if progress is not None:
                progress(t)
            if t == 1.0:
                return ContinuationResult(here.x, Outcome.CONVERGED, here.residual_norm, iterations, t)
            tangent = _tangent(path, here.x, t)
            step *= 2.0 if trial.jacobians <= limits.quick else 1.0
        else:
            step /= 2
    return ContinuationResult(here.x, Outcome.LOAD_STALLED, here.residual_norm, iterations, t)


def _depart(path: Path, limits: ContinuationSettings) -> tuple[NewtonResult, FloatArray]:
    if path.tangent is not None:
        return NewtonResult(path.start, Outcome.CONVERGED, 0.0, 0, 0, False), path.tangent
    here = newton(path.at(0.0), path.start, limits.newton)
    return here, _tangent(path, here.x, 0.0)


def _trusted(trial: NewtonResult, x: FloatArray, predicted: FloatArray, limits: ContinuationSettings) -> bool:
    """Whether a corrected point lies on the path and not on some other."""
    if trial.outcome is not Outcome.CONVERGED or trial.jacobians > limits.slow or trial.damped:
        return False
    correction = length_of(trial.x - x - predicted)
    return correction <= 0.3 + 0.5 * length_of(predicted)


def _tangent(path: Path, x: FloatArray, t: float) -> FloatArray:
    """The dx/dt of the path."""
    tangent = newton_step(path.jacobian(x, t), path.rate(x, t))
    return np.zeros_like(x) if tangent is None else tangent
