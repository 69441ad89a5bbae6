"""Exact contact as equations that do not change as contacts come and go: relaxed pairs of force and gap at sections.

An optimiser changes the contacts, but its equations must not change. So each of a number of sections has a
dimensionless force N and a gap g over the length, with the complementarity of a cable that may go slack,

    N + g − √(N² + g² + ε²) = 0,    which is N g = ε²/2 with N, g > 0.

Forces and gaps are those of the exact law: a section is a contact at a point, where an element ends. The smoothing ε
and the abscissae of the sections are parameters of the equations. As ε goes to zero each section obeys the exact law;
rods may enter obstacles between sections, so that touching sections are moved to the places of the exact contacts.

Two rods that touch have one pair, at a section of either whose abscissae s follow from unknowns y of any size: the gap
is least there, but for a barrier that keeps the sections off the ends of their rods,

    s = (1 + y/√(1 + y²))/2,    ∂g/∂s − b/s + b/(1 − s) = 0,    b = ε²/2 and a rest that keeps elements from vanishing.
"""

from __future__ import annotations

from bisect import bisect
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import casadi as ca
import numpy as np
import numpy.typing as npt

from cosserat_casadi import scene as scenes
from cosserat_casadi.constraints.cable_length import pair_kernel
from cosserat_casadi.equilibrium.contact.contact_equations import BehindPlaces, ContactEquations, Grids
from cosserat_casadi.equilibrium.contact.contact_search import contact_equilibrium
from cosserat_casadi.equilibrium.contact.contact_solve import solve_contact
from cosserat_casadi.equilibrium.contact.contact_state import (
    AT_END,
    SHORTEST,
    TIP,
    ContactState,
    Touch,
    at_end,
    given_inputs,
    load_sections,
    without_contacts,
)
from cosserat_casadi.equilibrium.contact.gap_rows import force_widths
from cosserat_casadi.equilibrium.contact.gaps import body_pairs, pairs, rod_pairs
from cosserat_casadi.equilibrium.contact.rod_gaps import RodsApart
from cosserat_casadi.equilibrium.contact.shape_projection import projected
from cosserat_casadi.equilibrium.load_path import column
from cosserat_casadi.equilibrium.solution import Solution
from cosserat_casadi.errors import Problem, SceneError, refuse
from cosserat_casadi.maths.typing import Columns, FloatArray, Matrix
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.inputs import InputLayout
from cosserat_casadi.numerics.newton import Equations, NewtonSettings, newton
from cosserat_casadi.numerics.outcome import Outcome

SECTIONS = 8
"""Sections of a rod that may touch an obstacle."""

FIRST_PLACE = 0.5
"""Abscissa on both rods at which two that touch are divided first."""

MODES = 2
"""Polynomials of each strain between two sections: without other loads the moment is linear there."""

NODES = 4
"""Intervals of the integration between two sections."""

LAST_BARRIER = SHORTEST / 2
"""Barrier b without smoothing: an end on which a gap of the slope 1/2 presses a section keeps SHORTEST from it."""

FIRST_SMOOTHING = 1e-2
"""First smoothing ε: gap times force is 5e-5 in units of the length and of EI/ℓ²."""


