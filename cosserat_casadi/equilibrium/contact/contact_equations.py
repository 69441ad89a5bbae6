"""Equations of rods and bodies in known contact: balance, no gap where they touch, no slope where contact moves.

Unknowns are z = (x, f, p): the unknowns of the model, the forces of the contacts, and the abscissae of contact that
are not at the tip. A point of contact gives d(r) = ρ and, if it may move, dd/dX = ρ′; a line gives both at its ends,
and the moments of d − ρ with the polynomials of its force. A load inside a line splits its force per length: the
section of the load has a point force and gives d(r) = ρ. A body is a ball, which gives d(r) = ρ. Elements end at p and
move with it, so that every field is smooth inside an element and the accuracy of the polynomials is kept. Parameters of
the scene are arguments of the equations as its inputs are: small changes of both move z as ∂g/∂z dz = −∂g/∂inputs d
inputs − ∂g/∂θ dθ while the contacts stay. See docs/contact.md.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property

import casadi as ca
import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.equilibrium.contact.contact_state import SHORTEST, ContactState, contact_loads, with_contacts
from cosserat_casadi.equilibrium.contact.gap_rows import force_widths, gap_rows, rows_from_start
from cosserat_casadi.equilibrium.contact.gaps import obstacle_of
from cosserat_casadi.equilibrium.contact.shape_projection import projected
from cosserat_casadi.equilibrium.load_path import column
from cosserat_casadi.equilibrium.solution import Solution
from cosserat_casadi.loads.contact_friction import ContactFriction
from cosserat_casadi.loads.contact_line import ContactLine
from cosserat_casadi.loads.rods_point import RodsPoint
from cosserat_casadi.maths.typing import FloatArray, Matrix
from cosserat_casadi.model.build import Model, build
from cosserat_casadi.model.discrete_scene import with_numbers
from cosserat_casadi.model.discretise import enriched, nodes_above_modes
from cosserat_casadi.model.element_ends import element_ends, places_on
from cosserat_casadi.model.parameters import ParameterLayout, parameter_layout
from cosserat_casadi.model.required_modes import seeing_modes
from cosserat_casadi.model.scene_equations import SceneEquations
from cosserat_casadi.model.system import Arguments, System
from cosserat_casadi.numerics.broyden import solved
from cosserat_casadi.numerics.newton import Equations
from cosserat_casadi.rod.discretisation import Discretisation

FIT = 1e-3
"""Singular values, relative to the largest, below which a first guess of forces leaves them out."""

TORSION = 2
"""Index of the torsion among the strains: bendings come before it."""


@dataclass(frozen=True)
class Grids:
    """Modes, nodes and rotation integrator of the elements of every rod, without the element ends.

    Attributes:
        rods: discretisation of each rod, by name. Its breaks are ignored.
    """

    rods: Mapping[str, Discretisation]

    def discretisation(self, scene: scenes.Scene) -> dict[str, Discretisation]:
        """Discretisation of every rod of a scene, by name, with the element ends that its loads ask for."""
        return {name: replace(own, breaks=element_ends(scene, name)) for name, own in self.rods.items()}

    def bending_modes(self, scene: scenes.Scene) -> dict[str, int]:
        """Least number of polynomials over the curvatures of each rod, by name."""
        fewest = {}
        for rod in scene.rods:
            modes = self.rods[rod.name].modes
            bending = [count for strain, count in zip(rod.admitted, modes, strict=True) if strain < TORSION]
            fewest[rod.name] = min(bending, default=1)
        return fewest


def richer(grids: Grids, scene: scenes.Scene) -> Grids:
    """The grids with modes and intervals added, on which the error of an answer is estimated.

    Args:
        grids: grids of the answer.
        scene: the scene without contacts.
    """
    rods = {}
    for name, rod in grids.rods.items():
        modes = seeing_modes(scene, name)
        rods[name] = enriched(rod, modes, nodes_above_modes(scene, name, touches=True))
    return Grids(rods)


@dataclass(frozen=True)
class Placed:
    """A model with element ends at the contacts of a state.

    Attributes:
        model: model of the scene with the forces of the contacts as inputs.
        state: the contacts.
        given: stacked inputs of the scene without contacts.
        modes: polynomials of the curvature of each rod, by name.
    """

    model: Model
    state: ContactState
    given: FloatArray
    modes: Mapping[str, int]

    @cached_property
    def force_entries(self) -> list[int]:
        """Entries of the forces in the stacked inputs, in the order of the loads."""
        names = {load.name for load in contact_loads(self.model.scene)}
        entries: list[int] = []
        for entry, span in self.model.inputs:
            if entry.owner in names:
                entries.extend(range(span.start, span.stop))
        return entries

    @cached_property
    def force_units(self) -> FloatArray:
        """Unit of each force, shape (k,): EI/ℓ² of its rod or body, in N, or EI/ℓ³, in N/m."""
        discrete = self.model.discrete
        units = []
        for load in contact_loads(self.model.scene):
            if isinstance(load, RodsPoint):
                units.append(discrete.tension_unit(load.rods[0]))
            elif isinstance(load, ContactLine):
                unit = discrete.tension_unit(load.rod) / discrete.rods[load.rod].length
                units += [unit] * len(load.force[0])
            elif isinstance(load, ContactFriction):
                assert load.rod is not None, "friction on a rod"
                units += [discrete.tension_unit(load.rod)] * len(load.force)
            elif load.body is not None:
                units.append(discrete.contact_unit(load.body, of_body=True))
            else:
                assert load.rod is not None, "a load acts on a body or on a rod"
                units.append(discrete.tension_unit(load.rod))
        return np.array(units)

    @cached_property
    def _spread(self) -> tuple[FloatArray, FloatArray]:
        """Matrices to all m inputs from the inputs of the scene, shape (m, m − k), and from the k forces, (m, k)."""
        size = self.model.inputs.size
        others = np.setdiff1d(np.arange(size), self.force_entries)
        by_given = np.zeros((size, len(others)))
        by_given[others, np.arange(len(others))] = 1.0
        by_forces = np.zeros((size, len(self.force_entries)))
        by_forces[self.force_entries, np.arange(len(self.force_entries))] = self.force_units
        return by_given, by_forces

    def inputs(self, forces: FloatArray) -> FloatArray:
        """Stacked inputs of the model for forces without unit, shape (k,)."""
        return self.inputs_moved(self.given, forces)

    def inputs_moved(self, given: FloatArray, forces: FloatArray) -> FloatArray:
        """Stacked inputs of the model for other inputs of the scene and other forces, or for columns of changes."""
        by_given, by_forces = self._spread
        return np.asarray(by_given @ given + by_forces @ forces)

    def written_inputs(self, given: Matrix, forces: Matrix) -> Matrix:
        """Stacked inputs of the model as expressions of the stacked inputs of the scene and of forces without unit."""
        by_given, by_forces = self._spread
        return ca.sparsify(ca.DM(by_given)) @ given + ca.sparsify(ca.DM(by_forces)) @ forces

    def residual(self, x: FloatArray, forces: FloatArray) -> FloatArray:
        """Balance and gaps, without unit."""
        inputs = self.inputs(forces)
        balance = column(self.model.path_residual(x, inputs, 1.0))
        gaps, _ = self.gaps(x, inputs)
        return np.concatenate([balance, column(gaps)])

    @cached_property
    def gaps(self) -> ca.Function:
        """(x, inputs) ↦ dimensionless residual of the contacts, and its derivative by x."""
        x, inputs, gaps = self._written_gaps
        return ca.Function("gaps", [x, inputs], [gaps, ca.jacobian(gaps, x)])

    @cached_property
    def gaps_by_inputs(self) -> ca.Function:
        """(x, inputs) ↦ derivative of the contacts' residual by the inputs; columns of forces of contacts are zero."""
        x, inputs, gaps = self._written_gaps
        by_inputs = ca.jacobian(gaps, inputs)
        # The compliance of surfaces is below rounding.
        by_inputs[:, self.force_entries] = 0
        return ca.Function("gaps_by_inputs", [x, inputs], [by_inputs])

    @cached_property
    def _written_gaps(self) -> tuple[ca.MX, ca.MX, Matrix]:
        x = ca.MX.sym("x", self.model.size)
        inputs = ca.MX.sym("inputs", self.model.inputs.size)
        system = System(self.model.discrete, Arguments(x, inputs))
        # The column is named, since CasADi takes an empty selection of a single input for a row.
        forces = inputs[self.force_entries, 0] / self.force_units
        return x, inputs, gap_rows(system, self.state, self.modes, forces)

    def obstacle(self, name: str) -> scenes.ObstacleRecord:
        """The obstacle of a name."""
        return obstacle_of(self.model.scene, name)


