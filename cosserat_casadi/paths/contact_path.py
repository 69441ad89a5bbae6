"""Equilibrium paths in exact contact: one arrangement of contacts is followed to its end, then the next one.

See docs/contact.md, "Paths", and contact_transitions.py for how one leads to another.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import TypeVar

import numpy as np
import numpy.typing as npt

from cosserat_casadi.equilibrium.contact.contact_equations import ContactEquations, Grids
from cosserat_casadi.equilibrium.contact.contact_judgement import judged
from cosserat_casadi.equilibrium.contact.contact_search import Settling
from cosserat_casadi.equilibrium.contact.contact_solve import LEAST_TOLERANCE, solve_contact
from cosserat_casadi.equilibrium.contact.contact_state import (
    TIP,
    ContactState,
    Touch,
    load_sections,
    state_in,
    without_contacts,
)
from cosserat_casadi.equilibrium.solution import SectionForce, Solution, SolvedPoses
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.numerics.arclength import ArcPoint, ArcSettings
from cosserat_casadi.numerics.events import Arc
from cosserat_casadi.numerics.newton import NewtonSettings
from cosserat_casadi.numerics.progress import Progress
from cosserat_casadi.numerics.trace import PathOutcome, Trace, extend
from cosserat_casadi.paths.contact_curve import Arrangement
from cosserat_casadi.paths.contact_transitions import ArrangementEntry, changes, entered
from cosserat_casadi.paths.equilibrium_path import (
    EquilibriumPath,
    InputChange,
    PathContact,
    PathEvent,
    loads_have_potential,
    path_along,
    path_events,
    tested_stability,
)
from cosserat_casadi.paths.margins import Key, margins, violated

RecordType = TypeVar("RecordType", bound="ContactPath")

MOST_CHANGES = 100
"""Most changes of the arrangement along a path."""

AT_ONCE = 1e-9
"""Differences of load factor and places below which two successive changes have made no progress."""

AT_SECTION = 1e-4
"""Distance of a place of contact from a section with a load below which the load has stopped the path."""


@dataclass(frozen=True, repr=False, kw_only=True)
class ContactPath(EquilibriumPath):
    """A path along which contacts come, go, slide and change between points and lines.

    Attributes:
        x: unknowns, forces and places of contact of each point: an array of k arrays, since their size changes with the
            contacts.
        arrangements: the arrangements of contacts that the path passes, one after the other.
        arrangement: index of the arrangement of each point, shape (k,).
    """

    arrangements: tuple[Arrangement, ...] = ()
    arrangement: npt.NDArray[np.int64] = field(default_factory=lambda: np.zeros(0, dtype=np.int64))

    @property
    def resolution_indices(self) -> FloatArray:
        """Resolution index at all points, shape (k,): a point with an index above 1 is not resolved."""
        return np.array([self.arrangements[number].resolution_index(z, factor) for z, factor, number in self._points])

    @property
    def stretches(self) -> list[range]:
        """Indices of the points between successive events, all of one arrangement."""
        # The event of a change of contact may be the first point of the next arrangement, before the points that
        # follow.
        changes = np.flatnonzero(np.diff(self.arrangement)) + 1
        others = [event.position for event in self.events if event.contact is None]
        bounds = [0, *sorted([*changes.tolist(), *others]), len(self.factor)]
        return [range(first, behind) for first, behind in pairwise(bounds)]

    def contacts(self, index: int) -> tuple[PathContact, ...]:
        """The contacts at a point of the path."""
        arrangement = self.arrangements[self.arrangement[index]]
        contacts = []
        for touch, ends, _ in arrangement.parts(self.x[index]):
            unit = self.model.discrete.contact_unit(touch.owner, of_body=touch.of_body)
            forces, inside = touch.sorted_forces(unit * ends)
            contacts.append(path_contact(touch, forces, inside))
        return tuple(contacts)

    def solution(self, index: int) -> Solution:
        """A point of the path as a solution with its contacts, judged like any other."""
        found = self.arrangements[self.arrangement[index]].equilibrium_at(self.x[index], float(self.factor[index]))
        return judged(found, holds=True, iterations=0, tolerance=NewtonSettings().tolerance)

    def shape(self, index: int, x: FloatArray, factor: float) -> Solution:
        """The equilibrium, not judged, with unknowns, forces and places of a point, or near them at another factor."""
        return self.arrangements[int(self.arrangement[index])].equilibrium_at(x, float(factor)).solution

    def event_shape(self, event: PathEvent) -> Solution:
        """The equilibrium, not judged, at an event with its contacts."""
        return self.arrangements[event.arrangement].equilibrium_at(event.x, event.factor).solution

    def _corrected(self, index: int, start: FloatArray, factor: float) -> FloatArray | None:
        """Unknowns, forces and places that solve the equations of a point's arrangement at another factor."""
        arrangement = self.arrangements[self.arrangement[index]]
        found = arrangement.curve.at(start / arrangement.scale, factor)
        return None if found is None else arrangement.scale * found

    @property
    def _points(self) -> Iterable[tuple[FloatArray, float, int]]:
        """Unknowns, factor and number of the arrangement of contacts of each point."""
        return zip(self.x, self.factor.tolist(), self.arrangement.tolist(), strict=True)

    def _tip(self, rod: str, x: FloatArray, factor: float, arrangement: int) -> SolvedPoses:
        """Pose of a rod's tip."""
        return self.arrangements[arrangement].poses(x, factor, TIP, rod)

    def _position(self, rod: str, X: float, x: FloatArray, factor: float, arrangement: int) -> FloatArray:
        """Position of a section of a rod, shape (3,), m."""
        return self.arrangements[arrangement].poses(x, factor, X, rod).position

    @property
    def stopped_at(self) -> str:
        """A sentence on a place of contact that has reached a load or another rod on its rod; empty if none has."""
        if self.outcome is not PathOutcome.LOAD_STALLED or not len(self.factor):
            return ""
        arrangement = self.arrangements[int(self.arrangement[-1])]
        sections = load_sections(arrangement.scene)
        for touch in arrangement.state(self.x[-1]).touches:
            for rod, place in touch.sought:
                for section in sections.get(rod, ()):
                    if abs(place - section) < AT_SECTION:
                        return (
                            f" The contact of {touch.owner!r} with {touch.obstacle!r} has come to X = {section:.6g}, "
                            "where a load or another rod acts: a path does not follow a contact past such a section. "
                            "A solve at larger factors finds it anew."
                        )
        return ""