@dataclass(frozen=True)
class RelaxedContact:
    """A scene in exact contact as functions of its unknowns z = (x, N, y), its inputs, and p = (ε, abscissae).

    Behind the forces stand the numbers y of the abscissae at which rods touch rods. The abscissae in p are of
    sections that touch obstacles.

    Attributes:
        model: the model of the scene, with the modes for exact contacts.
        equations: the contact equations with every section as a contact.
    """

    model: Model
    equations: ContactEquations

    @property
    def inputs(self) -> InputLayout:
        """Names, order and default values of the inputs of the model."""
        return self.model.inputs

    @property
    def size(self) -> int:
        """Number of unknowns, of forces, and of places at which rods touch rods."""
        return int(self._written.z.shape[0])

    @property
    def parameters(self) -> BehindPlaces:
        """Layout of the smoothing and the abscissae, for which the scene has no names."""
        return BehindPlaces((), places=len(self.defaults))

    @property
    def defaults(self) -> FloatArray:
        """The first smoothing, and abscissae that are evenly spread, shape (1 + sections,)."""
        return np.concatenate([[FIRST_SMOOTHING], self.equations.state.places[~self._sought]])

    @cached_property
    def _sought(self) -> npt.NDArray[np.bool_]:
        """Mask of the places of the state that are unknowns, at which rods touch rods."""
        return sought_places(self.equations.state)

    def _places(self, z: FloatArray, p: FloatArray) -> FloatArray:
        """All places of the state."""
        places = np.empty(len(self._sought))
        numbers = z[len(z) - int(self._sought.sum()) :]
        places[self._sought] = _abscissae(numbers)
        places[~self._sought] = p[1:]
        return places

    @cached_property
    def residual(self) -> ca.Function:
        """(z, inputs, p) ↦ balance and pairs."""
        return self._function("residual", self._written.residual)

    @cached_property
    def jacobian(self) -> ca.Function:
        """(z, inputs, p) ↦ derivative of the residual by z, and the residual."""
        return self._function("jacobian", self._written.jacobian, self._written.residual)

    @cached_property
    def input_jacobian(self) -> ca.Function:
        """(z, inputs, p) ↦ derivative of the residual by the inputs."""
        return self._function("input_jacobian", ca.jacobian(self._written.residual, self._written.inputs))

    @cached_property
    def parameter_jacobian(self) -> ca.Function:
        """(z, inputs, p) ↦ derivative of the residual by p."""
        return self._function("parameter_jacobian", ca.jacobian(self._written.residual, self._written.p))

    @cached_property
    def tip(self) -> dict[str, ca.Function]:
        """(z, inputs, p) ↦ position, m, quaternion and rotation of the tip, by rod."""
        return {name: self._pose(pose) for name, pose in self.equations.model.tip.items()}

    @cached_property
    def body(self) -> dict[str, ca.Function]:
        """(z, inputs, p) ↦ position, m, quaternion and rotation of a body, by body."""
        return {name: self._pose(pose) for name, pose in self.equations.model.body.items()}

    @cached_property
    def tip_jacobian(self) -> dict[str, ca.Function]:
        """(z, inputs, p) ↦ derivatives of the tip's position and quaternion by each argument, 7×… each, by rod."""
        return {name: self._slopes(pose) for name, pose in self.tip.items()}

    @cached_property
    def body_jacobian(self) -> dict[str, ca.Function]:
        """(z, inputs, p) ↦ derivatives of a body's position and quaternion by each argument, 7×… each, by body."""
        return {name: self._slopes(pose) for name, pose in self.body.items()}

    def near(self, solution: Solution, p: npt.ArrayLike | None = None) -> FloatArray:
        """Unknowns and forces in relaxed balance near an equilibrium of the scene, at its inputs, shape (size,).

        Newton's method solves for them; if it fails, unknowns and forces of the equilibrium are returned.

        Args:
            solution: an equilibrium of :attr:`model`, or of another model of the scene.
            p: smoothing and abscissae; by default :attr:`defaults`.
        """
        at = np.asarray(self.defaults if p is None else p, dtype=float)
        touching = self._touching(solution)
        equations = replace(self.equations, state=self.equations.state.at(self._places(touching, at).tolist()))
        inputs = given_inputs(solution.model, solution.inputs)
        z = equations.start_from(projected(solution, equations.nominal.model), inputs)
        x, forces, places = equations.parts(z)
        start = np.concatenate([self.equations.moved_strains(places) * x, np.maximum(forces, 0.0), touching])
        relaxed = newton(
            Equations(
                lambda z: column(self.residual(z, inputs, at)),
                lambda z: np.asarray(self.jacobian(z, inputs, at)[0].full()),
            ),
            start,
            NewtonSettings(),
        )
        return relaxed.x if relaxed.outcome is Outcome.CONVERGED else start

    def _touching(self, solution: Solution) -> FloatArray:
        """Numbers y of where rods touch rods in a solution, or are nearest to each other, shape (places of rods,)."""
        known = {(contact.owner, contact.obstacle): contact.on_rods for contact in solution.contacts}
        places: list[float] = []
        for touch in self.equations.state.touches:
            if touch.other is None:
                continue
            at = known.get((touch.owner, touch.obstacle))
            if at is None:
                at = min(RodsApart.of(solution, (touch.owner, touch.obstacle)).valleys, key=lambda own: own.gap).places
            places += at
        offsets = 2 * np.clip(np.array(places), AT_END, TIP - AT_END) - 1
        return np.asarray(offsets / np.sqrt(1 - offsets**2))

    def solution(self, z: FloatArray, inputs: FloatArray, p: FloatArray) -> Solution:
        """The shape of unknowns z as a solution that is not judged, with a contact at every section."""
        return self._equilibrium(z, inputs, p)[0]

    def exact(self, z: FloatArray, inputs: FloatArray, p: FloatArray) -> Solution:
        """The equilibrium in exact contact at these inputs, solved from the sections that press.

        Args:
            z: unknowns and forces of a problem, shape (size,).
            inputs: stacked inputs, shape (inputs.size,).
            p: smoothing and abscissae.
        """
        relaxed, contacts = self._equilibrium(z, inputs, p)
        scene = self.equations.scene
        values = self.model.inputs.unpack(inputs)
        grids = Grids(self.model.discretisation)
        return solve_contact(scene, grids, values, start=relaxed, contacts=contacts)

    def moved_to(self, solution: Solution, p: FloatArray) -> FloatArray:
        """The parameters p with the sections nearest to a solution's contacts moved to the contacts' places."""
        places = self.equations.state.places
        places[~self._sought] = p[1:]
        touches = list(self.equations.state.at(places.tolist()).touches)
        loads = load_sections(self.equations.scene)
        for owner, obstacle in {(contact.owner, contact.obstacle) for contact in solution.contacts}:
            numbers = [
                number
                for number, touch in enumerate(touches)
                if (touch.owner, touch.obstacle) == (owner, obstacle) and any(touch.moves) and touch.other is None
            ]
            places = {
                place
                for contact in solution.contacts
                if (contact.owner, contact.obstacle) == (owner, obstacle)
                for place in (contact.start, contact.end)
                if place < TIP
            }
            if numbers:
                sections = _nearest([touches[number].start for number in numbers], sorted(places), loads[owner])
                for number, section in zip(numbers, sections, strict=True):
                    touches[number] = touches[number].moved([section])
        moved = ContactState(tuple(touches)).places
        return np.concatenate([p[:1], moved[~self._sought]]) if self.equations.in_order(moved) else p

    def _equilibrium(self, z: FloatArray, inputs: FloatArray, p: FloatArray) -> tuple[Solution, ContactState]:
        own = z[: len(z) - int(self._sought.sum())]
        equilibrium = contact_equilibrium(self.equations, np.concatenate([own, self._places(z, p)]), inputs)
        return equilibrium.solution, _pressing(equilibrium.state, equilibrium.forces, p[0] / np.sqrt(2))

    @cached_property
    def _written(self) -> _Written:
        return _Written.of(self.equations)

    def _function(self, name: str, *results: Matrix) -> ca.Function:
        arguments = self._written.arguments
        outputs = [f"{name}_{i}" for i in range(len(results))]
        return ca.Function(name, arguments, list(results), ["x", "inputs", "p"], outputs)

    def _pose(self, function: ca.Function) -> ca.Function:
        return self._function("pose", *function.call(self._written.at))

    def _slopes(self, function: ca.Function) -> ca.Function:
        arguments = self._written.arguments
        position, quaternion, _ = function(*arguments)
        pose = ca.vertcat(position, quaternion)
        return self._function("slopes", *[ca.densify(ca.jacobian(pose, argument)) for argument in arguments])


