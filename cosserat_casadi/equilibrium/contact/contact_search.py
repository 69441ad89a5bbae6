"""Search for the contacts that hold, from a first guess: states are tried until one has no fault.

A state is at fault where a force pulls, or a section or a body is inside an obstacle; the fault suggests which states
to try next. Tried states are remembered and their number is bounded, so that the search ends; a search that ends
without a state that holds reports this. See docs/contact.md.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from math import inf

import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.equilibrium.contact.contact_alternatives import NEAR, instead_of_pulling, met, otherwise
from cosserat_casadi.equilibrium.contact.contact_equations import ContactEquations, Grids, Placed
from cosserat_casadi.equilibrium.contact.contact_newton import sought
from cosserat_casadi.equilibrium.contact.contact_state import (
    AT_END,
    BASE,
    TIP,
    ContactState,
    Touch,
    at_end,
    given_inputs,
    load_sections,
    state_in,
    without_contacts,
)
from cosserat_casadi.equilibrium.contact.gaps import (
    DENSE,
    body_gap,
    body_pairs,
    gap_along,
    lies_at_base,
    normals,
    obstacle_of,
    pairs,
    rod_pairs,
    runs,
)
from cosserat_casadi.equilibrium.contact.rod_gaps import RodsApart
from cosserat_casadi.equilibrium.solution import Solution
from cosserat_casadi.maths.chebyshev import legendre_polynomials
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.materials import BENDING
from cosserat_casadi.numerics.newton import NewtonSettings, newton, relative_norm
from cosserat_casadi.numerics.outcome import Outcome

MOST_STATES = 24
"""Most states that are tried."""

ROUNDING = 1e-12
"""Force, relative to the largest, that counts as zero."""

OPENING = 0.3
"""Share of the distance to the nearer end of a line, first guess of the stretch that opens inside the line."""

SHORT = 0.1
"""Length of a line beside a lifted section below which a point may remain of it."""

ALIKE = 0.05
"""Difference of places of contact below which two states are the same attempt."""

SHALLOW = 1e-12
"""Depth, relative to the length, that is rounding beside a point of contact."""

INDEPENDENT = 0.1
"""Sine of the angle between the normals of two obstacles above which a rod may touch both at one section."""

SAMPLES = np.linspace(0.0, 1.0, 41)
"""Number of places along a stretch at which its force per length is evaluated."""


@dataclass(frozen=True)
class ContactEquilibrium:
    """A state with a solution of its equations.

    Attributes:
        placed: the model with element ends at the contacts.
        x: unknowns.
        forces: forces of the contacts, without unit.
        solution: this equilibrium as a solution that is not judged yet.
    """

    placed: Placed
    x: FloatArray
    forces: FloatArray
    solution: Solution

    @property
    def state(self) -> ContactState:
        """The contacts."""
        return self.placed.state

    def parts(self) -> Iterator[tuple[Touch, FloatArray, FloatArray]]:
        """Each contact, the forces at its sections, and the coefficients of the force along it, without unit."""
        return self.state.with_forces(self.forces, self.placed.modes)

    @property
    def largest_force(self) -> float:
        """Scale of the forces, without unit: EI/ℓ², or the largest force at a section or along a line.

        The coefficients of a line are forces per length: of a short one they are larger than any force.
        """
        largest = 1.0
        for touch, carried, line in self.parts():
            largest = max(largest, float(np.abs(carried).max(initial=0.0)))
            if touch.is_line:
                _, pressure = self.pressure(touch, line)
                largest = max(largest, float(np.abs(pressure).mean() * (touch.end - touch.start)))
        return largest

    def pulls(self) -> Iterator[tuple[Touch, float]]:
        """Largest pull of each contact, relative to the largest force; 0 for a contact that only pushes."""
        for touch, carried, line in self.parts():
            least = min(float(carried.min()), self._least_along(touch, line))
            yield touch, max(-least, 0.0) / self.largest_force

    def pushes(self) -> Iterator[tuple[Touch, float]]:
        """Least push of each contact, where it would open first, relative to the largest force.

        Forces at the tip and at sections inside a line may be zero and do not count.
        """
        for touch, carried, line in self.parts():
            opens = carried.tolist()
            if touch.is_line:
                opens = [force for force, moves in zip(opens, touch.carriers_move, strict=True) if moves]
            yield touch, min([*opens, self._least_along(touch, line)]) / self.largest_force

    def _least_along(self, touch: Touch, line: FloatArray) -> float:
        """Least force per length of a line times its length, without unit; infinite for a point."""
        if not touch.is_line:
            return inf
        _, pressure = self.pressure(touch, line)
        width = float(touch.end) - float(touch.start)
        return float(pressure.min()) * width

    def pressure(self, touch: Touch, line: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Abscissae along a line of contact and the force per length there, without unit."""
        return pressure_along(touch, line, self.placed.modes[touch.owner])

    def weakest(self, touch: Touch) -> float:
        """Abscissa at which a line presses least, or pulls most, sections with forces included."""
        for other, carried, line in self.parts():
            if other != touch:
                continue
            X, pressure = self.pressure(touch, line)
            sections = np.array(touch.carriers)
            forces = np.concatenate([pressure * (touch.end - touch.start), carried])
            return float(np.concatenate([X, sections])[forces.argmin()])
        raise ValueError("no contact of this state")

    def risen(self, touch: Touch, section: float) -> float:
        """Length of rod that rises on either side of a section that pulls; 0 if the section does not pull.

        A load P raises a heavy straight beam of the weight q per length from a plane over 3P/4q on either side.
        """
        for other, carried, line in self.parts():
            if other == touch:
                _, pressure = self.pressure(touch, line)
                weight = float(np.median(pressure))
                pulls = dict(zip(touch.carriers, -carried, strict=True))
                return 0.75 * float(pulls.get(section, 0.0)) / weight if weight > 0.0 else 0.0
        raise ValueError("no contact of this state")

    def penetrations(self, tolerance: float) -> Iterator[Penetrated]:
        """Stretches and bodies that are inside an obstacle by more than a tolerance."""
        for rod, obstacle in pairs(self.placed.model.scene):
            X = np.union1d(DENSE, self._beside_contacts(rod))
            yield from _inside(rod, obstacle.name, X, gap_along(self.solution, rod, obstacle, X), tolerance)
        for rod, other in rod_pairs(self.placed.model.scene):
            apart = RodsApart.of(self.solution, (rod, other))
            valleys = [valley.places[0] for valley in apart.valleys]
            X = np.unique([*DENSE, *self._beside_contacts(rod), *valleys])
            gaps, others = apart.gaps(X)
            for penetrated in _inside(rod, other, X, gaps, tolerance):
                yield replace(penetrated, other=float(others[np.searchsorted(X, penetrated.deepest)]))
        for body, obstacle in body_pairs(self.placed.model.scene):
            gap = body_gap(self.solution, body, obstacle)
            if gap < -tolerance:
                yield Penetrated(body.name, obstacle.name, 0.0, 0.0, 0.0, -gap, of_body=True)

    def _beside_contacts(self, rod: str) -> FloatArray:
        """Abscissae close to the places of contact, where a rod starts to enter the obstacle beyond a line."""
        distances = np.geomspace(1e-4, 2e-2, 12)
        beside = np.concatenate([-distances, distances])
        ends = np.array([end for touch in self.state.along(rod) for end in touch.ends], dtype=float)
        X = (ends[:, None] + beside).ravel()
        return np.asarray(X[(X > 0.0) & (X < 1.0)])

    def unmet(self) -> float:
        """Bound on the error of poses, places and forces because contacts hold only to a tolerance.

        A stretch inside an obstacle has the error of its depth and of the angle at which it enters, which turns the rod
        beyond it. If points approximate a line of contact there, they should be at the ends of the stretch. A contact
        that pulls has its force as error. The depth along a line is an error of the modes.
        """
        pulls = [pull * self.largest_force for _, pull in self.pulls()]
        entered = [penetrated.error(self.state.touches) for penetrated in self.penetrations(SHALLOW)]
        return max([0.0, *pulls, *entered])


