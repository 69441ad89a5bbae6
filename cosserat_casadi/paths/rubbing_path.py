"""Paths of rods that rub on obstacles in exact contact: one input grows in increments, from touch to touch.

Each increment solves the equations of rubbing_equations.py at the next factor. An arrangement of contacts ends where a
margin vanishes, as without friction, and the next one is entered there. An increment ends where a contact breaks loose;
where one sticks again increments are shortened. What friction leaves open is told: forces without an effect, as along a
straight rod that does not stretch, and contacts that might slip on as well as stick. Beside these the determinants of
the derivatives for slipping and for sticking have different signs (S. Scholtes, Introduction to Piecewise
Differentiable Equations, Springer 2012, section 2.3).
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from math import inf
from typing import Any

import numpy as np
import numpy.typing as npt

from cosserat_casadi.equilibrium.contact.contact_state import ContactState, Touch
from cosserat_casadi.equilibrium.contact.gaps import obstacle_of
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.numerics.arclength import ArcPoint, ArcSettings, Curve
from cosserat_casadi.numerics.events import Arc
from cosserat_casadi.numerics.progress import Progress
from cosserat_casadi.numerics.trace import GROWTH, PathOutcome, Trace
from cosserat_casadi.paths.contact_curve import Arrangement
from cosserat_casadi.paths.contact_path import ContactPath, Guard, Travel, beginning, path_contact, record
from cosserat_casadi.paths.contact_transitions import ArrangementEntry
from cosserat_casadi.paths.equilibrium_path import InputChange, PathContact, PathEvent, path_along
from cosserat_casadi.paths.friction_path import SHORTEST, next_factor
from cosserat_casadi.paths.margins import Watch
from cosserat_casadi.paths.rubbing_equations import (
    AXES,
    LEAST,
    STIFFNESSES,
    Before,
    LastShape,
    RubbingEquations,
    is_same_contact,
    rubs,
)

CORRECTIONS = 20
"""Most steps of Newton's method at an increment, in which contacts change between sticking and slipping."""

HOLDS = 1e-8
"""Force relative to what friction can hold that counts as rounding."""

LATE = 1e-6
"""Depth, relative to the length, with which a rod may begin to touch."""

STICKS = 1e-3
"""Longest increment of the factor in which a contact that slips may stick again."""

BESIDE = 2e-5
"""Force relative to what friction can hold within which a contact is at the limit."""

AWAY = 1e-3
"""Relative change of a force of friction with which such a contact slips, or sticks, beyond doubt."""

UNDETERMINED = 1e-6
"""Singular value of the scaled equations below which forces of friction have no effect."""

MOSTLY = 0.5
"""Square of the part along the rods of a unit change of friction without effect, above which it is told."""

LIES = (
    " {owner!r} lies down on {obstacle!r}: friction along a line of contact is not followed. Give the obstacle a "
    "width, m, or leave its friction out."
)

WEDGES = (
    " Friction may wedge {owner!r} where it comes to {obstacle!r}: the force then jumps, and no equilibrium follows."
)

OPEN = (
    " From factor {factor:.6g} on friction along a rod has no effect, since the rod is straight and does not stretch: "
    "it is not determined, and stays as it was."
)

NOT_UNIQUE = (
    " At factor {factor:.6g} friction does not determine how the path goes on: {owner!r} may stick on {obstacle!r}, or "
    "slip away from this equilibrium."
)


@dataclass(frozen=True)
class IncrementCurve(Curve):
    """The curve of one increment, whose points are met at their load factors."""

    def point(self, y: FloatArray, direction: FloatArray, length: float) -> ArcPoint:
        """Make the point at y; the direction of travel is that of the load factor."""
        tangent = np.zeros(len(y))
        tangent[-1] = -1.0 if direction[-1] < 0.0 else 1.0
        return ArcPoint(y, tangent, length, np.zeros(0))


