"""Newton's method with a backtracking line search; success is judged here, by finiteness and residual."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.solver.outcome import Outcome

Equations = Callable[[FloatArray], tuple[FloatArray, FloatArray]]
"""x ↦ (Jacobian, residual)."""

SUFFICIENT_DECREASE = 1e-4
SHORTEST_STEP = 2.0**-12


@dataclass(frozen=True)
class NewtonSettings:
    """Limits of one Newton solve.

    Attributes:
        tolerance: bound on the residual norm, see :func:`relative_norm`.
        iterations: most Jacobians to factorise.
    """

    tolerance: float = 1e-11
    iterations: int = 30


@dataclass(frozen=True)
class NewtonResult:
    """Where a Newton solve ended.

    Attributes:
        x: last iterate that was accepted; finite whenever the start was.
        outcome: how it ended.
        residual_norm: relative norm of the residual at x.
        iterations: Jacobians factorised.
        damped: whether any step had to be shortened.
        jacobian: Jacobian at x.
    """

    x: FloatArray
    outcome: Outcome
    residual_norm: float
    iterations: int
    damped: bool
    jacobian: FloatArray


def newton(equations: Equations, start: FloatArray, settings: NewtonSettings) -> NewtonResult:
    """Solve equations from a start.

    The tolerance is met, then one more full step is taken if it lowers the residual: it costs one evaluation and
    brings the residual to rounding.

    Args:
        equations: x ↦ (Jacobian, residual).
        start: first iterate, shape (n,).
        settings: limits.
    """
    x, damped = start, False
    jacobian, residual = equations(x)
    norm = _norm(residual)
    for iteration in range(settings.iterations):
        if not np.isfinite(norm) or not np.all(np.isfinite(jacobian)):
            return NewtonResult(x, Outcome.NOT_FINITE, norm / _size(x), iteration, damped, jacobian)
        done = norm <= settings.tolerance * _size(x)
        step = newton_step(jacobian, residual)
        if step is None:
            outcome = Outcome.CONVERGED if done else Outcome.SINGULAR
            return NewtonResult(x, outcome, norm / _size(x), iteration, damped, jacobian)
        found = _search(equations, x, step, norm, 1.0 if done else SHORTEST_STEP)
        if found is None:
            outcome = Outcome.CONVERGED if done else Outcome.SINGULAR
            return NewtonResult(x, outcome, norm / _size(x), iteration + 1, damped, jacobian)
        x, length, jacobian, residual = found
        norm = _norm(residual)
        damped = damped or length < 1.0
        if done:
            return NewtonResult(x, Outcome.CONVERGED, norm / _size(x), iteration + 1, damped, jacobian)
    outcome = Outcome.CONVERGED if norm <= settings.tolerance * _size(x) else Outcome.MAX_ITERATIONS
    return NewtonResult(x, outcome, norm / _size(x), settings.iterations, damped, jacobian)


def newton_step(jacobian: FloatArray, residual: FloatArray) -> FloatArray | None:
    """The Newton step; the shortest one where the Jacobian is singular; None where there is none."""
    if not len(residual):
        return np.zeros(0)
    if not (np.all(np.isfinite(jacobian)) and np.all(np.isfinite(residual))):
        return None
    step: FloatArray
    try:
        step = np.asarray(np.linalg.solve(jacobian, -residual), dtype=np.float64)
    except np.linalg.LinAlgError:
        step = np.asarray(np.linalg.lstsq(jacobian, -residual, rcond=1e-12)[0], dtype=np.float64)
    return step if np.all(np.isfinite(step)) else None


def _search(
    equations: Equations, x: FloatArray, step: FloatArray, norm: float, shortest: float
) -> tuple[FloatArray, float, FloatArray, FloatArray] | None:
    """Halve the step until the residual falls; None if it never does."""
    length = 1.0
    while length >= shortest:
        trial = x + length * step
        jacobian, residual = equations(trial)
        trial_norm = _norm(residual)
        if np.isfinite(trial_norm) and trial_norm <= (1 - SUFFICIENT_DECREASE * length) * norm:
            return trial, length, jacobian, residual
        length /= 2
    return None


def relative_norm(residual: FloatArray, x: FloatArray) -> float:
    """2-norm of the dimensionless residual over one plus that of the unknowns: what rounding scales with."""
    return _norm(residual) / _size(x)


def _size(x: FloatArray) -> float:
    return 1.0 + _norm(x)


def _norm(vector: FloatArray) -> float:
    """2-norm; infinite where the squares overflow, which the line search takes for a step too long."""
    with np.errstate(over="ignore", invalid="ignore"):
        return float(np.sqrt(vector @ vector))
