"""Rods, floating frames, loads and actuators of a scene as expressions of its unknowns and inputs.

Rods stand side by side, each in the axes of its base. A scene of one rod is no special case: couplings of rods add rows
and columns (model/assembly_equations.py), never instructions to the rods themselves. See docs/theory.md, sections 2 to
8.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import casadi as ca
import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.constraints.joint_coordinate import JointEffort
from cosserat_casadi.constraints.joints import JOINT_KINDS
from cosserat_casadi.constraints.section_constraint import ConstraintPoses
from cosserat_casadi.errors import Problem, SceneError
from cosserat_casadi.maths.numbers import as_matrix, as_vector, is_zero, sparse_known
from cosserat_casadi.maths.pose import IDENTITY, Pose
from cosserat_casadi.maths.rotation import quaternion_product
from cosserat_casadi.maths.typing import FloatArray, Matrix
from cosserat_casadi.model.discrete_scene import DiscreteScene, JointStop
from cosserat_casadi.model.drag_terms import BodyDrag, RodDrag, drags_of
from cosserat_casadi.model.floating_frames import FrameName, FramePose
from cosserat_casadi.model.frame_motion import BodyInertia, FloatingFrameMotion, QuaternionMotion, body_inertia
from cosserat_casadi.model.homotopy import LoadFactor, scaled
from cosserat_casadi.model.inputs import input_value
from cosserat_casadi.model.load_assembly import RodBase, RodLoads
from cosserat_casadi.model.pair_terms import PairTerms
from cosserat_casadi.model.riding_bodies import RidingBody
from cosserat_casadi.model.scene_actuators import SceneActuators
from cosserat_casadi.model.scene_constraints import PlacedConstraint
from cosserat_casadi.model.scene_rods import written_base_pose
from cosserat_casadi.model.touching_rods import TouchingRods
from cosserat_casadi.model.unknowns import BlockKind
from cosserat_casadi.rod.igm import InverseGeometricModel
from cosserat_casadi.rod.inertia import RodInertia, SectionMasses, rod_mass, section_masses
from cosserat_casadi.rod.kinematics import Shape, shape
from cosserat_casadi.rod.relaxation import Relaxation
from cosserat_casadi.rod.rod_motion import AT_REST, FrameMotion, RodMotion, StrainRates
from cosserat_casadi.rod.statics import Statics
from cosserat_casadi.rod.strain import Ratio
from cosserat_casadi.rod.tangent import Columns, Tangent
from cosserat_casadi.rod.viscosity import Viscosity
from cosserat_casadi.rod.wrenches import PoseWrench, RodLoad, Wrench, WrenchAt

DRIVE_GROWTH = 6
"""Power of the load factor in the motion of drives of joints: they turn most while their constraints are rigid."""


@dataclass(frozen=True)
class MotionArguments:
    """Rates of the unknowns and of the inputs of a scene in motion.

    Attributes:
        v: rates of the unknowns, 1/s; rates of multipliers and tensions are ignored.
        a: second derivatives of the unknowns, 1/s².
        inputs_rate: rates of the stacked inputs; only rates of bases and lengths are used.
        inputs_acceleration: second derivatives of the stacked inputs.
    """

    v: Matrix
    a: Matrix
    inputs_rate: Matrix
    inputs_acceleration: Matrix


@dataclass(frozen=True)
class Arguments:
    """Arguments of a system, symbols or numbers.

    Attributes:
        x: unknowns.
        inputs: stacked inputs.
        load_factor: λ from 0, the unloaded scene, to 1; None for the scene itself.
        motion: rates of both; None at rest, where inertia adds nothing.
    """

    x: Matrix
    inputs: Matrix
    load_factor: LoadFactor = None
    motion: MotionArguments | None = None


@dataclass(frozen=True)
class System:
    """Rods, frames, loads and actuators of a scene in given arguments.

    Attributes:
        discrete: constant matrices of the scene.
        arguments: symbols or numbers that the expressions are written in.
        columns: columns of the variations of rods that are already computed, by rod.
        turns: turns of the intervals of a rod, by rod, that replace the turns by all its angular coordinates in
            :meth:`pose_variations`.
        friction: [force; moment] of each member of :attr:`rubbing`, by name; members that are left out are computed.
    """

    discrete: DiscreteScene
    arguments: Arguments
    columns: Mapping[str, Columns] = field(default_factory=dict)
    turns: Mapping[str, Matrix] = field(default_factory=dict)
    friction: Mapping[str, Sequence[Matrix]] = field(default_factory=dict)

    @cached_property
    def rods(self) -> dict[str, InverseGeometricModel]:
        """Balance of every rod in its base frame, under its loads, constraints, actuators and cables."""
        balances = {}
        for name, shape_of_rod in self.shapes.items():
            wrenches = [self._constraint_wrench(placed) for placed in self.discrete.constraints_on(name)]
            loads = [*self._loads(name), *wrenches, *self._pair_wrenches(name), *self._drag_wrenches(name)]
            loads += [*self._inertia_wrenches(name), *self._riding_inertias(name)]
            balances[name] = InverseGeometricModel(Statics(shape_of_rod, loads), self.actuators.on_rod(name))
        return balances

    @cached_property
    def tangents(self) -> dict[str, Tangent]:
        """Variations of every rod's fields."""
        # In motion there are so many more instructions that loops replace them.
        in_loops = self.arguments.motion is not None
        return {name: Tangent(igm, in_loops, given=self.columns.get(name)) for name, igm in self.rods.items()}

    def pose_variations(self, rod: str) -> Tangent:
        """Variations of a rod's sections, without variations of its loads."""
        return Tangent(InverseGeometricModel(Statics(self.shapes[rod], ())), turns=self.turns.get(rod))

    @cached_property
    def riding(self) -> dict[str, RidingBody]:
        """Bodies that ride on sections."""
        return {name: RidingBody(self.discrete, self.discrete.bodies[name]) for name in self.discrete.unloaded.riding}

    @cached_property
    def frame_poses(self) -> dict[FrameName, FramePose]:
        """World poses of the floating frames."""
        return {name: FramePose(frame, self.deviation(name)) for name, frame in self.discrete.frames.items()}

    @cached_property
    def shapes(self) -> dict[str, Shape]:
        """Shape of every rod, in its base frame."""
        shapes = {}
        for name, rod in self.discrete.rods.items():
            q = self.arguments.x[self.discrete.unknowns.strain(name)]
            shapes[name] = shape(rod, q, ratio_of(self.discrete, name, self.arguments))
        return shapes

    @cached_property
    def actuators(self) -> SceneActuators:
        """Actuators of all rods at the load factor."""
        return SceneActuators(
            self.discrete, self.arguments.x, self.arguments.inputs, self.arguments.load_factor, self.shapes
        )

    @cached_property
    def pairs(self) -> list[PairTerms]:
        """Pairs of rods that push each other."""
        return [PairTerms(self, pair) for pair in self.discrete.pairs]

    @cached_property
    def coupled_rods(self) -> list[PairTerms | TouchingRods]:
        """Pairs of rods that push each other smoothly, and pairs of rods that touch at a section of either."""
        return [*self.pairs, *(TouchingRods(self, load) for load in self.discrete.rods_points)]

    @cached_property
    def drags(self) -> list[RodDrag | BodyDrag]:
        """Drags of loads that bodies bear or that act on bodies; none at rest."""
        return [] if self.arguments.motion is None else list(drags_of(self))

    @property
    def rubbing(self) -> list[PairTerms | RodDrag | BodyDrag]:
        """All terms with friction that is computed apart: pairs of rods and drags."""
        return [*(terms for terms in self.pairs if terms.rubs), *self.drags]

    @cached_property
    def motions(self) -> dict[str, RodMotion]:
        """Motion of every rod, in its base frame; none at rest."""
        if self.arguments.motion is None:
            return {}
        motions = {}
        for name, rod_shape in self.shapes.items():
            motions[name] = RodMotion(rod_shape, self.strain_rates(name), self.base_motion(name)).damped
        return motions

    @cached_property
    def inertias(self) -> dict[str, RodInertia]:
        """Inertia of every rod in motion that has a mass, in its base frame."""
        inertias = {}
        for name, motion in self.motions.items():
            masses = section_masses(motion.rod, motion.shape.ratio)
            if masses is not None:
                inertias[name] = RodInertia(motion, masses)
        return inertias

    def inertia_of(self, rod: str) -> RodInertia:
        """Inertia of a rod in motion; a rod without mass stores nothing."""
        if rod in self.inertias:
            return self.inertias[rod]
        motion = self.motions[rod]
        return RodInertia(motion, SectionMasses(np.zeros(motion.rod.grid.size), {}))

    @cached_property
    def viscosities(self) -> dict[str, Viscosity]:
        """Viscous stress of the rods in motion that have any."""
        viscosities = {}
        for name, motion in self.motions.items():
            if motion.rod.properties.damping is not None:
                viscosities[name] = Viscosity(motion.shape, motion.rates)
        return viscosities

    @cached_property
    def relaxations(self) -> dict[str, Relaxation]:
        """Branches of the rods in motion whose stress relaxes.

        Raises:
            SceneError: the model was not built for a motion.
        """
        relaxations = {}
        for name, motion in self.motions.items():
            branches = len(motion.rod.properties.branches)
            if branches:
                given = self.arguments.motion
                assert given is not None, "asked for in motion"
                if not self.discrete.moving:
                    problem = "has stress that relaxes, and this model describes the scene at rest"
                    raise SceneError(Problem(f"{name}.damping.prony", problem, "build the model with moving=True"))
                flows = self.discrete.unknowns.slice_of(BlockKind.FLOW, name)
                size = (motion.rod.size, branches)
                velocity, acceleration = (ca.reshape(rate[flows], *size) for rate in (given.v, given.a))
                relaxations[name] = Relaxation(Viscosity(motion.shape, motion.rates), velocity, acceleration)
        return relaxations

    @cached_property
    def frame_motions(self) -> dict[FrameName, FloatingFrameMotion]:
        """Motions of the floating frames; none at rest."""
        motion = self.arguments.motion
        if motion is None:
            return {}
        motions = {}
        for name, frame in self.discrete.frames.items():
            entries = self.discrete.deviation(name)
            rate = motion.v[entries]
            acceleration = motion.a[entries]
            quaternion = QuaternionMotion(self.frame_poses[name].quaternion, rate[3:], acceleration[3:])
            norm_time = self._turning_mass(name) / frame.unit
            motions[name] = FloatingFrameMotion(frame, quaternion, rate, acceleration, norm_time)
        return motions

    def _turning_mass(self, name: FrameName) -> float:
        """Order of magnitude of the moment of inertia of a floating frame's body or rod, kg m²."""
        frame = self.discrete.nominal.frames[name]
        if frame.body is not None:
            return frame.body.mass * frame.length**2 + float(np.trace(frame.body.inertia_matrix))
        rod = self.discrete.nominal.rods[name.name]
        return rod_mass(rod) * frame.length**2

    @cached_property
    def body_motions(self) -> dict[str, FrameMotion]:
        """Motions of the bodies, world axes; none at rest."""
        motions = {name.name: moved.motion for name, moved in self.frame_motions.items() if name.kind == "body"}
        for name, riding in self.riding.items() if self.motions else ():
            rod = self.motions[riding.rod]
            world_R_base = self.base(riding.rod).rotation
            arm = self.section(riding.rod, riding.node).rotation @ riding.in_section.position
            motions[name] = rod.at(riding.node).at(arm).in_axes(world_R_base)
        return motions

    @cached_property
    def body_inertias(self) -> dict[str, BodyInertia]:
        """Inertia of every moving body with mass or moments of inertia, world axes."""
        inertias = {}
        for name, motion in self.body_motions.items():
            body = self.discrete.bodies[name]
            inertia = body_inertia(body)
            if is_zero(body.mass) and is_zero(inertia):
                continue
            inertias[name] = BodyInertia(
                mass=body.mass,
                centre_of_mass=as_vector(body.centre_of_mass),
                inertia=inertia,
                rotation=self.body(name).rotation,
                motion=motion,
            )
        return inertias

    def base_motion(self, rod: str) -> FrameMotion:
        """Motion of a rod's base in the world, in the axes of the base."""
        frame = self.discrete.unloaded.floating_base(rod)
        world_motion = self._still_base_motion(rod) if frame is None else self.frame_motions[frame].motion
        return world_motion.in_axes(self._base_R_world[rod])

    def section(self, rod: str, node: int) -> Pose:
        """Pose of a node's section in the base of its rod."""
        rod_shape = self.shapes[rod]
        return Pose(rod_shape.position_at(node), rod_shape.quaternion[:, node])

    def position_at(self, rod: str, node: int) -> Matrix:
        """World position of a node of a rod, 3×1, m."""
        base = self.base(rod)
        return base.position + base.rotation @ self.shapes[rod].position_at(node)

    def nodes(self, rod: str) -> Matrix:
        """World positions of the nodes of a rod, 3×M, m."""
        base, shape = self.base(rod), self.shapes[rod]
        return ca.repmat(base.position, 1, shape.rod.grid.size) + base.rotation @ shape.position

    def sections(self, rod: str, weights: Matrix) -> list[Matrix]:
        """World positions, 3×k, m, and directors, 3×k each, of sections interpolated by weights of nodes, M×k."""
        base, shape = self.base(rod), self.shapes[rod]
        start = ca.repmat(ca.MX(base.position), 1, weights.shape[1])
        directors = [base.rotation @ (director @ weights) for director in shape.directors]
        return [start + base.rotation @ (shape.position @ weights), *directors]

    def nodal_quaternions(self, rod: str) -> Matrix:
        """World quaternions of the nodes of a rod, 4×M."""
        shape = self.shapes[rod]
        bases = ca.MX(ca.repmat(self.base(rod).quaternion, 1, shape.rod.grid.size))
        return quaternion_product(bases, ca.densify(shape.quaternion))

    def base(self, rod: str) -> Pose:
        """World pose of a rod's base."""
        frame = self.discrete.unloaded.floating_base(rod)
        if frame is None:
            return self._still_bases[rod]
        return self.frame(frame)

    def frame(self, name: FrameName) -> Pose:
        """World pose of a floating frame, or of a body that rides on a section."""
        if name in self.frame_poses:
            return self.frame_poses[name].pose
        riding = self.riding[name.name]
        return self.base(riding.rod).then(self.section(riding.rod, riding.node)).then(riding.in_section)

    def body(self, name: str) -> Pose:
        """World pose of a body."""
        return self.frame(FrameName("body", name))

    def seen_from(self, body: str | None, positions: Matrix) -> Matrix:
        """World positions, 3×k in m, in the axes of a body; unchanged for None, the world."""
        if body is None:
            return positions
        pose = self.body(body)
        return pose.rotation.T @ (positions - ca.repmat(pose.position, 1, positions.shape[1]))

    def turned_to(self, body: str | None, vectors: Matrix) -> Matrix:
        """World vectors, 3×k, in the axes of a body; unchanged for None, the world."""
        return vectors if body is None else self.body(body).rotation.T @ vectors

    def poses(self, placed: PlacedConstraint) -> ConstraintPoses:
        """The poses that a constraint reads."""
        if placed.carried is None:
            held = self.section(placed.rod, placed.node)
        else:
            place = placed.carried.pose
            held = place if isinstance(place, Pose) else place.pose
        return self._poses_but_section(placed)._replace(section=held)

    def _frame_of(self, placed: PlacedConstraint) -> Pose:
        """World pose of the frame on the other side of a constraint; the identity for a support."""
        if placed.at_base:
            return self._still_bases[placed.rod]
        if placed.frame is None:
            return IDENTITY.pose
        return self.frame(placed.frame)

    def coordinate(self, placed: PlacedConstraint) -> Matrix | None:
        """Coordinate of a joint, 1×1, rad or m: an unknown, or prescribed by a drive; None for other joints."""
        if placed.constraint.coordinate is None:
            return None
        record = self.discrete.joint_record(placed)
        if not record.prescribed:
            return placed.coordinate_scale * self.arguments.x[self.discrete.coordinate(placed)]
        value = input_value(self.discrete.layout, record, record.coordinate_key, self.arguments.inputs)
        if value is None:
            value = ca.DM.zeros(1, 1)
        if self.arguments.load_factor is None:
            return value
        # The drive moves from its coordinate in the unloaded scene, so late that the growing springs keep up with it.
        return self.arguments.load_factor**DRIVE_GROWTH * value

    def joint_effort(self, placed: PlacedConstraint) -> JointEffort:
        """Spring, damper and motor along the coordinate of a joint."""
        record = self.discrete.joint_record(placed)
        motor = input_value(self.discrete.layout, record, record.effort_key, self.arguments.inputs)
        effort: JointEffort = JOINT_KINDS[record.kind].effort(record, ca.DM(1, 1) if motor is None else motor)
        return effort

    def way_to_stop(self, stop: JointStop) -> Matrix:
        """Distance of a joint from its stop, which may be elastic, 1×1, in the unit of its coordinate as an unknown."""
        value = self.arguments.x[self.discrete.coordinate(stop.placed)]
        way = stop.side * (value - as_matrix(as_vector([stop.bound])) / stop.placed.coordinate_scale)
        if stop.stiffness is None:
            return way
        return way + stop.softness * self.arguments.x[self.discrete.stop(stop)]

    def stop_energy(self, stop: JointStop) -> Matrix:
        """Energy stored in an elastic stop, 1×1, J."""
        push = self.arguments.x[self.discrete.stop(stop)]
        return stop.placed.constraint.unit * stop.softness / 2 * push**2

    def stop_effort(self, placed: PlacedConstraint) -> Matrix:
        """Push of the stops of a joint on its section along the coordinate, N m or N, 1×1."""
        pushes = [
            stop.side * self.arguments.x[self.discrete.stop(stop)]
            for stop in self.discrete.stops
            if stop.placed is placed
        ]
        return placed.constraint.unit / placed.coordinate_scale * sum(pushes[1:], pushes[0])

    def joint_state(self, placed: PlacedConstraint) -> tuple[Matrix, Matrix]:
        """Coordinate of a joint, rad or m, and the effort along it on the section, N m or N, 1×1 each."""
        value = self.coordinate(placed)
        assert value is not None, "asked for of a joint with a coordinate"
        unit = placed.constraint.unit / placed.coordinate_scale
        return value, unit * self.multipliers(placed)[placed.along_coordinate]

    def multipliers(self, placed: PlacedConstraint) -> Matrix:
        """Multipliers of a constraint."""
        return self.arguments.x[self.discrete.multipliers(placed)]

    def deviation(self, name: FrameName) -> Matrix:
        """Unknowns of a floating frame, 7×1."""
        return self.arguments.x[self.discrete.deviation(name)]

    @cached_property
    def _still_bases(self) -> dict[str, Pose]:
        """Poses of the bases by the scene and the inputs, by the names of their rods."""
        return {rod: self._still_base(rod) for rod in self.discrete.rods}

    def _still_base(self, rod: str) -> Pose:
        """Pose of a base that rests in the world: from the inputs, or else the scene."""
        position, quaternion = map(as_matrix, written_base_pose(self.discrete.records[rod]))
        free_position = self.discrete.layout.of_rod(rod, "base.position")
        free_quaternion = self.discrete.layout.of_rod(rod, "base.quaternion")
        if free_position is not None:
            position = self.arguments.inputs[free_position]
        if free_quaternion is not None:
            given = self.arguments.inputs[free_quaternion]
            quaternion = given / ca.sqrt(ca.sumsqr(given))
        return Pose(position, quaternion)

    def _still_base_motion(self, rod: str) -> FrameMotion:
        """Motion of a base that no frame carries, world axes: at rest, or from the rates of inputs."""
        motion = self.arguments.motion
        moved = AT_REST
        if motion is None:
            return moved
        position = self.discrete.layout.of_rod(rod, "base.position")
        if position is not None:
            rate, acceleration = motion.inputs_rate[position], motion.inputs_acceleration[position]
            moved = replace(moved, velocity=rate, acceleration=acceleration)
        turned = self.discrete.layout.of_rod(rod, "base.quaternion")
        if turned is not None:
            given = (self.arguments.inputs, motion.inputs_rate, motion.inputs_acceleration)
            turning = QuaternionMotion(*(values[turned] for values in given))
            spin, spin_rate = turning.angular_velocity, turning.angular_acceleration
            moved = replace(moved, angular_velocity=spin, angular_acceleration=spin_rate)
        return moved

    def strain_rates(self, rod: str) -> StrainRates:
        """Rates of the strain coordinates of a rod in motion, and of its length where that is an input."""
        motion = self.arguments.motion
        assert motion is not None, "asked for in motion"
        strains = self.discrete.unknowns.strain(rod)
        length = self.discrete.layout.of_rod(rod, "length")
        velocity = motion.v[strains]
        acceleration = motion.a[strains]
        if length is None:
            # A fixed length has no rates, a length that a parameter sets has zero rates.
            still = None if self.discrete.rods[rod].properties.ratio is None else ca.DM(1, 1)
            return StrainRates(velocity, acceleration, still, still)
        reference = self.discrete.rods[rod].properties.length
        ratio_rate = motion.inputs_rate[length] / reference
        ratio_acceleration = motion.inputs_acceleration[length] / reference
        return StrainRates(velocity, acceleration, ratio_rate, ratio_acceleration)

    def energy(self) -> Matrix:
        """Elastic energy of all rods, J."""
        energies = [igm.energy for igm in self.rods.values()]
        return ca.sum1(ca.vertcat(*energies))

    def potential(self) -> Matrix | None:
        """Energy of all rods and their dead forces, J; None if some load is not a dead force."""
        terms = [igm.potential for igm in self.rods.values()]
        known = [term for term in terms if term is not None]
        if self.discrete.constraints or self.coupled_rods or len(known) < len(terms):
            return None
        return ca.sum1(ca.vertcat(*known))

    def dead_wrenches(self, rod: str) -> list[Wrench]:
        """Wrenches of the scene's loads on a rod that keep their direction in the world, base frame."""
        wrenches = [load for load in self._loads(rod) if not isinstance(load, PoseWrench)]
        dead = [wrench for wrench in wrenches if not wrench.follower]
        # Inertia is a dead load too, with its value at this instant.
        return [*dead, *self._pair_wrenches(rod), *self._drag_wrenches(rod), *self._inertia_wrenches(rod)]

    def _pair_wrenches(self, rod: str) -> list[Wrench]:
        """Forces of contact with other rods, or with other stretches of the rod, on this rod, base frame."""
        return [wrench for terms in self.coupled_rods if rod in terms.rods for wrench in terms.wrenches(rod)]

    def _drag_wrenches(self, rod: str) -> list[Wrench]:
        """Drags of loads on a rod that bodies bear, base frame."""
        return [wrench for drag in self.drags for wrench in drag.wrenches(rod)]

    def _inertia_wrenches(self, rod: str) -> list[Wrench]:
        """Inertia of a rod as a wrench on its sections; none at rest."""
        return [] if rod not in self.inertias else [self.inertias[rod].wrench]

    def _riding_on(self, rod: str) -> list[RidingBody]:
        """Bodies that ride on a rod."""
        return [riding for riding in self.riding.values() if riding.rod == rod]

    def _riding_inertias(self, rod: str) -> list[PoseWrench]:
        """Inertia of the bodies that ride on a rod in motion; none at rest."""
        if rod not in self.motions:
            return []
        base = self.rod_loads(rod).base
        inertias = [riding.inertia(base, self.motions[rod]) for riding in self._riding_on(rod)]
        return [inertia for inertia in inertias if inertia is not None]

    def _loads(self, rod: str) -> list[RodLoad]:
        """The scene's loads on a rod, and on bodies that ride on it, at the load factor, base frame."""
        rod_loads = self.rod_loads(rod)
        loads = rod_loads.all()
        for riding in self._riding_on(rod):
            loads += riding.loads(rod_loads.base, self.arguments.inputs)
        return [scaled(load, self.arguments.load_factor) for load in loads]

    def loads_of(self, load: scenes.LoadRecord, rod: str) -> list[RodLoad]:
        """Wrenches of one load of the scene on a rod, base frame."""
        return self.rod_loads(rod).of(load)

    def resting_loads_of(self, load: scenes.LoadRecord, rod: str) -> list[RodLoad]:
        """Wrenches of one load on a rod that rests in this shape, base frame."""
        return replace(self.rod_loads(rod), motion=None).of(load)

    def rod_loads(self, rod: str) -> RodLoads:
        """The scene's loads on a rod, as its mechanics take them."""
        base = RodBase(self.base(rod).position, self._base_R_world[rod])
        ratio = ratio_of(self.discrete, rod, self.arguments)
        motion = self.motions.get(rod)
        return RodLoads(self.discrete, rod, base, self.arguments.inputs, ratio, motion, self.body)

    def length(self, rod: str) -> Matrix | float:
        """Length of a rod, m: set by an input or a parameter, or else the scene's."""
        nominal = self.discrete.rods[rod].properties.length
        ratio = ratio_of(self.discrete, rod, self.arguments)
        return nominal if ratio is None else nominal * ratio

    def body_length(self, body: str) -> Matrix | float:
        """Length of the longest rod that holds a body, m."""
        lengths = [self.length(rod) for rod in self.discrete.unloaded.rods_of(body)]
        return ca.mmax(ca.vertcat(*lengths))

    def _constraint_wrench(self, placed: PlacedConstraint) -> WrenchAt:
        """Wrench of a constraint on its section, in the axes of the rod's base."""
        constraint = placed.constraint
        held = constraint.held
        multipliers = self.multipliers(placed)
        if held.turn_with_pose:
            poses = self._poses_but_section(placed)
            wrench = constraint.wrench_basis(poses) @ multipliers
            return WrenchAt(constraint.at, wrench[3:], wrench[:3], follower=False)
        # With constant directions the constraint costs its rod no more than a load of fixed direction.
        displacements = held.positions.shape[1]
        force_unit = constraint.unit / constraint.length
        force = force_unit * (_sparse(held.positions) @ multipliers[:displacements])
        if not held.rotations.size:
            return WrenchAt(constraint.at, force, None, follower=False)
        moment = constraint.unit * (_sparse(held.rotations) @ multipliers[displacements:])
        return WrenchAt(constraint.at, force, moment, follower=False)

    def _poses_but_section(self, placed: PlacedConstraint) -> ConstraintPoses:
        """The poses on which the direction of a constraint's wrench depends, without the section's.

        The pose of the section follows from the wrench, so that the wrench on the rod must not depend on it.
        """
        base = self.base(placed.rod) if placed.carried is None else self.frame(placed.carried.frame)
        return ConstraintPoses(IDENTITY.pose, base, self._frame_of(placed), self.coordinate(placed))

    @cached_property
    def _base_R_world(self) -> dict[str, Matrix]:
        """Rotations from the world into the bases of the rods, 3×3 each; sparse where they are constant."""
        # Zeros of a constant base, such as that of an upright rod, cost no product.
        return {rod: sparse_known(self.base(rod).rotation).T for rod in self.discrete.rods}


def ratio_of(discrete: DiscreteScene, rod: str, arguments: Arguments) -> Ratio:
    """Length of a rod relative to the scene's where it is an input or a parameter, else None."""
    entries = discrete.layout.of_rod(rod, "length")
    if entries is None:
        return discrete.rods[rod].properties.ratio
    length = arguments.inputs[entries]
    return length / discrete.rods[rod].properties.length


def _sparse(vectors: FloatArray) -> ca.DM:
    return ca.sparsify(ca.DM(vectors))