@dataclass(frozen=True)
class RubbingArrangement(Arrangement):
    """One arrangement of contacts with friction, after one point of a path."""

    equations: RubbingEquations

    @property
    def tolerance(self) -> float:
        """Relative depth, pull and the like up to which the arrangement is valid: a late touch slides at once."""
        return min(super().tolerance, LATE)

    @cached_property
    def curve(self) -> Curve:
        """The curve of the scaled equations in the next increment."""
        plain = super().curve
        settings = replace(plain.settings, reject_above=CORRECTIONS)
        return IncrementCurve(plain.path, plain.monitor, settings, plain.rows, plain.singular)

    def after(self, point: ArcPoint) -> RubbingArrangement:
        """The arrangement after another point of the path, with the same functions and units."""
        return self.changed(before=self.before(self.z(point), point.load_factor))

    def changed(self, **changes: Any) -> RubbingArrangement:
        """The arrangement with changed equations, with the same functions and units."""
        assert self._scales and self._poses
        other = replace(self, equations=self.equations.changed(**changes))
        vars(other).update({name: value for name, value in vars(self).items() if name not in ("equations", "curve")})
        return other

    def before(self, z: FloatArray, load_factor: float) -> Before:
        """A point as the last one, from which slides are counted."""
        rods = {}
        for name, nodes in self._nodes(z, load_factor).items():
            ends = self.ends(name, z)
            shape = (len(ends) - 1, -1)
            rods[name] = LastShape(ends, nodes.positions.reshape(*shape, 3), nodes.quaternions.reshape(*shape, 4))
        touches = self.state(z).touches
        rubbing = [touches[number] for number in self.equations.rubbing]
        friction = tuple(zip(rubbing, self.equations.friction(z), strict=True))
        return Before(rods, self.bodies(z, load_factor), friction, self._largest(z))

    def _largest(self, z: FloatArray) -> float:
        """Largest dimensionless force of a contact."""
        return float(np.abs(self.equations.parts(z)[1]).max(initial=0.0))

    def excess(self, point: ArcPoint) -> FloatArray:
        """Force that would hold each contact less what friction can, relative to the largest force, shape (k,)."""
        z = self.z(point)
        return self.at(point.load_factor).excess(z) / max(LEAST, self._largest(z))

    def excess_of(self, number: int, point: ArcPoint) -> float:
        """The :meth:`excess` of one contact."""
        return float(self.excess(point)[number])

    def at(self, load_factor: float) -> RubbingEquations:
        """The equations at the inputs and parameters of a load factor."""
        equations = super().at(load_factor)
        assert isinstance(equations, RubbingEquations)
        return equations

    def friction(self, z: FloatArray, load_factor: float) -> list[tuple[int, FloatArray]]:
        """Indices of contacts that rub, with the force of friction on the rod, world axes, shape (3,), N."""
        bodies = self.bodies(z, load_factor)
        found = []
        for number, force in zip(self.equations.rubbing, self.equations.friction(z), strict=True):
            touch = self.equations.state.touches[number]
            force = self.equations.nominal.model.discrete.tension_unit(touch.owner) * force
            body = obstacle_of(self.scene, touch.obstacle).body
            found.append((number, force if body is None else bodies[body].rotation @ force))
        return found

    def turned(self, last: ArcPoint, end: ArcPoint) -> npt.NDArray[np.bool_]:
        """Whether friction of each contact has turned back in an increment, shape (k,)."""
        before, after = (self.equations.friction(self.z(point)) for point in (last, end))
        return np.asarray(np.sum(before * after, axis=1) < 0.0)

    def undecided(self, point: ArcPoint) -> int | None:
        """Index of a contact at the limit of friction that might stick as well as slip beside a point; None without."""
        z = self.z(point)
        here = self.at(point.load_factor)
        limiting = np.flatnonzero(self.excess(point) > -BESIDE).tolist()

        def sign(sticking: int | None) -> float:
            beside = z.copy()
            for number in limiting:
                beside[self._friction_entries(number)] *= 1.0 - AWAY if number == sticking else 1.0 + AWAY
            return float(np.linalg.slogdet(here.jacobian(beside, here.given))[0])

        all_slip = sign(None) if limiting else 0.0
        return next((number for number in limiting if sign(number) != all_slip), None)

    def _friction_entries(self, number: int) -> slice:
        """Entries in z of the friction of a contact that rubs."""
        first = self.equations.nominal.model.size + self.equations.pushes + AXES * number
        return slice(first, first + AXES)

    def is_open(self, point: ArcPoint) -> bool:
        """Whether friction along the rods at a point has a part without effect, which so is not determined."""
        assert self.equations.before is not None
        # On a surface that does not give at all.
        hard = self.changed(before=replace(self.equations.before, largest=inf))
        here = hard.at(point.load_factor)
        scale, rows = self._scales
        z = self.z(point)
        _, values, vectors = np.linalg.svd(rows[:, None] * here.jacobian(z, here.given) * scale)
        touches = self.state(z).touches
        along = np.zeros(len(vectors))
        # Across a rod that stays in a plane friction has no effect either.
        for number, own in enumerate(here.rubbing):
            touch = touches[own]
            tangent = self.poses(z, point.load_factor, float(touch.start), touch.owner).rotation[:, 2]
            body = obstacle_of(self.scene, touch.obstacle).body
            if body is not None:
                tangent = tangent @ self.bodies(z, point.load_factor)[body].rotation
            along += (vectors[:, self._friction_entries(number)] @ tangent) ** 2
        return bool(np.any(along[values < UNDETERMINED] > MOSTLY))


