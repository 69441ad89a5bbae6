"""Accelerations and multipliers that are consistent with given positions and velocities.

Rows of F that depend on neither v, a nor an algebraic entry are constraints g(t, x) = 0. Twice differentiated along
the motion they are linear in a: G a + (d²g/dt² of the motion with a = 0) = 0. With the other rows, linear in a and in
the algebraic entries, they are one linear system (E. Hairer, G. Wanner, *Solving Ordinary Differential Equations II*,
2nd ed., Springer 1996, section VII.1). If the mass matrix is singular in elastic directions, their balance does not
determine a: the least a along them is taken, and the residual of their balance is returned.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt
from numpy.polynomial import chebyshev

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.numerics.motion_equations import Instant, Linearisation, MotionEquations

DEGREE = 6
"""Degree of the polynomial by which the constraints along the motion are differentiated."""

NODES = np.cos(np.pi * np.arange(DEGREE, -1, -1) / DEGREE)
"""Nodes of that polynomial, from -1 to 1."""

_COEFFICIENTS = np.linalg.inv(chebyshev.chebvander(NODES, DEGREE))

DERIVATIVES = tuple(chebyshev.chebval(-1.0, chebyshev.chebder(_COEFFICIENTS, order)) for order in (1, 2))
"""Weights of the values at the nodes in the first and second derivative of that polynomial at the first node."""

RANK = 1e-11
"""Singular value, over the largest one, below which a direction counts as massless."""

CORRECTIONS = 3
"""Number of linear solves; the equations are linear, and all solves after the first remove rounding."""


@dataclass(frozen=True)
class ConsistentStart:
    """A start that satisfies the equations of motion as far as positions and velocities allow.

    Attributes:
        instant: the start with its accelerations and algebraic entries.
        position_error: largest dimensionless constraint residual at the positions; zero if they are consistent.
        velocity_error: largest rate of a constraint, 1/s; zero if the velocities are consistent.
        balance_error: largest entry of the other rows; zero except for massless directions that are out of balance.
        massless: number of directions whose acceleration the equations do not determine.
    """

    instant: Instant
    position_error: float
    velocity_error: float
    balance_error: float
    massless: int


@dataclass(frozen=True)
class Saddle:
    """The linear system of accelerations and algebraic entries, which depends on the positions alone.

    Attributes:
        constraints: mask of the rows that depend on positions alone, shape (n,).
        matrix: derivatives of the rows by accelerations and algebraic entries, with constraints twice differentiated,
            shape (n, n).
        differential: mask of the entries with accelerations, shape (n,).
    """

    constraints: npt.NDArray[np.bool_]
    matrix: FloatArray
    differential: npt.NDArray[np.bool_]

    @cached_property
    def inverse(self) -> tuple[FloatArray, int]:
        """Pseudo-inverse of the matrix, and dimension of its null space."""
        return _pseudo_inverse(self.matrix)

    def with_constraints(self, gradients: FloatArray, pushes: FloatArray) -> Saddle:
        """Append further constraints and their multipliers to the system.

        Args:
            gradients: gradients of the constraints, shape (m, n).
            pushes: effects of unit multipliers on the rows, shape (m, n).
        """
        count = len(gradients)
        added = np.block([[self.matrix, -pushes.T], [gradients, np.zeros((count, count))]])
        return Saddle(
            np.append(self.constraints, np.ones(count, dtype=bool)),
            added,
            np.append(self.differential, np.zeros(count, dtype=bool)),
        )


def saddle_of(linearisation: Linearisation, differential: npt.NDArray[np.bool_]) -> Saddle:
    """Make the system of linearised equations, with a mask of the entries that have accelerations, shape (n,)."""
    constraints = _constraint_rows(linearisation, differential)
    matrix = np.where(differential, linearisation.mass, linearisation.stiffness)
    matrix[constraints] = np.where(differential, linearisation.stiffness[constraints], 0.0)
    return Saddle(constraints, matrix, differential)


def saddle_at(equations: MotionEquations, instant: Instant) -> Saddle:
    """Make the system of equations at an instant."""
    return saddle_of(equations.linearised(instant), equations.differential)


def consistent_start(
    equations: MotionEquations,
    time: float,
    x: FloatArray,
    v: FloatArray,
    interval: float,
    saddle: Saddle | None = None,
) -> ConsistentStart:
    """Solve for accelerations and algebraic entries at given positions and velocities.

    Nothing is repaired: errors of the positions and velocities are returned, and the caller judges them.

    Args:
        equations: the equations of motion.
        time: time of the start, s.
        x: positions, and a guess of the algebraic entries, shape (n,).
        v: velocities, shape (n,), 1/s.
        interval: time after the start in which the equations are smooth and the motion bends little, s; constraints
            are differentiated in it.
        saddle: the linear system there, if it is known.
    """
    differential = equations.differential
    instant = Instant(time, x, np.where(differential, v, 0.0), np.zeros(equations.size))
    saddle = saddle or saddle_at(equations, instant)
    constraints, matrix = saddle.constraints, saddle.matrix
    values, rates, accelerations = _in_time(equations, instant, constraints, interval)

    inverse, massless = saddle.inverse
    for _ in range(CORRECTIONS):
        rows = equations.residual_at(instant)
        rows[constraints] = accelerations + matrix[constraints] @ instant.a
        change = -inverse @ rows
        corrected_x = np.where(differential, instant.x, instant.x + change)
        corrected_a = np.where(differential, instant.a + change, 0.0)
        instant = Instant(time, corrected_x, instant.v, corrected_a)

    balance = equations.residual_at(instant)[~constraints]
    return ConsistentStart(
        instant=instant,
        position_error=float(np.max(np.abs(values), initial=0.0)),
        velocity_error=float(np.max(np.abs(rates), initial=0.0)),
        balance_error=float(np.max(np.abs(balance), initial=0.0)),
        massless=massless,
    )


def following(
    equations: MotionEquations,
    time: float,
    x: FloatArray,
    v: FloatArray,
    interval: float,
    follows: npt.NDArray[np.bool_],
) -> FloatArray:
    """Velocities in which some entries follow the others, as little as constraints demand, shape (n,).

    If the others allow no such velocities, constraints keep a rate, which :func:`consistent_start` returns.

    Args:
        equations: the equations of motion.
        time: time of the start, s.
        x: positions, shape (n,).
        v: velocities, shape (n,), 1/s.
        interval: time of smooth equations, as for :func:`consistent_start`, s.
        follows: mask of the entries that follow, shape (n,).
    """
    instant = Instant(time, x, v, np.zeros(equations.size))
    linearisation = equations.linearised(instant)
    constraints = _constraint_rows(linearisation, equations.differential)
    _, rates, _ = _in_time(equations, instant, constraints, interval)
    by_followers = linearisation.stiffness[np.ix_(constraints, follows)]
    moved = v.copy()
    moved[follows] -= np.linalg.pinv(by_followers, rcond=RANK) @ rates
    return moved


def response(saddle: Saddle, directions: FloatArray) -> FloatArray:
    """Accelerations by unit forces, or velocities by unit impulses, that keep all constraints, shape (n, k).

    Args:
        saddle: the linear system.
        directions: forces on the unknowns as columns, shape (n, k).
    """
    inverse, _ = saddle.inverse
    forced = np.where(saddle.constraints[:, None], 0.0, directions)
    return np.where(saddle.differential[:, None], inverse @ forced, 0.0)


def least_change(saddle: Saddle, gradients: FloatArray, pushes: FloatArray, values: FloatArray) -> FloatArray:
    """Least change of unknowns, or of their rates, that reduces some gaps, or their rates, by given values.

    It is the least one, in the metric of the mass, that keeps all constraints: for rates, by impulses along the gaps.

    Args:
        saddle: the linear system.
        gradients: gradients of the gaps, shape (m, n).
        pushes: effects of unit forces along the gaps on the rows, shape (m, n).
        values: reduction of each gap, or rate, shape (m,).

    Returns:
        the change, shape (n,).
    """
    answers = response(saddle, pushes.T)
    impulses, *_ = np.linalg.lstsq(gradients @ answers, values, rcond=None)
    return np.asarray(-answers @ impulses)


def shortly_after(
    equations: MotionEquations, instant: Instant, horizon: float, directions: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Mean accelerations over a short time, and responses to unit forces, by a linear step of Euler's implicit method.

    Damping and stiffness of stiff parts act within that time, which accelerations at its beginning do not show.

    Args:
        equations: the equations of motion.
        instant: instant with consistent accelerations.
        horizon: the time h, s.
        directions: forces on the unknowns as columns, shape (n, k).

    Returns:
        accelerations, shape (n,), 1/s², and responses, shape (n, k).
    """
    differential = equations.differential
    linearisation = equations.linearised(instant)
    saddle = saddle_of(linearisation, differential)
    stiffness, damping = linearisation.stiffness, linearisation.damping
    answering = horizon * damping + horizon**2 * stiffness
    answering[saddle.constraints] = 0.0
    matrix = saddle.matrix + np.where(differential, answering, 0.0)
    inverse, _ = _pseudo_inverse(matrix)
    moved = -horizon * stiffness @ instant.v - answering @ instant.a
    forced = np.where(saddle.constraints[:, None], 0.0, np.column_stack([moved, directions]))
    answers = np.where(differential[:, None], inverse @ forced, 0.0)
    return instant.a + answers[:, 0], answers[:, 1:]