@dataclass
class Guard:
    """Guard that ends steps of a path at a zero of a margin of its arrangement.

    Attributes:
        arrangement: the arrangement that is followed.
        crossed: the margin that has vanished, with its abscissa; None while all are positive.
    """

    arrangement: Arrangement
    crossed: tuple[Key, float] | None = None

    def __call__(self, arc: Arc, end: ArcPoint) -> ArcPoint | None:
        """The end of a step, or its first point with a margin of zero; None for a step that is too long."""
        arrangement = self.arrangement
        at_start = margins(arrangement, arrangement.z(arc.start), arc.start.load_factor)
        at_end = margins(arrangement, arrangement.z(end), end.load_factor)
        first, crossed = end, None
        for key in violated(at_end, arrangement.tolerance):
            before = at_start.get(key)
            if before is None or before.value <= 0.0:
                # It was zero to rounding already at the start of the step.
                zero: ArcPoint | None = arc.start
            else:
                zero = self._zero(Arc(arc.curve, arc.start, end), key)
            if zero is None:
                return None
            if crossed is None or zero.length < first.length:
                first, crossed = zero, key
        if crossed is None:
            # The rod may have passed a thin obstacle.
            return None if arrangement.goes_through(arc.start, end) else end
        found = margins(arrangement, arrangement.z(first), first.load_factor)
        if first is not arc.start:
            # Rods that touch this late in the step may have passed other thin rods or obstacles before.
            overlooked = any(key != crossed for key in violated(found, arrangement.tolerance))
            if overlooked or arrangement.goes_through(arc.start, first):
                return None
        self.crossed = (crossed, found[crossed].X)
        return first

    def _zero(self, arc: Arc, key: Key) -> ArcPoint | None:
        """The point at which a margin vanishes along a step."""

        def value(point: ArcPoint) -> float:
            found = margins(self.arrangement, self.arrangement.z(point), point.load_factor)
            return found[key].value

        return arc.zero(value)