@dataclass(frozen=True, repr=False, kw_only=True)
class RubbingPath(ContactPath):
    """A path of contacts that stick and slip.

    Attributes:
        slips: for each point whether each contact that rubs slips.
        told: sentences on what friction leaves open.
    """

    slips: tuple[tuple[bool, ...], ...] = ()
    told: str = ""

    @property
    def stopped_at(self) -> str:
        """Sentences on a place that has reached a load or another rod on its rod, and on what friction leaves open."""
        return super().stopped_at + self.told

    def contacts(self, index: int) -> tuple[PathContact, ...]:
        """The contacts at a point of the path, with their friction."""
        contacts = list(super().contacts(index))
        arrangement = self._rubbing(index)
        friction = arrangement.friction(self.x[index], float(self.factor[index]))
        for (number, force), slips in zip(friction, self.slips[index], strict=True):
            x, y, z = force.tolist()
            contacts[number] = replace(contacts[number], friction=(x, y, z), slips=slips)
        return tuple(contacts)

    def _rubbing(self, index: int) -> RubbingArrangement:
        arrangement = self.arrangements[self.arrangement[index]]
        assert isinstance(arrangement, RubbingArrangement)
        return arrangement

    def _corrected(self, index: int, start: FloatArray, factor: float) -> FloatArray | None:
        """Unknowns, forces and places at another factor, after the point before this one."""
        before = self._rubbing(index - 1).before(self.x[index - 1], float(self.factor[index - 1]))
        arrangement = self._rubbing(index)
        arrangement = arrangement.changed(before=before)
        found = arrangement.curve.at(start / arrangement.scale, factor)
        return None if found is None else arrangement.scale * found


