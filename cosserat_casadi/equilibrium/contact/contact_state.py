"""States of contact: which sections touch which obstacles, as discrete data, and the unknown places of contact."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np
import numpy.typing as npt

from cosserat_casadi import scene as scenes
from cosserat_casadi.equilibrium.solution import SectionForce
from cosserat_casadi.loads.contact_friction import ContactFriction
from cosserat_casadi.loads.contact_line import ContactLine
from cosserat_casadi.loads.contact_point import ContactPoint
from cosserat_casadi.loads.rods_point import RodsPoint
from cosserat_casadi.maths.numbers import is_symbolic
from cosserat_casadi.maths.typing import Columns, FloatArray
from cosserat_casadi.model.element_ends import element_ends
from cosserat_casadi.model.system_functions import SystemFunctions

Place = Any
"""An abscissa X: a number, or an expression of unknown places."""

BASE = 0.0
"""Start of a line of contact of a rod whose base lies on the obstacle: the line has no unknown end there."""

TIP = 1.0
"""Abscissa of the tip, which contact cannot move beyond."""

AT_END = 1e-3
"""Distance from an end of a rod within which it is the end that touches."""

CLEAR = 1e-3
"""Distance of a place from a section with a load below which its solve starts at this distance from the section."""

SHORTEST = 1e-5
"""Least distance of places of contact from each other and from the base, relative to the length of the rod."""


@dataclass(frozen=True)
class Touch:
    """One contact with an obstacle: of a rod at a point or along a line, or of a body as a ball.

    Two rods that touch at a section of either are a point of the first on the second, which stands for the obstacle.

    Attributes:
        obstacle: name of the obstacle, or of the second of two rods.
        owner: name of the rod, or of the body, that touches.
        start: abscissa X at which contact begins; 0 for a body.
        end: abscissa at which it ends; ``start`` for a point.
        is_line: whether a stretch lies on the obstacle.
        of_body: whether it is a body that touches.
        seams: known abscissae inside a line at which the force per length may jump, base to tip.
        other: abscissa of the touching section of a second rod; None for contact with an obstacle.
    """

    obstacle: str
    owner: str
    start: Place
    end: Place
    is_line: bool = False
    of_body: bool = False
    seams: tuple[Place, ...] = ()
    other: Place | None = None

    @classmethod
    def ball(cls, obstacle: str, body: str) -> Touch:
        """Contact of a body; its place on the obstacle follows from the body's pose."""
        return cls(obstacle, body, 0.0, 0.0, of_body=True)

    @classmethod
    def point(cls, obstacle: str, rod: str, at: float) -> Touch:
        """Contact at one section."""
        return cls(obstacle, rod, at, at)

    @classmethod
    def of_rods(cls, rods: tuple[str, str], at: tuple[Place, Place]) -> Touch:
        """Contact of two rods at a section of either."""
        return cls(rods[1], rods[0], at[0], at[0], other=at[1])

    @classmethod
    def line(cls, obstacle: str, rod: str, start: float, end: float) -> Touch:
        """A stretch that lies on an obstacle."""
        return cls(obstacle, rod, start, end, is_line=True)

    @property
    def ends(self) -> tuple[Place, ...]:
        """Abscissae of the one point, or of both ends."""
        return (self.start, self.end) if self.is_line else (self.start,)

    @property
    def rods(self) -> tuple[str, ...]:
        """Names of the rods that have a place of it: one, two of rods that touch, none of a body."""
        if self.of_body:
            return ()
        return (self.owner,) if self.other is None else (self.owner, self.obstacle)

    def on(self, rod: str) -> Touch:
        """This contact as one of its rods has it: the second of two rods touches the first."""
        return self if rod == self.owner else Touch.of_rods((self.obstacle, self.owner), (self.other, self.start))

    @property
    def moves(self) -> tuple[bool, ...]:
        """Whether each end is an unknown place: all but the base and the tip, and no end of a body."""
        if self.of_body:
            return (False,)
        return tuple(is_sought(end) for end in self.ends)

    @property
    def sought(self) -> tuple[tuple[str, Place], ...]:
        """Unknown places with their rods: ends of this contact, then the place on a second rod."""
        own = [(self.owner, end) for end, moves in zip(self.ends, self.moves, strict=True) if moves]
        if self.other is None or not is_sought(self.other):
            return tuple(own)
        return (*own, (self.obstacle, self.other))

    @property
    def held_at(self) -> tuple[Place | None, ...]:
        """Each place, of ends and of the second of two rods, that is no unknown; None for one that is."""
        places = self.ends if self.other is None else (*self.ends, self.other)
        return tuple(None if is_sought(place) else place for place in places)

    @property
    def moving(self) -> tuple[Place, ...]:
        """The unknown places."""
        return tuple(place for _, place in self.sought)

    @property
    def carriers(self) -> tuple[Place, ...]:
        """Abscissae of the forces at sections, base to tip: the point, or both ends and the seams.

        A force on the base acts on the clamp, not on the rod, and is left out.
        """
        if not self.is_line:
            return (self.start,)
        sections = (*self.seams, self.end)
        return sections if self.starts_at_base else (self.start, *sections)

    @property
    def carriers_move(self) -> tuple[bool, ...]:
        """Whether each of the :attr:`carriers` is an unknown place."""
        seams = tuple(False for _ in self.seams)
        if self.starts_at_base:
            return (*seams, self.moves[-1])
        return (self.moves[0], *seams, *self.moves[1:])

    def sorted_forces(self, forces: FloatArray) -> tuple[tuple[float, ...], tuple[SectionForce, ...]]:
        """Split forces at sections into forces at the ends and forces inside a line."""
        if not self.is_line:
            return tuple(forces.tolist()), ()
        first, *inside, last = [0.0, *forces.tolist()] if self.starts_at_base else forces.tolist()
        return (first, last), tuple(map(SectionForce, self.seams, inside))

    @property
    def stretches(self) -> tuple[tuple[Place, Place], ...]:
        """Start and end of each part of a line with a smooth force per length; none for a point."""
        return tuple(pairwise((BASE, *self.carriers) if self.starts_at_base else self.carriers))

    @property
    def starts_at_base(self) -> bool:
        """Whether the contact is a line that begins at the base of the rod."""
        return self.is_line and not is_symbolic(self.start) and self.start == BASE

    @property
    def reaches_tip(self) -> bool:
        """Whether the contact ends at the tip."""
        return not self.of_body and not self.moves[-1]

    @property
    def kind(self) -> str:
        """Kind of contact in the words of the result file."""
        return "line" if self.is_line else "point"

    def moved(self, places: Sequence[Place]) -> Touch:
        """This contact at other places, one for each unknown place."""
        if self.of_body:
            return self
        if self.other is not None:
            left = iter(places)
            own, other = (next(left) if is_sought(place) else place for place in (self.start, self.other))
            return Touch.of_rods((self.owner, self.obstacle), (own, other))
        ends = [*places, TIP]
        if self.starts_at_base:
            ends.insert(0, BASE)
        ends = ends[: len(self.ends)]
        return replace(self, start=ends[0], end=ends[-1])

    def split(self, by_rod: Mapping[str, Sequence[float]]) -> Touch:
        """This contact with seams at the sections inside it, and places moved off the sections.

        Args:
            by_rod: abscissae of each rod at which loads make the shear force, or its rate, jump, by name.
        """
        if not self.is_line:
            return self.moved([_beside(place, by_rod[rod], CLEAR) for rod, place in self.sought])
        sections = by_rod[self.owner]
        start = BASE if self.starts_at_base else _beside(self.start, sections, -CLEAR)
        end = self.end if self.reaches_tip else _beside(self.end, sections, CLEAR)
        return replace(self, start=start, end=end, seams=tuple(X for X in sections if start < X < end))

    def moment_counts(self, modes: int) -> tuple[int, ...]:
        """Number of polynomials of the force per length on each stretch.

        In a stretch whose curvature has n polynomials the distance has n + 2. Distance and slope at its start are
        known: by the conditions of an unknown end or the clamp, or at a seam from the stretch before. At its end an
        unknown place takes two more conditions, a seam or the tip the distance alone; the rest is the number of
        polynomials, so that every condition is met once.
        """
        counts = []
        for moves in self.carriers_move[-len(self.stretches) :]:
            conditions = 2 + (2 if moves else 1)
            counts.append(max(modes + 2 - conditions, 1))
        return tuple(counts)

    def moment_count(self, modes: int) -> int:
        """Number of polynomials of the force per length, over all stretches."""
        return sum(self.moment_counts(modes))

    def by_stretch(self, along: Columns, modes: int) -> Iterator[tuple[Place, Place, Columns]]:
        """Start and end of each stretch, with its coefficients of the force per length."""
        first = 0
        for (start, end), count in zip(self.stretches, self.moment_counts(modes), strict=True):
            yield start, end, along[first : first + count]
            first += count


