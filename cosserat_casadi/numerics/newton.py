"""Newton's method that keeps a Jacobian while it serves; success is judged here, by finiteness and residual.

A Jacobian and its factorisation cost several residuals. Between two of them the steps are corrected by rank-one
updates, which converge superlinearly. A step that does not lower the residual well enough asks for a new Jacobian;
with a new one it is halved until it does. The exported C holds the same algorithm.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.numerics.broyden import Jacobian, Secant
from cosserat_casadi.numerics.outcome import Outcome

SUFFICIENT_DECREASE = 1e-4
SHORTEST_STEP = 2.0**-12

KEPT_DECREASE = 0.5
"""A Jacobian is kept while a step leaves at most this share of the residual."""

KEPT_STEPS = 12
"""Most steps with one Jacobian."""


@dataclass(frozen=True)
class Equations:
    """Square equations g(x) = 0 of n unknowns.

    Attributes:
        residual: x ↦ g, shape (n,).
        jacobian: x ↦ ∂g/∂x, n×n, dense or sparse.
    """

    residual: Callable[[FloatArray], FloatArray]
    jacobian: Callable[[FloatArray], Jacobian]


@dataclass(frozen=True)
class NewtonSettings:
    """Limits of one Newton solve.

    Attributes:
        tolerance: bound on the residual norm, see :func:`relative_norm`.
        aim: residual norm at which to stop; between it and the tolerance full steps go on while they help.
        iterations: most steps tried.
        rough: length of the step that would come next, as the last one foretells it, at which to stop; 0 for never.
        jacobians: most Jacobians factorised.
        damping: whether a step may be shortened.
    """

    tolerance: float = 1e-11
    aim: float = 1e-13
    iterations: int = 60
    rough: float = 0.0
    jacobians: int = 60
    damping: bool = True


@dataclass(frozen=True)
class NewtonResult:
    """Where a Newton solve ended.

    Attributes:
        x: last iterate that was accepted; finite whenever the start was.
        outcome: how it ended.
        residual_norm: relative norm of the residual at x.
        iterations: steps tried.
        jacobians: Jacobians factorised.
        damped: whether any step had to be shortened.
        residual: residual at x, shape (n,).
        secant: the last Jacobian with the steps since; None where none was asked for.
    """

    x: FloatArray
    outcome: Outcome
    residual_norm: float
    iterations: int
    jacobians: int
    damped: bool
    residual: FloatArray
    secant: Secant | None


def newton(equations: Equations, start: FloatArray, settings: NewtonSettings) -> NewtonResult:
    """Solve equations from a start.

    Args:
        equations: what to solve.
        start: first iterate, shape (n,).
        settings: limits.
    """
    x, damped, jacobians, keep, rough = start, False, 0, False, False
    residual, secant = equations.residual(x), Secant(np.zeros((0, 0)))
    norm = length_of(residual)

    def end(outcome: Outcome, iterations: int) -> NewtonResult:
        kept = secant if jacobians else None
        return NewtonResult(x, outcome, norm / _size(x), iterations, jacobians, damped, residual, kept)

    iteration = -1
    while True:
        iteration += 1
        # Beside unknowns without a finite norm every residual would be small.
        if not np.isfinite(norm) or not np.isfinite(_size(x)):
            return end(Outcome.NOT_FINITE, iteration)
        done = rough or norm <= settings.tolerance * _size(x)
        spent = iteration == settings.iterations or (jacobians == settings.jacobians and not keep)
        if rough or norm <= settings.aim * _size(x) or spent:
            return end(Outcome.CONVERGED if done else Outcome.MAX_ITERATIONS, iteration)
        if not keep:
            secant, jacobians, keep = Secant(equations.jacobian(x)), jacobians + 1, False
            if not secant.finite:
                return end(Outcome.NOT_FINITE, iteration)
        step, whole = secant.step(residual), keep or done or not settings.damping
        found = None if step is None else _search(equations, x, step, norm, 1.0 if whole else SHORTEST_STEP)
        if step is None or found is None:
            if done or not keep:
                return end(Outcome.CONVERGED if done else Outcome.SINGULAR, iteration + 1)
            keep = False
            continue
        x, length, residual = found
        norm, before = length_of(residual), norm
        damped = damped or length < 1.0
        if length == 1.0:
            secant.steps.append(step)
            rough = length_of(step) * norm < settings.rough * before
        keep = length == 1.0 and norm <= KEPT_DECREASE * before and len(secant.steps) < KEPT_STEPS


def _search(
    equations: Equations, x: FloatArray, step: FloatArray, norm: float, shortest: float
) -> tuple[FloatArray, float, FloatArray] | None:
    """Halve the step until the residual falls; None if it never does."""
    length = 1.0
    while length >= shortest:
        trial = x + length * step
        residual = equations.residual(trial)
        trial_norm = length_of(residual)
        if np.isfinite(trial_norm) and trial_norm <= (1 - SUFFICIENT_DECREASE * length) * norm:
            return trial, length, residual
        length /= 2
    return None


def relative_norm(residual: FloatArray, x: FloatArray) -> float:
    """2-norm of the dimensionless residual over one plus that of the unknowns: what rounding scales with."""
    return length_of(residual) / _size(x)


def _size(x: FloatArray) -> float:
    return 1.0 + length_of(x)


def length_of(vector: FloatArray) -> float:
    """2-norm; infinite where the squares overflow, which the line search takes for a step too long."""
    with np.errstate(over="ignore", invalid="ignore"):
        return float(np.sqrt(vector @ vector))