@dataclass(frozen=True)
class Penetrated:
    """A stretch of a rod, or a body, that is inside an obstacle.

    Attributes:
        owner: name of the rod, or of the body, that is inside.
        obstacle: name of the obstacle.
        start: abscissa of its first section.
        end: abscissa of its last section.
        deepest: abscissa of the section that is deepest inside.
        depth: depth of that section, over the length of the rod.
        angle: largest angle between the rod and the obstacle, rad; 0 for a body.
        of_body: whether it is a body.
        other: abscissa of the second of two rods that are inside each other, where they are deepest; else None.
    """

    owner: str
    obstacle: str
    start: float
    end: float
    deepest: float
    depth: float
    angle: float = 0.0
    of_body: bool = False
    other: float | None = None

    def joined(self, other: Penetrated) -> Penetrated:
        """The union of this stretch and another, from the start of the first to the end of the last."""
        deeper = self if self.depth >= other.depth else other
        return replace(deeper, start=min(self.start, other.start), end=max(self.end, other.end))

    @property
    def point(self) -> Touch:
        """A point of contact where the stretch is deepest; at an end of its rods where that is near."""
        if self.other is not None:
            return Touch.of_rods((self.owner, self.obstacle), (at_end(self.deepest), at_end(self.other)))
        return Touch.point(self.obstacle, self.owner, self.deepest if self.deepest < TIP - AT_END else TIP)

    def concerns(self, touch: Touch) -> bool:
        """Whether a contact has the rod, or body, and the obstacle of this stretch."""
        return (touch.owner, touch.obstacle, touch.of_body) == (self.owner, self.obstacle, self.of_body)

    def error(self, touches: Sequence[Touch]) -> float:
        """Bound on the error of poses and places because the stretch is inside, beside the contacts of its state."""
        own = [touch for touch in touches if self.concerns(touch)]
        if any(self.is_along(touch) for touch in own):
            return 0.0
        off = [self.depth, self.angle]
        if own and not any(touch.is_line for touch in own):
            # Points should be at the ends of the stretch, and none of it is between two points that suffice.
            first = min(touch.start for touch in own)
            last = max(touch.end for touch in own)
            off += [first - self.start, self.end - last, min(self.end, last) - max(self.start, first)]
        return max(off)

    def is_at(self, touch: Touch) -> bool:
        """Whether the stretch is next to a contact."""
        return bool(self.concerns(touch) and touch.start - NEAR <= self.end and self.start <= touch.end + NEAR)

    def is_along(self, touch: Touch) -> bool:
        """Whether the stretch is inside a line of contact: then its depth is an error of polynomials."""
        return bool(touch.is_line and touch.start < self.deepest < touch.end)


