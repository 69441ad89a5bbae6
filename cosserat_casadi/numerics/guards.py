"""Guards: values along a motion that have to stay at zero or above, and the time at which one of them would not.

What ends where a guard falls through zero goes on under other equations: a cable that becomes taut, one whose tension
vanishes. The last step is made just as long as brings that guard to zero, so that its end is a state of the method
and no interpolation.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.numerics.events import bracketed_zero
from cosserat_casadi.numerics.motion_equations import Instant
from cosserat_casadi.numerics.step import Step

Guards = Callable[[Instant], FloatArray]
"""State ↦ values that have to stay at zero or above, without unit, shape (m,)."""

THROUGH = 1e-10
"""Value below zero at which a guard has fallen through: less is rounding of a state that lies on it."""

WATCHED = np.linspace(0.0, 1.0, 9)
"""Shares of a step at which guards are asked for."""

MOST_HALVINGS = 12
"""Halvings of the time between two of them in which a guard that lies on zero is looked for above it."""


@dataclass(frozen=True)
class Crossing:
    """Where a guard falls through zero.

    Attributes:
        time: s.
        guard: its number.
    """

    time: float
    guard: int


def crossing(step: Step, guards: Guards) -> Crossing | None:
    """The first time in a step at which a guard falls through zero, by the dense output; None where none does."""
    times = step.start.time + WATCHED * (step.end.time - step.start.time)
    before = guards(step.start)
    for earlier, later in pairwise(times):
        after = guards(step.at(float(later)))
        fallen = np.flatnonzero(after < -THROUGH)
        if len(fallen):
            found = [_zero(step, guards, int(k), (earlier, before[k]), (later, after[k])) for k in fallen]
            return min(found, key=lambda one: one.time)
        before = after
    return None


def _zero(step: Step, guards: Guards, guard: int, first: tuple[float, float], last: tuple[float, float]) -> Crossing:
    """Where one guard vanishes between two times of a step, given with its values there."""

    def value(time: float) -> float:
        return float(guards(step.at(time))[guard])

    if first[1] <= 0.0:
        # It lay on zero already: it may have risen from there for a while.
        for halvings in range(1, MOST_HALVINGS + 1):
            time = first[0] + (last[0] - first[0]) / 2.0**halvings
            risen = value(time)
            if risen > 0.0:
                first = (time, risen)
                break
        else:
            return Crossing(float(first[0]), guard)
    return Crossing(float(bracketed_zero(value, first, last)), guard)
