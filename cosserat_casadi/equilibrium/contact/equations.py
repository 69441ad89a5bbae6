"""Equations of a rod in known contact: its balance, no gap where it touches, no slope of the gap where contact moves.

Unknowns are z = (x, f, p): the unknowns of the model, the forces of the contacts, and the abscissae of contact that
are not at the tip. A point of contact gives d(r) = ρ and, where it may move, dd/dX = ρ′; a stretch gives the same at its
ends, and the moments of d − ρ with the polynomials of its force. Elements end at p, so that every field is smooth
inside an element and the accuracy of the polynomials is kept. See docs/contact.md.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property

import casadi as ca
import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.equilibrium.contact.state import ContactState, Touch, with_contacts
from cosserat_casadi.equilibrium.contact.surfaces import surface
from cosserat_casadi.equilibrium.load_path import column
from cosserat_casadi.loads.penetration import section_radius
from cosserat_casadi.maths.chebyshev import legendre_polynomials
from cosserat_casadi.maths.rotation import quaternion_to_matrix
from cosserat_casadi.maths.typing import FloatArray, Matrix
from cosserat_casadi.model.build import Model, build
from cosserat_casadi.model.discretise import element_ends
from cosserat_casadi.model.system import Arguments, System
from cosserat_casadi.numerics.newton import Equations
from cosserat_casadi.rod.discretisation import Discretisation
from cosserat_casadi.rod.strain import DiscreteRod

DIFFERENCE = 1e-6
"""Step of the differences in places of contact, relative to the length of the rod."""

FIT = 1e-3
"""Singular values, relative to the largest, below which a first guess of forces does without them."""

TORSION = 2
"""Index of the torsion among the strains: bendings come before it."""

KEPT = 8
"""Models of other places that are kept: those of one Newton step."""


@dataclass(frozen=True)
class Grids:
    """Modes, nodes and rotation integrator of the elements of every rod, wherever elements end.

    Attributes:
        rods: by name; their own breaks are not read.
    """

    rods: Mapping[str, Discretisation]

    def discretisation(self, scene: scenes.Scene) -> dict[str, Discretisation]:
        """One for every rod of a scene, with elements that end where its loads say."""
        return {name: replace(own, breaks=element_ends(scene, name)) for name, own in self.rods.items()}

    def bending_modes(self, scene: scenes.Scene) -> dict[str, int]:
        """Polynomials that all curvatures of each rod have at least, by name."""
        fewest = {}
        for rod in scene.rods:
            modes = self.rods[rod.name].modes
            bending = [count for strain, count in zip(rod.admitted, modes, strict=True) if strain < TORSION]
            fewest[rod.name] = min(bending, default=1)
        return fewest


@dataclass(frozen=True)
class Placed:
    """A model whose elements end at the contacts of a state.

    Attributes:
        model: of the scene with the forces of the contacts as inputs.
        state: the contacts.
        given: stacked inputs of the scene without contacts.
        modes: polynomials of the curvature of each rod, by name.
    """

    model: Model
    state: ContactState
    given: FloatArray
    modes: Mapping[str, int]

    @cached_property
    def _force_entries(self) -> list[int]:
        """Entries of the forces in the stacked inputs, in the order of the loads."""
        entries: list[int] = []
        for entry, span in self.model.inputs:
            if entry.owner.startswith("contact "):
                entries.extend(range(span.start, span.stop))
        return entries

    @property
    def force_count(self) -> int:
        """Number of forces f."""
        return len(self._force_entries)

    @cached_property
    def force_units(self) -> FloatArray:
        """What one unit of each force stands for, shape (k,): EI/ℓ² of its rod, in N, or EI/ℓ³, in N/m."""
        units = []
        for load in self.model.scene.loads:
            if load.name.startswith("contact "):
                unit = self.model.discrete.tension_unit(load.rod)
                if load.kind == "contact_line":
                    length = self.model.discrete.rods[load.rod].length
                    units += [unit / length] * len(load.force[0])
                else:
                    units.append(unit)
        return np.array(units)

    def inputs(self, forces: FloatArray) -> FloatArray:
        """Stacked inputs of the model for forces without unit, shape (k,)."""
        inputs = np.zeros(self.model.inputs.size)
        others = np.setdiff1d(np.arange(len(inputs)), self._force_entries)
        inputs[others] = self.given
        inputs[self._force_entries] = forces * self.force_units
        return inputs

    def fitting_forces(self, x: FloatArray) -> FloatArray:
        """Forces that balance a shape best, shape (k,): it is linear in them."""
        none = np.zeros(self.force_count)
        inputs = self.inputs(none)
        balance = column(self.model.path_residual(x, inputs, 1.0))
        by_inputs = self.model.input_jacobian(x, inputs).full()
        by_forces = by_inputs[:, self._force_entries] * self.force_units
        fitting, *_ = np.linalg.lstsq(by_forces, -balance, rcond=FIT)
        return np.asarray(fitting)

    def residual(self, x: FloatArray, forces: FloatArray) -> FloatArray:
        """Balance and gaps, without unit."""
        inputs = self.inputs(forces)
        balance = column(self.model.path_residual(x, inputs, 1.0))
        return np.concatenate([balance, column(self.gaps(x, inputs))])

    def jacobian(self, x: FloatArray, forces: FloatArray) -> FloatArray:
        """Derivative of the residual with unknowns and forces."""
        inputs = self.inputs(forces)
        by_x = self.model.path_jacobian(x, inputs, 1.0).full()
        by_inputs = self.model.input_jacobian(x, inputs).full()
        by_forces = by_inputs[:, self._force_entries] * self.force_units
        gaps_by_x = self.gaps_by_x(x, inputs).full()
        none = np.zeros((len(gaps_by_x), len(forces)))
        return np.block([[by_x, by_forces], [gaps_by_x, none]])

    @cached_property
    def gaps(self) -> ca.Function:
        """(x, inputs) ↦ what the contacts ask to be zero, without unit."""
        x = ca.MX.sym("x", self.model.size)
        inputs = ca.MX.sym("inputs", self.model.inputs.size)
        system = System(self.model.discrete, Arguments(x, inputs))
        rows = [row for touch in self.state.touches for row in self._rows(system, touch)]
        return ca.Function("gaps", [x, inputs], [ca.vertcat(ca.MX(0, 1), *rows)])

    @cached_property
    def gaps_by_x(self) -> ca.Function:
        """(x, inputs) ↦ the derivative of the gaps with x."""
        x, inputs = self.gaps.mx_in()
        return ca.Function("gaps_by_x", [x, inputs], [ca.jacobian(self.gaps(x, inputs), x)])

    def _rows(self, system: System, touch: Touch) -> Iterator[Matrix]:
        """Rows of one contact: at its ends, then the moments along it."""
        distances = Distances(system, touch.rod, self.obstacle(touch.obstacle))
        grid = system.discrete.rods[touch.rod].grid
        for end in touch.ends:
            gap, slope = distances.at(grid.node_at(end))
            yield gap
            if end in touch.moving:
                yield slope
        if touch.is_line:
            yield distances.moments(touch.start, touch.end, touch.moment_count(self.modes[touch.rod]))

    def obstacle(self, name: str) -> scenes.ObstacleRecord:
        """The obstacle of a name."""
        (record,) = [obstacle for obstacle in self.model.scene.obstacles if obstacle.name == name]
        return record


@dataclass(frozen=True)
class Distances:
    """Distances of a rod's surface from an obstacle, over the length of the rod, as expressions.

    Attributes:
        system: the scene.
        rod: name of the rod.
        obstacle: the obstacle.
    """

    system: System
    rod: str
    obstacle: scenes.ObstacleRecord

    @property
    def _discrete_rod(self) -> DiscreteRod:
        return self.system.discrete.rods[self.rod]

    @cached_property
    def _world_R_base(self) -> Matrix:
        return quaternion_to_matrix(self.system.base(self.rod).quaternion)

    @cached_property
    def _radius(self) -> FloatArray:
        """Radius of the sections at the nodes, shape (M,), m."""
        return section_radius(self._discrete_rod.properties, self._discrete_rod.grid.nodes)

    def _gap(self, node: int) -> tuple[Matrix, Matrix]:
        """Distance of the surface at a node, m, and the normal of the obstacle there."""
        shape = self.system.shapes[self.rod]
        position = self.system.base(self.rod).position + self._world_R_base @ shape.position_at(node)
        distance, normal, _ = surface(self.obstacle)(position)
        return distance - self._radius[node], normal

    def at(self, node: int) -> tuple[Matrix, Matrix]:
        """Distance and its rate with X at a node, over the length."""
        gap, normal = self._gap(node)
        tangent = self._world_R_base @ self.system.shapes[self.rod].tangent[:, node]
        slope = ca.dot(normal, tangent) - self._radius_slope(node)
        length = self._discrete_rod.properties.length
        return gap / length, slope / length

    def moments(self, start: float, end: float, count: int) -> Matrix:
        """∫ P_j (d − ρ) over a stretch, relative to it, for the first Legendre polynomials, count×1."""
        grid = self._discrete_rod.grid
        nodes = list(map(int, grid.nodes_in(start, end)))
        gaps = ca.vertcat(*[self._gap(node)[0] for node in nodes])
        width = end - start
        local = (grid.nodes[nodes] - start) / width
        weights = grid.weights[nodes] / width
        polynomials = legendre_polynomials(count, local)
        return ca.DM((weights[:, None] * polynomials).T) @ gaps / self._discrete_rod.properties.length

    def _radius_slope(self, node: int) -> float:
        """dρ/dX at a node, m: sections vary linearly."""
        ends = section_radius(self._discrete_rod.properties, np.array([0.0, 1.0]))
        return float(ends[1] - ends[0])


@dataclass
class ContactEquations:
    """Equations of one state in z = (x, f, p), on models that are built for each p.

    Attributes:
        scene: the scene without contacts.
        given: its stacked inputs.
        grids: modes and nodes of every element.
        state: the contacts, at the places that the equations start from.
    """

    scene: scenes.Scene
    given: FloatArray
    grids: Grids
    state: ContactState
    _models: dict[bytes, Placed] = field(default_factory=dict)

    def placed(self, places: FloatArray) -> Placed:
        """The model for places of contact, shape (k,)."""
        key = places.tobytes()
        if key not in self._models:
            if len(self._models) == KEPT:
                self._models.pop(next(iter(self._models)))
            state = self.state.at(places)
            modes = self.grids.bending_modes(self.scene)
            loaded = with_contacts(self.scene, state, modes)
            model = build(loaded, self.grids.discretisation(loaded))
            self._models[key] = Placed(model, state, self.given, modes)
        return self._models[key]

    @cached_property
    def sizes(self) -> tuple[int, int]:
        """Numbers of unknowns x and of forces f."""
        placed = self.placed(self.state.places)
        return placed.model.size, placed.force_count

    def parts(self, z: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """x, f and p."""
        unknowns, forces = self.sizes
        x, f, p = np.split(z, [unknowns, unknowns + forces])
        return x, f, p

    def residual(self, z: FloatArray) -> FloatArray:
        """Balance and gaps; not a number where places do not follow each other along the rod."""
        x, f, p = self.parts(z)
        if not self.state.at(p).in_order:
            return np.full(len(z), np.nan)
        return self.placed(p).residual(x, f)

    def jacobian(self, z: FloatArray) -> FloatArray:
        """Derivative of the residual: exact with x and f, by differences with p."""
        x, f, p = self.parts(z)
        placed = self.placed(p)
        residual = placed.residual(x, f)
        columns = []
        for i in range(len(p)):
            moved = p.copy()
            moved[i] += DIFFERENCE
            columns.append((self.placed(moved).residual(x, f) - residual) / DIFFERENCE)
        by_places = np.array(columns).reshape(len(p), len(z)).T
        return np.hstack([placed.jacobian(x, f), by_places])

    @property
    def equations(self) -> Equations:
        """As Newton's method takes them."""
        return Equations(self.residual, self.jacobian)