@dataclass(frozen=True)
class _Written:
    """The equations as expressions of z, inputs and p.

    Attributes:
        z: unknowns and forces.
        inputs: of the scene.
        p: smoothing and abscissae.
        at: arguments of the functions of the model with element ends at the sections.
        residual: balance, then pairs.
        jacobian: its derivative by z.
    """

    z: ca.MX
    inputs: ca.MX
    p: ca.MX
    at: list[Matrix]
    residual: Matrix
    jacobian: Matrix

    @property
    def arguments(self) -> list[ca.MX]:
        """Arguments of all functions."""
        return [self.z, self.inputs, self.p]

    @classmethod
    def of(cls, equations: ContactEquations) -> _Written:
        """The expressions for the equations of sections that may touch."""
        written = equations.written
        x, forces, places = written.unknowns
        size, count = x.shape[0], forces.shape[0]
        mask = sought_places(equations.state)
        sought, given = np.flatnonzero(mask).tolist(), np.flatnonzero(~mask).tolist()
        # Rows without a width are slopes of gaps, one for each place: sections beside obstacles have fixed places.
        widths = force_widths(equations.state, written.modes)
        gap_rows = [size + number for number, width in enumerate(widths) if width is not None]
        slope_rows = [size + number for number, width in enumerate(widths) if width is None]
        smoothing = ca.MX.sym("smoothing")
        kernel = pair_kernel(slack=True, softness=1.0).map(count)
        row = written.residual[gap_rows].T
        residuals, by_gap, by_force = kernel(row, forces.T, ca.repmat(smoothing, 1, count))
        columns = [*range(size + count), *(size + count + place for place in sought)]
        whole = written.jacobian[:, columns]
        by_forces = ca.horzcat(ca.MX(count, size), ca.diag(by_force.T), ca.MX(count, len(sought)))
        pairs_by_z = ca.diag(by_gap.T) @ whole[gap_rows, :] + by_forces
        z = ca.MX.sym("z", size + count + len(sought))
        p = ca.MX.sym("p", 1 + len(given))
        at = [x, equations.nominal.written_inputs(written.given, forces)]
        if places.shape[0]:
            at.append(places)
        residual = [written.residual[:size], residuals.T]
        jacobian = [whole[:size, :], pairs_by_z]
        if sought:
            barrier = smoothing**2 / 2 + LAST_BARRIER
            at_sections = places[sought]
            slopes = [slope_rows[place] for place in sought]
            residual.append(written.residual[slopes] - barrier / at_sections + barrier / (1 - at_sections))
            stiffness = barrier / at_sections**2 + barrier / (1 - at_sections) ** 2
            jacobian.append(whole[slopes, :] + ca.horzcat(ca.MX(len(sought), size + count), ca.diag(stiffness)))
        expressions = [ca.vertcat(*residual), ca.vertcat(*jacobian), *at]
        own, pushes, numbers = ca.vertsplit(z, [0, size, size + count, z.shape[0]])
        new_smoothing, fixed = ca.vertsplit(p, [0, 1, p.shape[0]])
        new_places = fixed
        if sought:
            new_places = ca.MX(places.shape[0], 1)
            new_places[sought], new_places[given] = _abscissae(numbers), fixed
            by_numbers = 1 / (2 * ca.sqrt(1 + numbers**2) ** 3)
            expressions[1] = expressions[1] @ ca.diag(ca.vertcat(ca.DM.ones(size + count), by_numbers))
        old = [x, forces, smoothing, places]
        new = [own, pushes, new_smoothing, new_places]
        residual, jacobian, *at = ca.graph_substitute(expressions, old, new)
        return cls(z, written.given, p, at, residual, jacobian)


