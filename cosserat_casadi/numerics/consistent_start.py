"""Accelerations and multipliers that belong to given positions and velocities.

Rows of F that depend on neither v, a nor an algebraic entry are constraints g(t, x) = 0. Twice differentiated along
the motion they are linear in a: G a + (what the motion with a = 0 makes of d²g/dt²) = 0. With the other rows, linear
in a and in the algebraic entries, they are one linear system (E. Hairer, G. Wanner, *Solving Ordinary Differential
Equations II*, 2nd ed., Springer 1996, section VII.1). Where a mass matrix is singular in elastic directions their
balance says nothing of a: along them some small a is taken, and the residual of their balance is returned.
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
"""Degree of the polynomial that the constraints along the motion are differentiated by."""

NODES = np.cos(np.pi * np.arange(DEGREE, -1, -1) / DEGREE)
"""Nodes of that polynomial, from -1 to 1."""

_COEFFICIENTS = np.linalg.inv(chebyshev.chebvander(NODES, DEGREE))

DERIVATIVES = tuple(chebyshev.chebval(-1.0, chebyshev.chebder(_COEFFICIENTS, order)) for order in (1, 2))
"""First and second derivative of that polynomial at the first node: weights of the values at the nodes."""

RANK = 1e-11
"""Singular value, relative to the largest, below which a direction is one without mass."""

CORRECTIONS = 3
"""Linear solves; the equations are linear, and those after the first take away rounding."""


@dataclass(frozen=True)
class ConsistentStart:
    """A start that satisfies the equations of motion as well as positions and velocities allow.

    Attributes:
        instant: the start with its accelerations and algebraic entries.
        position_error: largest constraint left at the positions, without unit; zero where they are consistent.
        velocity_error: largest rate of a constraint, 1/s; zero where the velocities are consistent.
        balance_error: largest entry of the other rows; zero but for directions without mass that are out of balance.
        massless: number of directions whose acceleration the equations leave open.
    """

    instant: Instant
    position_error: float
    velocity_error: float
    balance_error: float
    massless: int


@dataclass(frozen=True)
class Saddle:
    """The linear system of accelerations and algebraic entries; it depends on the positions alone.

    Attributes:
        constraints: rows in which nothing but positions stands, shape (n,).
        matrix: derivatives of the rows with accelerations and algebraic entries, constraints twice differentiated,
            shape (n, n).
        differential: which entries have accelerations, shape (n,).
    """

    constraints: npt.NDArray[np.bool_]
    matrix: FloatArray
    differential: npt.NDArray[np.bool_]

    @cached_property
    def inverse(self) -> tuple[FloatArray, int]:
        """Pseudo-inverse of the matrix, and the number of directions that it leaves out."""
        return _pseudo_inverse(self.matrix)

    def with_constraints(self, gradients: FloatArray, pushes: FloatArray) -> Saddle:
        """The system with further constraints of these gradients, shape (m, n), and their multipliers, as last rows.

        Args:
            gradients: of the constraints, shape (m, n).
            pushes: what unit multipliers do to the rows, shape (m, n).
        """
        count = len(gradients)
        added = np.block([[self.matrix, -pushes.T], [gradients, np.zeros((count, count))]])
        return Saddle(
            np.append(self.constraints, np.ones(count, dtype=bool)),
            added,
            np.append(self.differential, np.zeros(count, dtype=bool)),
        )


def saddle_of(linearisation: Linearisation, differential: npt.NDArray[np.bool_]) -> Saddle:
    """The system of equations that are linearised, some of whose entries have accelerations, shape (n,)."""
    constraints = _constraint_rows(linearisation, differential)
    matrix = np.where(differential, linearisation.mass, linearisation.stiffness)
    matrix[constraints] = np.where(differential, linearisation.stiffness[constraints], 0.0)
    return Saddle(constraints, matrix, differential)


def saddle_at(equations: MotionEquations, instant: Instant) -> Saddle:
    """The system of some equations at an instant."""
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

    Nothing is repaired: errors of the positions and velocities are told, and the caller judges them.

    Args:
        equations: the equations of motion.
        time: s.
        x: positions, and a guess of the algebraic entries, shape (n,).
        v: velocities, shape (n,), 1/s.
        interval: time after the start in which the equations are smooth and the motion bends little, s; constraints
            are differentiated in it.
        saddle: the linear system there, where it is known.
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
    """Velocities in which some entries go along with the others as constraints demand, no further, shape (n,).

    Where the others leave no such velocities, constraints keep a rate: :func:`consistent_start` tells it.

    Args:
        equations: the equations of motion.
        time: s.
        x: positions, shape (n,).
        v: velocities, shape (n,), 1/s.
        interval: as for :func:`consistent_start`, s.
        follows: which entries go along, shape (n,).
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
    """Accelerations that unit forces make, or velocities that unit impulses make, all constraints kept, shape (n, k).

    Args:
        saddle: the linear system.
        directions: forces on the unknowns, one a column, shape (n, k).
    """
    inverse, _ = saddle.inverse
    forced = np.where(saddle.constraints[:, None], 0.0, directions)
    return np.where(saddle.differential[:, None], inverse @ forced, 0.0)