def _inside(owner: str, obstacle: str, X: FloatArray, gaps: FloatArray, tolerance: float) -> Iterator[Penetrated]:
    """Stretches of a rod whose gaps at abscissae X are below zero by more than a tolerance."""
    slopes = np.abs(np.gradient(gaps, X))
    for stretch in runs(gaps < -tolerance):
        inside = X[stretch]
        deepest = int(np.argmin(gaps[stretch]))
        places = inside[0], inside[-1], inside[deepest]
        angle = float(slopes[stretch].max())
        yield Penetrated(owner, obstacle, *places, -gaps[stretch][deepest], angle)


@dataclass
class Settling:
    """The search for a state that holds.

    Attributes:
        scene: without contacts.
        given: its stacked inputs.
        grids: modes and nodes of every element.
        newton: limits of the solve of each state.
        tolerance: depth and pull, relative, up to which a state holds.
        error: error of places and poses up to which a state holds whose depth is within the tolerance.
        iterations: Newton steps so far.
        squeezed: the contacts of the last state that was not solved, at their last places; None if all were solved.
    """

    scene: scenes.Scene
    given: FloatArray
    grids: Grids
    newton: NewtonSettings
    tolerance: float
    error: float = inf
    iterations: int = 0
    squeezed: ContactState | None = None

    @cached_property
    def sections(self) -> dict[str, tuple[float, ...]]:
        """Abscissae inside each rod at which lines of contact have seams, by name."""
        return load_sections(self.scene)

    def run(
        self, guesses: Sequence[tuple[ContactState, Solution]], admits: Callable[[Solution], bool]
    ) -> tuple[ContactEquilibrium | None, bool]:
        """Try states until one holds.

        Args:
            guesses: the first states, the likeliest first, each with a shape to start from.
            admits: whether the rods can have reached a shape; Newton's method may lead behind an obstacle.

        Returns:
            the state that holds, or the last one that was solved; whether it holds.
        """
        waiting = list(guesses)
        tried: list[ContactState] = []
        last: ContactEquilibrium | None = None
        while waiting and len(tried) < MOST_STATES:
            candidate, start = waiting.pop(0)
            candidate = candidate.apart(partial(_press_apart, start))
            candidate = candidate.split(self.sections).seamed
            if not candidate.in_order or any(self._alike(candidate, other) for other in tried):
                continue
            if any(touch.starts_at_base and not _lies_at_base(start, touch) for touch in candidate.touches):
                continue
            tried.append(candidate)
            found = self.solve(candidate, start)
            if found is None:
                # After places have met something the state beyond it is the likeliest.
                beyond = [] if self.squeezed is None else list(met(self.squeezed, self.sections))
                waiting = [(other, start) for other in beyond] + waiting
                waiting += [(other, start) for other in otherwise(candidate, self.sections)]
                continue
            others = list(next_states(found, self.tolerance, self.error))
            if not others and not admits(found.solution):
                continue
            last = found
            if not others:
                return found, True
            # States that follow from a solved state come before guesses.
            waiting = [(other, found.solution) for other in others] + waiting
        return last, False

    def _alike(self, first: ContactState, second: ContactState) -> bool:
        """Whether two states are the same attempt; beside a section with a load small differences matter."""
        if first.signature != second.signature:
            return False
        lines = [pair for pair in zip(first.touches, second.touches, strict=True) if pair[0].is_line]
        same_seams = all(self._seams_at_loads(one) == self._seams_at_loads(other) for one, other in lines)
        beside = [
            min((abs(place - section) for section in self.sections[rod]), default=inf)
            for touch in second.touches
            for rod, place in touch.sought
        ]
        near = np.abs(first.places - second.places) < np.minimum(ALIKE, np.array(beside) / 2)
        return bool(same_seams and np.all(near))

    def _seams_at_loads(self, touch: Touch) -> set[float]:
        """Seams of a line of contact at sections with loads; other seams move with the contacts there."""
        return set(touch.seams) & set(self.sections[touch.owner])

    def solve(self, state: ContactState, near: Solution) -> ContactEquilibrium | None:
        """Solve the equations of one state from a nearby shape; None if Newton's method does not converge."""
        equations = ContactEquations(self.scene, self.given, self.grids, state)
        z = self.solved(equations, near)
        if z is None:
            return None
        found = contact_equilibrium(equations, z, self.given)
        if self.squeezed is None:
            return found
        # A small residual does not determine forces of a stretch: places that moved far are solved for again.
        beside = ContactEquations(self.scene, self.given, self.grids, found.state)
        z, solved, taken = sought(beside, beside.start_near(found.solution), self.newton)
        self.iterations += taken
        return contact_equilibrium(beside, z, self.given) if solved else found

    def solved(self, equations: ContactEquations, near: Solution) -> FloatArray | None:
        """Unknowns, forces and places that solve equations, from a nearby shape."""
        return self.solved_from(equations, equations.start_near(near))

    def solved_from(self, equations: ContactEquations, start: FloatArray) -> FloatArray | None:
        """Unknowns, forces and places that solve equations, from a start z; None if the solve fails."""
        self.squeezed = None
        if len(equations.state.places):
            z, solved, taken = sought(equations, start, self.newton)
            self.iterations += taken
            if solved:
                return z
            _, _, places = equations.parts(z)
            self.squeezed = equations.state.at(places.tolist())
        result = newton(equations.equations, start, self.newton)
        self.iterations += result.iterations
        if result.outcome is not Outcome.CONVERGED:
            return None
        return result.x