def _abscissae(numbers: Columns) -> Columns:
    """Abscissae s = (1 + y/√(1 + y²))/2 of numbers y of any size."""
    return (1 + numbers / (1 + numbers**2) ** 0.5) / 2


def sought_places(state: ContactState) -> npt.NDArray[np.bool_]:
    """Mask of the places of a state at which rods touch rods, shape (k,)."""
    return np.array([touch.other is not None for touch in state.touches for _ in touch.moving], dtype=bool)


def _nearest(sections: list[float], places: list[float], loads: Sequence[float]) -> list[float]:
    """Move to each place the nearest section; both ascend, and sections keep their order.

    Elements end at loads, so that a section stays between the same two loads.
    """
    stretches = [bisect(loads, section) for section in sections]
    moved = dict[int, float]()
    for place in places:
        free = [i for i, stretch in enumerate(stretches) if stretch == bisect(loads, place) and i not in moved]
        if free:
            moved[min(free, key=lambda i: abs(sections[i] - place))] = place
    in_order = dict(zip(sorted(moved), moved.values(), strict=True))
    return [in_order.get(i, section) for i, section in enumerate(sections)]


def _pressing(state: ContactState, forces: FloatArray, least: float) -> ContactState:
    """The contacts that forces of sections suggest: neighbours that press are one point, or a line.

    Args:
        state: all sections.
        forces: dimensionless force of each section.
        least: force that equals the gap of its pair; a larger force is a contact.
    """
    kept: list[Touch] = []
    run: list[tuple[Touch, float]] = []
    for touch, force in zip(state.touches, forces.tolist(), strict=True):
        if run and (force < least or (touch.owner, touch.obstacle) != (run[0][0].owner, run[0][0].obstacle)):
            kept.append(_as_one(run))
            run = []
        if force >= least:
            run.append((touch, force))
    if run:
        kept.append(_as_one(run))
    return ContactState.of(kept)


