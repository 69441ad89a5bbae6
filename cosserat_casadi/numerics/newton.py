"""Newton's method that keeps a Jacobian as long as it is useful, with a verdict by finiteness and residual.

A Jacobian and its factorisation cost several residuals. Between two Jacobians the steps are corrected by Broyden's
rank-one updates, which converge superlinearly. After a step that does not lower the residual sufficiently a new
Jacobian is formed, with which the step is halved until it does (J. E. Dennis, R. B. Schnabel, *Numerical Methods for
Unconstrained Optimization and Nonlinear Equations*, SIAM 1996, sections 6.3 and 8.3). See docs/theory.md, section 9.

The exported C takes the same steps, but has no :attr:`NewtonSettings.aim`: it stops at the tolerance.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.numerics.broyden import Jacobian, UpdatedJacobian
from cosserat_casadi.numerics.outcome import Outcome

SUFFICIENT_DECREASE = 1e-4
"""Least decrease of the residual norm, over the norm and the step length (Armijo's condition)."""

SHORTEST_STEP = 2.0**-12
"""Share of a Newton step below which the line search gives up."""

REUSE_DECREASE = 0.5
"""Largest ratio of residuals after and before a step at which the Jacobian is kept."""

MAX_REUSES = 12
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
        aim: residual norm at which to stop; between it and the tolerance, full steps go on while they help.
        iterations: most steps tried.
        inexact: predicted length of the next step at which to stop; 0 for never.
        jacobians: most Jacobians factorised.
        damping: whether a step may be shortened.
    """

    tolerance: float = 1e-11
    aim: float = 1e-13
    iterations: int = 60
    inexact: float = 0.0
    jacobians: int = 60
    damping: bool = True


@dataclass(frozen=True)
class NewtonResult:
    """Result of a Newton solve.

    Attributes:
        x: last accepted iterate; finite if the start was.
        outcome: outcome of the solve.
        residual_norm: relative norm of the residual at x.
        iterations: number of steps tried.
        jacobians: number of Jacobians factorised.
        damped: whether any step had to be shortened.
        residual: residual at x, shape (n,).
        last_jacobian: the last Jacobian with the steps since; None if none was formed.
    """

    x: FloatArray
    outcome: Outcome
    residual_norm: float
    iterations: int
    jacobians: int
    damped: bool
    residual: FloatArray
    last_jacobian: UpdatedJacobian | None


@dataclass(frozen=True)
class _Trial:
    """A step that lowers the residual.

    Attributes:
        step: the full step, shape (n,).
        length: share of the step that was taken.
        x: unknowns after it, shape (n,).
        residual: residual there, shape (n,).
        norm: 2-norm of that residual.
    """

    step: FloatArray
    length: float
    x: FloatArray
    residual: FloatArray
    norm: float


@dataclass
class _Iterate:
    """State of Newton's method, which changes from one step to the next.

    Attributes:
        x: unknowns, shape (n,).
        residual: residual at x, shape (n,).
        norm: 2-norm of the residual.
        jacobian: the last Jacobian with the steps since; None before the first.
        reuse_jacobian: whether the next step may use that Jacobian.
        inexact_enough: whether the predicted next step is shorter than ``inexact`` of the settings.
        iterations: number of steps tried.
        jacobians: number of Jacobians factorised.
        damped: whether a step had to be shortened.
    """

    x: FloatArray
    residual: FloatArray
    norm: float
    jacobian: UpdatedJacobian | None = None
    reuse_jacobian: bool = False
    inexact_enough: bool = False
    iterations: int = 0
    jacobians: int = 0
    damped: bool = False

    def within(self, bound: float) -> bool:
        """Whether the relative norm of the residual is at most a bound."""
        largest = bound * _scale(self.x)
        return self.norm <= largest

    def linearise(self, equations: Equations) -> UpdatedJacobian:
        """Form a Jacobian at x, without updates yet."""
        self.jacobian = UpdatedJacobian(equations.jacobian(self.x))
        self.jacobians += 1
        return self.jacobian

    def accept(self, trial: _Trial, jacobian: UpdatedJacobian, inexact: float) -> None:
        """Accept a step, and decide whether its Jacobian is kept for the next one.

        Args:
            trial: the step.
            jacobian: Jacobian of the step.
            inexact: length at which to stop, as in :class:`NewtonSettings`.
        """
        norm_before = self.norm
        self.x = trial.x
        self.residual = trial.residual
        self.norm = trial.norm
        if trial.length < 1.0:
            # Broyden's update holds for full steps only, so a shortened one ends the use of its Jacobian.
            self.damped = True
            self.reuse_jacobian = False
            return
        jacobian.steps.append(trial.step)
        # The next step will be shorter than this one by about as much as the residual has fallen.
        self.inexact_enough = length_of(trial.step) * trial.norm < inexact * norm_before
        decreased = trial.norm <= REUSE_DECREASE * norm_before
        self.reuse_jacobian = decreased and len(jacobian.steps) < MAX_REUSES

    def result(self, outcome: Outcome) -> NewtonResult:
        """Make the result of the solve at this iterate."""
        return NewtonResult(
            x=self.x,
            outcome=outcome,
            residual_norm=self.norm / _scale(self.x),
            iterations=self.iterations,
            jacobians=self.jacobians,
            damped=self.damped,
            residual=self.residual,
            last_jacobian=self.jacobian,
        )


def newton(equations: Equations, start: FloatArray, settings: NewtonSettings) -> NewtonResult:
    """Solve equations from a start.

    Args:
        equations: equations to solve.
        start: first iterate, shape (n,).
        settings: limits of the solve.
    """
    residual = equations.residual(start)
    iterate = _Iterate(start, residual, length_of(residual))
    while True:
        outcome = _outcome_before_step(iterate, settings)
        if outcome is not None:
            return iterate.result(outcome)

        jacobian = iterate.jacobian
        if jacobian is None or not iterate.reuse_jacobian:
            jacobian = iterate.linearise(equations)
            if not jacobian.finite:
                return iterate.result(Outcome.NOT_FINITE)

        within_tolerance = iterate.within(settings.tolerance)
        # A shorter step mends neither a Jacobian of an earlier iterate nor, below the tolerance, rounding.
        full_step_only = iterate.reuse_jacobian or within_tolerance or not settings.damping
        step = jacobian.step(iterate.residual)
        trial = _line_search(equations, iterate, step, full_step_only)
        iterate.iterations += 1

        if trial is not None:
            iterate.accept(trial, jacobian, settings.inexact)
        elif within_tolerance:
            # Only full steps towards the aim were left, and they help no more.
            return iterate.result(Outcome.CONVERGED)
        elif iterate.reuse_jacobian:
            # The Jacobian may be too old: the same iterate gets one of its own.
            iterate.reuse_jacobian = False
        else:
            return iterate.result(Outcome.SINGULAR)


def _outcome_before_step(iterate: _Iterate, settings: NewtonSettings) -> Outcome | None:
    """Outcome of the solve at an iterate; None if another step is due."""
    # If the norm of the unknowns is not finite, every residual would count as small.
    scale = _scale(iterate.x)
    if not np.isfinite(iterate.norm) or not np.isfinite(scale):
        return Outcome.NOT_FINITE

    # The last Jacobian of the budget may go on serving.
    no_jacobian_left = iterate.jacobians == settings.jacobians
    no_step_left = iterate.iterations == settings.iterations
    budget_spent = no_step_left or (no_jacobian_left and not iterate.reuse_jacobian)
    aim_reached = iterate.inexact_enough or iterate.within(settings.aim)
    if not aim_reached and not budget_spent:
        return None

    # Between tolerance and aim the budget may run out: that is a success all the same.
    if iterate.inexact_enough or iterate.within(settings.tolerance):
        return Outcome.CONVERGED
    return Outcome.MAX_ITERATIONS


def _line_search(
    equations: Equations, iterate: _Iterate, step: FloatArray | None, full_step_only: bool
) -> _Trial | None:
    """Halve a step until the residual falls; None if there is no step, or if no share of it helps."""
    if step is None:
        return None
    shortest = 1.0 if full_step_only else SHORTEST_STEP
    # Halving, not interpolating: a residual that overflows gives nothing to interpolate.
    length = 1.0
    while length >= shortest:
        x = iterate.x + length * step
        residual = equations.residual(x)
        norm = length_of(residual)
        bound = (1 - SUFFICIENT_DECREASE * length) * iterate.norm
        if np.isfinite(norm) and norm <= bound:
            return _Trial(step, length, x, residual, norm)
        length /= 2
    return None


def relative_norm(residual: FloatArray, x: FloatArray) -> float:
    """2-norm of the dimensionless residual over one plus the 2-norm of the unknowns, as rounding scales with them."""
    scale = _scale(x)
    return length_of(residual) / scale


def _scale(x: FloatArray) -> float:
    return 1.0 + length_of(x)


def length_of(vector: FloatArray) -> float:
    """2-norm; infinite if the squares overflow, so that the line search shortens the step."""
    with np.errstate(over="ignore", invalid="ignore"):
        squares = vector @ vector
        return float(np.sqrt(squares))
