"""Guards of the contacts of a motion: forces, places, bends and gaps that are not negative between two events."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from enum import IntEnum

import numpy as np

from cosserat_casadi.errors import Problem
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.motion.coincident_ends import MeetingEnds
from cosserat_casadi.motion.contact_forces import Follower, MovingContact, Touches
from cosserat_casadi.motion.contact_gap import FLATTEST, Facing
from cosserat_casadi.motion.moving_inputs import Piece
from cosserat_casadi.numerics.guards import Guards
from cosserat_casadi.numerics.motion_equations import Instant

SAME_PLACE = 0.02
"""Distance, over the length, up to which two sections that touch one obstacle count as one contact."""

CLOSE = 1e-7
"""Largest gap, over the length, at which a section of a lying rod touches; the contact keeps the gap at this height."""

ROLLING = 2.0 * FLATTEST
"""Bend of the gap above which a rod that lies on one section rolls on from there, and would not lie down at once."""

NO_PULL = 1e-6
"""Value, in force units, of the guard of a contact that may pull for now; with zero an event would follow at once."""


class GuardKind(IntEnum):
    """Quantity of a guard: up to BEND one for each contact, then one for each pair of a rod or body and an obstacle.

    Guards are stacked in the order of the members, whose values are the indices of their blocks.
    """

    FORCE = 0
    """The force of a contact; the contact ends where the force would pull."""

    END = 1
    """Distance of a sliding contact from the ends of its element and other contacts; at an end, slope of the gap."""

    BEND = 2
    """The bend of the gap at a sliding contact."""

    GAP = 3
    """The least gap of the sections, or the body, that do not touch."""

    CLEAR = 4
    """Distance of a lying rod from having got up, or from rolling on over the section that it lies on."""


@dataclass(frozen=True)
class ContactPhase:
    """The contacts of a stretch of a motion, between two events.

    Attributes:
        touches: the contacts.
        laid: indices of the pairs of a rod and an obstacle in which the rod lies; never of pairs with a body.
        follower: tracker of the places of the contacts.
        floors: least admissible gaps without contact, an array for each pair: one entry for each section that holds a
            lying rod, else one entry.
        forces_from: time before which forces may pull, while stiff parts come to rest after an impact, s.
        moment: start of the moment in which changes of contact are counted, s.
        changes: number of changes in that moment.
        closed: cables that are taut, and stops that hold their joints.
        slopes: for each pair, slope of the gap at the only section on which a rod lies, if it may roll on from there;
            else zero.
    """

    touches: Touches = ()
    laid: frozenset[int] = frozenset()
    follower: Follower = field(default_factory=lambda: Follower((), ()))
    floors: tuple[FloatArray, ...] = ()
    forces_from: float = -np.inf
    moment: float = -np.inf
    changes: int = 0
    closed: tuple[bool, ...] = ()
    slopes: tuple[float, ...] = ()


def start_inside(facings: Iterable[Facing], depth: float) -> Problem:
    """Problem of a motion that starts with rods or bodies inside obstacles or rods, by a depth over the length."""
    pairs = ", ".join(dict.fromkeys(f"{facing.owner!r} in {facing.touched!r}" for facing in facings))
    what = f"a rod is inside an obstacle by {depth:.2g} (over the length) where the motion starts: {pairs}"
    return Problem("simulation.start", what, "start from another shape, or move the obstacle")


@dataclass(frozen=True)
class ContactGuards:
    """Guards of the contacts of a model.

    Attributes:
        size: number of unknowns of the model.
        facings: rods and bodies, with the obstacles that they may touch.
        meeting_ends: the ends of rods that coincide.
    """

    size: int
    facings: Sequence[Facing]
    meeting_ends: MeetingEnds

    def of(self, piece: Piece, arrangement: ContactPhase) -> Guards:
        """Make the function that evaluates all guards along the motion, in the order of :class:`GuardKind`."""
        touches = arrangement.touches
        follower = arrangement.follower
        size = self.size

        def values(instant: Instant) -> FloatArray:
            x = instant.x[:size]
            inputs = piece.at(instant.time).value
            followed = follower.follow(x, inputs)
            forces = instant.x[size:]
            if instant.time <= arrangement.forces_from:
                forces = np.maximum(forces, NO_PULL)
            ends = np.ones(len(touches))
            bends = np.ones(len(touches))
            placed = [touch._replace(place=place) for touch, place in zip(touches, followed.places, strict=True)]
            for k, (touch, gap) in enumerate(zip(placed, followed.gaps, strict=True)):
                if touch.facing not in arrangement.laid:
                    ends[k] = min(self._within(touch, follower.elements[k], x, inputs), apart(touch, placed))
                if touch.slides:
                    bends[k] = -1.0 if followed.gone[k] else gap.bend - FLATTEST
            others = np.ones(len(self.facings))
            clear = np.ones(len(self.facings))
            for number, facing in enumerate(self.facings):
                nodes = facing.nodes(x, inputs)
                floor = arrangement.floors[number]
                if number not in arrangement.laid:
                    others[number] = min(1.0, self.lowest(number, nodes, placed) - float(floor[0]))
                    continue
                pressing = [k for k, touch in enumerate(placed) if touch.facing == number]
                untouched = ~np.isin(facing.laid_at, [placed[k].place for k in pressing])
                others[number] = np.min((facing.laid_gaps(nodes) - floor)[untouched], initial=1.0)
                if not pressing:
                    clear[number] = CLOSE - facing.deepest(nodes).gap
                elif arrangement.slopes[number]:
                    gap = followed.gaps[pressing[0]]
                    turned = gap.slope / arrangement.slopes[number]
                    clear[number] = max(turned, ROLLING - gap.bend)
            return np.concatenate([forces, ends, bends, others, clear])

        return values

    def _within(self, touch: MovingContact, element: int, x: FloatArray, inputs: FloatArray) -> float:
        """Distance of a sliding contact from the ends of its element; at an end, least slope of the gap there."""
        if touch.slides:
            ends = self.facings[touch.facing].ends
            return min(touch.place - ends[element], ends[element + 1] - touch.place)
        if self.facings[touch.facing].of_body:
            return 1.0
        return self.meeting_ends.rise(touch, x, inputs)

    def lowest(self, number: int, nodes: FloatArray, touches: Sequence[MovingContact]) -> float:
        """Least gap, over the length, of a rod that does not lie, or of a body, outside its contacts.

        Args:
            number: index of the pair.
            nodes: positions of the points, shape (M, 3), m.
            touches: the contacts, at their places.
        """
        own = [touch for touch in touches if touch.facing == number]
        # An end that is held has no valley: the section that is least beside it may strike before the rod rolls on.
        held = [] if self.facings[number].of_body else [touch.place for touch in own if not touch.slides]
        valleys = [touch.place for touch in own if touch.place not in held]
        beside = [end for touch in touches for end in self.meeting_ends.beside(touch, SAME_PLACE)]
        left_out = [X for other, X in beside if other == number]
        return self.facings[number].lowest(nodes, valleys, held + left_out)


def apart(touch: MovingContact, touches: Sequence[MovingContact]) -> float:
    """Distance of a sliding contact from other contacts of its rod, less SAME_PLACE; 1 for other contacts."""
    if not touch.slides:
        return 1.0
    others = [one for one in touches if one.facing == touch.facing and one is not touch]
    return min((abs(one.place - touch.place) - SAME_PLACE for one in others), default=1.0)


def guarded(guard: int | None, count: int, facings: int) -> tuple[GuardKind | None, int]:
    """Kind of a guard, and the index of its contact, or of its pair of a rod or body and an obstacle.

    Args:
        guard: index of the guard; None for no guard.
        count: number of contacts.
        facings: number of pairs.
    """
    if guard is None:
        return None, 0
    of_contacts = GuardKind.GAP * count
    if guard < of_contacts:
        return GuardKind(guard // count), guard % count
    of_facing = guard - of_contacts
    return GuardKind(GuardKind.GAP + of_facing // facings), of_facing % facings