def is_sought(place: Place) -> bool:
    """Whether a place moves along its rod: it is neither at the base nor at the tip."""
    return is_symbolic(place) or BASE < place < TIP


def at_end(place: float) -> float:
    """A place on a rod, or the end that it is near."""
    return float(round(place)) if min(place - BASE, TIP - place) < AT_END else place


def _beside(place: float, sections: Sequence[float], way: float) -> float:
    """A place; if it is on a section, moved off it by a given distance."""
    for section in sections:
        if abs(place - section) < CLEAR:
            return section + way
    return place


@dataclass(frozen=True)
class ContactState:
    """All contacts of a scene.

    Attributes:
        touches: the contacts, sorted by rod and abscissa, contacts of bodies last.
    """

    touches: tuple[Touch, ...]

    @classmethod
    def of(cls, touches: Sequence[Touch]) -> ContactState:
        """The state of some contacts, in order."""
        return cls(tuple(sorted(touches, key=_order)))

    @property
    def signature(self) -> tuple[tuple[object, ...], ...]:
        """The discrete part of the state: states with equal signatures differ in their places alone."""
        return tuple((touch.owner, touch.obstacle, touch.kind, touch.of_body, touch.held_at) for touch in self.touches)

    def split(self, sections: Mapping[str, Sequence[float]]) -> ContactState:
        """These contacts with seams at the sections, given for each rod by name, that are inside them."""
        return ContactState(tuple(touch if touch.of_body else touch.split(sections) for touch in self.touches))

    @property
    def seamed(self) -> ContactState:
        """These contacts with seams of lines where the rod begins or ceases to touch another obstacle.

        The force of the other contact may make the force per length of the line jump there.
        """
        touches = []
        for touch in self.touches:
            beside = [other for other in self.touches if other is not touch and other.rods == (touch.owner,)]
            ends = {end for other in beside for end in other.moving if touch.start < end < touch.end}
            touches.append(replace(touch, seams=tuple(sorted({*touch.seams, *ends}))) if touch.is_line else touch)
        return ContactState(tuple(touches))

    def reseamed(self, places: Mapping[str, Mapping[float, Place]]) -> ContactState:
        """These contacts with moved seams, by the old and new places of each rod, by name: numbers or expressions."""
        touches = []
        for touch in self.touches:
            moved = places.get(touch.owner, {})
            touches.append(replace(touch, seams=tuple(moved.get(seam, seam) for seam in touch.seams)))
        return ContactState(tuple(touches))

    @property
    def places(self) -> FloatArray:
        """All unknown places, shape (k,)."""
        return np.array([float(place) for touch in self.touches for place in touch.moving])

    def along(self, rod: str) -> list[Touch]:
        """The contacts of a rod as it has them, in the order of the state: base to tip, but for a second rod."""
        return [touch.on(rod) for touch in self.touches if rod in touch.rods]

    def at(self, places: Sequence[Place]) -> ContactState:
        """These contacts at other places, numbers or expressions; seams at places of other contacts move with them."""
        touches = []
        moved: dict[str, dict[Place, Place]] = {}
        first = 0
        for touch in self.touches:
            last = first + len(touch.moving)
            touches.append(touch.moved(places[first:last]))
            for (rod, before), after in zip(touch.sought, places[first:last], strict=True):
                moved.setdefault(rod, {})[before] = after
            first = last
        state = ContactState(tuple(touches))
        return state.reseamed(moved) if any(touch.seams for touch in touches) else state

    def with_forces(self, forces: Columns, modes: Mapping[str, int]) -> Iterator[tuple[Touch, Columns, Columns]]:
        """Each contact, the forces at its sections, and the coefficients of the force along it.

        Args:
            forces: forces of all contacts, in the order of the loads.
            modes: polynomials of the curvature of each rod, by name.
        """
        first = 0
        for touch in self.touches:
            last = first + len(touch.carriers)
            count = touch.moment_count(modes[touch.owner]) if touch.is_line else 0
            yield touch, forces[first:last], forces[last : last + count]
            first = last + count

    def apart(self, share: Callable[[Touch, Touch], bool]) -> ContactState:
        """The contacts, but no two of a rod at one section, where the longer or earlier one stays; tips may share.

        Args:
            share: whether a section of a rod may have two contacts, since their forces are independent.
        """
        kept: list[Touch] = []
        for touch in sorted(self.touches, key=lambda touch: touch.start - touch.end):
            if all(_are_apart(touch, other) or share(touch, other) for other in kept):
                kept.append(touch)
        return ContactState.of(kept)

    @property
    def in_order(self) -> bool:
        """Whether the places of each rod ascend between base and tip, at least a little apart.

        Contacts with two obstacles may overlap; no two have an unknown place in common.
        """
        for rod in {rod for touch in self.touches for rod in touch.rods}:
            own = self.along(rod)
            sought = [end for touch in own for end in touch.moving]
            inside = {end for touch in own for end in touch.carriers if BASE < end < TIP}
            gaps = np.diff([BASE, *sorted(inside)])
            if len(set(sought)) < len(sought) or np.any(gaps < SHORTEST):
                return False
            for obstacle in {touch.obstacle for touch in own}:
                alike = sorted((touch for touch in own if touch.obstacle == obstacle), key=lambda touch: touch.start)
                ends = [end for touch in alike for end in touch.carriers]
                if np.any(np.diff(ends) < 0.0) or ends[-1] > TIP:
                    return False
        return True

    def loads(self, scene: scenes.Scene, modes: Mapping[str, int]) -> list[scenes.LoadRecord]:
        """The forces of the contacts as loads of the scene, with open magnitudes: at sections, then along lines.

        Args:
            scene: the scene without them.
            modes: polynomials of the curvature of each rod, by name.
        """
        obstacles = {obstacle.name: obstacle for obstacle in scene.obstacles}
        disks = {body.name: body for body in scene.bodies if body.thickness is not None}
        loads: list[scenes.LoadRecord] = []
        for touch in self.touches:
            if touch.other is not None:
                loads.append(
                    RodsPoint.model_construct(
                        name=f"contact {len(loads) + 1}",
                        rods=(touch.owner, touch.obstacle),
                        places=(touch.start, touch.other),
                        force=0.0,
                    )
                )
                continue
            obstacle = obstacles[touch.obstacle]
            disk = disks.get(touch.owner) if touch.of_body else None
            for end in touch.carriers:
                loads.append(
                    ContactPoint.model_construct(
                        name=f"contact {len(loads) + 1}",
                        rod=None if touch.of_body else touch.owner,
                        body=touch.owner if touch.of_body else None,
                        obstacle=obstacle,
                        at=end,
                        force=0.0,
                        radius=0.0 if disk is None or disk.radius is None else disk.radius,
                        thickness=None if disk is None else disk.thickness,
                    )
                )
            if not touch.is_line:
                continue
            for span, count in zip(touch.stretches, touch.moment_counts(modes[touch.owner]), strict=True):
                loads.append(
                    ContactLine.model_construct(
                        name=f"contact {len(loads) + 1}",
                        rod=touch.owner,
                        obstacle=obstacle,
                        span=span,
                        force=((0.0,) * count,),
                    )
                )
        return loads