@dataclass
class Travel:
    """The followed part of a path.

    Attributes:
        settings: limits.
        branch: number of the bifurcation at which to leave, see :func:`cosserat_casadi.follow`; 0 after leaving.
        arrangements: arrangements in the order of travel.
        points: points, with the index of the arrangement of each.
        events: events in the order of travel.
        outcome: how the path ended; None before its end.
        left_at: index of the first point on the branch.
        steps: number of tried steps.
    """

    settings: ArcSettings
    branch: int
    arrangements: list[Arrangement]
    points: list[tuple[int, ArcPoint]] = field(default_factory=list)
    events: list[PathEvent] = field(default_factory=list)
    outcome: PathOutcome | None = None
    left_at: int | None = None
    steps: int = 0

    def run(self, first: ArcPoint, progress: Progress | None) -> None:
        """Follow the path from a point of the first arrangement to its end."""
        point = first
        for _ in range(MOST_CHANGES):
            guard = Guard(self.arrangements[-1])
            self._follow(point, guard, progress)
            if self.outcome is not None:
                return
            entry = self._change(guard)
            if entry is None:
                self.outcome = PathOutcome.CONTACT_UNSETTLED
                return
            point = entry.point
        self.outcome = PathOutcome.MAX_STEPS

    def _follow(self, first: ArcPoint, guard: Guard, progress: Progress | None) -> None:
        """Follow one arrangement until the path or a margin ends it."""
        curve = guard.arrangement.curve
        traced = Trace([first])
        step = self.settings.first
        while traced.outcome is None and guard.crossed is None:
            if self.steps >= self.settings.steps:
                traced.outcome = PathOutcome.MAX_STEPS
                break
            step = extend(curve, traced, step, self._to_leave_at(traced), guard)
            self.steps += 1
            if progress is not None:
                progress(float(np.clip(traced.points[-1].load_factor, 0.0, 1.0)))
        self._keep(traced)

    def _to_leave_at(self, traced: Trace) -> int:
        """Number, counted in this arrangement, of the bifurcation at which to leave."""
        if not self.branch or traced.branch is not None:
            return 0
        before = sum(event.kind == "bifurcation" for event in self.events)
        return int(np.sign(self.branch)) * (abs(self.branch) - before)

    def _keep(self, traced: Trace) -> None:
        """Add the traced part of the last arrangement."""
        number = len(self.arrangements) - 1
        begun = len(self.points)
        self.events += path_events(traced, self.arrangements[-1].scale, begun, number)
        self.points += [(number, point) for point in traced.points]
        if traced.branch is not None:
            self.left_at = begun + traced.branch
            self.branch = 0
        self.outcome = traced.outcome

    def _change(self, guard: Guard) -> ArrangementEntry | None:
        """Enter the next arrangement; None if none is valid."""
        assert guard.crossed is not None
        key, X = guard.crossed
        arrangement = self.arrangements[-1]
        _, last = self.points[-1]
        for change in changes(arrangement, arrangement.z(last), last.load_factor, key, X):
            if not self._admits(change.state):
                continue
            entry = entered(arrangement, last, change)
            if entry is None:
                continue
            self._keep_change(entry, last)
            self.arrangements.append(entry.arrangement)
            return entry
        return None

    def _admits(self, state: ContactState) -> bool:
        """Whether contacts are followed."""
        return True

    def _keep_change(self, entry: ArrangementEntry, last: ArcPoint) -> None:
        """Add the event of a change, with the equilibrium of the last point before it or the first point after it."""
        number = len(self.arrangements) - 1
        point = last
        arrangement = self.arrangements[-1]
        beyond = len(self.points)
        if entry.is_event:
            number += 1
            point = entry.point
            arrangement = entry.arrangement
            beyond += 1
        touch = entry.change.touch
        if entry.is_event:
            touch = entry.arrangement.state(arrangement.z(point)).touches[entry.change.grows.number]
        self.events.append(
            PathEvent(
                entry.change.kind,
                point.load_factor,
                arrangement.z(point),
                1,
                beyond,
                arrangement=number,
                contact=path_contact(touch, ()),
            )
        )


