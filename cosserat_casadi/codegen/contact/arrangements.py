"""Which arrangements of contacts a library in C holds: those that its scene meets, and no contact.

They are collected by solving the scene, at its own inputs and over load cases. Between two load cases that end in
different arrangements the straight line of inputs is halved, so that what lies between is met too.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.equilibrium.contact.equations import ContactEquations, Grids
from cosserat_casadi.equilibrium.contact.settle import Settling
from cosserat_casadi.equilibrium.contact.solve import LEAST_TOLERANCE, solve_contact
from cosserat_casadi.equilibrium.contact.state import ContactState, state_in, with_contacts, without_contacts
from cosserat_casadi.equilibrium.solution import Solution
from cosserat_casadi.errors import ExportError, Problem
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.inputs import InputLayout, input_layout
from cosserat_casadi.numerics.newton import NewtonSettings

HALVINGS = 6
"""Times that the way between two load cases is halved in search of what lies between."""

MOST_ARRANGEMENTS = 16
"""Most arrangements of a library: each has equations of its own."""


@dataclass(frozen=True)
class Chosen:
    """The arrangements of a library.

    Attributes:
        scene: without contacts.
        layout: its inputs.
        given: stacked inputs that the library starts from: the scene's own.
        equations: of each arrangement, at places where it was met.
        start: number of the arrangement for these inputs.
        z: unknowns, forces and places that solve its equations.
    """

    scene: scenes.Scene
    layout: InputLayout
    given: FloatArray
    equations: Sequence[ContactEquations]
    start: int
    z: FloatArray

    @property
    def tolerance(self) -> float:
        """Depth and pull, relative, up to which an arrangement holds."""
        return max(self.scene.accuracy.tolerance, LEAST_TOLERANCE)


def chosen_arrangements(model: Model, load_cases: FloatArray | None = None) -> Chosen:
    """The arrangements that a scene meets, and no contact.

    Args:
        model: of a scene with obstacles.
        load_cases: stacked inputs, a row for each case, shape (k, m).

    Raises:
        ExportError: a load case has no equilibrium, or there are too many arrangements.
    """
    scene = without_contacts(model.scene)
    grids = Grids(model.discretisation)
    layout = input_layout(scene)
    given = layout.pack(None)
    search = _Search(scene, grids, layout)
    own = search.solved(given, None, "the scene's own inputs")
    search.note(own)
    previous = _Case(given, own)
    rows = np.zeros((0, layout.size)) if load_cases is None else load_cases
    for number, row in enumerate(rows, start=1):
        case = _Case(row, search.solved(row, previous.solution, f"load case {number}"))
        search.between(previous, case, HALVINGS)
        search.note(case.solution)
        previous = case
    search.add(ContactState(()))
    if len(search.states) > MOST_ARRANGEMENTS:
        problem = (
            f"the load cases meet {len(search.states)} arrangements of contacts, a library holds {MOST_ARRANGEMENTS}"
        )
        raise ExportError(Problem("--over", problem, "give fewer load cases, or smaller ranges"))
    equations = [ContactEquations(scene, given, grids, state) for state in search.states.values()]
    start = list(search.states).index(search.key(state_in(own.model.scene)))
    return Chosen(scene, layout, given, equations, start, _z_of(equations[start], own))


def _z_of(equations: ContactEquations, near: Solution) -> FloatArray:
    """Unknowns, forces and places of a solution in the equations of its arrangement."""
    settling = Settling(equations.scene, equations.given, equations.grids, NewtonSettings(), LEAST_TOLERANCE)
    z = settling.solved(equations, near)
    if z is None:
        raise ExportError(Problem("obstacles", "the contacts of the scene's own inputs could not be found again"))
    return z


@dataclass(frozen=True)
class _Case:
    """A load case.

    Attributes:
        inputs: stacked.
        solution: its equilibrium.
    """

    inputs: FloatArray
    solution: Solution


@dataclass
class _Search:
    """Load cases on their way to a list of arrangements.

    Attributes:
        scene: without contacts.
        grids: modes and nodes of every element.
        layout: inputs of the scene.
        states: by what is discrete of them.
    """

    scene: scenes.Scene
    grids: Grids
    layout: InputLayout
    states: dict[object, ContactState] = field(default_factory=dict)

    def solved(self, inputs: FloatArray, start: Solution | None, what: str) -> Solution:
        """The equilibrium for some inputs.

        Raises:
            ExportError: there is none.
        """
        solution = self._try(inputs, start)
        if not solution.converged:
            raise ExportError(Problem("--over", f"{what}: {solution.message}", "leave it out"))
        return solution

    def _try(self, inputs: FloatArray, start: Solution | None) -> Solution:
        return solve_contact(self.scene, self.grids, self.layout.unpack(inputs), start=start)

    def between(self, first: _Case, last: _Case, halvings: int) -> None:
        """Note what is met on the straight line of inputs between two cases, where they differ in their contacts."""
        if halvings == 0 or self._key_of(first.solution) == self._key_of(last.solution):
            return
        inputs = (first.inputs + last.inputs) / 2
        solution = self._try(inputs, first.solution)
        if not solution.converged:
            return
        middle = _Case(inputs, solution)
        self.note(solution)
        self.between(first, middle, halvings - 1)
        self.between(middle, last, halvings - 1)

    def note(self, solution: Solution) -> None:
        """Add the arrangement of a solution."""
        self.add(state_in(solution.model.scene))

    def add(self, state: ContactState) -> None:
        """Add an arrangement, unless it is there."""
        self.states.setdefault(self.key(state), state)

    def _key_of(self, solution: Solution) -> object:
        return self.key(state_in(solution.model.scene))

    def key(self, state: ContactState) -> object:
        """What is discrete of an arrangement: who touches what, and between which ends of elements that stay."""
        loaded = with_contacts(self.scene, state, self.grids.bending_modes(self.scene))
        ends = []
        for name, discretisation in self.grids.discretisation(loaded).items():
            places = {float(end) for touch in state.touches if touch.rod == name for end in touch.moving}
            ends.append(tuple(None if end in places else end for end in discretisation.breaks))
        return state.signature, tuple(ends)
