"""Constraints, floating frames and cables in the equations of a scene, and the Jacobian of the whole.

The balance of a frame is the derivative of the Lagrangian with respect to its pose: −F ℓ for the position, and for the
quaternion −Tᵀ M with δθ = T δQ, both in units of the frame's EI/ℓ. No mechanics depends on the norm of a quaternion:
the derivative (Q·Q − 1) Q of ¼ (Q·Q − 1)² is added, orthogonal to the rest, and makes the norm one. So no rotation is
singular. The Jacobian is symmetric but for units wherever the loads have a potential and the constraints are closed.

The Jacobian follows by the chain rule. Every constraint gives derivatives with respect to three motions [δθ; δr]: of
its section, of the base of its rod, of the frame on its other side. Sections move with the strains (rod/tangent.py),
frames with their unknowns. With u = (strains q, multipliers m, deviations d of frames, tensions τ) the blocks are

               q                    m                  d                        τ
    rod        tangent              −δᵀ W              turn of dead loads,      ∂L/∂q / ℓ
                                                       W that turns,
                                                       loads seen from bodies
    constraint c_section δ          0                  c_base B, c_frame B      0
    frame      reaction of the      reactions          all that turns with it   0
               rods it carries
    cable      by ∂L/∂q             0                  0                        by τ

A joint whose coordinate is an unknown adds its row (constraints/joint_coordinate.py) and a column wherever its wrench
turns with it; a stop of the coordinate adds the row of its pair, and entries in the column of the coordinate.

Here δ is the motion of the section with q, W the wrench of a unit of each multiplier, and B the motion of a frame with
d. Docs/theory.md, section 8.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import cached_property
from itertools import pairwise

import casadi as ca

from cosserat_casadi import scene as scenes
from cosserat_casadi.constraints.cable_length import SMOOTHING, pair_kernel
from cosserat_casadi.constraints.section_constraint import ConstraintPoses, PoseVariations
from cosserat_casadi.maths.calls import ONE_DIRECTION
from cosserat_casadi.maths.numbers import as_matrix, as_vector, is_zero
from cosserat_casadi.maths.rotation import hat
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.model.body_loads import BodyLoad, BodyLoads
from cosserat_casadi.model.body_obstacle_loads import BorneLoad, borne_loads
from cosserat_casadi.model.discrete_scene import STOP_COMPLIANCE, CableOfLength, DiscreteScene, JointStop
from cosserat_casadi.model.floating_frames import FrameName, turn_matrix
from cosserat_casadi.model.homotopy import Compliance, LoadFactor, column_at, row_at, smoothing_at, spring
from cosserat_casadi.model.pair_terms import PairTerms
from cosserat_casadi.model.scene_actuators import CORNER
from cosserat_casadi.model.scene_constraints import ASSEMBLED, RELEASED, PlacedConstraint
from cosserat_casadi.model.system import System
from cosserat_casadi.model.touching_rods import TouchingRods
from cosserat_casadi.rod.reaction import Reaction


def _turn_rows() -> ca.Function:
    """(Q, M) ↦ rows of a frame's quaternion, (Q·Q − 1) Q − Tᵀ M, and their derivative with Q at fixed M.

    M is the moment on the frame in units of its EI/ℓ.
    """
    quaternion = ca.SX.sym("quaternion", 4)
    moment = ca.SX.sym("moment", 3)
    # The norm's term is along Q, the moment's term orthogonal to it: the sum vanishes only where both do.
    norm_row = (ca.sumsqr(quaternion) - 1) * quaternion
    rows = norm_row - turn_matrix(quaternion).T @ moment
    results = ca.cse([rows, ca.jacobian(rows, quaternion)])
    return ca.Function("turn_rows", [quaternion, moment], results, ONE_DIRECTION)


TURN_ROWS = _turn_rows()


@dataclass(frozen=True)
class Assembly:
    """Rods of a system with their constraints and the floating frames."""

    system: System

    @property
    def discrete(self) -> DiscreteScene:
        """The scene with its constant matrices."""
        return self.system.discrete

    @property
    def load_factor(self) -> LoadFactor:
        """Load factor λ at which the equations are written."""
        return self.system.arguments.load_factor

    def _closing(self, compliance: Compliance) -> LoadFactor:
        """Load factor λ of rows with this compliance; None where they are closed for every load factor."""
        if compliance is ASSEMBLED and self.discrete.closed_unloaded:
            return None
        return self.load_factor

    # Residual

    @cached_property
    def constraint_rows(self) -> list[Matrix]:
        """Residual of every constraint, at the load factor."""
        rows = []
        for placed in self.discrete.constraints:
            gap = placed.constraint.residual(self.system.poses(placed))
            multipliers = self.system.multipliers(placed)
            rows.append(row_at(gap, multipliers, placed.compliance, self._closing(placed.compliance)))
        return rows

    @cached_property
    def balance_rows(self) -> list[Matrix]:
        """Balance of every floating frame, 7×1, without unit, at the load factor."""
        rows = []
        for name, frame in self.discrete.frames.items():
            wrench = self._wrenches[name]
            moment = wrench[:3] / frame.unit
            force_row = -frame.length / frame.unit * wrench[3:]
            turn_row = TURN_ROWS(self.system.frame_poses[name].quaternion, moment)[0]
            balance = ca.vertcat(force_row, turn_row)
            deviation = self.system.deviation(name)
            rows.append(row_at(balance, deviation, ASSEMBLED, self._closing(ASSEMBLED)))
        return rows

    @cached_property
    def coordinate_rows(self) -> list[Matrix]:
        """λ + V'(q) − ρ of every joint whose coordinate q is an unknown, ρ of its stops, at the load factor."""
        rows = []
        for placed in self.discrete.free_coordinates:
            value = self.system.coordinate(placed)
            assert value is not None, "a coordinate that is free is there"
            slope = self.system.joint_effort(placed).slope(value)
            effort = self.system.multipliers(placed)[placed.along_coordinate]
            balance = effort + placed.coordinate_scale / placed.constraint.unit * slope
            for stop in self.discrete.stops:
                if stop.placed is placed:
                    balance = balance - stop.side * self.system.arguments.x[self.discrete.stop(stop)]
            unknown = self.system.arguments.x[self.discrete.coordinate(placed)]
            rows.append(row_at(balance, unknown, RELEASED, self.load_factor))
        return rows

    @cached_property
    def cable_rows(self) -> list[Matrix]:
        """Residual of every cable of given length, at the load factor."""
        equations = self.system.actuators.cable_lengths
        pairs = [(cable, equations[cable.tendon.name]) for cable in self.discrete.cables]
        return [row_at(own.residual, own.tension, cable.compliance, self.load_factor) for cable, own in pairs]

    @cached_property
    def stop_rows(self) -> list[Matrix]:
        """Pair of every stop of a joint and its push, at the load factor."""
        return [
            row_at(residual, self.system.arguments.x[self.discrete.stop(stop)], STOP_COMPLIANCE, self.load_factor)
            for stop, (residual, _, _) in self._stop_pairs
        ]

    @cached_property
    def _stop_pairs(self) -> list[tuple[JointStop, tuple[Matrix, Matrix, Matrix]]]:
        """Stops with their rows at λ = 1, and derivatives of these by the way to the stop and by the push."""
        if not self.discrete.stops:
            return []
        kernel = pair_kernel(slack=True, softness=1.0)
        smoothing = smoothing_at(CORNER, SMOOTHING, self.load_factor)
        pairs = []
        for stop in self.discrete.stops:
            push = self.system.arguments.x[self.discrete.stop(stop)]
            pairs.append((stop, kernel(self.system.way_to_stop(stop), push, smoothing)))
        return pairs

    # Jacobian

    @cached_property
    def jacobian(self) -> Matrix:
        """∂ residual / ∂x of the whole scene, sparse by blocks."""
        blocks = BlockMatrix(self.discrete.unknowns.ends)
        for rod, tangent in self.system.tangents.items():
            strains = self.discrete.unknowns.strain(rod)
            blocks.add(strains, strains, tangent.jacobian)
        for placed in self.discrete.constraints:
            self._add_constraint(blocks, placed)
            if placed.carried is None:
                self._add_constraint_wrench(blocks, placed)
        for floating in self.discrete.unloaded.floating_rods:
            self._add_turned_loads(blocks, floating.name)
        for borne in self._borne_loads:
            # The motion of a body moves the obstacle that presses the rod.
            by_deviation = borne.residual_with_body @ self.system.frame_poses[borne.body].motion
            blocks.add(self.discrete.unknowns.strain(borne.rod), self.discrete.deviation(borne.body), by_deviation)
        for terms in self.system.coupled_rods:
            self._add_pair(blocks, terms)
        for name in self.discrete.frames:
            self._add_balance(blocks, name)
        for placed in self.discrete.free_coordinates:
            self._add_coordinate(blocks, placed)
        for cable in self.discrete.cables:
            self._add_cable(blocks, cable)
        for stop, (_, by_way, by_push) in self._stop_pairs:
            push = self.discrete.stop(stop)
            coordinate = self.discrete.coordinate(stop.placed)
            blocks.add(coordinate, push, column_at(ca.DM(-stop.side), self.load_factor))
            blocks.add(push, coordinate, column_at(stop.side * by_way, self.load_factor))
            if stop.stiffness is not None:
                by_push = by_push + by_way * stop.softness
            blocks.add(push, push, column_at(by_push, self.load_factor))
        for entries, compliance in self._compliances():
            block = spring(entries.stop - entries.start, compliance, self._closing(compliance))
            if block is not None:
                blocks.add(entries, entries, block)
        return blocks.matrix()

    @cached_property
    def constraint_jacobian(self) -> Matrix:
        """∂ residual / ∂x with the rows of the constraints alone; the other rows are empty."""
        blocks = BlockMatrix(self.discrete.unknowns.ends)
        for placed in self.discrete.constraints:
            self._add_constraint(blocks, placed)
        return blocks.matrix()

    def _section_motion(self, placed: PlacedConstraint) -> Matrix:
        """δ: motion [δθ; δr] of a held section with the strains of its rod, 6×n, base axes."""
        tangent = self.system.tangents[placed.rod]
        return ca.vertcat(tangent.rotation_of(placed.node), tangent.position(placed.node))

    def _of_floating(self, placed: PlacedConstraint, variations: PoseVariations) -> list[tuple[FrameName, Matrix]]:
        """Derivatives with respect to the motions of a constraint's floating frames: its rod's base, its other side."""
        if placed.carried is None:
            base = self.discrete.unloaded.floating_base(placed.rod)
        else:
            base = placed.carried.frame
        derivatives = []
        if base is not None:
            derivatives.append((base, variations.base))
        if placed.frame is not None:
            derivatives.append((placed.frame, variations.frame))
        return derivatives

    def _of_coordinate(self, placed: PlacedConstraint, variations: PoseVariations) -> list[tuple[slice, Matrix]]:
        """Derivative with respect to the coordinate of a joint, if the coordinate is an unknown."""
        if variations.coordinate is None or placed not in self.discrete.free_coordinates:
            return []
        return [(self.discrete.coordinate(placed), placed.coordinate_scale * variations.coordinate)]

    def _add_coordinate(self, blocks: BlockMatrix, placed: PlacedConstraint) -> None:
        """Add the row of a joint's coordinate: its derivatives by the multiplier and, with a spring, the coordinate."""
        rows = self.discrete.coordinate(placed)
        along = ca.DM(ca.Sparsity.triplet(1, placed.size, [0], [placed.along_coordinate]), 1.0)
        blocks.add(rows, self.discrete.multipliers(placed), column_at(along, self.load_factor))
        stiffness = self.discrete.joint_record(placed).stiffness
        if not is_zero(stiffness):
            scaled = placed.coordinate_scale**2 / placed.constraint.unit * as_matrix(as_vector([stiffness]))
            blocks.add(rows, rows, column_at(scaled, self.load_factor))

    # Rows of constraints

    def _add_constraint(self, blocks: BlockMatrix, placed: PlacedConstraint) -> None:
        """Rows of a constraint: c_section δ, c_base B, c_frame B."""
        rows = self.discrete.multipliers(placed)
        variations = placed.constraint.residual_variation(self.system.poses(placed))
        closing = self._closing(placed.compliance)
        if placed.carried is None:
            by_strain = variations.section @ self._section_motion(placed)
            blocks.add(rows, self.discrete.unknowns.strain(placed.rod), column_at(by_strain, closing))
        for name, derivative in self._of_floating(placed, variations):
            deviation = self.discrete.deviation(name)
            by_deviation = derivative @ self.system.frame_poses[name].motion
            blocks.add(rows, deviation, column_at(by_deviation, closing))
        for column, derivative in self._of_coordinate(placed, variations):
            blocks.add(rows, column, column_at(derivative, closing))

    # Columns of the rods

    def _add_constraint_wrench(self, blocks: BlockMatrix, placed: PlacedConstraint) -> None:
        """Blocks of the multipliers in their rod's residual, −δᵀ W / (EI/ℓ), and of the turn of W with its frame."""
        constraint = placed.constraint
        poses = self.system.poses(placed)
        strains = self.discrete.unknowns.strain(placed.rod)
        # δᵀ times a wrench on the section is its virtual work; the residual of a rod is in units of its EI/ℓ.
        work = self._section_motion(placed).T / -constraint.unit
        multipliers = self.discrete.multipliers(placed)
        blocks.add(strains, multipliers, work @ constraint.wrench_basis(poses))
        if not constraint.held.turn_with_pose:
            return
        variations = constraint.wrench_variation(poses, self.system.multipliers(placed))
        for name, derivative in self._of_floating(placed, variations):
            deviation = self.discrete.deviation(name)
            blocks.add(strains, deviation, work @ derivative @ self.system.frame_poses[name].motion)
        for column, derivative in self._of_coordinate(placed, variations):
            blocks.add(strains, column, work @ derivative)

    def _add_turned_loads(self, blocks: BlockMatrix, rod: str) -> None:
        """Blocks of a moving base in its rod's residual: dead loads turn back, pose-dependent loads change."""
        name = FrameName("rod", rod)
        frame_pose = self.system.frame_poses[name]
        base_R_world = frame_pose.pose.rotation.T
        reaction = self._reactions[rod]
        motion = frame_pose.motion
        strains = self.discrete.unknowns.strain(rod)
        deviation = self.discrete.deviation(name)
        by_turn, _, _ = reaction.with_turn
        blocks.add(strains, deviation, by_turn @ base_R_world @ motion[:3, :])
        # A shift of the base changes nothing where no load depends on the pose.
        if reaction.with_shift is not None:
            by_shift, _, _ = reaction.with_shift
            blocks.add(strains, deviation, by_shift @ base_R_world @ motion[3:, :])

    def _add_pair(self, blocks: BlockMatrix, terms: PairTerms | TouchingRods) -> None:
        """Blocks, in the rows of the strains of two rods, of the push between them."""
        for (rod, other), stiffness in terms.stiffness.items():
            rows = self.discrete.unknowns.strain(rod)
            work = stiffness[: rows.stop - rows.start, :] / self.discrete.rods[rod].energy_unit
            for columns, block in self._by_side(other, work):
                blocks.add(rows, columns, block)

    def _by_side(self, rod: str, derivative: Matrix) -> Iterator[tuple[slice, Matrix]]:
        """Split a derivative with respect to one side of a pair into columns of the rod's strains and of its base."""
        strains = self.discrete.unknowns.strain(rod)
        count = strains.stop - strains.start
        yield strains, derivative[:, :count]
        base = self.discrete.unloaded.floating_base(rod)
        if base is not None:
            yield self.discrete.deviation(base), derivative[:, count:] @ self.system.frame_poses[base].motion

    # Rows of floating frames

    @cached_property
    def _borne_loads(self) -> list[BorneLoad]:
        """Loads on rods with reactions on bodies, at the load factor."""
        return list(borne_loads(self.system))

    @cached_property
    def _wrenches(self) -> dict[FrameName, Matrix]:
        """Wrench [moment about the origin; force] on every floating frame, 6×1, world axes, N m and N."""
        wrenches: dict[FrameName, Matrix] = {name: ca.DM.zeros(6, 1) for name in self.discrete.frames}
        for placed in self.discrete.constraints:
            if placed.frame is not None:
                reaction = placed.constraint.reaction(self.system.poses(placed), self.system.multipliers(placed))
                wrenches[placed.frame] = wrenches[placed.frame] + reaction
            if placed.carried is not None:
                wrench = placed.constraint.on_body(self.system.poses(placed), self.system.multipliers(placed))
                wrenches[placed.carried.frame] = wrenches[placed.carried.frame] + wrench
        for name in self.discrete.frames:
            if name.kind == "rod":
                wrenches[name] = wrenches[name] + self._rod_reaction(name)
            for load in self._body_loads[name]:
                wrenches[name] = wrenches[name] + load.wrench
        for borne in self._borne_loads:
            wrenches[borne.body] = wrenches[borne.body] + borne.wrench
        for drag in self.system.drags:
            if drag.body in wrenches:
                wrenches[drag.body] = wrenches[drag.body] + drag.on_body
        return wrenches

    def _rod_reaction(self, name: FrameName) -> Matrix:
        """Wrench of a rod on its own floating base, world axes."""
        statics = self.system.rods[name.name].statics
        world_R_base = self.system.frame_poses[name].pose.rotation
        moment = world_R_base @ statics.base_moment
        force = world_R_base @ statics.base_force
        return -ca.vertcat(moment, force)

    @cached_property
    def _reactions(self) -> dict[str, Reaction]:
        """Variations of the base wrenches of rods with floating bases."""
        names = [rod.name for rod in self.discrete.unloaded.floating_rods]
        return {name: Reaction(self.system.tangents[name], self.system.dead_wrenches(name)) for name in names}

    def _add_balance(self, blocks: BlockMatrix, name: FrameName) -> None:
        """Add the rows of a frame's balance, from the variations of the wrench on the frame."""
        frame = self.discrete.frames[name]
        quaternion = self.system.frame_poses[name].quaternion
        rows = self.discrete.deviation(name)
        turn = turn_matrix(quaternion)
        # From a variation of the wrench [moment; force] to that of the rows [−F ℓ; −Tᵀ M], in units of EI/ℓ.
        by_force = ca.horzcat(ca.DM(3, 3), -frame.length / frame.unit * ca.DM.eye(3))
        by_moment = ca.horzcat(-turn.T / frame.unit, ca.DM(4, 3))
        to_rows = ca.vertcat(by_force, by_moment)
        closing = self._closing(ASSEMBLED)
        for columns, variation in self._wrench_variations(name):
            blocks.add(rows, columns, column_at(to_rows @ variation, closing))
        # T and the norm of Q change with Q itself, at fixed moment.
        moment = self._wrenches[name][:3] / frame.unit
        by_quaternion = TURN_ROWS(quaternion, moment)[1]
        at_fixed_wrench = ca.diagcat(ca.DM(3, 3), by_quaternion)
        blocks.add(rows, rows, column_at(at_fixed_wrench, closing))

    def _wrench_variations(self, name: FrameName) -> list[tuple[slice, Matrix]]:
        """Variation of the wrench on a frame with each block of unknowns that changes it, 6×k, world axes."""
        variations: list[tuple[slice, Matrix]] = []
        # Derivatives with respect to the motions of frames are summed first, so that B is applied once to each frame.
        by_motion: dict[FrameName, Matrix] = defaultdict(lambda: ca.DM(6, 6))
        for placed in self.discrete.constraints:
            if placed.frame == name:
                of_reaction = placed.constraint.reaction_variation
                added, by_poses = self._wrench_on_frame(placed, of_reaction, by_motion)
                variations += added
                # The wrench acts at the joint of the frame, but for a slide at the section, wherever the section is.
                if placed.constraint.held.slides and placed.carried is None:
                    by_strain = by_poses.section @ self._section_motion(placed)
                    variations.append((self.discrete.unknowns.strain(placed.rod), by_strain))
            if placed.carried is not None and placed.carried.frame == name:
                of_wrench = placed.constraint.on_body_variation
                variations += self._wrench_on_frame(placed, of_wrench, by_motion)[0]
        if name.kind == "rod":
            variations += self._rod_reaction_variations(name, by_motion)
        for load in self._body_loads[name]:
            by_motion[name] = by_motion[name] + load.variation
        for borne in self._borne_loads:
            for moved, derivative in borne.with_motions(name):
                by_motion[moved] = by_motion[moved] + derivative
            if borne.body == name:
                variations.append((self.discrete.unknowns.strain(borne.rod), borne.wrench_with_strain))
        for terms in self.system.coupled_rods:
            for (rod, other), stiffness in terms.stiffness.items():
                if self.discrete.unloaded.floating_base(rod) == name:
                    variations += self._by_side(other, -stiffness[self.discrete.rods[rod].size :, :])
        for moved, derivative in by_motion.items():
            by_deviation = derivative @ self.system.frame_poses[moved].motion
            variations.append((self.discrete.deviation(moved), by_deviation))
        return variations

    def _wrench_on_frame(
        self,
        placed: PlacedConstraint,
        varied: Callable[[ConstraintPoses, Matrix], tuple[Matrix, PoseVariations]],
        by_motion: dict[FrameName, Matrix],
    ) -> tuple[list[tuple[slice, Matrix]], PoseVariations]:
        """Variation of a constraint's wrench with its multipliers and coordinate; with poses, into by_motion."""
        by_multipliers, by_poses = varied(self.system.poses(placed), self.system.multipliers(placed))
        for moved, derivative in self._of_floating(placed, by_poses):
            by_motion[moved] = by_motion[moved] + derivative
        variations = [(self.discrete.multipliers(placed), by_multipliers), *self._of_coordinate(placed, by_poses)]
        return variations, by_poses

    def _rod_reaction_variations(
        self, name: FrameName, by_motion: dict[FrameName, Matrix]
    ) -> list[tuple[slice, Matrix]]:
        """Variation of a rod's wrench on its floating base with strains and multipliers; frames into by_motion."""
        rod = name.name
        reaction = self._reactions[rod]
        rotation = self.system.frame_poses[name].pose.rotation
        to_world = ca.diagcat(rotation, rotation)
        by_strain = ca.vertcat(reaction.moment_with_strain, reaction.force_with_strain)
        variations = [(self.discrete.unknowns.strain(rod), -to_world @ by_strain)]
        statics = self.system.rods[rod].statics
        _, force, moment = reaction.with_turn
        # In the axes of the base, dead loads turn back; the base wrench itself turns with the base.
        by_turn = ca.vertcat(moment - hat(statics.base_moment), force - hat(statics.base_force))
        by_shift: Matrix = ca.DM(6, 3)
        if reaction.with_shift is not None:
            _, force, moment = reaction.with_shift
            by_shift = ca.vertcat(moment, force)
        in_base_axes = ca.horzcat(by_turn @ rotation.T, by_shift @ rotation.T)
        by_motion[name] = by_motion[name] - to_world @ in_base_axes
        for placed in self.discrete.constraints_on(rod):
            variations += self._passed_on(placed, to_world, by_motion)
        return variations

    def _passed_on(
        self, placed: PlacedConstraint, to_world: Matrix, by_motion: dict[FrameName, Matrix]
    ) -> list[tuple[slice, Matrix]]:
        """Wrench that k multipliers of a constraint on a carried rod transmit to the rod's base, 6×k, world axes."""
        constraint = placed.constraint
        poses = self.system.poses(placed)
        # The force of the section has its arm about the base: moment + r × force.
        moment_rows = ca.horzcat(ca.DM.eye(3), hat(poses.section.position))
        force_rows = ca.horzcat(ca.DM(3, 3), ca.DM.eye(3))
        to_base = to_world @ ca.vertcat(moment_rows, force_rows)
        passed_on = [(self.discrete.multipliers(placed), to_base @ constraint.wrench_basis(poses))]
        if constraint.held.turn_with_pose:
            variations = constraint.wrench_variation(poses, self.system.multipliers(placed))
            for moved, derivative in self._of_floating(placed, variations):
                by_motion[moved] = by_motion[moved] + to_base @ derivative
            of_coordinate = self._of_coordinate(placed, variations)
            passed_on += [(column, to_base @ derivative) for column, derivative in of_coordinate]
        return passed_on

    # Loads on bodies

    @cached_property
    def _body_loads(self) -> dict[FrameName, list[BodyLoad]]:
        """Loads on the bodies at the load factor; none on the bases of rods."""
        return {name: list(self._loads_on(name, frame.body)) for name, frame in self.discrete.frames.items()}

    def _loads_on(self, name: FrameName, body: scenes.Body | None) -> Iterator[BodyLoad]:
        if body is None:
            return
        pose = self.system.frame_poses[name].pose
        loads = BodyLoads(self.discrete, body, pose.position, pose.rotation, self.system.arguments.inputs)
        for load in loads.all():
            yield load.scaled(self.load_factor)
        inertia = self.system.body_inertias.get(body.name)
        if inertia is not None:
            yield BodyLoad(
                position=body.centre_of_mass,
                arm=inertia.arm,
                force=inertia.force,
                moment=inertia.moment,
                follower=False,
                aligns=False,
            )

    # Cables of given length

    def _add_cable(self, blocks: BlockMatrix, cable: CableOfLength) -> None:
        """Row of a cable of given length, and its tension's column in the residual of its rod."""
        equation = self.system.actuators.cable_lengths[cable.tendon.name]
        strains = self.discrete.unknowns.strain(equation.rod)
        tension = self.discrete.tension(cable)
        blocks.add(strains, tension, equation.pull)
        blocks.add(tension, strains, column_at(equation.strain_columns, self.load_factor))
        blocks.add(tension, tension, column_at(equation.tension_column, self.load_factor))

    # From the unloaded scene to the scene

    def _compliances(self) -> Iterator[tuple[slice, Compliance]]:
        """Blocks of unknowns with a spring on the load path, and the compliance of each spring (model/homotopy.py)."""
        for placed in self.discrete.constraints:
            yield self.discrete.multipliers(placed), placed.compliance
        for name in self.discrete.frames:
            yield self.discrete.deviation(name), ASSEMBLED
        for placed in self.discrete.free_coordinates:
            yield self.discrete.coordinate(placed), RELEASED
        for cable in self.discrete.cables:
            yield self.discrete.tension(cable), cable.compliance
        for stop in self.discrete.stops:
            yield self.discrete.stop(stop), STOP_COMPLIANCE


@dataclass
class BlockMatrix:
    """A square matrix of blocks; blocks in the same rows and columns are summed.

    Attributes:
        ends: last row of each block row, plus one; block columns end at the same indices.
        entries: blocks by the first of their rows and the first of their columns.
    """

    ends: list[int]
    entries: dict[tuple[int, int], Matrix] = field(default_factory=dict)

    def add(self, rows: slice, columns: slice, block: Matrix) -> None:
        """Add a block."""
        corner = (rows.start, columns.start)
        if corner in self.entries:
            block = self.entries[corner] + block
        self.entries[corner] = block

    def matrix(self) -> Matrix:
        """The whole, sparse."""
        ranges = list(pairwise([0, *self.ends]))
        # Unknowns that are not coupled have a block without stored entries.
        blocks = [
            [self.entries.get((top, left), ca.DM(bottom - top, right - left)) for left, right in ranges]
            for top, bottom in ranges
        ]
        return ca.vertcat(*[ca.horzcat(*row) for row in blocks])
