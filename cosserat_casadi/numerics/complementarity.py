"""One-sided constraints: which of them push, and how hard, so that none pulls and none is passed."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from cosserat_casadi.maths.typing import FloatArray

DEPENDENT = 1e-9
"""Share of a constraint's compliance that active constraints must leave; below it the constraint depends on them.

A rate that the forces close to less than the same share of their contribution counts as rounding.
"""

FALLS = 1e-4
"""Fall of an active force, for a unit of a dependent one in their scales, below which it is rounding."""

MOST_TURNS = 10
"""Turns for each constraint before the search is given up."""

TINY = float(np.finfo(np.float64).tiny)
"""Least number to divide by."""


def least_pushes(compliance: FloatArray, rates: FloatArray, tolerance: float) -> FloatArray | None:
    """Forces f of constraints that open at rates q + W f: f ≥ 0, q + W f ≥ 0, one of both zero, shape (m,).

    A constraint that closes is made active, the fastest first, and leaves again where it would pull: the method of
    least squares with non-negative unknowns, which does not run in circles (C. L. Lawson, R. J. Hanson, *Solving Least
    Squares Problems*, SIAM 1995, chapter 23). One that depends on the active ones and closes all the same takes the
    place of one of them: its force grows, at no change of the opening rates, until the first active force is zero.
    Where it closes to rounding only, or where no active force falls, so that no forces stop it, it stays inactive.

    Args:
        compliance: W, symmetric and positive semidefinite, shape (m, m).
        rates: q, shape (m,).
        tolerance: rate below zero that counts as none.

    Returns:
        the forces; None where rounding keeps them from settling. Constraints that no forces stop close all the same.
    """
    try:
        return _settled(compliance, rates, tolerance)
    except np.linalg.LinAlgError:
        return None


def _settled(compliance: FloatArray, rates: FloatArray, tolerance: float) -> FloatArray | None:
    """The forces of :func:`least_pushes`.

    Raises:
        LinAlgError: rounding has made active constraints depend on each other.
    """
    count = len(rates)
    sizes = np.sqrt(np.maximum(np.diag(compliance), 0.0))
    moves = sizes > DEPENDENT * sizes.max(initial=0.0)
    scale = np.where(moves, 1.0 / np.where(moves, sizes, 1.0), 0.0)
    scaled = scale[:, None] * compliance * scale
    wanted = scale * rates
    forces = np.zeros(count)
    active: list[int] = []
    passed_over = set(np.flatnonzero(~moves).tolist())
    for _ in range(MOST_TURNS * max(1, count)):
        opening = wanted + scaled @ forces
        idle = [k for k in range(count) if k not in passed_over and k not in active]
        closing = [k for k in idle if opening[k] < -tolerance * scale[k]]
        if not closing:
            return forces * scale
        fastest = min(closing, key=lambda k: float(opening[k]))
        answers = _answers(scaled, active, fastest)
        left = float(scaled[fastest, fastest] + scaled[fastest, active] @ answers)
        if left < DEPENDENT:
            summed = abs(wanted[fastest]) + np.abs(scaled[fastest]) @ forces
            if opening[fastest] >= -DEPENDENT * summed or not np.any(answers < -FALLS):
                passed_over.add(fastest)
                continue
            _make_room(forces, active, answers, fastest)
        active.append(fastest)
        _balance(scaled, wanted, forces, active)
    return None


def _balance(scaled: FloatArray, rates: FloatArray, forces: FloatArray, active: list[int]) -> None:
    """Forces at which active constraints do not open, in place; constraints that would pull on the way leave."""
    while active:
        balanced = np.linalg.solve(scaled[np.ix_(active, active)], -rates[active])
        if balanced.min() > 0.0:
            forces[active] = balanced
            return
        present = forces[active]
        pulls = balanced <= 0.0
        shares = np.full(len(active), np.inf)
        shares[pulls] = present[pulls] / (present[pulls] - balanced[pulls] + TINY)
        first = int(np.argmin(shares))
        forces[active] = present + shares[first] * (balanced - present)
        forces[active[first]] = 0.0
        del active[first]


def _answers(scaled: FloatArray, active: Sequence[int], number: int) -> FloatArray:
    """Changes of the forces of active constraints for a unit of another's that leave them as open as they are."""
    if not active:
        return np.zeros(0)
    return np.asarray(-np.linalg.solve(scaled[np.ix_(active, active)], scaled[active, number]))


def _make_room(forces: FloatArray, active: list[int], answers: FloatArray, number: int) -> None:
    """The force of a constraint grows, in place, until the first active one has none left, which leaves."""
    present = forces[active]
    falls = answers < -FALLS
    lasts = np.full(len(active), np.inf)
    lasts[falls] = present[falls] / -answers[falls]
    first = int(np.argmin(lasts))
    forces[active] = present + lasts[first] * answers
    forces[number] = lasts[first]
    forces[active[first]] = 0.0
    del active[first]