def least_change(saddle: Saddle, gradients: FloatArray, pushes: FloatArray, values: FloatArray) -> FloatArray:
    """The change of unknowns, or of their rates, that takes values from some gaps, or from the rates of these.

    It is the smallest in the metric of the mass that keeps all constraints: of rates, one by impulses along the gaps.

    Args:
        saddle: the linear system.
        gradients: gradients of the gaps, shape (m, n).
        pushes: what unit forces along the gaps do to the rows, shape (m, n).
        values: values to be taken from each gap, or rate, shape (m,).

    Returns:
        the change, shape (n,).
    """
    answers = response(saddle, pushes.T)
    impulses, *_ = np.linalg.lstsq(gradients @ answers, values, rcond=None)
    return np.asarray(-answers @ impulses)


def shortly_after(
    equations: MotionEquations, instant: Instant, horizon: float, directions: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Mean accelerations over a short time, and answers to unit forces: a linear step of Euler's implicit method.

    Damping and stiffness of stiff parts answer within that time: accelerations at its beginning do not show it.

    Args:
        equations: the equations of motion.
        instant: with consistent accelerations.
        horizon: the time h, s.
        directions: forces on the unknowns, one a column, shape (n, k).

    Returns:
        accelerations, shape (n,), 1/s², and answers, shape (n, k).
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
    """Velocities that satisfy the constraints, after impulses along them: nothing bounces.

    M Δv + (∂F/∂λ) Λ = 0 with the rates of all constraints zero after it: the projection of the velocities in the
    metric of the mass (F. Pfeiffer, C. Glocker, *Multibody Dynamics with Unilateral Contacts*, Wiley 1996, section 6).
    Whether impulses of constraints that only push, or only pull, have the right sign is for the caller to judge.

    Args:
        equations: with the constraints that hold after the blow.
        time: s.
        x: positions, on the constraints, shape (n,).
        v: velocities before it, shape (n,), 1/s.
        interval: time after it in which the equations are smooth, s.

    Returns:
        velocities after it, shape (n,), 1/s; and impulses, the integrals over the blow of the algebraic entries, zero
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
    """Rows in which nothing but positions stands, shape (n,)."""
    no_mass = ~np.any(linearisation.mass, axis=1)
    no_damping = ~np.any(linearisation.damping, axis=1)
    no_multiplier = ~np.any(linearisation.stiffness[:, ~differential], axis=1)
    return np.asarray(no_mass & no_damping & no_multiplier)


def _in_time(
    equations: MotionEquations, instant: Instant, constraints: npt.NDArray[np.bool_], interval: float
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Constraints g along the motion x + τ v, ġ in 1/s, and g̈ without the part of a in 1/s², at τ = 0, shape (m,) each.

    They are differentiated by a polynomial through values after the start.

    Values before the start may belong to a piece in which the inputs moved otherwise.
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
    """Pseudo-inverse with rows and columns scaled, and the number of directions it leaves out."""
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
    """Sizes to divide by; nothing is divided where all is zero."""
    return np.where(sizes > 0.0, sizes, 1.0)


def regular_inverse(matrix: FloatArray, rank: float) -> FloatArray | None:
    """Inverses of matrices whose singular values are all above a share of the largest; None where some may not be.

    It takes a tenth of the time of the singular values. The condition in the norm of sums of columns, times the number
    of columns, bounds the ratio of the singular values.

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