def continuations(scene: scenes.Scene) -> dict[str, str]:
    """Rods that continue another rod from its tip without a corner, by the name of the other rod."""
    following = {}
    for rod in scene.rods:
        base = rod.base
        if base.rod is None or base.at != TIP or any(base.position):
            continue
        # It may be turned about its own axis.
        _, x, y, _ = base.quaternion
        if x == 0.0 and y == 0.0:
            following[base.rod] = rod.name
    return following


def with_contacts(scene: scenes.Scene, state: ContactState, modes: Mapping[str, int]) -> scenes.Scene:
    """The scene with the forces of its contacts as loads with inputs as magnitudes."""
    return with_loads(scene, state.loads(scene, modes))


def with_loads(scene: scenes.Scene, loads: Sequence[scenes.LoadRecord]) -> scenes.Scene:
    """The scene with further loads, whose forces are inputs."""
    changes: dict[str, object] = {"loads": (*scene.loads, *loads)}
    if scene.inputs is not None:
        changes["inputs"] = (*scene.inputs, *(f"{load.name}.force" for load in loads))
    return scene.model_copy(update=changes)


ContactForce = ContactPoint | ContactLine | RodsPoint | ContactFriction
"""Loads that are forces of contacts."""


def contact_loads(scene: scenes.Scene) -> list[ContactForce]:
    """Loads of a scene that are forces of contacts; no scene file has them."""
    loads: Sequence[scenes.LoadRecord] = scene.loads
    return [load for load in loads if isinstance(load, ContactForce)]


