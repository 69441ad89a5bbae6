"""Load continuation: from a known equilibrium to the wanted one along a path in the loads.

Natural continuation in t ∈ [0, 1] with a tangent predictor. A step is taken back and halved unless Newton needs
few iterations, no damping, and little correction: far from the path Newton finds some equilibrium, not the one that
the growing load leads to.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.solver.newton import NewtonResult, NewtonSettings, newton, newton_step
from cosserat_casadi.solver.outcome import Outcome

PathEquations = Callable[[FloatArray, float], tuple[FloatArray, FloatArray, FloatArray]]
"""(x, t) ↦ (Jacobian, residual, derivative of the residual with t)."""

Progress = Callable[[float], None]
"""Told the t reached."""


@dataclass(frozen=True)
class ContinuationSettings:
    """Limits of a continuation.

    Attributes:
        newton: limits of each correction.
        longest: longest predicted change of x in a step (2-norm; about one radian of bending a unit).
        shortest: smallest step in t before the path counts as stalled.
        steps: most steps, taken or refused.
        quick: iterations up to which the next step grows.
        slow: iterations beyond which a step is refused.
    """

    newton: NewtonSettings = field(default_factory=NewtonSettings)
    longest: float = 1.5
    shortest: float = 1e-7
    steps: int = 400
    quick: int = 4
    slow: int = 9


@dataclass(frozen=True)
class ContinuationResult:
    """Where a continuation ended.

    Attributes:
        x: unknowns at the end of the path, or the last good ones.
        outcome: how it ended.
        residual_norm: 2-norm of the residual at x and t.
        iterations: Newton iterations of all steps.
        reached: t that was reached; 1 unless the path stalled.
        jacobian: Jacobian at x and t.
    """

    x: FloatArray
    outcome: Outcome
    residual_norm: float
    iterations: int
    reached: float
    jacobian: FloatArray


def follow(
    equations: PathEquations,
    start: FloatArray,
    settings: ContinuationSettings | None = None,
    progress: Progress | None = None,
) -> ContinuationResult:
    """Follow the path from t = 0 to t = 1.

    Args:
        equations: (x, t) ↦ (Jacobian, residual, t-derivative).
        start: unknowns at or near the equilibrium at t = 0.
        settings: limits.
        progress: told the t reached after every step.
    """
    limits = settings or ContinuationSettings()
    here = newton(_frozen(equations, 0.0), start, limits.newton)
    iterations, t, step = here.iterations, 0.0, 1.0
    if here.outcome is not Outcome.CONVERGED:
        return ContinuationResult(here.x, here.outcome, here.residual_norm, iterations, t, here.jacobian)
    rate = _rate(equations, here.x, t)
    for _ in range(limits.steps):
        step = min(step, 1.0 - t, limits.longest / max(float(np.linalg.norm(rate)), 1e-12))
        target = 1.0 if t + step > 1.0 - 1e-12 else t + step
        trial = _step(equations, here.x + step * rate, target, limits)
        iterations += trial.iterations
        if _trusted(trial, here.x, step * rate, limits):
            here, t = trial, target
            if progress is not None:
                progress(t)
            if t == 1.0:
                return ContinuationResult(here.x, Outcome.CONVERGED, here.residual_norm, iterations, t, here.jacobian)
            rate = _rate(equations, here.x, t)
            step *= 2.0 if trial.iterations <= limits.quick else 1.0
        else:
            step /= 2
            if step < limits.shortest:
                break
    return ContinuationResult(here.x, Outcome.LOAD_STALLED, here.residual_norm, iterations, t, here.jacobian)


def _frozen(equations: PathEquations, t: float) -> Callable[[FloatArray], tuple[FloatArray, FloatArray]]:
    def at(x: FloatArray) -> tuple[FloatArray, FloatArray]:
        jacobian, residual, _ = equations(x, t)
        return jacobian, residual

    return at


def _step(equations: PathEquations, x: FloatArray, t: float, limits: ContinuationSettings) -> NewtonResult:
    return newton(_frozen(equations, t), x, limits.newton)


def _trusted(trial: NewtonResult, x: FloatArray, predicted: FloatArray, limits: ContinuationSettings) -> bool:
    """Whether a corrected point lies on the path and not on some other."""
    if trial.outcome is not Outcome.CONVERGED or trial.iterations > limits.slow or trial.damped:
        return False
    correction = float(np.linalg.norm(trial.x - x - predicted))
    return correction <= 0.3 + 0.5 * float(np.linalg.norm(predicted))


def _rate(equations: PathEquations, x: FloatArray, t: float) -> FloatArray:
    """The dx/dt of the path."""
    jacobian, _, derivative = equations(x, t)
    rate = newton_step(jacobian, derivative)
    return np.zeros_like(x) if rate is None else rate
