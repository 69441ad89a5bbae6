"""Margins of an arrangement of contacts: numbers, each of a contact or a pair, that are positive while it is valid.

They are Signorini's conditions between two changes of the arrangement: no section is inside an obstacle, no contact
pulls, and a contact at a point stays a point between base and tip.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from enum import Enum

import numpy as np

from cosserat_casadi.equilibrium.contact.contact_search import pressure_along
from cosserat_casadi.equilibrium.contact.contact_state import AT_END, BASE, TIP, Touch, is_sought
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.paths.contact_curve import Arrangement
from cosserat_casadi.paths.gaps_along import GapsAlong, RodsGaps

OPEN = 0.005
"""Least width of a line of contact, and least distance of a moving place from the tip, along a path."""

OVER_JOINT = 2e-4
"""Least distance of a point of contact from the joint of two rods, one of which continues the other.

Places of rods that touch rods come as close to an end: on a longer way the normal of a thin rod turns much.
"""

NEAR = 0.01
"""Distance along the rod from a contact within which the contact's own margins cover the gap."""

PER_ELEMENT = 48
"""Number of intervals between abscissae of an element at which gaps are evaluated."""

NARROWINGS = 3
"""Rounds of refinement in the search for the section that is nearest to an obstacle."""

POLISHING = 4
"""Newton steps to the section that is nearest to an obstacle."""

ROUNDING = 1e-9
"""Difference of distances, over the length, that may be rounding."""


class Watch(Enum):
    """Quantity of a margin."""

    GAP = "least distance of a rod from an obstacle, beside its contacts"
    BODY_GAP = "distance of a body from an obstacle that it does not touch"
    FORCE = "force at a point, or at an end of a line times its length"
    PRESSURE = "least force per length along a line"
    CURVATURE = "second derivative of the gap at a point: below zero the rod lies down"
    SLOPE = "fall of the gap towards a tip that touches: below zero a section inwards is nearer"
    TO_TIP = "distance of the last moving place of a contact from the tip"
    TO_BASE = "distance of a point from the base of a rod that goes on where another ends, or that touches a rod"
    WIDTH = "length of a line of contact"


@dataclass(frozen=True)
class Key:
    """Name of a margin.

    Attributes:
        watch: quantity of the margin.
        number: index of the contact in the arrangement; −1 for a gap.
        end: index, base to tip, of the section of a line that the force acts on; for two rods the index of the rod
            that the place is on.
        pair: names of rod, or body, and obstacle, or of both rods.
    """

    watch: Watch
    number: int
    pair: tuple[str, str]
    end: int = 0


@dataclass(frozen=True)
class Margin:
    """A margin at a point of a path.

    Attributes:
        value: dimensionless value, positive in a valid arrangement.
        X: abscissa of the margin.
    """

    value: float
    X: float


def margins(arrangement: Arrangement, z: FloatArray, load_factor: float) -> dict[Key, Margin]:
    """All margins of an arrangement at z and λ."""
    gaps = arrangement.gaps(z, load_factor)
    found: dict[Key, Margin] = {}
    parts = list(arrangement.parts(z))
    largest = 1.0
    for _, ends, line in parts:
        largest = max(largest, float(np.abs(ends).max()), float(np.abs(line).max(initial=0.0)))
    for number, (touch, ends, line) in enumerate(parts):
        pair = (touch.owner, touch.obstacle)
        # Errors of the moment cause errors of the forces in inverse proportion to the length of a line.
        lever = touch.end - touch.start if touch.is_line else 1.0
        for end, (force, X) in enumerate(zip(ends, touch.carriers, strict=True)):
            found[Key(Watch.FORCE, number, pair, end)] = Margin(float(force) * lever / largest, float(X))
        if touch.other is not None:
            along = gaps[pair]
            assert isinstance(along, RodsGaps)
            found |= _margins_of_rods(touch, along, number)
            continue
        if touch.moving:
            last = float(touch.moving[-1])
            passes = touch.owner in arrangement.following and not touch.is_line
            least = OVER_JOINT if passes else OPEN
            found[Key(Watch.TO_TIP, number, pair)] = Margin(TIP - last - least, last)
            if touch.owner in arrangement.following.values() and not touch.is_line:
                found[Key(Watch.TO_BASE, number, pair)] = Margin(last - OVER_JOINT, last)
        if touch.is_line:
            width = touch.end - touch.start
            abscissae, pressure = pressure_along(touch, line, arrangement.equations.nominal.modes[touch.owner])
            weakest = int(pressure.argmin())
            pressing = float(pressure[weakest]) * width / largest
            found[Key(Watch.PRESSURE, number, pair)] = Margin(pressing, float(abscissae[weakest]))
            found[Key(Watch.WIDTH, number, pair)] = Margin(width - OPEN, float(touch.start))
        elif touch.of_body:
            # A body has no place of contact along a rod.
            continue
        elif touch.moving:
            _, _, curvature = gaps[pair].at(touch.start)
            found[Key(Watch.CURVATURE, number, pair)] = Margin(curvature, float(touch.start))
        else:
            _, slope, _ = gaps[pair].at(TIP)
            found[Key(Watch.SLOPE, number, pair)] = Margin(-slope, TIP)
    for pair, gap in gaps.items():
        taken = [
            (touch.start, touch.end)
            for touch, _, _ in parts
            if (touch.owner, touch.obstacle) == pair and not touch.of_body
        ]
        X = nearest(gap, taken)
        if X is not None:
            distance, _, _ = gap.at(X)
            found[Key(Watch.GAP, -1, pair)] = Margin(distance, X)
    touching = {(touch.owner, touch.obstacle) for touch, _, _ in parts if touch.of_body}
    for pair, distance in arrangement.body_gaps(z, load_factor).items():
        if pair not in touching:
            found[Key(Watch.BODY_GAP, -1, pair)] = Margin(distance, 0.0)
    return found


