"""Guards: values along a motion that have to stay at zero or above, and the time at which a guard would not.

What ends where a guard falls through zero goes on under other equations: a cable that becomes taut, one whose tension
vanishes. The last step is made just as long as brings that guard to zero, so that its end is a state of the method
and no interpolation.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise

import numpy as np

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.numerics.events import bracketed_zero
from cosserat_casadi.numerics.motion_equations import Instant
from cosserat_casadi.numerics.step import TimeStep

Guards = Callable[[Instant], FloatArray]
"""State ↦ values that have to stay at zero or above, without unit, shape (m,)."""

THROUGH = 1e-10
"""Value below zero at which a guard has fallen through: less is rounding of a state that lies on it."""

WATCHED = np.linspace(0.0, 1.0, 9)
"""Shares of a step at which guards are asked for."""

MOST_HALVINGS = 12
"""Halvings of the time between two looks in which a guard that lies on zero is looked for above it."""


STEEPER = 2.0
"""How much faster than between looks next to them a guard is thought to fall, where it may fall and rise between."""

GOLDEN = (3.0 - 5.0**0.5) / 2.0
"""Share of an interval at which golden sections are looked at."""

MOST_SECTIONS = 40
"""Golden sections of the time between two looks in which a guard may fall through zero and rise again."""


def remembering(guards: Guards) -> Guards:
    """Guards that remember the last state: a step starts where the one before it has ended."""
    last: list[tuple[Instant, FloatArray]] = []

    def values(instant: Instant) -> FloatArray:
        if not (last and last[0][0] is instant):
            last[:] = [(instant, guards(instant))]
        return last[0][1]

    return values


def crossing(step: TimeStep, guards: Guards) -> tuple[float, int] | None:
    """The first time, s, in a step at which a guard falls through zero, and its number; None where none does.

    One that falls through zero and rises again between two looks is found where it does so in one dip.
    """
    times = step.start.time + WATCHED * (step.end.time - step.start.time)
    seen = {0: guards(step.start)}
    if _far_from_zero(step, guards, times, seen):
        return None
    values = [seen[0]]
    for number, time in enumerate(times[1:], start=1):
        # A place that guards follow may seem lost where it is looked at from afar: it is looked at again from nearby.
        known = seen.get(number)
        is_lost = known is not None and bool(np.any(known < -THROUGH))
        values.append(guards(step.at(float(time))) if known is None or is_lost else known)
        if np.any(values[-1] < -THROUGH):
            break
    # The looks are at even distances, and what turns between two of them is steep between one of them and the next.
    changes = np.pad(np.abs(np.diff(values, axis=0)), ((1, 1), (0, 0)))
    steepest = STEEPER * np.max([changes[:-2], changes[1:-1], changes[2:]], axis=0)
    for number, (before, after) in enumerate(pairwise(values)):
        earlier, later = float(times[number]), float(times[number + 1])
        found = []
        for k in range(len(before)):
            fallen: tuple[float, float] | None = (later, after[k])
            if not after[k] < -THROUGH:
                fallen = None
                falls = steepest[number, k]
                if min(before[k], after[k]) > THROUGH and before[k] + after[k] < falls:
                    fallen = _dip(step, guards, k, (earlier, later), falls / (later - earlier))
            if fallen is not None:
                found.append((_zero(step, guards, k, (earlier, before[k]), fallen), k))
        if found:
            return min(found)
    return None


def _far_from_zero(step: TimeStep, guards: Guards, times: FloatArray, seen: dict[int, FloatArray]) -> bool:
    """Whether looks at the ends and the middle of a step tell that no guard comes to zero in it.

    Args:
        step: the step.
        guards: all of them.
        times: of all looks, s.
        seen: values by the number of the look, which these looks are added to.
    """
    half = len(times) // 2
    for number in (half, 2 * half):
        before = seen[number - half]
        seen[number] = guards(step.at(float(times[number])))
        change = np.abs(seen[number] - before)
        if not np.all(np.minimum(before, seen[number]) > STEEPER * change):
            return False
    return True


def _dip(
    step: TimeStep, guards: Guards, guard: int, between: tuple[float, float], steepest: float
) -> tuple[float, float] | None:
    """A time between two others at which a guard is below zero, with its value; None where its least is not.

    By golden sections: J. Kiefer, *Sequential minimax search for a maximum*, Proc. AMS 4 (1953).

    Args:
        step: the step.
        guards: all of them.
        guard: number of the guard.
        between: the times, s.
        steepest: rate at which it falls at most, 1/s.
    """

    def value(time: float) -> float:
        return float(guards(step.at(time))[guard])

    start, end = between
    inner = [start + GOLDEN * (end - start), end - GOLDEN * (end - start)]
    values = [value(time) for time in inner]
    for _ in range(MOST_SECTIONS):
        lower = int(values[1] < values[0])
        if values[lower] < -THROUGH:
            return inner[lower], values[lower]
        if lower:
            start = inner[0]
            inner = [inner[1], end - GOLDEN * (end - start)]
            values = [values[1], value(inner[1])]
        else:
            end = inner[1]
            inner = [start + GOLDEN * (end - start), inner[0]]
            values = [value(inner[0]), values[0]]
        # What is left is too short to come to zero in.
        if min(values) > steepest * (end - start):
            return None
    return None


def _zero(step: TimeStep, guards: Guards, guard: int, first: tuple[float, float], last: tuple[float, float]) -> float:
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
            return float(first[0])
    return float(bracketed_zero(value, first, last))
