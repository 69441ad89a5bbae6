"""Ends of rods that coincide: a rod starts at the tip of another, or several tips are joined to one point of a body.

Such a point touches once, not once for each rod. A contact that slides to it stays there if the rods form a corner, and
goes on along the next rod if they do not.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.constraints.joints import JOINT_KINDS
from cosserat_casadi.loads.penetration import section_radius
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.motion.contact_forces import MovingContact, Touches
from cosserat_casadi.motion.contact_gap import Facing

BASE = 0.0
"""Abscissa of the base of a rod."""

TIP = 1.0
"""Abscissa of the tip of a rod."""

SMOOTH = 1e-6
"""Largest slope of a gap over arc length at which two rods that meet count as going on without a corner."""


class RodEnd(NamedTuple):
    """An end of a rod: the name of the rod, and the abscissa X, 0 or 1."""

    rod: str
    X: float


def meetings(scene: scenes.Scene) -> list[set[RodEnd]]:
    """Sets of coinciding ends of rods, one set for each point."""
    found: list[set[RodEnd]] = []
    for pair in _pairs(scene):
        joined = [one for one in found if one & pair]
        found = [one for one in found if not one & pair]
        found.append(pair.union(*joined))
    return found


def _pairs(scene: scenes.Scene) -> Iterator[set[RodEnd]]:
    """Pairs of coinciding ends: a tip and a base that starts at it, or two tips at one point of a body."""
    for rod in scene.rods:
        base = rod.base
        if base.rod is not None and base.at == TIP and not any(base.position):
            yield {RodEnd(base.rod, TIP), RodEnd(rod.name, BASE)}
    # A tip that slides in its body is not at one point.
    tips = [joint for joint in scene.joints if joint.at == TIP]
    points = [joint for joint in tips if not JOINT_KINDS[joint.kind].directions(joint).slides]
    for number, joint in enumerate(points):
        for other in points[:number]:
            if joint.body == other.body and joint.position == other.position:
                yield {RodEnd(other.rod, TIP), RodEnd(joint.rod, TIP)}


def watched_ends(model: Model, rod: str, obstacle: scenes.ObstacleRecord) -> tuple[bool, bool]:
    """Whether the base and the tip of a rod are watched for contact with an obstacle.

    An end is not watched if it cannot move relative to the obstacle: a base fixed in the world, or an end fixed to the
    body that carries the obstacle. Of coinciding ends only the thickest is watched. A base on a section of another rod
    is not watched if that rod is as thick there: its section touches first.
    """
    watched = []
    for end in (RodEnd(rod, BASE), RodEnd(rod, TIP)):
        (together,) = [one for one in meetings(model.scene) if end in one] or [{end}]
        concerned = [one for one in _ordered(model, together) if obstacle.concerns(one.rod)]
        watched.append(concerned[0] == end)
    moves = obstacle.body is not None or model.discrete.unloaded.floating_base(rod) is not None
    watched[0] = watched[0] and moves and not _on_a_carrier(model, rod, obstacle)
    held = [joint.at for joint in model.scene.joints if (joint.rod, joint.body) == (rod, obstacle.body)]
    return watched[0] and BASE not in held, watched[1] and TIP not in held


def _ordered(model: Model, ends: set[RodEnd]) -> list[RodEnd]:
    """Sort ends by radius, thickest first; equal ones with tips before bases, then in the order of the scene."""
    order = [rod.name for rod in model.scene.rods]
    return sorted(ends, key=lambda end: (-_radius(model, end.rod, end.X), -end.X, order.index(end.rod)))


def _on_a_carrier(model: Model, rod: str, obstacle: scenes.ObstacleRecord) -> bool:
    """Whether the base of a rod is on an inner section of another rod, as thick there, which touches in its place."""
    base = model.discrete.records[rod].base
    if base.rod is None or base.at == TIP or any(base.position) or not obstacle.concerns(base.rod):
        return False
    return _radius(model, base.rod, base.at) >= _radius(model, rod, BASE)


def _radius(model: Model, rod: str, X: float) -> float:
    """Radius of a section, m."""
    (radius,) = section_radius(model.discrete.rods[rod].properties, np.array([X])).tolist()
    return float(radius)


class MeetingEnds:
    """The coinciding ends among rods that may touch obstacles.

    Args:
        facings: pairs of a rod or body and an obstacle that may touch.
    """

    def __init__(self, facings: Sequence[Facing]) -> None:
        self._facings = facings
        self._others: dict[tuple[int, float], list[tuple[int, float]]] = {}
        if not facings:
            return
        points = meetings(facings[0].model.scene)
        for number, facing in enumerate(facings):
            for X in (BASE, TIP):
                end = RodEnd(facing.owner, X)
                together = [] if facing.of_body else [one for point in points if end in point for one in point - {end}]
                self._others[number, X] = [
                    (other, one.X)
                    for one in together
                    for other, candidate in enumerate(facings)
                    if not candidate.of_body and candidate.owner == one.rod and candidate.touched == facing.touched
                ]

    def beside(self, touch: MovingContact, near: float) -> list[tuple[int, float]]:
        """Ends of other rods next to a contact, as indices of facings and abscissae.

        Args:
            touch: the contact, at its place.
            near: largest distance from the common point, over the length, that counts as next to it.
        """
        found = []
        for X in (BASE, TIP):
            if abs(touch.place - X) <= near:
                found += self._others.get((touch.facing, X), [])
        return found

    def rise(self, touch: MovingContact, x: FloatArray, inputs: FloatArray) -> float:
        """Least slope of the gap over arc length at an end that touches, among all rods that meet there."""
        return min(slope for slope, _ in self._rises(touch, x, inputs))

    def gone_on(self, touch: MovingContact, x: FloatArray, inputs: FloatArray) -> MovingContact:
        """The contact that replaces a contact which has slid to an end of its rod, or leaves that end.

        Args:
            touch: the contact, at its place.
            x: unknowns, shape (n,).
            inputs: stacked inputs, shape (m,).
        """
        end = touch._replace(place=TIP if touch.place > (BASE + TIP) / 2.0 else BASE)
        rises = self._rises(end, x, inputs)
        if touch.slides:
            # Where it comes from the gap is level now.
            rises = rises[1:]
            if not rises or min(rises)[0] > SMOOTH:
                return end._replace(slides=False)
        _, (number, X) = min(rises)
        height = touch.height * self._facings[touch.facing].length / self._facings[number].length
        return MovingContact(number, X, True, height)

    def distinct(self, known: Touches, found: Touches, near: float) -> Touches:
        """Known contacts and new ones, each common point of several rods once.

        Args:
            known: contacts that last.
            found: new contacts; of two that coincide, the one inside a rod is kept.
            near: distance from the common point, over the length, up to which contacts coincide.
        """
        kept = list(known)
        for touch in sorted(found, key=lambda one: not one.slides):
            seen = {end for one in kept for end in self.beside(one, near)}
            own = {(touch.facing, X) for X in (BASE, TIP) if abs(touch.place - X) <= near}
            if not seen & own:
                kept.append(touch)
        return tuple(kept)

    def _rises(self, touch: MovingContact, x: FloatArray, inputs: FloatArray) -> list[tuple[float, tuple[int, float]]]:
        """Slopes of the gaps over arc length away from an end, along its own rod, then along the others there."""
        own = (touch.facing, touch.place)
        found = []
        for number, X in [own, *self._others.get(own, [])]:
            facing = self._facings[number]
            slope = facing.at(facing.nodes(x, inputs), X).slope
            found.append((-slope if X == TIP else slope, (number, X)))
        return found
