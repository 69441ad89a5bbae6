"""Choice of the arrangements of contacts in a C library: all that its scene meets, and the one without contact.

The scene is solved at its own inputs and parameters, and followed from there to each load case, one after the other,
along straight lines of both, like the solver in C. The arrangements on the way are collected.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.equilibrium.contact.contact_equations import ContactEquations, Grids, richer
from cosserat_casadi.equilibrium.contact.contact_search import Settling
from cosserat_casadi.equilibrium.contact.contact_solve import LEAST_TOLERANCE, solve_contact
from cosserat_casadi.equilibrium.contact.contact_state import ContactState, state_in, with_contacts, without_contacts
from cosserat_casadi.equilibrium.solution import Solution
from cosserat_casadi.errors import ExportError, Problem, refuse
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model, build
from cosserat_casadi.model.inputs import InputLayout, input_layout
from cosserat_casadi.model.parameters import ParameterLayout
from cosserat_casadi.numerics.newton import NewtonSettings
from cosserat_casadi.paths.contact_path import ContactPath, follow_contact_path
from cosserat_casadi.paths.equilibrium_path import InputChange

MOST_ARRANGEMENTS = 16
"""Largest number of arrangements of a library; each has its own equations."""


@dataclass(frozen=True)
class Chosen:
    """The arrangements of a library.

    Attributes:
        scene: the scene without contacts and without the list of its parameters.
        layout: inputs of the scene.
        parameters: numbers of the scene that the library takes after the inputs; often none.
        given: stacked inputs and parameters of the scene, from which the library starts.
        equations: equations of each arrangement, at places where it was met.
        richer: equations of each arrangement with added modes and intervals; empty without error estimates.
        start: index of the arrangement at the inputs of the scene.
        z: unknowns, forces and places that solve the equations of that arrangement.
        judges_stability: whether the library judges the stability of solutions.
    """

    scene: scenes.Scene
    layout: InputLayout
    parameters: ParameterLayout
    given: FloatArray
    equations: Sequence[ContactEquations]
    richer: Sequence[ContactEquations]
    start: int
    z: FloatArray
    judges_stability: bool = False

    @property
    def tolerance(self) -> float:
        """Largest relative depth and pull at which an arrangement is valid."""
        return max(self.scene.accuracy.tolerance, LEAST_TOLERANCE)


@dataclass
class _Met:
    """Collector of the arrangements that were met.

    Attributes:
        scene: the scene without contacts.
        grids: modes and nodes of every element.
        states: states of contact, by their discrete parts.
    """

    scene: scenes.Scene
    grids: Grids
    states: dict[object, ContactState] = field(default_factory=dict)

    def add(self, state: ContactState) -> None:
        """Add an arrangement, unless it is known. Contacts at one section are in the order of the scene, as in C."""
        number = [record.name for record in (*self.scene.obstacles, *self.scene.rods)].index
        ordered = ContactState(
            tuple(sorted(state.touches, key=lambda one: (one.of_body, one.owner, one.start, number(one.obstacle))))
        )
        self.states.setdefault(self.key(ordered), ordered)

    def add_path(self, path: ContactPath) -> None:
        """Add the arrangements of a path between its load cases, each where it was met last."""
        is_between = (path.factor >= 0.0) & (path.factor <= 1.0)
        for number, arrangement in enumerate(path.arrangements):
            points = np.flatnonzero((path.arrangement == number) & is_between)
            if len(points):
                self.add(arrangement.state(path.x[points[-1]]))

    def key(self, state: ContactState) -> object:
        """Return the discrete part of an arrangement: who touches what, and the ends of elements of each rod in order.

        An end is a number where it is fixed, else the index of the place of contact that moves it: second rods do not
        have theirs in the order of the contacts.
        """
        loaded = with_contacts(self.scene, state, self.grids.bending_modes(self.scene))
        sought = [entry for touch in state.touches for entry in touch.sought]
        ends = []
        for name, discretisation in self.grids.discretisation(loaded).items():
            places = {float(end): (number,) for number, (rod, end) in enumerate(sought) if rod == name}
            ends.append(tuple(places.get(end, end) for end in discretisation.breaks))
        return state.signature, tuple(ends)

    def check(self) -> None:
        """Refuse lines of contact that begin at the base or contain a load, and too many arrangements.

        Raises:
            ExportError: there are some.
        """
        touches = [touch for state in self.states.values() for touch in state.touches]
        from_base = sorted({(touch.owner, touch.obstacle) for touch in touches if touch.starts_at_base})
        lines = [(state, touch) for state in self.states.values() for touch in state.touches if touch.is_line]
        split: dict[tuple[str, str, float], tuple[str, str]] = {}
        for state, touch in lines:
            others = {end: other.obstacle for other in state.along(touch.owner) for end in other.moving}
            for X in touch.seams:
                inside = ("obstacles", f"contact with {others[X]!r}") if X in others else ("loads", "a load or joint")
                split[touch.owner, touch.obstacle, X] = inside
        problems = []
        for rod, obstacle in from_base:
            problem = f"it lies on {obstacle!r} from its base on: C has no such line of contact"
            problems.append(Problem(f"rods.{rod}", problem, "give the obstacle a width, m, or move it off the base"))
        for (rod, obstacle, X), (where, inside) in sorted(split.items()):
            problem = (
                f"{inside} at {X:g} of {rod!r} is inside the line along which it touches {obstacle!r}: C has no "
                "such contact"
            )
            problems.append(Problem(where, problem, "give each obstacle a width, m, for a contact that is smooth"))
        count = len(self.states)
        if not problems and count > MOST_ARRANGEMENTS:
            problem = f"the load cases meet {count} arrangements of contacts, a library holds {MOST_ARRANGEMENTS}"
            problems.append(Problem("--over", problem, "give fewer load cases, or smaller ranges"))
        refuse(problems, ExportError)


def chosen_arrangements(
    model: Model,
    load_cases: FloatArray | None,
    *,
    estimate_errors: bool,
    leave_out: bool = False,
    stability: bool = False,
) -> Chosen:
    """Find the arrangements that a scene meets, and the one without contact.

    Args:
        model: model of a scene with obstacles.
        load_cases: stacked inputs, a row for each case, shape (k, m), or with appended parameters, (k, m + p).
        estimate_errors: whether the library estimates the errors of its answers.
        leave_out: whether load cases without an equilibrium are left out, instead of refused.
        stability: whether the library judges the stability of solutions.

    Raises:
        ExportError: the scene has no equilibrium, a load case has none, there are too many arrangements, or a load acts
            inside a line of contact.
    """
    parameters = model.parameters
    named = without_contacts(model.scene)
    theta = parameters.pack()
    # Contacts are found for numbers; equations that take parameters are written at the end.
    scene = named.model_copy(update={"parameters": ()})
    grids = Grids(model.discretisation)
    free = build(named, grids.discretisation(named))
    layout = input_layout(scene)
    given = layout.pack(None)
    met = _Met(scene, grids)
    names = [*layout.names, *parameters.names]
    own = solve_contact(scene, grids, layout.unpack(given))
    _check(own, "the scene's own inputs")
    met.add(state_in(own.model.scene))
    first = next(iter(met.states))
    own_values = before = np.append(given, theta)
    for number, row in enumerate([] if load_cases is None else load_cases, start=1):
        # Of a row without parameters they are the scene's own.
        values = np.append(row, own_values[len(row) :])
        inputs, of_case = np.split(values, [layout.size])
        in_case = parameters.set_in(named, parameters.unpack(of_case)) if of_case.size else scene
        # Where a path ends early, at a fold or a change that it does not find, the load case is solved all the same.
        case = solve_contact(in_case, grids, layout.unpack(inputs))
        if leave_out and not case.converged:
            continue
        _check(case, f"load case {number}")
        if not np.array_equal(values, before):
            met.add_path(follow_contact_path(InputChange(free, names[0], before, values - before)))
        met.add(state_in(case.model.scene))
        before = values
    met.add(ContactState(()))
    met.check()
    start = list(met.states).index(first)
    answers, finer = (
        [ContactEquations(named, given, own_grids, state, theta) for state in met.states.values()]
        for own_grids in (grids, richer(grids, scene))
    )
    return Chosen(
        scene=scene,
        layout=layout,
        parameters=parameters,
        given=own_values,
        equations=answers,
        richer=finer if estimate_errors else [],
        start=start,
        z=_z_of(answers[start], own),
        judges_stability=stability,
    )


def _check(solution: Solution, what: str) -> None:
    """Refuse inputs without an equilibrium.

    Raises:
        ExportError: there is none.
    """
    if not solution.converged:
        raise ExportError(Problem("--over", f"{what}: {solution.message}", "leave it out, or lead there by others"))


def _z_of(equations: ContactEquations, near: Solution) -> FloatArray:
    """Solve the equations of an arrangement for unknowns, forces and places, near a solution."""
    settling = Settling(equations.scene, equations.given, equations.grids, NewtonSettings(), LEAST_TOLERANCE)
    z = settling.solved(equations, near)
    if z is None:
        raise ExportError(Problem("obstacles", "the contacts at the scene's own inputs were not found again"))
    return z
