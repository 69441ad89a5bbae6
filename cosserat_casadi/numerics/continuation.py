"""Load continuation: from a known equilibrium to the wanted one along a path in the loads.

Natural continuation in t ∈ [0, 1] (E. L. Allgower, K. Georg, *Introduction to Numerical Continuation Methods*, SIAM
2003, chapters 2 and 6). The cubic through the last two points and their tangents predicts, Newton's method corrects:
inexactly on the way, to the full tolerance at the end. A step is retracted and halved unless Newton's method needs few
Jacobians, no damping, and a small correction: far from the path it may find another equilibrium than the one to which
the growing load leads. The last Jacobian of a correction gives the tangent. See docs/theory.md, section 9.

The exported C follows paths alike; its corrections stop at the tolerance, those here at
:attr:`NewtonSettings.aim`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.numerics.broyden import Jacobian, UpdatedJacobian
from cosserat_casadi.numerics.newton import Equations, NewtonResult, NewtonSettings, length_of, newton
from cosserat_casadi.numerics.outcome import Outcome
from cosserat_casadi.numerics.progress import Progress

MOST_BENT = 0.5
"""Largest deviation of the cubic from the tangent, relative to the tangent."""

CORRECTION_FLOOR = 0.3
"""Correction that is always plausible (2-norm; about a third of a radian of bending)."""

CORRECTION_SHARE = 0.5
"""Share of the prediction that a plausible correction may have on top of the floor."""

ENDS_MEET = 1e-12
"""Distance in t from the end of the path below which a step ends there."""


PathPoint = tuple[FloatArray, float]
"""Unknowns x with their parameter t."""


@dataclass(frozen=True)
class Path:
    """Equations that change along a path t ∈ [0, 1].

    Attributes:
        residual: (x, t) ↦ g, shape (n,).
        jacobian: (x, t) ↦ ∂g/∂x, n×n, dense or sparse.
        rate: (x, t) ↦ ∂g/∂t, shape (n,).
        start: unknowns at or near the equilibrium at t = 0, shape (n,).
        tangent: dx/dt at the start if it is known, and with it that the start is an equilibrium; else None.
        step_weights: weight of each unknown in the length of a step, shape (n,); None for equal weights.
        first_step: longest first step in t.
        exact_tangents: whether a tangent takes the Jacobian at its point. Newton's last one may be far from it where
            small corrections turn large forces.
        admits: ((x, t) before, (x, t) after) ↦ whether a step may lead from one to the other; None to admit all. A
            refused step is halved.
    """

    residual: Callable[[FloatArray, float], FloatArray]
    jacobian: Callable[[FloatArray, float], Jacobian]
    rate: Callable[[FloatArray, float], FloatArray]
    start: FloatArray
    tangent: FloatArray | None = None
    step_weights: FloatArray | None = None
    first_step: float = 1.0
    exact_tangents: bool = False
    admits: Callable[[PathPoint, PathPoint], bool] | None = None

    def length(self, change: FloatArray) -> float:
        """Weighted 2-norm of a change of x, shape (n,)."""
        return length_of(change) if self.step_weights is None else length_of(self.step_weights * change)

    def admitted(self, before: PathPoint, after: PathPoint) -> bool:
        """Whether a step, or a correction at one t, may lead from one point to another."""
        return self.admits is None or self.admits(before, after)

    def at(self, t: float) -> Equations:
        """The equations at one point of the path."""
        return Equations(
            residual=lambda x: self.residual(x, t),
            jacobian=lambda x: self.jacobian(x, t),
        )


@dataclass(frozen=True)
class ContinuationSettings:
    """Limits of a continuation.

    Attributes:
        newton: limits of the correction at the end of the path.
        inexact: largest error of x of the corrections before the end (2-norm).
        longest: longest tangent of a step (2-norm; one unit is about one radian of bending).
        shortest: smallest step in t before the path counts as stalled.
        steps: most steps, taken or refused.
        grow_below: most Jacobians of a correction after which the next step grows.
        reject_above: most Jacobians of the correction of an accepted step.
    """

    newton: NewtonSettings = field(default_factory=NewtonSettings)
    inexact: float = 0.01
    longest: float = 4.0
    shortest: float = 1e-7
    steps: int = 400
    grow_below: int = 2
    reject_above: int = 4

    def correction(self, target: float) -> NewtonSettings:
        """Limits of the correction at a point of the path.

        A correction that would not be accepted is abandoned at once: it may neither damp nor take more Jacobians.
        """
        inexact = 0.0 if target == 1.0 else self.inexact
        return replace(self.newton, inexact=inexact, jacobians=self.reject_above, damping=False)


@dataclass(frozen=True)
class ContinuationResult:
    """Result of a continuation.

    Attributes:
        x: unknowns at the end of the path, or the last good ones.
        outcome: outcome of the continuation.
        residual_norm: relative norm of the residual at x and t.
        iterations: number of Newton steps of all corrections, plus refused predictions.
        reached: value of t that was reached; 1 unless the path stalled.
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
        t: parameter of the path.
        tangent: tangent dx/dt, shape (n,).
        correction: Newton solve that led there.
    """

    t: float
    tangent: FloatArray
    correction: NewtonResult

    @property
    def x(self) -> FloatArray:
        """Unknowns, shape (n,)."""
        return self.correction.x


def follow(
    path: Path, settings: ContinuationSettings | None = None, progress: Progress | None = None
) -> ContinuationResult:
    """Follow a path from t = 0 to t = 1.

    Args:
        path: the equations and their start.
        settings: limits of the continuation.
        progress: receives the t reached after every step.
    """
    limits = settings or ContinuationSettings()
    current = _first_point(path, limits)
    start = current.correction
    if start.outcome is Outcome.CONVERGED and not path.admitted((path.start, 0.0), (start.x, 0.0)):
        # Parameters change at once: there is no way that could be halved.
        start = replace(start, x=path.start, outcome=Outcome.LOAD_STALLED)
    if start.outcome is not Outcome.CONVERGED:
        return _ended(start, start.iterations, 0.0)

    previous: _Point | None = None
    iterations = start.iterations
    step = path.first_step
    renewed = False
    for _ in range(limits.steps):
        remaining = 1.0 - current.t
        # A tangent of zero bounds no step.
        longest = limits.longest / max(path.length(current.tangent), 1e-12)
        step = min(step, remaining, longest)
        if step < min(limits.shortest, remaining):
            if renewed:
                break
            # The Jacobian that an inexact correction has left may foresee wrongly however short the step is.
            exact = newton(path.at(current.t), current.x, limits.newton)
            iterations += exact.iterations
            if not _stays(path, current, exact):
                break
            current = _point(path, replace(exact, last_jacobian=None), current.t)
            renewed = True
            step = remaining
            continue

        target = _target(current, step)
        predicted = _predicted_change(path, current, previous, step)
        if not _predictor_plausible(path, current, predicted, target):
            # It has cost a residual, which counts like a Newton step.
            iterations += 1
            step /= 2
            continue

        trial = newton(path.at(target), current.x + predicted, limits.correction(target))
        iterations += trial.iterations
        # The point must be on this path, not on another.
        accepted = trial.outcome is Outcome.CONVERGED and not trial.damped
        accepted = accepted and _is_small(path, trial.x - current.x - predicted, predicted)
        if not accepted or not path.admitted((current.x, current.t), (trial.x, target)):
            step /= 2
            continue

        if progress is not None:
            progress(target)
        if target == 1.0:
            return _ended(trial, iterations, 1.0)
        previous = current
        current = _point(path, trial, target)
        renewed = False
        if trial.jacobians <= limits.grow_below:
            # One or two Jacobians: the prediction was good, and a longer step costs no more.
            step *= 2.0
    return _stalled(path, current, limits, iterations)


def _first_point(path: Path, limits: ContinuationSettings) -> _Point:
    """Solve for the equilibrium at t = 0 with its tangent; the outcome says whether it exists."""
    if path.tangent is None:
        correction = newton(path.at(0.0), path.start, limits.newton)
        point = _point(path, correction, 0.0)
    else:
        at_rest = NewtonResult(
            x=path.start,
            outcome=Outcome.CONVERGED,
            residual_norm=0.0,
            iterations=0,
            jacobians=0,
            damped=False,
            residual=np.zeros_like(path.start),
            last_jacobian=None,
        )
        point = _Point(0.0, path.tangent, at_rest)
    converged = point.correction.outcome is Outcome.CONVERGED
    if converged and not np.isfinite(length_of(point.tangent)):
        not_finite = replace(point.correction, outcome=Outcome.NOT_FINITE)
        return replace(point, correction=not_finite)
    return point


def _point(path: Path, correction: NewtonResult, t: float) -> _Point:
    """Make a corrected point with its tangent dx/dt = −(∂g/∂x)⁻¹ ∂g/∂t, by the last Jacobian of the correction."""
    jacobian = correction.last_jacobian
    if jacobian is None or path.exact_tangents:
        # Without one the prediction was good enough already: nothing has been linearised.
        jacobian = UpdatedJacobian(path.jacobian(correction.x, t))
        correction = replace(correction, last_jacobian=jacobian)
    rate = path.rate(correction.x, t)
    tangent = jacobian.response(rate, correction.residual)
    if tangent is None:
        # No direction is known: the next point is predicted where this one is.
        tangent = np.zeros_like(correction.x)
    return _Point(t, tangent, correction)


def _stays(path: Path, current: _Point, exact: NewtonResult) -> bool:
    """Whether a point stays on its path when it is corrected exactly; near a fold Newton's method may stray.

    Args:
        path: the equations.
        current: the point, corrected inexactly.
        exact: result of Newton's method from that point, at equal t.
    """
    if exact.outcome is not Outcome.CONVERGED or not _is_small(path, exact.x - current.x, np.zeros_like(exact.x)):
        return False
    return path.admitted((current.x, current.t), (exact.x, current.t))


def _target(current: _Point, step: float) -> float:
    target = current.t + step
    if target > 1.0 - ENDS_MEET:
        # Exactly 1, so that the last equations are those of the full load.
        return 1.0
    return target


def _predicted_change(path: Path, current: _Point, previous: _Point | None, step: float) -> FloatArray:
    """Predict the change of x by the cubic through two points, or by the tangent if they differ much or for one point.

    With σ = (t − t₁)/h, h = t₁ − t₀ and Δ = x₁ − x₀ the Hermite cubic is x₁ + h x₁' σ + (c₃ + h x₁' − Δ) σ² + c₃ σ³,
    c₃ = h (x₁' + x₀') − 2 Δ.
    """
    linear = step * current.tangent
    if previous is None:
        return linear
    interval = current.t - previous.t
    share = step / interval
    change = current.x - previous.x
    cubic = interval * (current.tangent + previous.tangent) - 2 * change
    quadratic = cubic + interval * current.tangent - change
    bent = share**2 * quadratic + share**3 * cubic
    if path.length(bent) <= MOST_BENT * path.length(linear):
        return linear + bent
    # Where a path turns sharply the cubic overshoots.
    return linear


def _predictor_plausible(path: Path, current: _Point, predicted: FloatArray, target: float) -> bool:
    """Whether the available Jacobian predicts a correction that would be accepted.

    This costs one residual; a failure of Newton's method costs a Jacobian and its factorisation.
    """
    jacobian = current.correction.last_jacobian
    if jacobian is None:
        return True
    residual = path.residual(current.x + predicted, target)
    foreseen = jacobian.response(residual, current.correction.residual)
    if foreseen is None:
        # Without a forecast Newton has to try.
        return True
    return _is_small(path, foreseen, predicted)


def _is_small(path: Path, correction: FloatArray, predicted: FloatArray) -> bool:
    # The floor lets short steps converge to a path that bends; the share keeps long ones off other branches.
    return path.length(correction) <= CORRECTION_FLOOR + CORRECTION_SHARE * path.length(predicted)


def _stalled(path: Path, last: _Point, limits: ContinuationSettings, iterations: int) -> ContinuationResult:
    """Result at the last point, which was corrected inexactly, after Newton's method at that point."""
    end = newton(path.at(last.t), last.x, limits.newton)
    if not _stays(path, last, end):
        # Newton's method would lead to the end of another path.
        end = replace(last.correction, iterations=end.iterations)
    return _ended(replace(end, outcome=Outcome.LOAD_STALLED), iterations + end.iterations, last.t)


def _ended(last: NewtonResult, iterations: int, reached: float) -> ContinuationResult:
    """Result of a continuation at its last correction."""
    return ContinuationResult(last.x, last.outcome, last.residual_norm, iterations, reached)
