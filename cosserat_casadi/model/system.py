"""The equations of a scene as expressions: rods side by side, coupled by constraints.

A single rod is the case of one; what couples rods adds rows and columns, never instructions to the rods themselves.
The equations of docs/theory.md, sections 2 to 8, in the order of the unknowns:

    rods          K q + Q_ad = 0, the report's (2.20), under loads and multipliers
    constraints   what is left to close = 0
    frames        balance of every floating frame = 0
    cables        length, or slack = 0
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import casadi as ca

from cosserat_casadi import scene as scenes
from cosserat_casadi.actuators.chamber import PRESSED, volume_rates
from cosserat_casadi.actuators.routing import routing
from cosserat_casadi.constraints.cable_length import CableLength
from cosserat_casadi.constraints.section_constraint import Poses
from cosserat_casadi.loads.load import Site, constant
from cosserat_casadi.maths.pose import IDENTITY, Pose
from cosserat_casadi.maths.rotation import quaternion_to_matrix
from cosserat_casadi.maths.typing import FloatArray, Matrix
from cosserat_casadi.model.assembly import Assembly
from cosserat_casadi.model.constraints import PlacedConstraint
from cosserat_casadi.model.discrete_scene import CableOfLength, DiscreteScene
from cosserat_casadi.model.floating_frames import FrameName
from cosserat_casadi.model.homotopy import LoadFactor, row_at, scaled
from cosserat_casadi.model.inputs import InputLayout, magnitude
from cosserat_casadi.model.registry import EFFECTS
from cosserat_casadi.model.rods import base_pose
from cosserat_casadi.rod.cable import RoutedCable
from cosserat_casadi.rod.igm import InverseGeometricModel
from cosserat_casadi.rod.kinematics import Shape, shape
from cosserat_casadi.rod.statics import Statics
from cosserat_casadi.rod.strain import Ratio
from cosserat_casadi.rod.tangent import Tangent
from cosserat_casadi.rod.wrenches import Action, Actuation, Cable, LineWrench, PointWrench, Wrench


@dataclass(frozen=True)
class Arguments:
    """Symbols, or numbers, that a system is written in.

    Attributes:
        x: unknowns.
        inputs: stacked inputs.
        load_factor: λ from 0, the unloaded scene, to 1; None for the scene itself.
    """

    x: Matrix
    inputs: Matrix
    load_factor: LoadFactor = None


@dataclass(frozen=True)
class System:
    """The equations of a scene in given arguments.

    Attributes:
        discrete: what is constant.
        arguments: what they are written in.
    """

    discrete: DiscreteScene
    arguments: Arguments

    @cached_property
    def rods(self) -> dict[str, InverseGeometricModel]:
        """Balance of every rod, in its base frame."""
        return {name: self._rod(name) for name in self.discrete.rods}

    @cached_property
    def tangents(self) -> dict[str, Tangent]:
        """Variations of every rod's fields."""
        return {name: Tangent(igm) for name, igm in self.rods.items()}

    @cached_property
    def assembly(self) -> Assembly:
        """What floating frames and constraints add."""
        return Assembly(self)

    @cached_property
    def residual(self) -> Matrix:
        """Residuals of rods, constraints, floating frames and cables of given length, without unit, size×1."""
        rods = [igm.residual for igm in self.rods.values()]
        lengths = [self._length_row(cable) for cable in self.discrete.cables]
        return ca.vertcat(*rods, *self.assembly.constraint_rows, *self.assembly.balance_rows, *lengths)

    @cached_property
    def jacobian(self) -> Matrix:
        """∂ residual / ∂x from its structure, exact for the discrete model; sparse by rods."""
        if any(rod.discretisation.transport == "permuted" for rod in self.discrete.rods.values()):
            return ca.jacobian(self.residual, self.arguments.x)
        if self.discrete.constraints or self.discrete.cables:
            return self.assembly.jacobian
        return ca.diagcat(*[tangent.jacobian for tangent in self.tangents.values()])

    def section(self, rod: str, node: int) -> Pose:
        """Pose of a node's section in the base of its rod."""
        rod_shape = self.rods[rod].shape
        return Pose(rod_shape.position_at(node), rod_shape.quaternion[:, node])

    def tip(self, rod: str) -> Pose:
        """Pose of a rod's tip in its base frame."""
        return self.section(rod, -1)

    def base(self, rod: str) -> Pose:
        """World pose of a rod's base."""
        frame = self.discrete.unloaded.floating_base(rod)
        return self._still_base(rod) if frame is None else self.frame(frame)

    def frame(self, name: FrameName) -> Pose:
        """World pose of a floating frame."""
        return self.assembly.poses[name].pose

    def poses(self, placed: PlacedConstraint) -> Poses:
        """The poses that a constraint reads."""
        frame = IDENTITY.pose if placed.frame is None else self.frame(placed.frame)
        return Poses(self.section(placed.rod, placed.node), self.base(placed.rod), frame)

    def multipliers(self, placed: PlacedConstraint) -> Matrix:
        """Multipliers of a constraint."""
        return self.arguments.x[self.discrete.multipliers(placed)]

    def actuator(self, name: str) -> tuple[Matrix, Matrix, Matrix]:
        """Effort of an actuator, the length or volume that it works on, and the derivative of that with x."""
        actuator = next(actuator for actuator in self.discrete.scene.actuators if actuator.name == name)
        rod_shape = self.rods[actuator.rod].shape
        rod = self.discrete.rods[actuator.rod]
        if actuator.kind == "chamber":
            rates = ca.DM(volume_rates(actuator, rod.grid) * rod.properties.length * rod.grid.weights)
            effort = self._effort(actuator, "pressure")
            conjugate, gradient = rod_shape.strain_work(PRESSED, rates)
        else:
            cable = RoutedCable(rod_shape, routing(actuator, rod.grid))
            effort = self._cable_tension(actuator)
            effort = ca.fmax(effort, 0.0) if actuator.slack else effort
            conjugate = cable.length
            gradient = cable.length_gradient
        return effort, conjugate, self._among_unknowns(actuator.rod, gradient).T

    def _cable_tension(self, tendon: scenes.Tendon) -> Matrix:
        """Tension of a tendon, N: an input, or unknown where its length is given."""
        if tendon.length is None:
            return self._effort(tendon, "tension")
        return self._unknown_tension(self._cable(tendon.name))

    def _cable(self, name: str) -> CableOfLength:
        return next(cable for cable in self.discrete.cables if cable.tendon.name == name)

    def _effort(self, actuator: scenes.Actuator, field: str) -> Matrix:
        value = self._value(actuator, field)
        return ca.DM(0.0) if value is None else value

    def _still_base(self, rod: str) -> Pose:
        """Pose of a base that rests in the world: the scene's, or what the inputs say."""
        record = self.discrete.unloaded.records[rod]
        position, quaternion = (ca.DM(part) for part in base_pose(record))
        free_position = self._rod_input(rod, "base.position")
        free_quaternion = self._rod_input(rod, "base.quaternion")
        if free_position is not None:
            position = free_position
        if free_quaternion is not None:
            quaternion = free_quaternion / ca.sqrt(ca.sumsqr(free_quaternion))
        return Pose(position, quaternion)

    def _rod_input(self, rod: str, field: str) -> Matrix | None:
        """An input of a rod's own geometry; None where the scene fixes it."""
        entries = self.discrete.layout.of_rod(rod, field)
        return None if entries is None else self.arguments.inputs[entries]

    def energy(self) -> Matrix:
        """Elastic energy of all rods, J."""
        return ca.sum1(ca.vertcat(*[igm.energy for igm in self.rods.values()]))

    def potential(self) -> Matrix | None:
        """Energy of all rods and their dead forces, J; None where some load has none that can be written."""
        terms = [igm.potential for igm in self.rods.values()]
        known = [term for term in terms if term is not None]
        if self.discrete.constraints or len(known) < len(terms):
            return None
        return ca.sum1(ca.vertcat(*known))

    def values(self, load: scenes.Load | scenes.Actuator) -> dict[str, Matrix | None]:
        """Magnitudes of a load in these arguments; None where one is zero for good."""
        return {field: self._value(load, field) for field in load.inputs}

    def dead_wrenches(self, rod: str) -> list[Wrench]:
        """Wrenches of the scene's loads on a rod that keep their direction in the world, base frame."""
        actions = [scaled(action, self.arguments.load_factor) for action in self._actions(rod)]
        return [a for a in actions if not isinstance(a, Actuation) and not a.follower]

    @cached_property
    def cable_lengths(self) -> dict[str, CableLength]:
        """Equations of the cables of given length by the names of their tendons."""
        return {cable.tendon.name: self._cable_length(cable) for cable in self.discrete.cables}

    def _cable_length(self, cable: CableOfLength) -> CableLength:
        cables = self.rods[cable.tendon.rod].cables
        wanted = self._value(cable.tendon, "length")
        assert wanted is not None
        return CableLength(
            cable=next(routed for _, routed in cables if routed.routing is cable.routing),
            wanted=wanted,
            tension=self.arguments.x[self.discrete.tension(cable)],
            slack=cable.tendon.slack,
        )

    def _length_row(self, cable: CableOfLength) -> Matrix:
        equation = self.cable_lengths[cable.tendon.name]
        return row_at(equation.residual, equation.tension, cable.compliance, self.arguments.load_factor)

    def _among_unknowns(self, rod: str, columns: Matrix) -> Matrix:
        """Columns on the coordinates of one rod, among those of all unknowns."""
        entries = self.discrete.unknowns.strain(rod)
        count = columns.shape[1]
        zeros = type(columns)
        before = zeros(entries.start, count)
        after = zeros(self.discrete.size - entries.stop, count)
        return ca.vertcat(before, columns, after)

    def _rod(self, name: str) -> InverseGeometricModel:
        rod = self.discrete.rods[name]
        q = self.arguments.x[self.discrete.unknowns.strain(name)]
        actions = [scaled(action, self.arguments.load_factor) for action in self._actions(name)]
        actions += [self._constraint_wrench(placed) for placed in self.discrete.constraints_on(name)]
        cables = [cable for cable in self.discrete.cables if cable.tendon.rod == name]
        actions += [Cable(cable.routing, self._unknown_tension(cable)) for cable in cables]
        return balance(shape(rod, q, ratio_of(self.discrete, name, self.arguments)), actions)

    def _constraint_wrench(self, placed: PlacedConstraint) -> PointWrench:
        """Wrench of a constraint on its section, in the axes of the rod's base."""
        constraint = placed.constraint
        held = constraint.held
        multipliers = self.multipliers(placed)
        if held.turn_with_place:
            wrench = constraint.wrench_basis(self._frames_of(placed)) @ multipliers
            return PointWrench(constraint.at, wrench[3:], wrench[:3], follower=False)
        displacements = held.positions.shape[1]
        force = constraint.unit / constraint.rod.length * (_sparse(held.positions) @ multipliers[:displacements])
        moment = constraint.unit * (_sparse(held.rotations) @ multipliers[displacements:])
        return PointWrench(constraint.at, force, moment if held.rotations.size else None, follower=False)

    def _frames_of(self, placed: PlacedConstraint) -> Poses:
        """The poses that the direction of a constraint's wrench hangs on; the section's is not among them."""
        frame = IDENTITY.pose if placed.frame is None else self.frame(placed.frame)
        return Poses(IDENTITY.pose, self.base(placed.rod), frame)

    def _unknown_tension(self, cable: CableOfLength) -> Matrix:
        """Tension of a cable of given length, N."""
        return self.discrete.tension_unit(cable.tendon.rod) * self.arguments.x[self.discrete.tension(cable)]

    def _actions(self, rod: str) -> list[Action]:
        return rod_actions(self.discrete, rod, self._base_R_world(rod), self.arguments)

    def _base_R_world(self, rod: str) -> Matrix:
        rotation = quaternion_to_matrix(self.base(rod).quaternion)
        return ca.sparsify(rotation, 1e-16).T if isinstance(rotation, ca.DM) else rotation.T

    def _value(self, load: scenes.Load | scenes.Actuator, field: str) -> Matrix | None:
        return _value(self.discrete.layout, load, field, self.arguments.inputs)


