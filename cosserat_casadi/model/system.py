"""The equations of a scene as expressions: rods side by side, coupled by constraints.

A single rod is the case of one; what couples rods adds rows and columns, never instructions to the rods themselves.
The equations of docs/theory.md, sections 2 to 8, in the order of the unknowns:

    rods          K q + Q_ad = 0, the report's (2.20), under loads and multipliers
    constraints   what is left to close = 0
    frames        balance of every floating frame = 0
    cables        length, or slack = 0
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import casadi as ca

from cosserat_casadi import scene as scenes
from cosserat_casadi.constraints.cable_length import CableLength
from cosserat_casadi.constraints.section_constraint import Poses
from cosserat_casadi.maths.pose import IDENTITY, Pose
from cosserat_casadi.maths.rotation import quaternion_to_matrix
from cosserat_casadi.maths.typing import FloatArray, Matrix
from cosserat_casadi.model.assembly import Assembly
from cosserat_casadi.model.constraints import PlacedConstraint
from cosserat_casadi.model.discrete_scene import CableOfLength, DiscreteScene
from cosserat_casadi.model.floating_frames import FrameName
from cosserat_casadi.model.homotopy import LoadFactor, row_at, scaled, scaled_effort
from cosserat_casadi.model.load_assembly import RodBase, RodLoads, input_value, rod_actuation
from cosserat_casadi.model.registry import EFFECTS
from cosserat_casadi.model.rods import base_pose
from cosserat_casadi.rod.actuation import Actuation
from cosserat_casadi.rod.igm import InverseGeometricModel
from cosserat_casadi.rod.kinematics import shape
from cosserat_casadi.rod.statics import Statics
from cosserat_casadi.rod.strain import Ratio
from cosserat_casadi.rod.tangent import Tangent
from cosserat_casadi.rod.wrenches import PointWrench, PoseWrench, RodLoad, Wrench


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
        member = EFFECTS[actuator.kind]
        quantity = member.quantity(actuator, self.discrete.rods[actuator.rod].grid)
        conjugate = quantity.on(self.rods[actuator.rod].shape)
        effort = self._effort(actuator)
        if member.may_go_slack(actuator):
            effort = ca.fmax(effort, 0.0)
        return effort, conjugate.value, self._among_unknowns(actuator.rod, conjugate.gradient).T

    def _effort(self, actuator: scenes.Actuator) -> Matrix:
        """Effort of an actuator: an input, or unknown where the scene gives what it works on."""
        member = EFFECTS[actuator.kind]
        if member.prescribes_conjugate(actuator):
            return self._unknown_tension(self._cable(actuator.name))
        value = input_value(self.discrete.layout, actuator, member.effort, self.arguments.inputs)
        return ca.DM(0.0) if value is None else value

    def _cable(self, name: str) -> CableOfLength:
        return next(cable for cable in self.discrete.cables if cable.tendon.name == name)

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

    def dead_wrenches(self, rod: str) -> list[Wrench]:
        """Wrenches of the scene's loads on a rod that keep their direction in the world, base frame."""
        return [load for load in self._loads(rod) if not isinstance(load, PoseWrench) and not load.follower]

    def _loads(self, rod: str) -> list[RodLoad]:
        """The scene's loads on a rod at the load factor, base frame."""
        base = RodBase(self.base(rod).position, self._base_R_world(rod))
        ratio = ratio_of(self.discrete, rod, self.arguments)
        loads = RodLoads(self.discrete, rod, base, self.arguments.inputs, ratio).all()
        return [scaled(load, self.arguments.load_factor) for load in loads]

    @cached_property
    def cable_lengths(self) -> dict[str, CableLength]:
        """Equations of the cables of given length by the names of their tendons."""
        return {cable.tendon.name: self._cable_length(cable) for cable in self.discrete.cables}

    def _cable_length(self, cable: CableOfLength) -> CableLength:
        tendon = cable.tendon
        wanted = input_value(self.discrete.layout, tendon, "length", self.arguments.inputs)
        assert wanted is not None
        return CableLength(
            cable=cable.routing.on(self.rods[tendon.rod].shape),
            wanted=wanted,
            tension=self.arguments.x[self.discrete.tension(cable)],
            slack=EFFECTS[tendon.kind].may_go_slack(tendon),
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
        loads = [*self._loads(name), *map(self._constraint_wrench, self.discrete.constraints_on(name))]
        given = rod_actuation(self.discrete, name, self.arguments.inputs)
        efforts = [scaled_effort(actuation, self.arguments.load_factor) for actuation in given]
        cables = [cable for cable in self.discrete.cables if cable.tendon.rod == name]
        efforts += [Actuation(cable.routing, self._unknown_tension(cable)) for cable in cables]
        rod_shape = shape(rod, q, ratio_of(self.discrete, name, self.arguments))
        return InverseGeometricModel(Statics(rod_shape, loads), tuple(efforts))

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

    def _base_R_world(self, rod: str) -> Matrix:
        rotation = quaternion_to_matrix(self.base(rod).quaternion)
        return ca.sparsify(rotation, 1e-16).T if isinstance(rotation, ca.DM) else rotation.T


def ratio_of(discrete: DiscreteScene, rod: str, arguments: Arguments) -> Ratio:
    """Length of a rod relative to the scene's where it is an input, else None."""
    entries = discrete.layout.of_rod(rod, "length")
    return None if entries is None else arguments.inputs[entries] / discrete.rods[rod].properties.length


def _sparse(vectors: FloatArray) -> ca.DM:
    return ca.sparsify(ca.DM(vectors))