def contact_equilibrium(equations: ContactEquations, z: FloatArray, given: FloatArray) -> ContactEquilibrium:
    """The solution z of the equations of a state, for stacked inputs of its scene."""
    x, forces, places = equations.parts(z)
    # A force that is rounding alone counts as zero.
    forces = np.where(np.abs(forces) <= ROUNDING * np.abs(forces).max(initial=0.0), 0.0, forces)
    placed = equations.placed(equations.state.at(places.tolist()), given)
    x = x / equations.moved_strains(places)
    outcome = Outcome.CONVERGED
    norm = relative_norm(equations.residual(z, given), z)
    solution = Solution(placed.model, placed.inputs(forces), x, outcome, outcome.value, norm, iterations=0)
    return ContactEquilibrium(placed, x, forces, solution)


def equilibrium_in(solution: Solution) -> ContactEquilibrium:
    """The contacts among the loads of a solution's scene, with their forces."""
    model = solution.model
    modes = Grids(model.discretisation).bending_modes(without_contacts(model.scene))
    placed = Placed(model, state_in(model.scene), given_inputs(model, solution.inputs), modes)
    forces = solution.inputs[placed.force_entries] / placed.force_units
    return ContactEquilibrium(placed, solution.x, forces, solution)


def equations_at(solution: Solution) -> tuple[ContactEquations, FloatArray]:
    """The equations of the contacts of a solution, and their solution z."""
    found = equilibrium_in(solution)
    scene = without_contacts(solution.model.scene)
    equations = ContactEquations(scene, found.placed.given, Grids(solution.model.discretisation), found.state)
    return equations, np.concatenate([found.x, found.forces, found.state.places])


