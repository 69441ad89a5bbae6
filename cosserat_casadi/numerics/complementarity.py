"""Which of several one-sided constraints are active: those that are push, the others open."""

from __future__ import annotations

from collections.abc import Callable
from itertools import combinations

import numpy as np

from cosserat_casadi.maths.typing import FloatArray

Chosen = tuple[int, ...]
"""Numbers of the active constraints, ascending."""

Solve = Callable[[Chosen], tuple[FloatArray, FloatArray]]
"""Active constraints ↦ their multipliers, and how fast all of them open, shape (m,); zero of active ones."""

MOST_LISTED = 8
"""Constraints whose choices are all tried where exchanges one at a time do not settle."""


def active_constraints(count: int, solve: Solve, push: float, opening: float) -> Chosen | None:
    """Choose active constraints so that none pulls and none that is not active closes; None where none is found.

    Exchanges the one that is most at fault, from all of them on (R. W. Cottle, J.-S. Pang, R. E. Stone, *The Linear
    Complementarity Problem*, SIAM 2009, section 4.2); where that runs in circles all choices are tried.

    Args:
        count: number of constraints m.
        solve: what active constraints make.
        push: multiplier below zero that counts as none.
        opening: rate below zero that counts as none.
    """
    chosen: Chosen = tuple(range(count))
    seen: set[Chosen] = set()
    while chosen not in seen:
        seen.add(chosen)
        fault = _fault(chosen, *solve(chosen), push, opening)
        if fault is None:
            return chosen
        exchanged = set(chosen) ^ {fault}
        chosen = tuple(sorted(exchanged))
    if count > MOST_LISTED:
        return None
    for size in range(count, -1, -1):
        for chosen in combinations(range(count), size):
            if chosen not in seen and _fault(chosen, *solve(chosen), push, opening) is None:
                return chosen
    return None


def _fault(chosen: Chosen, multipliers: FloatArray, rates: FloatArray, push: float, opening: float) -> int | None:
    """The constraint most at fault; one that pulls before one that closes; None where none is."""
    if len(chosen) and not np.min(multipliers) >= -push:
        return chosen[int(np.argmin(multipliers))]
    others = [k for k in range(len(rates)) if k not in chosen]
    closing = [k for k in others if not rates[k] >= -opening]
    if closing:
        return min(closing, key=lambda k: float(rates[k]))
    return None
