"""Guards: values that must not become negative along a motion, and the time at which one would.

Where a guard falls through zero a motion continues with other equations: a cable becomes taut, or its tension vanishes.
The size of the last step is chosen so that the guard is zero at its end, which thus is a state of the method and not an
interpolation.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from itertools import pairwise

import numpy as np

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.numerics.events import bracketed_zero
from cosserat_casadi.numerics.motion_equations import Instant
from cosserat_casadi.numerics.step import TimeStep

Guards = Callable[[Instant], FloatArray]
"""State ↦ dimensionless values that must not become negative, shape (m,)."""

THROUGH = 1e-10
"""Size of a negative value at which a guard has fallen through zero; smaller ones are rounding at a zero guard."""

WATCHED = np.linspace(0.0, 1.0, 9)
"""Shares of a step at which guards are evaluated."""

MOST_HALVINGS = 12
"""Most halvings of the time between two evaluations in the search for a positive value of a zero guard."""


STEEPER = 2.0
"""How much faster than between looks next to them a guard is thought to fall, where it may fall and rise between."""

GOLDEN = (3.0 - 5.0**0.5) / 2.0
"""Share of an interval at which golden-section search evaluates."""

MOST_SECTIONS = 40
"""Most golden sections of the time between two evaluations, in the search for a dip of a guard below zero."""


def remembering(guards: Guards) -> Guards:
    """Make guards that keep the values of the last state, as a step starts where the step before it ended."""
    last: list[tuple[Instant, FloatArray]] = []

    def values(instant: Instant) -> FloatArray:
        if not (last and last[0][0] is instant):
            last[:] = [(instant, guards(instant))]
        return last[0][1]

    return values


def crossing(step: TimeStep, guards: Guards) -> tuple[float, int] | None:
    """Find the first time, s, in a step at which a guard falls through zero, and its number; None if none does.

    A guard that falls through zero and rises again between two evaluations is found if it does so in one dip.
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
            value = partial(_value, step, guards, k)
            fallen: tuple[float, float] | None = (later, after[k])
            if not after[k] < -THROUGH:
                fallen = None
                falls = steepest[number, k]
                if min(before[k], after[k]) > THROUGH and before[k] + after[k] < falls:
                    fallen = _dip(value, (earlier, later), falls / (later - earlier))
            if fallen is not None:
                found.append((_zero(value, (earlier, before[k]), fallen), k))
        if found:
            return min(found)
    return None


def _far_from_zero(step: TimeStep, guards: Guards, times: FloatArray, seen: dict[int, FloatArray]) -> bool:
    """Whether values at the ends and the middle of a step show that no guard comes to zero in it.

    Args:
        step: the step.
        guards: all guards.
        times: times of all evaluations, s.
        seen: values by the index of the evaluation, to which new ones are added.
    """
    half = len(times) // 2
    for number in (half, 2 * half):
        before = seen[number - half]
        seen[number] = guards(step.at(float(times[number])))
        change = np.abs(seen[number] - before)
        if not np.all(np.minimum(before, seen[number]) > STEEPER * change):
            return False
    return True


def _value(step: TimeStep, guards: Guards, guard: int, time: float) -> float:
    """One guard at a time of a step."""
    return float(guards(step.at(time))[guard])


def _dip(value: Callable[[float], float], between: tuple[float, float], steepest: float) -> tuple[float, float] | None:
    """Find a time between two others at which a guard is negative, with its value; None if its minimum is not.

    Golden-section search: J. Kiefer, *Sequential minimax search for a maximum*, Proc. AMS 4 (1953).

    Args:
        value: the guard over time.
        between: the times, s.
        steepest: largest rate at which it falls, 1/s.
    """
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
        # The remaining time is too short for a zero.
        if min(values) > steepest * (end - start):
            return None
    return None


def _zero(value: Callable[[float], float], first: tuple[float, float], last: tuple[float, float]) -> float:
    """Find the zero of a guard over time between two times of a step, given with its values there."""
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