@dataclass(frozen=True)
class Written:
    """The equations of a state as expressions.

    Attributes:
        unknowns: symbols of x, f and p; in p the parameters of the scene follow the places.
        given: symbol of the stacked inputs of the scene without contacts.
        state: the contacts, at expressions of p.
        system: rods with element ends at the contacts.
        modes: polynomials of the curvature of each rod, by name.
    """

    unknowns: tuple[ca.MX, ca.MX, ca.MX]
    given: ca.MX
    state: ContactState
    system: System
    modes: Mapping[str, int]

    @property
    def arguments(self) -> list[ca.MX]:
        """Arguments of the functions of the equations."""
        return [*self.unknowns, self.given]

    @cached_property
    def _balance(self) -> SceneEquations:
        return SceneEquations(self.system)

    @cached_property
    def _gaps(self) -> Matrix:
        return gap_rows(self.system, self.state, self.modes, self.unknowns[1])

    @property
    def residual(self) -> Matrix:
        """Residual of the balance, then of the gaps."""
        return ca.vertcat(self._balance.residual, self._gaps)

    @property
    def jacobian(self) -> Matrix:
        """Derivative of the residual by the unknowns; it has the balance's written Jacobian, contacts add little."""
        _, f, p = self.unknowns
        balance = self._balance.residual
        by_forces = ca.jacobian(balance, f)
        by_places = ca.jacobian(balance, p)
        of_balance = ca.horzcat(self._balance.jacobian, by_forces, by_places)
        gaps_by_others = [ca.jacobian(self._gaps, part) for part in (f, p)]
        return ca.vertcat(of_balance, ca.horzcat(self._gaps_by_unknowns(by_forces), *gaps_by_others))

    def _gaps_by_unknowns(self, by_forces: Matrix) -> Matrix:
        """Derivative of the gaps by x: the generalised force of a gap's force, which does work on this gap alone.

        Args:
            by_forces: derivative of the balance by the forces.
        """
        x, _, _ = self.unknowns
        # The balances of frames, and of two rods, have different units; parameters do not change units.
        discrete = self.system.discrete
        if discrete.frames or discrete.parameters.entries or discrete.rods_points:
            return ca.jacobian(self._gaps, x)
        rows: list[Matrix] = [ca.MX(0, x.shape[0])]
        force = 0
        for number, width in enumerate(force_widths(self.state, self.modes)):
            if width is None:
                rows.append(ca.jacobian(self._gaps[number], x))
            else:
                rows.append(-by_forces[:, force].T / width)
                force += 1
        for row, start in rows_from_start(self.system, self.state, self.modes):
            rows[1 + row] -= rows[1 + start]
        return ca.vertcat(*rows)