@dataclass
class RubbingTravel(Travel):
    """The followed part of a path with friction.

    Attributes:
        slips: for each point whether each contact that rubs slips.
        sliding: whether each contact slips at the last point; None for a new one.
        step: next increment of the factor.
        told: sentences on what friction leaves open, by their templates.
    """

    slips: list[tuple[bool, ...]] = field(default_factory=list)
    sliding: list[bool | None] = field(default_factory=list)
    step: float = 0.0
    told: dict[str, str] = field(default_factory=dict)

    @property
    def arrangement(self) -> RubbingArrangement:
        """The last arrangement."""
        last = self.arrangements[-1]
        assert isinstance(last, RubbingArrangement)
        return last

    def _follow(self, first: ArcPoint, guard: Guard, progress: Progress | None) -> None:
        """Follow one arrangement until the path or a margin ends it."""
        traced = Trace([first])
        self._reached(first, guard)
        # Behind an entry against the load nothing follows while the load grows.
        if first.tangent[-1] < 0.0:
            traced.outcome = PathOutcome.CONTACT_UNSETTLED
        self.step = self.step or self.settings.first
        while traced.outcome is None and guard.crossed is None:
            last = traced.points[-1]
            shapes = [(point.load_factor, self._shape(point.x)) for point in traced.points[-2:]]
            factor = next_factor(self.settings, self.step, shapes)
            end = self._advanced(traced.points, factor, guard)
            self.steps += 1
            if end is None:
                guard.crossed = None
                self.step = (factor - last.load_factor) / 2
                if self.step < SHORTEST:
                    traced.outcome = PathOutcome.LOAD_STALLED
            else:
                self.step = GROWTH * (factor - last.load_factor)
                traced.points.append(end)
                self._reached(end, guard)
                if end.load_factor == 1.0:
                    traced.outcome = PathOutcome.CONVERGED
            if progress is not None:
                progress(float(np.clip(traced.points[-1].load_factor, 0.0, 1.0)))
            if traced.outcome is None and self.steps >= self.settings.steps:
                traced.outcome = PathOutcome.MAX_STEPS
        self._keep(traced)

    def _change(self, guard: Guard) -> ArrangementEntry | None:
        """Enter the next arrangement; contacts that go on keep sticking or slipping."""
        before = self.arrangement
        _, last = self.points[-1]
        entry = None
        for stiffness in STIFFNESSES:
            self.arrangements[-1] = before.changed(stiffness=stiffness)
            entry = super()._change(guard)
            if entry is not None:
                break
        if entry is None and guard.crossed is not None and guard.crossed[0].watch is Watch.GAP:
            owner, obstacle = guard.crossed[0].pair
            self.tell(WEDGES, Touch.point(obstacle, owner, guard.crossed[1]))
        if entry is not None:
            touches = before.state(before.z(last)).touches
            known = {
                touches[number]: slips for number, slips in zip(before.equations.rubbing, self.sliding, strict=True)
            }
            added = entry.change.grows.number if entry.change.kind == "touch" else None
            after = self.arrangement.state(self.arrangement.z(entry.point)).touches
            self.sliding = []
            for number in self.arrangement.equations.rubbing:
                same = [slips for own, slips in known.items() if is_same_contact(after[number], own)]
                self.sliding.append(same[0] if same and number != added else None)
        return entry

    def _admits(self, state: ContactState) -> bool:
        """Whether contacts are followed: friction along lines is not."""
        for touch in state.touches:
            if touch.is_line and rubs(self.arrangement.scene, touch):
                self.tell(LIES, touch)
                return False
        return True

    def tell(self, sentence: str, touch: Touch | None = None, factor: float = 0.0) -> None:
        """Keep a sentence for the user, each of its kind once."""
        names = {} if touch is None else {"owner": touch.owner, "obstacle": touch.obstacle}
        self.told.setdefault(sentence, sentence.format(factor=factor, **names))

    def _advanced(self, points: list[ArcPoint], factor: float, guard: Guard) -> ArcPoint | None:
        """The next point, at a factor or where contacts change before it; None if a shorter increment is needed."""
        last = points[-1]
        end = self._solved(points, factor)
        if end is None:
            return None
        guard.arrangement = self.arrangement
        arc = Arc(self.arrangement.curve, last, end)
        broken = self._broken_loose(arc)
        if broken is not None:
            end = broken[1]
        guarded = guard(replace(arc, end=end), end)
        if guarded is None:
            return None
        if guarded is not end:
            broken = None
        arrangement = self.arrangement
        holds = arrangement.excess(guarded) < -HOLDS
        turned = arrangement.turned(last, guarded)
        halts = [bool(slips and (held or back)) for slips, held, back in zip(self.sliding, holds, turned, strict=True)]
        if any(halts) and guarded.load_factor - last.load_factor > STICKS:
            return None
        for number, halted in enumerate(halts):
            if halted:
                self._add_event("stick", last, number, len(points))
            if halted and not holds[number]:
                self._add_event("slip", last, number, len(points))
            if halted or self.sliding[number] is None:
                self.sliding[number] = not holds[number]
        if broken is not None:
            number, at = broken
            self.sliding[number] = True
            self._add_event("slip", at, number, len(points) + (at is not last))
        return guarded

    def _solved(self, points: list[ArcPoint], factor: float) -> ArcPoint | None:
        """The point at a factor: sections that slip go on, so the last increment is extrapolated first."""
        last = points[-1]
        starts = [last.x]
        if len(points) > 1 and last.load_factor > points[-2].load_factor:
            share = (factor - last.load_factor) / (last.load_factor - points[-2].load_factor)
            starts.insert(0, last.x + share * (last.x - points[-2].x))
        now = self.arrangement.equations.stiffness
        for stiffness in (now, *(other for other in STIFFNESSES if other != now)):
            self.arrangements[-1] = arrangement = self.arrangement.changed(stiffness=stiffness)
            for start in starts:
                x = arrangement.curve.at(start, factor)
                if x is None:
                    continue
                way = float(np.linalg.norm(self._shape(x) - self._shape(last.x)))
                if way <= self.settings.longest:
                    length = last.length + factor - last.load_factor
                    return arrangement.curve.point(np.append(x, factor), last.tangent, length)
        return None

    def _shape(self, x: FloatArray) -> FloatArray:
        """The unknowns of the shape, in the units of the curve."""
        model = self.arrangement.equations.nominal.model
        return x[: model.size][model.discrete.unknowns.differential]

    def _broken_loose(self, arc: Arc) -> tuple[int, ArcPoint] | None:
        """The first contact that breaks loose in an increment, by its index, and the point where it does."""
        arrangement = self.arrangement
        first, last = (arrangement.excess(point) for point in (arc.start, arc.end))
        found: tuple[int, ArcPoint] | None = None
        for number, slips in enumerate(self.sliding):
            if slips is not False or last[number] <= HOLDS:
                continue
            zero: ArcPoint | None = arc.start
            if first[number] < -HOLDS:
                zero = arc.zero(partial(arrangement.excess_of, number))
            if zero is not None and (found is None or zero.load_factor < found[1].load_factor):
                found = number, zero
        return found

    def _add_event(self, kind: str, point: ArcPoint, number: int, beyond: int) -> None:
        """Add an event of a contact that rubs.

        Args:
            kind: "slip" or "stick".
            point: where it happens.
            number: index of the contact.
            beyond: number of the points of this arrangement up to the event.
        """
        arrangement = self.arrangement
        z = arrangement.z(point)
        touch = arrangement.state(z).touches[arrangement.equations.rubbing[number]]
        of_path = (len(self.points) + beyond, len(self.arrangements) - 1, path_contact(touch, ()))
        self.events.append(PathEvent(kind, point.load_factor, z, 1, *of_path))

    def _reached(self, point: ArcPoint, guard: Guard) -> None:
        """Count slides from a point on, keep what sticks there, and tell what friction leaves open."""
        arrangement = self.arrangements[-1] = guard.arrangement = self.arrangement.after(point)
        self.slips.append(tuple(bool(slips) for slips in self.sliding))
        number = arrangement.undecided(point)
        if number is not None:
            touch = arrangement.equations.state.touches[arrangement.equations.rubbing[number]]
            self.tell(NOT_UNIQUE, touch, point.load_factor)
        if False in self.sliding and arrangement.is_open(point):
            self.tell(OPEN, factor=point.load_factor)