def impact(
    equations: MotionEquations, time: float, x: FloatArray, v: FloatArray, interval: float
) -> tuple[FloatArray, FloatArray]:
    """Velocities after a plastic impact, by impulses along the constraints, which they then satisfy.

    M Δv + (∂F/∂λ) Λ = 0 with the rates of all constraints zero after it: the projection of the velocities in the
    metric of the mass (F. Pfeiffer, C. Glocker, *Multibody Dynamics with Unilateral Contacts*, Wiley 1996, section 6).
    Whether impulses of constraints that only push, or only pull, have the right sign is for the caller to judge.

    Args:
        equations: equations of motion with the constraints after the impact.
        time: time of the impact, s.
        x: positions, on the constraints, shape (n,).
        v: velocities before the impact, shape (n,), 1/s.
        interval: time after the impact in which the equations are smooth, s.

    Returns:
        velocities after the impact, shape (n,), 1/s; and impulses, the integrals of the algebraic entries over it, zero
        for differential entries, shape (n,), s.
    """
    differential = equations.differential
    instant = Instant(time, x, np.where(differential, v, 0.0), np.zeros(equations.size))
    saddle = saddle_at(equations, instant)
    constraints, matrix = saddle.constraints, saddle.matrix
    inverse, _ = saddle.inverse
    wanted = np.zeros(equations.size)
    _, rates, _ = _in_time(equations, instant, constraints, interval)
    wanted[constraints] = -rates
    change = np.zeros(equations.size)
    for _ in range(CORRECTIONS):
        change = change + inverse @ (wanted - matrix @ change)
    return instant.v + np.where(differential, change, 0.0), np.where(differential, 0.0, change)


