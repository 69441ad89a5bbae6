"""One-sided constraints: which of them push, and how hard, so that none pulls and none is passed."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from cosserat_casadi.maths.typing import FloatArray

DEPENDENT = 1e-9
"""What active constraints leave of the compliance of another, over its own, below which it depends on them."""

MOST_TURNS = 10
"""Turns for each constraint before the search is given up."""

TINY = float(np.finfo(np.float64).tiny)
"""Least number to divide by."""


def least_pushes(compliance: FloatArray, rates: FloatArray, tolerance: float) -> FloatArray | None:
    """Forces f of constraints that open at rates q + W f: f ≥ 0, q + W f ≥ 0, one of both zero, shape (m,).

    A constraint that closes is made active, the fastest first, and leaves again where it would pull: the method of
    least squares with non-negative unknowns, which does not run in circles (C. L. Lawson, R. J. Hanson, *Solving Least
    Squares Problems*, SIAM 1995, chapter 23). One that depends on those that are active stays without a force, which
    could be anything.

    Args:
        compliance: W, symmetric and positive semidefinite, shape (m, m).
        rates: q, shape (m,).
        tolerance: rate below zero that counts as none.

    Returns:
        the forces; None where rounding keeps them from settling.
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
        if _left_of(scaled, active, fastest) < DEPENDENT:
            passed_over.add(fastest)
            continue
        active.append(fastest)
        _balance(scaled, wanted, forces, active)
    return None


def _balance(scaled: FloatArray, rates: FloatArray, forces: FloatArray, active: list[int]) -> None:
    """Forces at which active constraints do not open, in place; those that would pull on the way there leave."""
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


def _left_of(scaled: FloatArray, active: Sequence[int], number: int) -> float:
    """Compliance of a constraint that those that are active leave it, over its own."""
    if not active:
        return 1.0
    column = scaled[active, number]
    taken = column @ np.linalg.solve(scaled[np.ix_(active, active)], column)
    return float(scaled[number, number] - taken)
