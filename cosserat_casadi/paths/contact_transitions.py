"""Transitions between arrangements of contacts at zeros of margins: touch, lift-off, points to lines, sliding.

The arrangements before and after a change share the equilibrium at the change. If both are regular, the next one is
entered at this load factor. A line begins with zero length and a place leaves the tip with zero distance, where the
equations of the next arrangement are singular: it is entered where that length is slightly larger. An arrangement that
ends in this way, by a line that shrinks or a place that comes to the tip, is left slightly before, and its end is
computed along the next one.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from cosserat_casadi.equilibrium.contact.contact_alternatives import instead_of_pulling
from cosserat_casadi.equilibrium.contact.contact_state import BASE, TIP, ContactState, Touch, at_end, load_sections
from cosserat_casadi.equilibrium.contact.shape_projection import projected
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.numerics.arclength import ArcPoint
from cosserat_casadi.numerics.events import Arc
from cosserat_casadi.paths.contact_curve import Arrangement
from cosserat_casadi.paths.gaps_along import RodsGaps
from cosserat_casadi.paths.margins import OPEN, OVER_JOINT, Key, Watch, margins, violated

WIDER = 4.0
"""Width, in units of the least one, with which a line or a distance from the tip begins."""

PROBE = 1e-3
"""Step along the next arrangement that decides which direction leads into it."""

MOST_PROBES = 40
"""Step lengths in the search for the beginning of the next arrangement, shorter ones for corners."""


@dataclass(frozen=True)
class Transition:
    """The next arrangement of contacts after a margin has vanished.

    Attributes:
        kind: kind of the event.
        touch: the contact before the change.
        state: the next contacts.
        grows: the margin of the next arrangement that is zero at the change and grows after it.
        opens: entries of the places, with factors, whose sum defines the point of entry; empty if the load factor does.
        level: value of their sum at the point of entry.
        located: whether the change is at the zero of that margin along the next arrangement.
    """

    kind: str
    touch: Touch
    state: ContactState
    grows: Key
    opens: tuple[tuple[Touch, int, float], ...] = ()
    level: float = 0.0
    located: bool = False


@dataclass(frozen=True)
class ArrangementEntry:
    """The entry of a path into an arrangement.

    Attributes:
        change: transition from the arrangement before.
        arrangement: the next one.
        point: the first point, whose tangent leads into the arrangement.
        is_event: whether this point is the change itself; else the last point of the arrangement before is.
    """

    change: Transition
    arrangement: Arrangement
    point: ArcPoint
    is_event: bool


def changes(arrangement: Arrangement, z: FloatArray, load_factor: float, key: Key, X: float) -> Iterator[Transition]:
    """Transitions to other arrangements at a zero of a margin, the likeliest first.

    Args:
        arrangement: the arrangement that ends.
        z: last point of the arrangement.
        load_factor: load factor λ at that point.
        key: key of the margin.
        X: abscissa of the margin.
    """
    state = arrangement.state(z)
    if key.watch is Watch.GAP:
        rod, obstacle = key.pair
        gaps = arrangement.gaps(z, load_factor)[key.pair]
        if isinstance(gaps, RodsGaps):
            yield _added(state, Touch.of_rods(key.pair, (X, at_end(gaps.place(X)))))
        else:
            yield _added(state, Touch.point(obstacle, rod, X))
        return
    if key.watch is Watch.BODY_GAP:
        body, obstacle = key.pair
        yield _added(state, Touch.ball(obstacle, body))
        return
    touch = state.touches[key.number]
    others = [other for number, other in enumerate(state.touches) if number != key.number]
    if touch.other is not None and key.watch is not Watch.FORCE:
        yield from _along_rods(touch, others, key)
    elif key.watch is Watch.FORCE and not touch.is_line:
        gap = Watch.BODY_GAP if touch.of_body else Watch.GAP
        yield Transition("lift_off", touch, ContactState.of(others), Key(gap, -1, key.pair))
    elif key.watch is Watch.CURVATURE:
        half = WIDER * OPEN / 2
        yield _opened("point_to_line", touch, others, replace(touch, start=X - half, end=X + half, is_line=True))
    elif key.watch is Watch.WIDTH:
        yield _replaced("line_to_point", touch, others, Touch.point(touch.obstacle, touch.owner, X), Watch.CURVATURE)
    elif key.watch is Watch.TO_TIP and touch.is_line:
        yield _replaced("slide_to_tip", touch, others, replace(touch, end=TIP), Watch.FORCE)
    elif key.watch is Watch.TO_TIP and touch.owner in arrangement.following:
        beyond = Touch.point(touch.obstacle, arrangement.following[touch.owner], WIDER * OVER_JOINT)
        yield _passed_on(touch, others, beyond, Watch.TO_BASE)
    elif key.watch is Watch.TO_BASE:
        before = next(first for first, second in arrangement.following.items() if second == touch.owner)
        beyond = Touch.point(touch.obstacle, before, TIP - WIDER * OVER_JOINT)
        yield _passed_on(touch, others, beyond, Watch.TO_TIP)
    elif key.watch is Watch.TO_TIP:
        yield _replaced("slide_to_tip", touch, others, Touch.point(touch.obstacle, touch.owner, TIP), Watch.SLOPE)
    elif key.watch is Watch.SLOPE:
        inwards = TIP - WIDER * OPEN
        yield _opened("slide_from_tip", touch, others, Touch.point(touch.obstacle, touch.owner, inwards))
        yield _opened("point_to_line", touch, others, Touch.line(touch.obstacle, touch.owner, inwards, TIP))
    elif key.watch is Watch.FORCE and touch.reaches_tip and key.end == len(touch.carriers) - 1:
        yield _opened("slide_from_tip", touch, others, replace(touch, end=TIP - WIDER * OPEN))
    else:
        for option in instead_of_pulling(touch):
            following = ContactState.of([*others, *option])
            kind = "slide_from_tip" if any(other.is_line for other in option) else "line_to_point"
            yield Transition(kind, touch, following, Key(Watch.GAP, -1, key.pair))


def _along_rods(touch: Touch, others: list[Touch], key: Key) -> Iterator[Transition]:
    """Transitions of two rods whose place comes to an end of its rod, or leaves it; none where they lie down."""
    places = [touch.start, touch.other]
    if key.watch is Watch.SLOPE:
        way = WIDER * OVER_JOINT
        places[key.end] = BASE + way if places[key.end] == BASE else TIP - way
        new = Touch.of_rods(key.pair, (places[0], places[1]))
        following = ContactState.of([*others, new])
        number = new.sought.index((touch.rods[key.end], places[key.end]))
        watch = Watch.TO_BASE if places[key.end] == BASE + way else Watch.TO_TIP
        grows = Key(watch, _number(following, new), key.pair, key.end)
        yield Transition("slide_from_tip", touch, following, grows, ((new, number, 1.0),), float(places[key.end]))
    elif key.watch in (Watch.TO_TIP, Watch.TO_BASE):
        places[key.end] = TIP if key.watch is Watch.TO_TIP else BASE
        new = Touch.of_rods(key.pair, (places[0], places[1]))
        following = ContactState.of([*others, new])
        grows = Key(Watch.SLOPE, _number(following, new), key.pair, key.end)
        yield Transition("slide_to_tip", touch, following, grows, located=True)


def _number(state: ContactState, touch: Touch) -> int:
    return state.touches.index(touch)


def _added(state: ContactState, touch: Touch) -> Transition:
    """Transition with an additional contact, whose force grows from zero."""
    following = ContactState.of([*state.touches, touch])
    grows = Key(Watch.FORCE, _number(following, touch), (touch.owner, touch.obstacle))
    return Transition("touch", touch, following, grows)


def _replaced(kind: str, old: Touch, others: list[Touch], new: Touch, watch: Watch) -> Transition:
    """Transition to a contact of another kind, which begins at a zero of one of its margins."""
    following = ContactState.of([*others, new])
    last = len(new.carriers) - 1 if watch is Watch.FORCE else 0
    grows = Key(watch, _number(following, new), (new.owner, new.obstacle), last)
    return Transition(kind, old, following, grows, located=True)


def _passed_on(old: Touch, others: list[Touch], new: Touch, watch: Watch) -> Transition:
    """Transition of a point to the next rod of a chain, entered slightly beyond the joint."""
    following = ContactState.of([*others, new])
    grows = Key(watch, _number(following, new), (new.owner, new.obstacle))
    return Transition("slide_over_joint", old, following, grows, ((new, 0, 1.0),), float(new.start))


def _opened(kind: str, old: Touch, others: list[Touch], new: Touch) -> Transition:
    """Transition to a contact with one more unknown place, entered slightly off its other place, or the tip."""
    following = ContactState.of([*others, new])
    number = _number(following, new)
    pair = (new.owner, new.obstacle)
    if new.is_line and not new.reaches_tip and old.kind == "point":
        opens = ((new, 0, -1.0), (new, 1, 1.0))
        return Transition(kind, old, following, Key(Watch.WIDTH, number, pair), opens, WIDER * OPEN)
    # Index of the last unknown place.
    last = len(new.moving) - 1
    watch = Watch.WIDTH if new.is_line and new.reaches_tip else Watch.TO_TIP
    return Transition(kind, old, following, Key(watch, number, pair), ((new, last, 1.0),), TIP - WIDER * OPEN)


def entered(arrangement: Arrangement, point: ArcPoint, change: Transition) -> ArrangementEntry | None:
    """The entry of the path into the next arrangement; None if this is not valid there.

    Args:
        arrangement: the arrangement that ends.
        point: its last point.
        change: transition to the next one.
    """
    change = _split(change, load_sections(arrangement.scene))
    if not change.state.in_order:
        return None
    z = arrangement.z(point)
    equations = replace(arrangement.equations, state=change.state)
    found = arrangement.equilibrium_at(z, point.load_factor)
    x = projected(found.solution, equations.nominal.model)
    following = replace(arrangement, equations=equations, load_factor=point.load_factor)
    here = following.at(point.load_factor)
    near = here.start_from(x, here.given)
    following = replace(following, near=near)
    guess = following.y(near, point.load_factor)
    met = _met(following, guess, _plane(following, change, point.load_factor))
    if met is None:
        return None
    if change.located:
        met = _where_it_begins(following, met, change.grows)
    else:
        met = _turned(following, met, change.grows)
    if met is None or not _is_valid(following, met):
        return None
    start = replace(met, length=0.0)
    return ArrangementEntry(change, following, start, change.located)


def _split(change: Transition, sections: Mapping[str, Sequence[float]]) -> Transition:
    """This transition with seams of lines at the loads."""
    opens = tuple((touch.split(sections), number, factor) for touch, number, factor in change.opens)
    return replace(change, state=change.state.split(sections), opens=opens)


def _plane(arrangement: Arrangement, change: Transition, load_factor: float) -> tuple[FloatArray, float]:
    """Normal and level of the plane in which the next arrangement is entered: by load factor, or by opening."""
    size = len(arrangement.scale)
    normal = np.zeros(size + 1)
    if not change.opens:
        normal[-1] = 1.0
        return normal, load_factor
    first = size - len(change.state.places)
    for touch, number, factor in change.opens:
        earlier = change.state.touches[: _number(change.state, touch)]
        before = sum(len(other.moving) for other in earlier)
        normal[first + before + number] = factor
    return normal, change.level


def _met(arrangement: Arrangement, guess: FloatArray, plane: tuple[FloatArray, float]) -> ArcPoint | None:
    """The point of an arrangement in a plane; its tangent leads to either side."""
    corrected = arrangement.curve.correct(guess, *plane)
    if corrected is None:
        return None
    return arrangement.curve.point(corrected[0], plane[0], 0.0)


def _value(arrangement: Arrangement, point: ArcPoint, key: Key) -> float:
    return margins(arrangement, arrangement.z(point), point.load_factor)[key].value


def _beside(arrangement: Arrangement, point: ArcPoint, step: float) -> ArcPoint | None:
    """The point after a short step along the tangent, or against it."""
    predicted = point.y + step * point.tangent
    corrected = arrangement.curve.correct(predicted, point.tangent)
    if corrected is None:
        return None
    return arrangement.curve.point(corrected[0], np.sign(step) * point.tangent, point.length + abs(step))


def _turned(arrangement: Arrangement, point: ArcPoint, grows: Key) -> ArcPoint | None:
    """The point with its tangent in the direction in which a margin grows."""
    ahead = _beside(arrangement, point, PROBE)
    behind = _beside(arrangement, point, -PROBE)
    if ahead is None or behind is None:
        return None
    if _value(arrangement, ahead, grows) >= _value(arrangement, behind, grows):
        return point
    return replace(point, tangent=-point.tangent)


def _where_it_begins(arrangement: Arrangement, point: ArcPoint, grows: Key) -> ArcPoint | None:
    """The nearby point of an arrangement with a margin of zero; the margin grows along its tangent."""
    turned = _turned(arrangement, point, grows)
    if turned is None:
        return None
    value = _value(arrangement, turned, grows)
    # From a point beyond the beginning the curve is followed back to it.
    back = value > 0.0
    if back:
        turned = replace(turned, tangent=-turned.tangent)
    step = PROBE
    start = turned
    for _ in range(MOST_PROBES):
        end = _beside(arrangement, start, step)
        if end is None or end.tangent @ start.tangent < arrangement.settings.min_cosine:
            step /= 2
            continue
        passed = (_value(arrangement, end, grows) > 0.0) != back
        if passed:
            zero = Arc(arrangement.curve, start, end).zero(lambda p: _value(arrangement, p, grows))
            if zero is None:
                return None
            return replace(zero, tangent=-zero.tangent) if back else zero
        start = end
        step *= 2
    return None


def _is_valid(arrangement: Arrangement, point: ArcPoint) -> bool:
    """Whether no margin is below zero slightly beyond the entry."""
    beyond = _beside(arrangement, point, PROBE)
    if beyond is None:
        return False
    ahead = margins(arrangement, arrangement.z(beyond), beyond.load_factor)
    return not list(violated(ahead, arrangement.tolerance))
