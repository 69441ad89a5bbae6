"""Rods, floating frames, loads and actuators of a scene as expressions of its unknowns and inputs.

Rods stand side by side, each in the axes of its base. A scene of one rod is no special case: what couples rods adds
rows and columns (model/assembly.py), never instructions to the rods themselves. Docs/theory.md, sections 2 to 8.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import casadi as ca

from cosserat_casadi import scene as scenes
from cosserat_casadi.constraints.cable_length import SMOOTHING, CableLength
from cosserat_casadi.constraints.section_constraint import Poses
from cosserat_casadi.maths.pose import IDENTITY, Pose
from cosserat_casadi.maths.rotation import quaternion_to_matrix
from cosserat_casadi.maths.typing import FloatArray, Matrix
from cosserat_casadi.model.constraints import PlacedConstraint
from cosserat_casadi.model.discrete_scene import CableOfLength, DiscreteScene
from cosserat_casadi.model.floating_frames import FrameName
from cosserat_casadi.model.frame_pose import FramePose
from cosserat_casadi.model.homotopy import LoadFactor, scaled, scaled_effort, smoothing_at
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

CORNER = 0.01
"""Smoothing, relative to the rod's length, of the corner between slack and taut in the unloaded scene."""

ROUNDING = 1e-16
"""Entry of a rotation matrix below which it is rounding."""


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
    """A scene in given arguments.

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
    def frame_poses(self) -> dict[FrameName, FramePose]:
        """World poses of the floating frames."""
        return {name: FramePose(frame, self.deviation(name)) for name, frame in self.discrete.frames.items()}

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
        if frame is None:
            return self._still_base(rod)
        return self.frame(frame)

    def frame(self, name: FrameName) -> Pose:
        """World pose of a floating frame."""
        return self.frame_poses[name].pose

    def poses(self, placed: PlacedConstraint) -> Poses:
        """The poses that a constraint reads."""
        section = self.section(placed.rod, placed.node)
        base = self.base(placed.rod)
        return Poses(section, base, self._frame_of(placed))

    def _frame_of(self, placed: PlacedConstraint) -> Pose:
        """World pose of the frame on the other side of a constraint; the world's own for a support."""
        if placed.frame is None:
            return IDENTITY.pose
        return self.frame(placed.frame)

    def multipliers(self, placed: PlacedConstraint) -> Matrix:
        """Multipliers of a constraint."""
        return self.arguments.x[self.discrete.multipliers(placed)]

    def deviation(self, name: FrameName) -> Matrix:
        """Unknowns of a floating frame, 7×1."""
        return self.arguments.x[self.discrete.deviation(name)]

    def actuator(self, name: str) -> tuple[Matrix, Matrix, Matrix]:
        """Effort of an actuator, the length or volume that it works on, and the derivative of that with x."""
        actuator = next(actuator for actuator in self.discrete.scene.actuators if actuator.name == name)
        member = EFFECTS[actuator.kind]
        grid = self.discrete.rods[actuator.rod].grid
        quantity = member.quantity(actuator, grid)
        conjugate = quantity.on(self.rods[actuator.rod].shape)
        effort = self._effort(actuator)
        # The smooth complementarity leaves a slack cable a tension of either sign, as small as its smoothing.
        if member.may_go_slack(actuator):
            effort = ca.fmax(effort, 0.0)
        gradient = self._among_unknowns(actuator.rod, conjugate.gradient)
        return effort, conjugate.value, gradient.T

    def _effort(self, actuator: scenes.Actuator) -> Matrix:
        """Effort of an actuator: an input, or unknown where the scene gives what it works on."""
        member = EFFECTS[actuator.kind]
        if member.prescribes_conjugate(actuator):
            return self._unknown_tension(self._cable(actuator.name))
        effort = input_value(self.discrete.layout, actuator, member.effort, self.arguments.inputs)
        if effort is None:
            return ca.DM(0.0)
        return effort

    def _cable(self, name: str) -> CableOfLength:
        return next(cable for cable in self.discrete.cables if cable.tendon.name == name)

    def _still_base(self, rod: str) -> Pose:
        """Pose of a base that rests in the world: the scene's, or what the inputs say."""
        record = self.discrete.unloaded.records[rod]
        given_position, given_quaternion = base_pose(record)
        position: Matrix = ca.DM(given_position)
        quaternion: Matrix = ca.DM(given_quaternion)
        free_position = self._rod_input(rod, "base.position")
        free_quaternion = self._rod_input(rod, "base.quaternion")
        if free_position is not None:
            position = free_position
        if free_quaternion is not None:
            norm = ca.sqrt(ca.sumsqr(free_quaternion))
            quaternion = free_quaternion / norm
        return Pose(position, quaternion)

    def _rod_input(self, rod: str, field: str) -> Matrix | None:
        """An input of a rod's own geometry; None where the scene fixes it."""
        entries = self.discrete.layout.of_rod(rod, field)
        if entries is None:
            return None
        return self.arguments.inputs[entries]

    def energy(self) -> Matrix:
        """Elastic energy of all rods, J."""
        energies = [igm.energy for igm in self.rods.values()]
        return ca.sum1(ca.vertcat(*energies))

    def potential(self) -> Matrix | None:
        """Energy of all rods and their dead forces, J; None where some load has none that can be written."""
        terms = [igm.potential for igm in self.rods.values()]
        known = [term for term in terms if term is not None]
        if self.discrete.constraints or len(known) < len(terms):
            return None
        return ca.sum1(ca.vertcat(*known))

    def dead_wrenches(self, rod: str) -> list[Wrench]:
        """Wrenches of the scene's loads on a rod that keep their direction in the world, base frame."""
        wrenches = [load for load in self._loads(rod) if not isinstance(load, PoseWrench)]
        return [wrench for wrench in wrenches if not wrench.follower]

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
        # The scene's rules let no tendon of given length have the length zero.
        assert wanted is not None
        routed = cable.routing.on(self.rods[tendon.rod].shape)
        return CableLength(
            cable=routed,
            wanted=wanted,
            tension=self.arguments.x[self.discrete.tension(cable)],
            slack=EFFECTS[tendon.kind].may_go_slack(tendon),
            softness=cable.softness,
            smoothing=smoothing_at(CORNER, SMOOTHING, self.arguments.load_factor),
        )

    def _among_unknowns(self, rod: str, columns: Matrix) -> Matrix:
        """Columns on the coordinates of one rod, among those of all unknowns."""
        entries = self.discrete.unknowns.strain(rod)
        count = columns.shape[1]
        zeros = type(columns)
        before = zeros(entries.start, count)
        after = zeros(self.discrete.size - entries.stop, count)
        return ca.vertcat(before, columns, after)

    def _rod(self, name: str) -> InverseGeometricModel:
        """Balance of a rod under its loads, the wrenches of its constraints, its actuators and its cables."""
        rod = self.discrete.rods[name]
        strains = self.discrete.unknowns.strain(name)
        q = self.arguments.x[strains]
        constraints = self.discrete.constraints_on(name)
        wrenches = [self._constraint_wrench(placed) for placed in constraints]
        loads = [*self._loads(name), *wrenches]
        ratio = ratio_of(self.discrete, name, self.arguments)
        rod_shape = shape(rod, q, ratio)
        return InverseGeometricModel(Statics(rod_shape, loads), self._actuation(name))

    def _actuation(self, rod: str) -> tuple[Actuation, ...]:
        """Actuators on a rod: the efforts that are given, at the load factor, then the unknown tensions."""
        given = rod_actuation(self.discrete, rod, self.arguments.inputs)
        efforts = [scaled_effort(actuation, self.arguments.load_factor) for actuation in given]
        for cable in self.discrete.cables:
            # An unknown tension is what its length asks for at this load factor: it is not scaled.
            if cable.tendon.rod == rod:
                tension = self._unknown_tension(cable)
                efforts.append(Actuation(cable.routing, tension))
        return tuple(efforts)

    def _constraint_wrench(self, placed: PlacedConstraint) -> PointWrench:
        """Wrench of a constraint on its section, in the axes of the rod's base."""
        constraint = placed.constraint
        held = constraint.held
        multipliers = self.multipliers(placed)
        if held.turn_with_place:
            poses = self._poses_but_section(placed)
            wrench = constraint.wrench_basis(poses) @ multipliers
            return PointWrench(constraint.at, wrench[3:], wrench[:3], follower=False)
        # Constant directions: the constraint costs its rod no more than a load of fixed direction.
        displacements = held.positions.shape[1]
        force_unit = constraint.unit / constraint.rod.length
        force = force_unit * (_sparse(held.positions) @ multipliers[:displacements])
        if not held.rotations.size:
            return PointWrench(constraint.at, force, None, follower=False)
        moment = constraint.unit * (_sparse(held.rotations) @ multipliers[displacements:])
        return PointWrench(constraint.at, force, moment, follower=False)

    def _poses_but_section(self, placed: PlacedConstraint) -> Poses:
        """The poses that the direction of a constraint's wrench depends on; the section's is not among them.

        The pose of the section follows from the wrench: the balance of the rod cannot be written in it.
        """
        return Poses(IDENTITY.pose, self.base(placed.rod), self._frame_of(placed))

    def _unknown_tension(self, cable: CableOfLength) -> Matrix:
        """Tension of a cable of given length, N."""
        unit = self.discrete.tension_unit(cable.tendon.rod)
        tension = self.arguments.x[self.discrete.tension(cable)]
        return unit * tension

    def _base_R_world(self, rod: str) -> Matrix:
        """Rotation from the world into the base of a rod, 3×3; sparse where it is constant."""
        rotation = quaternion_to_matrix(self.base(rod).quaternion)
        # Zeros of a constant base, an upright rod's above all, cost no product.
        if isinstance(rotation, ca.DM):
            rotation = ca.sparsify(rotation, ROUNDING)
        return rotation.T


def ratio_of(discrete: DiscreteScene, rod: str, arguments: Arguments) -> Ratio:
    """Length of a rod relative to the scene's where it is an input, else None."""
    entries = discrete.layout.of_rod(rod, "length")
    if entries is None:
        return None
    length = arguments.inputs[entries]
    return length / discrete.rods[rod].properties.length


def _sparse(vectors: FloatArray) -> ca.DM:
    return ca.sparsify(ca.DM(vectors))