def pressure_along(touch: Touch, line: FloatArray, modes: int) -> tuple[FloatArray, FloatArray]:
    """Abscissae along a line of contact and the force per length there, without unit.

    Args:
        touch: the line.
        line: coefficients of its force per length.
        modes: polynomials of the curvature of its rod.
    """
    X = []
    pressure = []
    for start, end, own in touch.by_stretch(line, modes):
        X.append(start + (end - start) * SAMPLES)
        pressure.append(legendre_polynomials(len(own), SAMPLES) @ own)
    return np.concatenate(X), np.concatenate(pressure)


@dataclass(frozen=True)
class Replacement:
    """States of one contact that may replace a contact that is at fault.

    Attributes:
        touch: the contact; None for a stretch inside an obstacle away from all contacts.
        options: contacts to try in its place, the likeliest first.
    """

    touch: Touch | None
    options: tuple[tuple[Touch, ...], ...]


def next_states(found: ContactEquilibrium, tolerance: float, error: float = inf) -> Iterator[ContactState]:
    """States to try instead of a state at fault, the likeliest first; none for a state that holds.

    Args:
        found: the state.
        tolerance: depth and pull up to which a state holds.
        error: error of a stretch inside an obstacle up to which a state holds, however shallow the stretch is.
    """
    pulling = [touch for touch, pull in found.pulls() if pull > tolerance]
    changes = [Replacement(touch, tuple(_where_it_opens(found, touch))) for touch in pulling]
    for penetrated, touch in _by_touch(found, tolerance, error):
        # No change of the state mends a depth inside a line.
        if touch is not None and penetrated.is_along(touch):
            continue
        if touch not in pulling:
            changes.append(Replacement(touch, tuple(_instead_of_entering(penetrated, touch))))
    changed = [change.touch for change in changes]
    for touch in found.state.touches:
        # If the base lies on the obstacle only rounding decides where the line begins.
        beside_base = touch.is_line and not touch.starts_at_base and touch.start < NEAR
        if beside_base and touch not in changed and _lies_at_base(found.solution, touch):
            changes.append(Replacement(touch, ((replace(touch, start=BASE),),)))
    if not changes:
        return
    # All contacts at fault are changed at once, then each in another way.
    likeliest = [(change.touch, change.options[0]) for change in changes]
    yield _changed(found.state, likeliest)
    for index, change in enumerate(changes):
        others = likeliest[:index] + likeliest[index + 1 :]
        for option in change.options[1:]:
            yield _changed(found.state, [*others, (change.touch, option)])


def _press_apart(solution: Solution, one: Touch, other: Touch) -> bool:
    """Whether a rod that bends to all sides may touch two obstacles at one section: their normals are independent."""
    if one.rods != (one.owner,) or other.rods != one.rods or one.obstacle == other.obstacle:
        return False
    scene = solution.model.scene
    (rod,) = [rod for rod in scene.rods if rod.name == one.owner]
    if not set(BENDING) <= set(rod.admitted):
        return False
    X = np.array([max(one.start, other.start)])
    first, second = (normals(solution, rod.name, obstacle_of(scene, touch.obstacle), X)[0] for touch in (one, other))
    return bool(np.linalg.norm(np.cross(first, second)) > INDEPENDENT)


def _lies_at_base(solution: Solution, touch: Touch) -> bool:
    return lies_at_base(solution, touch.owner, obstacle_of(solution.model.scene, touch.obstacle))