def _margins_of_rods(touch: Touch, gaps: RodsGaps, number: int) -> dict[Key, Margin]:
    """Margins of two rods that touch: of each place its distance from both ends of its rod, or the slope at an end."""
    assert touch.other is not None, "two rods"
    pair = (touch.owner, touch.obstacle)
    places = (float(touch.start), float(touch.other))
    _, slopes, bends = gaps.between(*places)
    found = {}
    for side, (place, slope) in enumerate(zip(places, slopes, strict=True)):
        if is_sought(place):
            found[Key(Watch.TO_TIP, number, pair, side)] = Margin(TIP - place - OVER_JOINT, place)
            found[Key(Watch.TO_BASE, number, pair, side)] = Margin(place - OVER_JOINT, place)
        else:
            # Inwards of a base the abscissa grows.
            found[Key(Watch.SLOPE, number, pair, side)] = Margin(float(slope if place == BASE else -slope), place)
    moves = [is_sought(place) for place in places]
    if any(moves):
        least = np.linalg.eigvalsh(bends[np.ix_(moves, moves)])[0]
        found[Key(Watch.CURVATURE, number, pair)] = Margin(float(least), places[0])
    return found


def nearest(gaps: GapsAlong, taken: list[tuple[float, float]]) -> float | None:
    """Abscissa of the section that is nearest to an obstacle, away from stretches that already touch it."""
    local = np.linspace(0.0, 1.0, PER_ELEMENT + 1)
    X = gaps.line.abscissae(local)
    free = np.ones(X.shape, dtype=bool)
    for start, end in taken:
        free &= (start - NEAR > X) | (end + NEAR < X)
    # The clamp may touch the obstacle to which it is fixed.
    free[0, 0] = False
    if not free.any():
        return None
    values = np.where(free, gaps.values(local), np.inf)
    element, index = np.unravel_index(int(values.argmin()), values.shape)
    start = float(X[element, index])
    spacing = float(gaps.line.ends[element + 1] - gaps.line.ends[element]) / PER_ELEMENT
    polished = _polished(gaps, start, spacing)
    # A tip touches itself first, not a section beside it.
    tip_is_nearest = values[-1, -1] <= values[element, index] + ROUNDING
    if polished > TIP - AT_END and tip_is_nearest:
        return TIP
    if any(first - NEAR <= polished <= last + NEAR for first, last in taken):
        return start
    return polished


def _polished(gaps: GapsAlong, start: float, spacing: float) -> float:
    """Abscissa of the least gap near an abscissa, within a spacing."""
    X = start
    reach = spacing
    # Beside a thin obstacle the gap nearly has a corner: Newton's method must start close to it.
    for _ in range(NARROWINGS):
        around = np.clip(X + reach * np.linspace(-1.0, 1.0, 9), 0.0, TIP)
        X = float(around[gaps.distances(around).argmin()])
        reach /= 4
    least, slope, curvature = gaps.at(X)
    for _ in range(POLISHING):
        # Beside a thin obstacle the square of the distance from its middle is a parabola, the distance is none.
        to_middle = least + gaps.depth(X)
        curvature += slope**2 / to_middle if to_middle > 0.0 else 0.0
        if curvature <= 0.0:
            return X
        closer = float(np.clip(X - slope / curvature, max(X - reach, 0.0), min(X + reach, TIP)))
        distance, slope, curvature = gaps.at(closer)
        if distance > least:
            return X
        X = closer
        least = distance
    return X


def violated(found: dict[Key, Margin], tolerance: float) -> Iterator[Key]:
    """The margins below zero by more than a tolerance."""
    for key, margin in found.items():
        if margin.value < -tolerance:
            yield key
