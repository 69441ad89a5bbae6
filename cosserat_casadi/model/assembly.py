"""What floating frames and constraints add to the equations of a scene, and the Jacobian of the whole.

The balance of a frame is the derivative of the Lagrangian with respect to its pose: −F ℓ for the position, and for the
quaternion −Tᵀ M with δθ = T δQ, both in units of the frame's EI/ℓ. A quaternion has a length that no mechanics sees:
the derivative (Q·Q − 1) Q of ¼ (Q·Q − 1)² is added, orthogonal to the rest, and makes it one. So no rotation is
singular. The Jacobian is symmetric but for units wherever the loads have a potential and the constraints are closed.

The Jacobian follows by the chain rule. Every constraint gives derivatives with three motions [δθ; δr]: of its section,
of the base of its rod, of the frame on its other side. Sections move with the strains (rod/tangent.py), frames with
their unknowns. With u = (strains q, multipliers m, deviations d of frames, tensions τ) the blocks are

               q                    m                  d                        τ
    rod        tangent              −δᵀ W              turn of dead loads,      ∂L/∂q / ℓ
                                                       W that turns
    constraint c_section δ          0                  c_base B, c_frame B      0
    frame      reaction of the      reactions          all that turns with it   0
               rods it carries
    cable      by ∂L/∂q             0                  0                        by τ

where δ is the motion of the section with q, W the wrench of a unit of each multiplier, and B the motion of a frame
with d. Docs/theory.md, section 8.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

import casadi as ca

from cosserat_casadi import scene as scenes
from cosserat_casadi.constraints.section_constraint import Variations
from cosserat_casadi.maths.pose import Pose
from cosserat_casadi.maths.rotation import hat
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.model.constraints import ASSEMBLED, PlacedConstraint
from cosserat_casadi.model.floating_frames import FloatingFrame, FrameName
from cosserat_casadi.model.homotopy import column_at, row_at, spring
from cosserat_casadi.model.load_assembly import BodyLoad, BodyLoads
from cosserat_casadi.model.unknowns import BlockKind
from cosserat_casadi.rod.reaction import Reaction

if TYPE_CHECKING:
    from cosserat_casadi.model.system import System


@dataclass
class Blocks:
    """A square matrix made of blocks, those that meet in the same rows and columns added.

    Attributes:
        ends: where the rows and columns of blocks end.
        entries: blocks by the first of their rows and the first of their columns.
    """

    ends: list[int]
    entries: dict[tuple[int, int], Matrix] = field(default_factory=dict)

    def add(self, rows: slice, columns: slice, block: Matrix) -> None:
        """Add a block."""
        corner = (rows.start, columns.start)
        self.entries[corner] = self.entries[corner] + block if corner in self.entries else block

    def matrix(self) -> Matrix:
        """The whole, sparse."""
        starts = [0, *self.ends[:-1]]
        rows = []
        for top, bottom in zip(starts, self.ends, strict=True):
            row = [
                self.entries.get((top, left), ca.DM(bottom - top, right - left))
                for left, right in zip(starts, self.ends, strict=True)
            ]
            rows.append(ca.horzcat(*row))
        return ca.vertcat(*rows)


@dataclass(frozen=True)
class FramePose:
    """World pose of a floating frame from its unknowns.

    Attributes:
        position: 3×1, m.
        quaternion: 4×1, not zero; only its direction counts.
    """

    position: Matrix
    quaternion: Matrix

    @cached_property
    def pose(self) -> Pose:
        """The pose, with the quaternion of norm 1."""
        return Pose(self.position, self.quaternion / ca.sqrt(ca.sumsqr(self.quaternion)))


def turn_matrix(quaternion: Matrix) -> Matrix:
    """Matrix T from δQ to δθ in world axes, 3×4: δθ = 2 vec(δQ ⊗ Q*) / Q·Q."""
    w, x, y, z = ca.vertsplit(2 * quaternion / ca.sumsqr(quaternion))
    return ca.blockcat([[-x, w, -z, y], [-y, z, w, -x], [-z, -y, x, w]])


def _turn_rows() -> ca.Function:
    """(Q, M) ↦ rows of a frame's quaternion, (Q·Q − 1) Q − Tᵀ M, and their derivative with Q at fixed M.

    M is the moment on the frame in units of its EI/ℓ.
    """
    quaternion = ca.SX.sym("quaternion", 4)
    moment = ca.SX.sym("moment", 3)
    rows = (ca.sumsqr(quaternion) - 1) * quaternion - turn_matrix(quaternion).T @ moment
    results = ca.cse([rows, ca.jacobian(rows, quaternion)])
    return ca.Function("turn_rows", [quaternion, moment], results)


TURN_ROWS = _turn_rows()


@dataclass(frozen=True)
class Assembly:
    """Rods of a system with their constraints and the floating frames.

    Attributes:
        system: the rods and the arguments of the equations.
    """

    system: System

    @property
    def frames(self) -> dict[FrameName, FloatingFrame]:
        """The floating frames."""
        return self.system.discrete.frames

    @property
    def constraints(self) -> list[PlacedConstraint]:
        """The constraints."""
        return self.system.discrete.constraints

    @cached_property
    def poses(self) -> dict[FrameName, FramePose]:
        """World poses of the floating frames."""
        return {name: self._pose(name, frame) for name, frame in self.frames.items()}

    @cached_property
    def constraint_rows(self) -> list[Matrix]:
        """Residual of every constraint, at the load factor."""
        return [self._constraint_row(placed) for placed in self.constraints]

    @cached_property
    def balance_rows(self) -> list[Matrix]:
        """Balance of every floating frame, 7×1, without unit, at the load factor."""
        rows = []
        for name, frame in self.frames.items():
            wrench = self._wrenches[name]
            force_row = -frame.length / frame.unit * wrench[3:]
            turn_row = TURN_ROWS(self.poses[name].quaternion, wrench[:3] / frame.unit)[0]
            balance = ca.vertcat(force_row, turn_row)
            rows.append(row_at(balance, self._deviation(name), ASSEMBLED, self._load_factor))
        return rows

    @cached_property
    def jacobian(self) -> Matrix:
        """∂ residual / ∂x of the whole scene, sparse by blocks."""
        discrete = self.system.discrete
        blocks = Blocks([entries.stop for entries in discrete.unknowns.slices.values()])
        for rod, tangent in self.system.tangents.items():
            entries = discrete.unknowns.strain(rod)
            blocks.add(entries, entries, tangent.jacobian)
        for placed in self.constraints:
            self._add_constraint(blocks, placed)
            self._add_constraint_wrench(blocks, placed)
        for carried in discrete.unloaded.carried:
            self._add_turned_loads(blocks, carried.name)
        for name in self.frames:
            self._add_balance(blocks, name)
        for cable in discrete.cables:
            self._add_cable_length(blocks, cable.tendon.name)
        self._add_springs(blocks)
        return blocks.matrix()

    # Rows of constraints

    @property
    def _load_factor(self) -> Matrix | None:
        return self.system.arguments.load_factor

    def _pose(self, name: FrameName, frame: FloatingFrame) -> FramePose:
        deviation = self._deviation(name)
        position = ca.DM(frame.start.position) + frame.length * deviation[:3]
        return FramePose(position, ca.DM(frame.start.quaternion) + deviation[3:])

    def _deviation(self, name: FrameName) -> Matrix:
        return self.system.arguments.x[self.system.discrete.deviation(name)]

    def _constraint_row(self, placed: PlacedConstraint) -> Matrix:
        row = placed.constraint.residual(self.system.poses(placed))
        return row_at(row, self.system.multipliers(placed), placed.compliance, self._load_factor)

    def _add_constraint(self, blocks: Blocks, placed: PlacedConstraint) -> None:
        """Rows of a constraint: c_section δ, c_base B, c_frame B."""
        rows = self.system.discrete.multipliers(placed)
        variations = placed.constraint.residual_variation(self.system.poses(placed))
        by_strain = variations.section @ self._section_motion(placed)
        strains = self.system.discrete.unknowns.strain(placed.rod)
        blocks.add(rows, strains, column_at(by_strain, self._load_factor))
        for name, derivative in self._by_frames(placed, variations):
            columns = derivative @ self._frame_motion(name)
            deviation = self.system.discrete.deviation(name)
            blocks.add(rows, deviation, column_at(columns, self._load_factor))

    def _section_motion(self, placed: PlacedConstraint) -> Matrix:
        """δ: motion [δθ; δr] of a held section with the strains of its rod, 6×n, base axes."""
        tangent = self.system.tangents[placed.rod]
        return ca.vertcat(tangent.rotation_of(placed.node), tangent.position(placed.node))

    def _frame_motion(self, name: FrameName) -> Matrix:
        """B: motion [δθ; δr] of a floating frame with its unknowns, 6×7, world axes."""
        turn = turn_matrix(self.poses[name].quaternion)
        length = self.frames[name].length
        return ca.vertcat(ca.horzcat(ca.DM(3, 3), turn), ca.horzcat(length * ca.DM.eye(3), ca.DM(3, 4)))

    def _by_frames(self, placed: PlacedConstraint, variations: Variations) -> list[tuple[FrameName, Matrix]]:
        """Derivatives with the motions of those frames of a constraint that float."""
        base = self.system.discrete.unloaded.floating_base(placed.rod)
        candidates = ((base, variations.base), (placed.frame, variations.frame))
        return [(name, derivative) for name, derivative in candidates if name is not None]

    # Columns of the rods

    def _add_constraint_wrench(self, blocks: Blocks, placed: PlacedConstraint) -> None:
        """What multipliers do to the residual of their rod, −δᵀ W / (EI/ℓ), and W that turns with its place."""
        constraint = placed.constraint
        poses = self.system.poses(placed)
        strains = self.system.discrete.unknowns.strain(placed.rod)
        work = self._section_motion(placed).T / -constraint.unit
        blocks.add(strains, self.system.discrete.multipliers(placed), work @ constraint.wrench_basis(poses))
        if not constraint.held.turn_with_place:
            return
        turned = constraint.wrench_variation(poses, self.system.multipliers(placed))
        for name, derivative in self._by_frames(placed, turned):
            blocks.add(strains, self.system.discrete.deviation(name), work @ derivative @ self._frame_motion(name))

    def _add_turned_loads(self, blocks: Blocks, rod: str) -> None:
        """What the motion of a floating base does to its rod: dead loads turn back, pose-dependent ones change."""
        name = FrameName("rod", rod)
        base_R_world = self.poses[name].pose.rotation.T
        reaction = self._reactions[rod]
        motion = self._frame_motion(name)
        strains = self.system.discrete.unknowns.strain(rod)
        deviation = self.system.discrete.deviation(name)
        by_turn, _, _ = reaction.with_turn
        blocks.add(strains, deviation, by_turn @ base_R_world @ motion[:3, :])
        if reaction.with_shift is not None:
            by_shift, _, _ = reaction.with_shift
            blocks.add(strains, deviation, by_shift @ base_R_world @ motion[3:, :])

    # Rows of floating frames

    @cached_property
    def _wrenches(self) -> dict[FrameName, Matrix]:
        """Wrench [moment about the origin; force] on every floating frame, 6×1, world axes, N m and N."""
        wrenches: dict[FrameName, Matrix] = {name: ca.DM.zeros(6, 1) for name in self.frames}
        for placed in self.constraints:
            if placed.frame is not None:
                reaction = placed.constraint.reaction(self.system.poses(placed), self.system.multipliers(placed))
                wrenches[placed.frame] = wrenches[placed.frame] + reaction
        for name in self.frames:
            if name.kind == "rod":
                wrenches[name] = wrenches[name] + self._rod_reaction(name)
            for load in self._body_loads[name]:
                wrenches[name] = wrenches[name] + load.wrench
        return wrenches

    def _rod_reaction(self, name: FrameName) -> Matrix:
        """Wrench of a carried rod on its own base, world axes."""
        statics = self.system.rods[name.name].statics
        world_R_base = self.poses[name].pose.rotation
        return -ca.vertcat(world_R_base @ statics.base_moment, world_R_base @ statics.base_force)

    @cached_property
    def _reactions(self) -> dict[str, Reaction]:
        """Variations of the base wrenches of carried rods."""
        carried = [rod.name for rod in self.system.discrete.unloaded.carried]
        return {rod: Reaction(self.system.tangents[rod], self.system.dead_wrenches(rod)) for rod in carried}

    def _add_balance(self, blocks: Blocks, name: FrameName) -> None:
        """Rows of a frame's balance, from the variations of the wrench on it."""
        frame = self.frames[name]
        quaternion = self.poses[name].quaternion
        rows = self.system.discrete.deviation(name)
        turn = turn_matrix(quaternion)
        # From a variation of the wrench [moment; force] to one of the rows [−F ℓ; −Tᵀ M].
        by_force = ca.horzcat(ca.DM(3, 3), -frame.length / frame.unit * ca.DM.eye(3))
        by_moment = ca.horzcat(-turn.T / frame.unit, ca.DM(4, 3))
        to_rows = ca.vertcat(by_force, by_moment)
        for columns, variation in self._wrench_variations(name):
            blocks.add(rows, columns, column_at(to_rows @ variation, self._load_factor))
        own_turn = TURN_ROWS(quaternion, self._wrenches[name][:3] / frame.unit)[1]
        blocks.add(rows, rows, column_at(ca.diagcat(ca.DM(3, 3), own_turn), self._load_factor))

    def _wrench_variations(self, name: FrameName) -> list[tuple[slice, Matrix]]:
        """Variation of the wrench on a frame with each block of unknowns that changes it, 6×k, world axes."""
        discrete = self.system.discrete
        variations: list[tuple[slice, Matrix]] = []
        by_motion: dict[FrameName, Matrix] = defaultdict(lambda: ca.DM(6, 6))
        for placed in self.constraints:
            if placed.frame != name:
                continue
            by_multipliers, by_poses = placed.constraint.reaction_variation(
                self.system.poses(placed), self.system.multipliers(placed)
            )
            variations.append((discrete.multipliers(placed), by_multipliers))
            for frame, derivative in self._by_frames(placed, by_poses):
                by_motion[frame] = by_motion[frame] + derivative
            if placed.constraint.slides:
                strains = discrete.unknowns.strain(placed.rod)
                variations.append((strains, by_poses.section @ self._section_motion(placed)))
        if name.kind == "rod":
            variations += self._rod_reaction_variations(name, by_motion)
        for load in self._body_loads[name]:
            by_motion[name] = by_motion[name] + load.variation
        for frame, derivative in by_motion.items():
            variations.append((discrete.deviation(frame), derivative @ self._frame_motion(frame)))
        return variations

    def _rod_reaction_variations(
        self, name: FrameName, by_motion: dict[FrameName, Matrix]
    ) -> list[tuple[slice, Matrix]]:
        """Variation of the wrench of a carried rod on its base with strains and multipliers; frames into by_motion."""
        rod = name.name
        discrete = self.system.discrete
        statics = self.system.rods[rod].statics
        reaction = self._reactions[rod]
        rotation = self.poses[name].pose.rotation
        to_world = ca.diagcat(rotation, rotation)
        by_strain = ca.vertcat(reaction.moment_with_strain, reaction.force_with_strain)
        variations = [(discrete.unknowns.strain(rod), -to_world @ by_strain)]
        _, force, moment = reaction.with_turn
        # In the axes of the base, dead loads turn back; the base wrench itself turns with the base.
        by_turn = ca.vertcat(moment - hat(statics.base_moment), force - hat(statics.base_force))
        by_shift: Matrix = ca.DM(6, 3)
        if reaction.with_shift is not None:
            _, force, moment = reaction.with_shift
            by_shift = ca.vertcat(moment, force)
        in_base_axes = ca.horzcat(by_turn @ rotation.T, by_shift @ rotation.T)
        by_motion[name] = by_motion[name] - to_world @ in_base_axes
        for placed in discrete.constraints_on(rod):
            variations += self._passed_on(placed, to_world, by_motion)
        return variations

    def _passed_on(
        self, placed: PlacedConstraint, to_world: Matrix, by_motion: dict[FrameName, Matrix]
    ) -> list[tuple[slice, Matrix]]:
        """What a constraint on a carried rod passes on to the rod's base."""
        poses = self.system.poses(placed)
        position = poses.section.position
        levered_force = ca.horzcat(ca.DM.eye(3), hat(position))
        lever = ca.vertcat(levered_force, ca.horzcat(ca.DM(3, 3), ca.DM.eye(3)))
        to_base = to_world @ lever
        if placed.constraint.held.turn_with_place:
            turned = placed.constraint.wrench_variation(poses, self.system.multipliers(placed))
            for frame, derivative in self._by_frames(placed, turned):
                by_motion[frame] = by_motion[frame] + to_base @ derivative
        return [(self.system.discrete.multipliers(placed), to_base @ placed.constraint.wrench_basis(poses))]

    # Loads on bodies

    @cached_property
    def _body_loads(self) -> dict[FrameName, list[BodyLoad]]:
        """Loads on the bodies at the load factor; none on the bases of rods."""
        return {name: list(self._loads_on(name, frame.body)) for name, frame in self.frames.items()}

    def _loads_on(self, name: FrameName, body: scenes.Body | None) -> Iterator[BodyLoad]:
        if body is None:
            return
        pose = self.poses[name].pose
        loads = BodyLoads(self.system.discrete, body, pose.position, pose.rotation, self.system.arguments.inputs)
        for load in loads.all():
            yield load.scaled(self._load_factor)

    # Cables of given length

    def _add_cable_length(self, blocks: Blocks, tendon: str) -> None:
        """Row of a cable of given length, and its tension's column in the residual of its rod."""
        equation = self.system.cable_lengths[tendon]
        strains = self.system.discrete.unknowns.strain(equation.rod)
        tension = self.system.discrete.unknowns.slice_of(BlockKind.TENSION, tendon)
        blocks.add(strains, tension, equation.pull)
        blocks.add(tension, strains, column_at(equation.strain_columns, self._load_factor))
        blocks.add(tension, tension, column_at(equation.tension_column, self._load_factor))

    # The way to the scene

    def _add_springs(self, blocks: Blocks) -> None:
        """Derivatives of the springs that constraints, frames and cables are on the way to the scene."""
        discrete = self.system.discrete
        rows = [(discrete.multipliers(placed), placed.compliance) for placed in self.constraints]
        rows += [(discrete.deviation(name), ASSEMBLED) for name in self.frames]
        rows += [(discrete.tension(cable), cable.compliance) for cable in discrete.cables]
        for entries, compliance in rows:
            block = spring(entries.stop - entries.start, compliance, self._load_factor)
            if block is not None:
                blocks.add(entries, entries, block)