def without_contacts(scene: scenes.Scene) -> scenes.Scene:
    """The scene of the file, without forces of contacts."""
    names = {load.name for load in contact_loads(scene)}
    if not names:
        return scene
    changes: dict[str, object] = {"loads": tuple(load for load in scene.loads if load.name not in names)}
    if scene.inputs is not None:
        inputs = {f"{name}.force" for name in names}
        changes["inputs"] = tuple(name for name in scene.inputs if name not in inputs)
    return scene.model_copy(update=changes)


def given_names(model: SystemFunctions) -> list[str]:
    """Names of a model's inputs without the forces of contacts, which follow from the others."""
    names = {load.name for load in contact_loads(model.scene)}
    return [entry.name for entry, _ in model.inputs if entry.owner not in names]


def given_entries(model: SystemFunctions) -> npt.NDArray[np.int64]:
    """Indices, in the stacked inputs of a model, of all inputs but the forces of contacts."""
    entries = np.arange(model.inputs.size)
    return np.concatenate([entries[:0], *(entries[model.inputs.slices[name]] for name in given_names(model))])


def given_inputs(model: SystemFunctions, inputs: FloatArray) -> FloatArray:
    """Stacked inputs of a scene, from the stacked inputs of a model that may have forces of contacts too."""
    return inputs[given_entries(model)]