def _constraint_rows(linearisation: Linearisation, differential: npt.NDArray[np.bool_]) -> npt.NDArray[np.bool_]:
    """Mask of the rows that depend on positions alone, shape (n,)."""
    no_mass = ~np.any(linearisation.mass, axis=1)
    no_damping = ~np.any(linearisation.damping, axis=1)
    no_multiplier = ~np.any(linearisation.stiffness[:, ~differential], axis=1)
    return np.asarray(no_mass & no_damping & no_multiplier)


def _in_time(
    equations: MotionEquations, instant: Instant, constraints: npt.NDArray[np.bool_], interval: float
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Constraints g along x + τ v, ġ in 1/s, and g̈ at zero acceleration in 1/s², at τ = 0, shape (m,) each.

    They are differentiated by a polynomial through values after the start.

    Values before the start may belong to another piece of the inputs, and are not used.
    """
    exact = np.zeros(0), np.zeros(0)
    if equations.rates_of_last is not None:
        exact = equations.rates_of_last(instant.time, instant.x, instant.v)
    first = int(np.count_nonzero(constraints)) - len(exact[0])
    if first == 0:
        return equations.residual_at(instant)[constraints], *exact
    delays = interval * (1.0 + NODES) / 2.0
    samples = []
    for delay in delays:
        moved = Instant(instant.time + delay, instant.x + delay * instant.v, instant.v, instant.a)
        samples.append(equations.residual_at(moved)[constraints])
    values = np.stack(samples)
    # The nodes run over two units while the interval passes.
    stretch = 2.0 / interval
    rates, accelerations = stretch * DERIVATIVES[0] @ values, stretch**2 * DERIVATIVES[1] @ values
    rates[first:], accelerations[first:] = exact
    return values[0], rates, accelerations


def _pseudo_inverse(matrix: FloatArray) -> tuple[FloatArray, int]:
    """Pseudo-inverse with scaled rows and columns, and dimension of the null space."""
    rows = _scale(np.abs(matrix).max(axis=1))
    columns = _scale((np.abs(matrix) / rows[:, None]).max(axis=0))
    scaled = matrix / rows[:, None] / columns
    regular = regular_inverse(scaled, RANK)
    if regular is not None:
        return regular / columns[:, None] / rows, 0
    left, singular, right = np.linalg.svd(scaled)
    kept = singular > RANK * singular.max(initial=0.0)
    inverse = (right[kept].T / singular[kept]) @ left[:, kept].T
    missing = len(singular) - int(np.sum(kept))
    return inverse / columns[:, None] / rows, missing


def _scale(sizes: FloatArray) -> FloatArray:
    """Sizes by which to divide, with one in place of zero."""
    return np.where(sizes > 0.0, sizes, 1.0)


def regular_inverse(matrix: FloatArray, rank: float) -> FloatArray | None:
    """Inverses of matrices whose singular values are all above a share of the largest; None where some may not be.

    The check takes a tenth of the time of singular values: the condition number in the 1-norm, times the number of
    columns, bounds the ratio of the singular values.

    Args:
        matrix: square, or several, shape (…, n, n).
        rank: the share.
    """
    try:
        inverse = np.asarray(np.linalg.inv(matrix), dtype=float)
    except np.linalg.LinAlgError:
        return None
    conditions = matrix.shape[-1] * _largest_column(matrix) * _largest_column(inverse)
    # A condition that is not a number is not below the bound.
    return inverse if np.all(conditions * rank < 1.0) else None


def _largest_column(matrix: npt.NDArray[Any]) -> FloatArray:
    """Norms of small matrices by their columns: NumPy's own takes as long as the inverse."""
    return np.asarray(np.abs(matrix).sum(axis=-2).max(axis=-1))