def balance(rod_shape: Shape, actions: Sequence[Action]) -> InverseGeometricModel:
    """Balance of a rod of this shape under these actions."""
    wrenches = [action for action in actions if not isinstance(action, Actuation)]
    actuation = tuple(action for action in actions if isinstance(action, Actuation))
    return InverseGeometricModel(Statics(rod_shape, wrenches), actuation)


def rod_actions(discrete: DiscreteScene, rod: str, base_R_world: Matrix, arguments: Arguments) -> list[Action]:
    """What the scene's loads and actuators do to one rod, in its base frame."""
    discrete_rod = discrete.rods[rod]
    site = Site(discrete_rod.properties, discrete_rod.grid, base_R_world)
    ratio = ratio_of(discrete, rod, arguments)
    actions: list[Action] = []
    for cause in discrete.scene.causes:
        effect = EFFECTS[cause.kind]
        if effect.acts_on(cause, rod):
            values = {f: _value(discrete.layout, cause, f, arguments.inputs) for f in cause.inputs}
            actions.extend(per_length(action, ratio) for action in effect.actions(cause, site, values))
    return actions


def ratio_of(discrete: DiscreteScene, rod: str, arguments: Arguments) -> Ratio:
    """Length of a rod relative to the scene's where it is an input, else None."""
    entries = discrete.layout.of_rod(rod, "length")
    return None if entries is None else arguments.inputs[entries] / discrete.rods[rod].properties.length


def per_length(action: Action, ratio: Ratio) -> Action:
    """An action on a rod whose length is free: what acts per length acts on more or less of it."""
    if ratio is None or not isinstance(action, LineWrench):
        return action
    return scaled(action, ratio)


def _value(layout: InputLayout, cause: scenes.Load | scenes.Actuator, field: str, inputs: Matrix) -> Matrix | None:
    entries = layout.of_load(cause.name, field)
    default = magnitude(cause, field)
    if entries is None:
        return constant(default)
    return ca.reshape(inputs[entries], *default.shape)


def _sparse(vectors: FloatArray) -> ca.DM:
    return ca.sparsify(ca.DM(vectors))