def follow_rubbing_path(
    moved: InputChange[Model],
    settings: ArcSettings,
    *,
    first: RubbingPath | None = None,
    progress: Progress | None = None,
) -> RubbingPath:
    """Follow the equilibrium of rods that rub on obstacles in exact contact while one input grows to its value.

    Args:
        moved: the change of an input.
        settings: settings, of which only the limits of the load factor and of a step are used.
        first: a path that this one continues; by default there is no friction at factor 0.
        progress: receives the reached factor.
    """
    nothing: dict[str, Any] = {"factor": np.zeros(0), "x": np.zeros(0), "smallest_eigenvalue": None, "neutral": None}
    empty = path_along(moved, RubbingPath, PathOutcome.NO_START, events=(), **nothing)
    if first is None:
        plain, z, message = beginning(moved)
        if plain is None:
            return replace(empty, message=empty.message + message)
        equations = RubbingEquations(plain.scene, plain.given, plain.grids, plain.state, plain.theta)
        x, forces, places = plain.parts(z)
        z = np.concatenate([x, forces, np.zeros(AXES * len(equations.rubbing)), places])
        sliding: list[bool | None] = [False] * len(equations.rubbing)
    else:
        last = first.arrangements[int(first.arrangement[-1])].equations
        assert isinstance(last, RubbingEquations)
        given, theta = np.split(moved.base, [moved.model.inputs.size])
        assert last._functions and last._by_arguments
        at = last.at(given, theta)
        assert isinstance(at, RubbingEquations)
        equations, z, sliding = at, first.x[-1], list(first.slips[-1])
    arrangement = RubbingArrangement(equations, moved.change, False, settings, z, 0.0)
    travel = RubbingTravel(settings, 0, [arrangement], sliding=sliding)
    if not travel._admits(equations.state):
        return replace(empty, told="".join(travel.told.values()))
    growing_load = np.append(np.zeros(len(z)), 1.0)
    start = arrangement.curve.point(arrangement.y(z, 0.0), growing_load, 0.0)
    assert start is not None
    travel.run(start, progress)
    path = record(empty, travel)
    return replace(path, slips=tuple(travel.slips), told="".join(travel.told.values()))
