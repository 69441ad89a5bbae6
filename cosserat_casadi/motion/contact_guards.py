"""Guards of the contacts of a motion: forces, places, bends and gaps that stay at zero or above between two events."""

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
"""Distance of two sections, over the length, that touch one obstacle, up to which they count as one."""

CLOSE = 1e-7
"""Gap, over the length, up to which a section of a rod that lies touches: it is held at that height."""

ROLLING = 2.0 * FLATTEST
"""Bend of the gap from which on a rod that lies on one section rolls on from there: it would not lie down at once."""

NO_PULL = 1e-6
"""Force, in its unit, that one counts as which may pull: a guard that is zero would be an event at once."""


class GuardKind(IntEnum):
    """Quantity of a guard: of a contact up to the bend, then of a pair of a rod or body and an obstacle.

    Members are in the order in which the guards stand one after the other, and their values count the blocks.
    """

    FORCE = 0
    """The force of a contact, which ends where it would pull."""

    END = 1
    """How far a place is from the ends of its rod; a place that slides, from ends of its element and other contacts."""

    BEND = 2
    """The bend of the gap about a section that slides."""

    GAP = 3
    """The least gap of what does not touch."""

    CLEAR = 4
    """How little a rod that lies has got up, or how far it is from rolling on over the section that it lies on."""


@dataclass(frozen=True)
class ContactPhase:
    """The contacts of a stretch of a motion, between two events.

    Attributes:
        touches: the contacts.
        laid: numbers of the pairs of a rod and an obstacle in which the rod lies; never of pairs with a body.
        follower: of the contacts.
        floors: least gaps that what does not touch may have, an array for each pair: one for each section of a rod that
            lies, else one.
        forces_from: time before which forces may pull: after an impact stiff parts have to come to rest first, s.
        moment: beginning of the moment in which changes are counted, s.
        changes: changes in it.
        closed: cables that are taut, and stops that hold their joints.
        slopes: slope of the gap for each pair in which a rod lies on one section that it may roll on from; zero of
            others.
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
    """The problem of a start with rods or bodies inside obstacles or other rods, by a depth over the length."""
    pairs = ", ".join(dict.fromkeys(f"{facing.owner!r} in {facing.touched!r}" for facing in facings))
    what = f"a rod is inside an obstacle by {depth:.2g} (over the length) where the motion starts: {pairs}"
    return Problem("simulation.start", what, "start from another shape, or move the obstacle")


@dataclass(frozen=True)
class ContactGuards:
    """Guards of the contacts of a model.

    Attributes:
        size: number of unknowns of the model.
        facings: rods and bodies, with the obstacles that they may touch.
        meeting_ends: which ends of the rods are one point.
    """

    size: int
    facings: Sequence[Facing]
    meeting_ends: MeetingEnds

    def of(self, piece: Piece, arrangement: ContactPhase) -> Guards:
        """Forces, places within the rod, bends of gaps, and gaps of all else; they are asked for along the motion."""
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
        """How far a place is from the ends of its element; of an end, how fast the gap rises towards all rods there."""
        if touch.slides:
            ends = self.facings[touch.facing].ends
            return min(touch.place - ends[element], ends[element + 1] - touch.place)
        if self.facings[touch.facing].of_body:
            return 1.0
        return self.meeting_ends.rise(touch, x, inputs)

    def lowest(self, number: int, nodes: FloatArray, touches: Sequence[MovingContact]) -> float:
        """The least gap, over the length, of a rod that does not lie or of a body, but for what touches.

        Args:
            number: of the rod or body and obstacle.
            nodes: positions, shape (M, 3), m.
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
    """How much farther than counts as one place a section that slides is from other contacts of its rod."""
    if not touch.slides:
        return 1.0
    others = [one for one in touches if one.facing == touch.facing and one is not touch]
    return min((abs(one.place - touch.place) - SAME_PLACE for one in others), default=1.0)


def guarded(guard: int | None, count: int, facings: int) -> tuple[GuardKind | None, int]:
    """Kind of a guard, and the index of its contact, or of its pair of a rod or body and an obstacle.

    Args:
        guard: its number; None for none.
        count: number of contacts.
        facings: number of rods and obstacles.
    """
    if guard is None:
        return None, 0
    of_contacts = GuardKind.GAP * count
    if guard < of_contacts:
        return GuardKind(guard // count), guard % count
    of_facing = guard - of_contacts
    return GuardKind(GuardKind.GAP + of_facing // facings), of_facing % facings