def load_sections(scene: scenes.Scene) -> dict[str, tuple[float, ...]]:
    """Abscissae inside each rod at which a load makes the shear force, or its rate, jump, by name of the rod."""
    return {rod.name: element_ends(scene, rod.name)[1:-1] for rod in scene.rods}


def state_in(scene: scenes.Scene) -> ContactState:
    """The state of the contacts whose forces are among the loads of a scene."""
    touches: list[Touch] = []
    loads = contact_loads(scene)
    for line in loads:
        if not isinstance(line, ContactLine):
            continue
        start, end = line.span
        touch = Touch.line(line.obstacle.name, line.rod, start, end)
        last = touches[-1] if touches else None
        if last is not None and (last.owner, last.obstacle, last.end) == (touch.owner, touch.obstacle, start):
            # Stretches that follow each other make one line.
            before = touches.pop()
            touch = replace(touch, start=before.start, seams=(*before.seams, start))
        touches.append(touch)
    of_lines = {(touch.owner, touch.obstacle, at) for touch in touches for at in touch.carriers}
    for point in loads:
        if isinstance(point, RodsPoint):
            touches.append(Touch.of_rods(point.rods, point.places))
        if not isinstance(point, ContactPoint):
            continue
        if point.body is not None:
            touches.append(Touch.ball(point.obstacle.name, point.body))
        elif point.rod is not None and (point.rod, point.obstacle.name, point.at) not in of_lines:
            touches.append(Touch.point(point.obstacle.name, point.rod, point.at))
    return ContactState.of(touches)


def _are_apart(touch: Touch, other: Touch) -> bool:
    """Whether two contacts are on different rods, at different sections, or at the tip with different obstacles."""
    for rod in set(touch.rods) & set(other.rods):
        one, another = touch.on(rod), other.on(rod)
        at_tip = one.start == TIP and one.obstacle != another.obstacle
        if not (at_tip or another.end < one.start or one.end < another.start):
            return False
    return True


def _order(touch: Touch) -> tuple[bool, str, Place, str]:
    """Key by which contacts are sorted."""
    return touch.of_body, touch.owner, touch.start, touch.obstacle