@dataclass(frozen=True)
class BehindPlaces(ParameterLayout):
    """Layout of the places of contact, which move elements as parameters do, followed by the scene's parameters.

    Attributes:
        places: number of places.
    """

    places: int = 0

    @cached_property
    def size(self) -> int:
        """Number of places and of entries of the parameters."""
        return self.places + sum(entry.size for entry in self.entries)


@dataclass(frozen=True)
class ContactEquations:
    """Equations of one state in z = (x, f, p).

    Attributes:
        scene: the scene without contacts.
        given: stacked inputs of the scene.
        grids: modes and nodes of every element.
        state: the contacts, at the places from which the equations start.
        theta: values of the parameters that the scene names.
    """

    scene: scenes.Scene
    given: FloatArray
    grids: Grids
    state: ContactState
    theta: FloatArray = field(default_factory=lambda: np.zeros(0))

    def at(self, given: FloatArray, theta: FloatArray) -> ContactEquations:
        """These equations for other inputs and parameters, with the same functions."""
        # The shared functions are written before the copy takes them.
        assert self._functions and self._by_arguments and self.parameters is not None
        other = replace(self, given=given, theta=theta)
        vars(other).update({name: value for name, value in vars(self).items() if name not in ("given", "theta")})
        return other

    def loaded(self, scene: scenes.Scene, state: ContactState, modes: Mapping[str, int]) -> scenes.Scene:
        """A scene with the forces of contacts as loads."""
        return with_contacts(scene, state, modes)

    def placed(self, state: ContactState, given: FloatArray | None = None) -> Placed:
        """The model of the contacts at known places, for the inputs ``given`` or else those of the equations."""
        modes = self.grids.bending_modes(self.scene)
        loaded = self.loaded(self.scene.baked(), state, modes)
        model = build(loaded, self.grids.discretisation(loaded))
        if self.parameters.size:
            # Unknowns keep the units of the scene's own numbers.
            scene = self.parameters.set_in(self.scene, self.parameters.unpack(self.theta))
            state = self._with_seams(state, scene)
            model = Model(with_numbers(model.discrete, self.loaded(scene, state, modes)))
        return Placed(model, state, self.given if given is None else given, modes)

    @cached_property
    def parameters(self) -> ParameterLayout:
        """Parameters of the scene."""
        return parameter_layout(self.scene)

    @cached_property
    def nominal(self) -> Placed:
        """The model at the first places of contact; other places move its elements."""
        return replace(self, scene=self.scene.baked()).placed(self.state)

    @property
    def pushes(self) -> int:
        """Number of the forces along normals."""
        return len(self.nominal.force_units)

    @cached_property
    def slope_rows(self) -> list[int]:
        """Rows of the residual with the slopes of gaps, one for each unknown place."""
        widths = force_widths(self.state, self.nominal.modes)
        return [self.nominal.model.size + number for number, width in enumerate(widths) if width is None]

    def parts(self, z: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """x, f and p."""
        unknowns = self.nominal.model.size
        x, f, p = np.split(z, [unknowns, unknowns + len(self.nominal.force_units)])
        return x, f, p

    @cached_property
    def written(self) -> Written:
        """The equations as expressions."""
        return self._write()

    def _write(self) -> Written:
        nominal = self.nominal
        x = ca.MX.sym("x", nominal.model.size)
        f = ca.MX.sym("f", len(nominal.force_units))
        given = ca.MX.sym("given", len(self.given))
        model, state = self._moving
        system = System(model.discrete, Arguments(x, nominal.written_inputs(given, f)))
        return Written((x, f, model.parameters.symbol), given, state, system, nominal.modes)

    @cached_property
    def _moving(self) -> tuple[Model, ContactState]:
        """The model with places of contact and the scene's parameters as parameters; contacts at these places."""
        count = len(self.state.places)
        parameters = BehindPlaces(self.parameters.entries, self.parameters.moving, count)
        p = parameters.symbol
        if not p.shape[0]:
            return self.nominal.model, self.state
        # One expression for each place, by which elements and loads that end there are identified.
        state = self.state.at([p[i] for i in range(count)])
        scene = self.parameters.written(self.scene.baked(), p[count:])
        state = self._with_seams(state, scene)
        written = self.loaded(scene, state, self.nominal.modes)
        return Model(with_numbers(self.nominal.model.discrete, written, parameters)), state

    def _with_seams(self, state: ContactState, scene: scenes.Scene) -> ContactState:
        """Contacts with seams at the loads of a scene with other numbers, or expressions."""
        places = {}
        for own in self.parameters.moving:
            pairs = zip(places_on(self.scene, own.rod), places_on(scene, own.rod), strict=True)
            places[own.rod] = {float(before): after for before, after in pairs}
        return state.reseamed(places)

    @property
    def model(self) -> Model:
        """The model whose parameters are the places of contact, then the scene's; it gives poses and fields."""
        return self._moving[0]

    def arguments(self, z: FloatArray, given: FloatArray | None = None) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Unknowns, stacked inputs and parameters of :attr:`model`, for the inputs ``given`` or else the equations'."""
        x, f, places = self.parts(z)
        inputs = self.nominal.inputs_moved(self.given if given is None else given, f)
        return x, inputs, np.concatenate([places, self.theta])

    @cached_property
    def _functions(self) -> tuple[ca.Function, ca.Function]:
        """(x, f, p, inputs) ↦ residual, and ↦ its derivative by x, f and p."""
        written = self.written
        residual = ca.Function("residual", written.arguments, [written.residual])
        return residual, ca.Function("jacobian", written.arguments, [written.jacobian])

    @cached_property
    def _by_arguments(self) -> ca.Function:
        """(x, f, p, inputs) ↦ derivative of the residual by the inputs."""
        written = self.written
        return ca.Function("by_inputs", written.arguments, [ca.jacobian(written.residual, written.given)])

    def ends(self, rod: str, p: FloatArray) -> FloatArray:
        """Element ends of a rod for places of contact p, shape (E + 1,)."""
        breaks = self.nominal.model.discretisation[rod].breaks
        moved = self.state.at(p.tolist())
        places = dict(zip(self._places_on(self.state, rod), self._places_on(moved, rod), strict=True))
        return np.array([places.get(end, end) for end in breaks])

    def in_order(self, p: FloatArray) -> bool:
        """Whether the ends of the elements of all rods, which places and parameters move, ascend."""
        widths = [np.diff(self.ends(rod, p)).min() for rod in self.grids.rods]
        for own in self.parameters.moving:
            moved = own.ends(self.theta).full()[:, 0].tolist()
            places = dict(zip(element_ends(self.scene, own.rod), moved, strict=True))
            ends = [places.get(end, end) for end in self.ends(own.rod, p).tolist()]
            widths.append(np.diff(ends).min())
        return bool(min(widths) >= SHORTEST)

    @staticmethod
    def _places_on(state: ContactState, rod: str) -> list[float]:
        return [float(end) for touch in state.along(rod) for end in touch.carriers]

    def moved_strains(self, p: FloatArray) -> FloatArray:
        """Factors from the unknowns of unmoved elements to the unknowns of elements moved to p, shape (n,).

        Strains of moved elements count per moved length; all other unknowns keep their values.
        """
        return self._widths(p) / self.nominal_widths

    @cached_property
    def nominal_widths(self) -> FloatArray:
        """Width of the unmoved element of each strain coordinate, 1 for other unknowns, shape (n,)."""
        return self._widths(self.state.places)

    def _widths(self, p: FloatArray) -> FloatArray:
        model = self.nominal.model
        widths = np.ones(model.size)
        for name, rod in model.discrete.rods.items():
            own = np.diff(self.ends(name, p))
            first = model.discrete.unknowns.strain(name).start
            for entries in rod.columns.values():
                modes = (entries.stop - entries.start) // rod.grid.elements
                widths[first + entries.start : first + entries.stop] = np.repeat(own, modes)
        return widths

    def residual(self, z: FloatArray, given: FloatArray) -> FloatArray:
        """Residual of balance and gaps for inputs; NaN if element ends would not ascend along a rod."""
        if not self.in_order(self.parts(z)[2]):
            return np.full(len(z), np.nan)
        return column(self._functions[0](*self.numbers(z, given)))

    def numbers(self, z: FloatArray, given: FloatArray) -> list[FloatArray]:
        """Values of the arguments of the functions of :attr:`written`."""
        x, f, p = self.parts(z)
        return [x, f, np.concatenate([p, self.theta]), given]

    def _derivatives(self, z: FloatArray, given: FloatArray) -> FloatArray:
        """Derivatives of the residual by z, then by the parameters of the scene."""
        return np.asarray(self._functions[1](*self.numbers(z, given)).full())

    def jacobian(self, z: FloatArray, given: FloatArray) -> FloatArray:
        """Derivative of the residual by z."""
        return self._derivatives(z, given)[:, : len(z)]

    def by_inputs(self, z: FloatArray, given: FloatArray) -> FloatArray:
        """Derivative of the residual by the inputs, shape (len(z), inputs)."""
        return np.asarray(self._by_arguments(*self.numbers(z, given)).full())

    def rate(self, z: FloatArray, change: FloatArray, of_parameters: FloatArray) -> FloatArray:
        """Rate of the residual as inputs and parameters of these equations change, shape (len(z),)."""
        rate = self.by_inputs(z, self.given) @ change
        if of_parameters.size:
            rate = rate + self._derivatives(z, self.given)[:, len(z) :] @ of_parameters
        return np.asarray(rate)

    def moved(self, z: FloatArray, by_inputs: FloatArray, by_parameters: FloatArray) -> FloatArray:
        """Derivatives of the solution z by m arguments of the scene while its contacts stay, shape (len(z), m).

        Args:
            z: the solution at the inputs and parameters of these equations.
            by_inputs: derivatives of the inputs by the arguments, shape (inputs, m).
            by_parameters: derivatives of the parameters, shape (parameters, m).

        Returns:
            derivatives; NaN if the equations are singular.
        """
        derivatives = self._derivatives(z, self.given)
        pushed = self.by_inputs(z, self.given) @ by_inputs + derivatives[:, len(z) :] @ by_parameters
        moved = solved(derivatives[:, : len(z)], -pushed)
        return np.full(pushed.shape, np.nan) if moved is None else moved

    def arguments_moved(self, by_z: FloatArray, by_inputs: FloatArray, by_parameters: FloatArray) -> FloatArray:
        """Derivatives of all stacked arguments of :attr:`model` by m arguments of the scene.

        Args:
            by_z: derivatives of z, shape (len(z), m).
            by_inputs: derivatives of the inputs of the scene, shape (inputs, m).
            by_parameters: derivatives of its parameters, shape (parameters, m).
        """
        x, f, places = np.split(by_z, np.cumsum([self.nominal.model.size, len(self.nominal.force_units)]))
        inputs = self.nominal.inputs_moved(by_inputs, f)
        return np.vstack([x, inputs, places, by_parameters])

    def start_near(self, near: Solution) -> FloatArray:
        """Start z from a shape near the solution, with the forces that balance it best, shape (n + k + p,)."""
        return self.start_from(projected(near, self.nominal.model), self.given)

    def start_from(self, x: FloatArray, given: FloatArray) -> FloatArray:
        """Start z from a shape, with the forces that balance it best; the balance is linear in the forces.

        Args:
            x: unknowns of the nominal model, shape (n,).
            given: stacked inputs of the scene without contacts.

        Returns:
            z, shape (n + k + p,), for k forces and p places.
        """
        forces = np.zeros(len(self.nominal.force_units))
        z = np.concatenate([x, forces, self.state.places])
        if not len(forces):
            return z
        own = slice(len(x), len(x) + len(forces))
        balance = self.residual(z, given)[: len(x)]
        by_forces = self.jacobian(z, given)[: len(x), own]
        z[own], *_ = np.linalg.lstsq(by_forces, -balance, rcond=FIT)
        return z

    @property
    def equations(self) -> Equations:
        """The equations for Newton's method: residual and Jacobian as functions of z."""
        return Equations(lambda z: self.residual(z, self.given), lambda z: self.jacobian(z, self.given))