def _by_touch(found: ContactEquilibrium, tolerance: float, error: float) -> list[tuple[Penetrated, Touch | None]]:
    """Stretches inside an obstacle, each with its adjacent contact; stretches on both sides of one are joined."""
    alone: list[tuple[Penetrated, Touch | None]] = []
    joined: dict[Touch, Penetrated] = {}
    # A short line is shallow, however large the error of its places is.
    for penetrated in found.penetrations(min(tolerance, SHALLOW) if error < inf else tolerance):
        if penetrated.depth <= tolerance and penetrated.error(found.state.touches) <= error:
            continue
        touch = next((touch for touch in found.state.touches if penetrated.is_at(touch)), None)
        if touch is None:
            alone.append((penetrated, None))
        else:
            joined[touch] = penetrated.joined(joined.get(touch, penetrated))
    return [*alone, *((penetrated, touch) for touch, penetrated in joined.items())]


def _changed(state: ContactState, changes: Sequence[tuple[Touch | None, tuple[Touch, ...]]]) -> ContactState:
    """The state with some contacts replaced by others; None adds contacts without a replacement."""
    replaced = {old for old, _ in changes}
    kept = [touch for touch in state.touches if touch not in replaced]
    added = [touch for _, new in changes for touch in new]
    return ContactState.of([*kept, *added])


def _where_it_opens(found: ContactEquilibrium, touch: Touch) -> Iterator[tuple[Touch, ...]]:
    """Contacts to try instead of one that pulls; first two lines for a line that is lifted in its middle."""
    if touch.is_line:
        # Pushing forces cannot balance a moment: a line opens at the section of the moment, wherever it pulls most.
        for lifted in dict.fromkeys([found.weakest(touch), *touch.seams]):
            reach = found.risen(touch, lifted)
            if 0.0 < reach < min(lifted - touch.start, touch.end - lifted):
                yield _sides(touch, lifted, reach)
            yield from _opened(touch, lifted)
    yield from instead_of_pulling(touch)


def _sides(touch: Touch, lifted: float, reach: float) -> tuple[Touch, Touch]:
    """The two lines on both sides of a section, if the line between rises over a reach to each side."""
    return replace(touch, end=lifted - reach, seams=()), replace(touch, start=lifted + reach, seams=())


def _opened(touch: Touch, lifted: float) -> Iterator[tuple[Touch, ...]]:
    """Both sides of a line that rises around a section inside it; a short side becomes a point, or is left out."""
    before = lifted - touch.start
    after = touch.end - lifted
    if not before > 0.0 < after:
        return
    first, last = _sides(touch, lifted, OPENING * min(before, after))
    parts = [part for part, length in ((first, before), (last, after)) if length >= NEAR]
    if parts:
        yield tuple(parts)
    if min(before, after) < SHORT <= max(before, after):
        # The risen stretch may be longer than the short side, of which a point remains.
        if before < after:
            short, start, end = touch.start, lifted + NEAR, touch.end
        else:
            short, start, end = touch.end, touch.start, lifted - NEAR
        point = Touch.point(touch.obstacle, touch.owner, short)
        line = Touch.line(touch.obstacle, touch.owner, start, end)
        yield (point, line) if before < after else (line, point)


def _instead_of_entering(penetrated: Penetrated, touch: Touch | None) -> Iterator[tuple[Touch, ...]]:
    """Contacts that keep a stretch out of an obstacle, additional ones or instead of the adjacent contact."""
    if penetrated.of_body:
        yield (Touch.ball(penetrated.obstacle, penetrated.owner),)
        return
    point = penetrated.point
    if touch is None:
        yield (point,)
        return
    if point.other is not None:
        # An end that lifts off leaves a section inwards to touch; two rods may touch at two places.
        both, alone = (touch, point), (point,)
        yield from (alone, both) if any(place is not None for place in touch.held_at) else (both, alone)
        return
    start = min(penetrated.start, touch.start)
    end = max(penetrated.end, touch.end)
    line = Touch.line(penetrated.obstacle, penetrated.owner, start, end)
    if touch.is_line:
        yield (line,)
        yield (touch, point)
    elif touch.end == TIP:
        # If a tip lifts off, a section further inwards touches, or the rod lies down.
        inwards = Touch.point(penetrated.obstacle, penetrated.owner, min(point.start, TIP - 2 * NEAR))
        yield (inwards,)
        yield (line,)
        yield (inwards, touch)
    else:
        yield (line,)
        yield (touch, point)
        yield (point,)
