"""Contacts to try in place of others, chosen by the places of contact alone."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import pairwise, product

import numpy as np

from cosserat_casadi.equilibrium.contact.contact_state import BASE, TIP, ContactState, Touch

NEAR = 0.03
"""Distance along the rod within which a penetration belongs to a contact."""

LIES_FROM = 0.8
"""First guess of the start of the line along which a rod lies down to its tip."""

ACROSS = 0.05
"""Distance beyond a section with a load at which a contact that would slide past the section is tried."""

MET = 4e-3
"""Distance below which a place of contact counts as having met a section with a load, the tip or another place."""

BEYOND = 0.01
"""Distance beyond a section at which a place that has met the section is tried next."""

LONGER = 2.0 + 3.0**0.5
"""Ratio of the lengths by which a heavy straight beam rises from a plane on both sides of a moment."""


def instead_of_pulling(touch: Touch) -> Iterator[tuple[Touch, ...]]:
    """Contacts that may take the place of a contact that pulls."""
    if not touch.is_line:
        yield ()
        return
    middle = (touch.start + touch.end) / 2
    first, last, between = (
        Touch.point(touch.obstacle, touch.owner, place) for place in (touch.start, touch.end, middle)
    )
    yield (first, last)
    yield (between,)
    yield (first,)
    yield (last,)
    if touch.reaches_tip:
        # A rod that curls up leaves the obstacle before its tip.
        yield (replace(touch, end=touch.start + 0.7 * (touch.end - touch.start)),)


def _across(state: ContactState, sections: Mapping[str, Sequence[float]]) -> Iterator[ContactState]:
    """States with one place moved to the other side of an adjacent section with a load, the nearest first."""
    crossings: list[tuple[float, ContactState]] = []
    places = state.places
    sought = [place for touch in state.touches for place in touch.sought]
    for index, (rod, place) in enumerate(sought):
        stations = np.array([0.0, *sections[rod], TIP])
        before = int(np.searchsorted(stations, place)) - 1
        for section, beyond in ((before, before - 1), (before + 1, before + 2)):
            if not 0 < section < len(stations) - 1:
                continue
            way = stations[beyond] - stations[section]
            moved = places.copy()
            moved[index] = stations[section] + np.sign(way) * min(ACROSS, abs(way) / 2)
            crossings.append((abs(stations[section] - place), state.at(moved.tolist())))
    yield from (other for _, other in sorted(crossings, key=lambda crossing: crossing[0]))


def otherwise(state: ContactState, sections: Mapping[str, Sequence[float]]) -> Iterator[ContactState]:
    """States to try instead of a state whose equations have no solution nearby."""
    yield from _across(state, sections)
    for index, touch in enumerate(state.touches):
        rest = [other for i, other in enumerate(state.touches) if i != index]
        if touch.other is not None:
            ways = (_otherwise_at(touch.start), _otherwise_at(touch.other))
            for places in product(*ways):
                yield ContactState.of([*rest, Touch.of_rods((touch.owner, touch.obstacle), places)])
        elif touch.is_line:
            for option in instead_of_pulling(touch):
                yield ContactState.of([*rest, *option])
        elif touch.reaches_tip:
            yield ContactState.of([*rest, Touch.point(touch.obstacle, touch.owner, TIP - 2 * NEAR)])
            yield ContactState.of([*rest, Touch.line(touch.obstacle, touch.owner, LIES_FROM, TIP)])
        elif not touch.of_body:
            yield ContactState.of([*rest, Touch.point(touch.obstacle, touch.owner, TIP)])
        yield ContactState.of(rest)


def _otherwise_at(place: float) -> tuple[float, ...]:
    """A place of rods that touch, then another: the nearer end of the rod, or inwards of an end."""
    if place in (BASE, TIP):
        return place, abs(place - 2 * NEAR)
    return place, float(round(place))


def met(state: ContactState, sections: Mapping[str, Sequence[float]]) -> Iterator[ContactState]:
    """States after places of contact have met each other, the tip or a load: joined, ended or moved beyond the load.

    Args:
        state: the contacts, with the places at which a solve stopped.
        sections: abscissae of each rod at which loads act, by name.
    """
    of_rods = [touch for touch in state.touches if not touch.of_body]
    for first, second in pairwise(of_rods):
        same = (first.owner, first.obstacle) == (second.owner, second.obstacle) and first.other is None
        if same and second.start - first.end < MET:
            yield _with(state, {first: Touch.line(first.obstacle, first.owner, first.start, second.end), second: None})
            for section in sections[first.owner]:
                if first.is_line and second.is_line and first.end < section < second.start:
                    # A moment lifts a longer stretch on one side than on the other.
                    for before, after in ((BEYOND, LONGER * BEYOND), (LONGER * BEYOND, BEYOND)):
                        opened = replace(first, end=section - before), replace(second, start=section + after)
                        yield _with(state, dict(zip((first, second), opened, strict=True)))
    for touch in of_rods:
        if touch.is_line and touch.end - touch.start < MET:
            yield _with(state, {touch: Touch.point(touch.obstacle, touch.owner, touch.start)})
            continue
        if touch.other is not None:
            ends = [float(round(place)) if _has_met(place) else place for place in (touch.start, touch.other)]
            if ends != [touch.start, touch.other]:
                yield _with(state, {touch: Touch.of_rods((touch.owner, touch.obstacle), (ends[0], ends[1]))})
        elif TIP - MET < touch.end < TIP:
            yield _with(state, {touch: replace(touch, start=touch.start if touch.is_line else TIP, end=TIP)})
        for number, (rod, place) in enumerate(touch.sought):
            for section in sections[rod]:
                if abs(place - section) < MET:
                    places = list(touch.moving)
                    places[number] = section + BEYOND * np.sign(section - place)
                    yield _with(state, {touch: touch.moved(places)})


def _has_met(place: float) -> bool:
    """Whether a place has run into an end of its rod."""
    return min(place - BASE, TIP - place) < MET


def _with(state: ContactState, changes: Mapping[Touch, Touch | None]) -> ContactState:
    """The state with some contacts replaced, or removed if replaced by None."""
    touches = [changes.get(touch, touch) for touch in state.touches]
    return ContactState.of([touch for touch in touches if touch is not None])