def _as_one(run: Sequence[tuple[Touch, float]]) -> Touch:
    """The one contact that represents neighbours which press: a point, or a line."""
    first, last = run[0][0], run[-1][0]
    if first.other is not None:
        return Touch.of_rods((first.owner, first.obstacle), (at_end(first.start), at_end(first.other)))
    if first.of_body or len(run) == 1:
        return first
    if len(run) > 2:
        return Touch.line(first.obstacle, first.owner, first.start, last.start)
    place = sum(touch.start * force for touch, force in run) / sum(force for _, force in run)
    return Touch.point(first.obstacle, first.owner, place)


def relaxed_contact(
    model: Model, sections: int = SECTIONS, *, modes: int = MODES, nodes: int = NODES
) -> RelaxedContact:
    """The model of a scene in exact contact for an optimisation problem, with one set of equations for all contacts.

    Args:
        model: a model of a scene with obstacles without a width; parameters have its values.
        sections: number of sections of each rod that may touch each obstacle; the last one is the tip.
        modes: polynomials of each strain of such a rod between two sections; other rods keep theirs.
        nodes: intervals of the integration between two sections.

    Raises:
        SceneError: nothing touches exactly, fewer than one section is asked for, or a rod that touches another one has
            further sections at which its elements end.
    """
    scene = model.at().scene.baked()
    if not scene.touches_exactly:
        problem = "no rod touches exactly: there is no pair to relax"
        raise SceneError(Problem("obstacles", problem, "take the model itself"))
    refuse(_crowded(scene))
    if sections < 1:
        raise SceneError(Problem("sections", f"must be 1 or more, got {sections}"))
    of_rods = list(pairs(scene))
    touches = [Touch.ball(obstacle.name, body.name) for body, obstacle in body_pairs(scene)]
    for rod in scene.rods:
        obstacles = [obstacle for name, obstacle in of_rods if name == rod.name]
        for number, obstacle in enumerate(obstacles):
            # Two obstacles have no section in common except the tip.
            late = number / len(obstacles)
            inner = [(i + 1 - late) / sections for i in range(sections - (late == 0.0))]
            touches += [Touch.point(obstacle.name, rod.name, X) for X in (*inner, TIP)]
    touches += [Touch.of_rods(rods, (FIRST_PLACE, FIRST_PLACE)) for rods in rod_pairs(scene)]
    grids = dict(model.discretisation)
    for name in {rod for rod, _ in of_rods}:
        grids[name] = replace(grids[name], modes=(modes,) * len(grids[name].modes), nodes=nodes)
    bare = without_contacts(scene)
    state = ContactState.of(touches).split(load_sections(bare))
    equations = ContactEquations(bare, model.pack(), Grids(grids), state)
    return RelaxedContact(model.at(), equations)


def _crowded(scene: scenes.Scene) -> Iterator[Problem]:
    """Problems of rods that touch a rod and have other sections at which elements end: a place would pass these."""
    loads = load_sections(without_contacts(scene))
    met = Counter(rod for rods in rod_pairs(scene) for rod in rods)
    beside = {rod for rod, _ in pairs(scene)}
    for number, contact in enumerate(scene.rod_contacts):
        for name, count in met.items():
            if contact.exact and (contact.rods is None or name in contact.rods):
                others = ["several rods"] * (count > 1) + ["an obstacle"] * (name in beside)
                others += ["a load or a rod between its ends"] * bool(loads[name])
                if others:
                    problem = f"the place at which {name!r} touches a rod would have to pass others: it has {others[0]}"
                    yield Problem(
                        f"rod_contacts[{number}].exact", problem, "leave exact out, for a contact that is smooth"
                    )