def path_contact(touch: Touch, forces: tuple[float, ...], inside: tuple[SectionForce, ...] = ()) -> PathContact:
    """A contact at its place, with the forces at its ends and at sections inside it, N."""
    start, end = float(touch.start), float(touch.end)
    on_rods = None if touch.other is None else (start, float(touch.other))
    return PathContact(touch.obstacle, touch.owner, start, end, touch.kind, forces, touch.of_body, inside, on_rods)


def follow_contact_path(
    moved: InputChange[Model],
    *,
    branch: int = 0,
    settings: ArcSettings | None = None,
    progress: Progress | None = None,
) -> ContactPath:
    """Follow the equilibrium of a scene with obstacles, from one arrangement of contacts to the next.

    Args:
        moved: the change of inputs, and of parameters if the model has any.
        branch: as in :func:`cosserat_casadi.follow`.
        settings: limits.
        progress: receives the largest factor reached.
    """
    limits = settings or ArcSettings()
    potential = loads_have_potential(moved)
    empty = path_along(
        moved,
        ContactPath,
        PathOutcome.NO_START,
        factor=np.zeros(0),
        x=np.zeros(0),
        smallest_eigenvalue=np.zeros(0) if potential else None,
        neutral=np.zeros(0, dtype=np.bool_) if potential else None,
        events=(),
    )
    equations, z, message = beginning(moved)
    if equations is None:
        return replace(empty, message=empty.message + message)
    arrangement = Arrangement(equations, moved.change, potential, limits, z, 0.0)
    growing_load = np.append(np.zeros(len(z)), 1.0)
    first = arrangement.curve.point(arrangement.y(z, 0.0), growing_load, 0.0)
    if first is None:
        return empty
    travel = Travel(limits, branch, [arrangement])
    travel.run(first, progress)
    return record(empty, travel)


def beginning(moved: InputChange[Model]) -> tuple[ContactEquations | None, FloatArray, str]:
    """Equations of the contacts at factor 0 and their solution z; without an equilibrium None and a sentence on it."""
    model = moved.model
    scene = without_contacts(model.scene)
    grids = Grids(model.discretisation)
    given, theta = np.split(moved.base, [model.inputs.size])
    values = model.inputs.unpack(given)
    numbers = model.parameters.set_in(scene, model.parameters.unpack(theta)) if theta.size else scene
    start = solve_contact(numbers, grids, values)
    if not start.converged:
        return None, np.zeros(0), f" {start.message}"
    state = state_in(start.model.scene)
    settling = Settling(scene, given, grids, NewtonSettings(), max(scene.accuracy.tolerance, LEAST_TOLERANCE))
    equations = ContactEquations(scene, given, grids, state, theta)
    z = settling.solved(equations, start)
    return (None, np.zeros(0), "") if z is None else (equations, z, "")


def record(empty: RecordType, travel: Travel) -> RecordType:
    """The followed path as arrays."""
    outcome = travel.outcome or PathOutcome.MAX_STEPS
    numbers = np.array([number for number, _ in travel.points], dtype=np.int64)
    factors = np.array([point.load_factor for _, point in travel.points])
    unknowns = np.empty(len(travel.points), dtype=object)
    for index, (number, point) in enumerate(travel.points):
        unknowns[index] = travel.arrangements[number].z(point)
    smallest = empty.smallest_eigenvalue
    neutral = empty.neutral
    if smallest is not None:
        smallest, neutral = tested_stability(point for _, point in travel.points)
    return replace(
        empty,
        outcome=outcome,
        message=outcome.value,
        factor=factors,
        x=unknowns,
        smallest_eigenvalue=smallest,
        neutral=neutral,
        events=tuple(travel.events),
        branch=travel.left_at,
        arrangements=tuple(travel.arrangements),
        arrangement=numbers,
    )
