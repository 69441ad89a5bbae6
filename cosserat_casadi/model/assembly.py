"""The equations that couple the rods of a scene: gaps of ties, balance of moving frames, and their derivatives.

The balance of a frame is the derivative of the Lagrangian with respect to its pose: −F ℓ for the position, and for the
quaternion −Tᵀ M with δθ = T δQ, both in units of the frame's EI/ℓ. A quaternion has a length that no mechanics sees:
the derivative (Q·Q − 1) Q of ¼ (Q·Q − 1)² is added, orthogonal to the rest, and makes it one. So no rotation is
singular, and the Jacobian is symmetric but for units wherever the loads have a potential and the gaps are closed.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

import casadi as ca

from cosserat_casadi.constraints.joint import Joint, Placement
from cosserat_casadi.constraints.tip_support import Pose
from cosserat_casadi.maths.rotation import hat
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.model.couplings import Carrier, Couplings, MovingFrame, Tie
from cosserat_casadi.model.load_assembly import BodyLoad, BodyLoads
from cosserat_casadi.rod.reaction import Reaction

if TYPE_CHECKING:
    from cosserat_casadi.model.system import System


GIVE = 3
"""Power of (1 − factor) with which springs vanish: what holds rods that do not fit is far stiffer than they are."""


@dataclass
class Blocks:
    """A square matrix made of blocks, those that meet the same place added.

    Attributes:
        ends: where the rows and columns of blocks end.
        entries: blocks by their places.
    """

    ends: list[int]
    entries: dict[tuple[int, int], Matrix] = field(default_factory=dict)

    def add(self, rows: slice, columns: slice, block: Matrix) -> None:
        """Add a block."""
        place = (rows.start, columns.start)
        self.entries[place] = self.entries[place] + block if place in self.entries else block

    def matrix(self) -> Matrix:
        """The whole, sparse."""
        places = list(zip([0, *self.ends], self.ends, strict=False))
        rows = []
        for a, b in places:
            row = [self.entries.get((a, c), ca.DM(b - a, d - c)) for c, d in places]
            rows.append(ca.horzcat(*row))
        return ca.vertcat(*rows)


@dataclass(frozen=True)
class Coupled:
    """Rods of a system with the frames that move and the ties between them.

    Attributes:
        system: the rods and the arguments of the equations.
    """

    system: System

    @property
    def couplings(self) -> Couplings:
        """What does not depend on the unknowns."""
        return self.system.discrete.couplings

    @cached_property
    def placements(self) -> dict[Carrier, Placement]:
        """Poses of the moving frames."""
        return {carrier: self._placement(carrier, frame) for carrier, frame in self.couplings.moving.items()}

    def base(self, rod: str) -> Placement:
        """World pose of a rod's base."""
        carrier = self.couplings.carrier(rod)
        if carrier is not None:
            return self.placements[carrier]
        pose = self.system.base(rod)
        return Placement(pose.position, pose.quaternion)

    def multipliers(self, tie: Tie) -> Matrix:
        """Multipliers of a tie."""
        return self.system.arguments.x[self.system.discrete.tie_slices[tie.where]]

    @cached_property
    def gaps(self) -> list[Matrix]:
        """Gap of every tie, on the way to the scene with the tie's give."""
        return [self._closing(self.gap(tie), self.multipliers(tie)) for tie in self.couplings.ties]

    def gap(self, tie: Tie) -> Matrix:
        """What a tie has left to close, without unit."""
        return tie.joint.gap(self._section(tie), self.base(tie.rod), self._other(tie))

    @cached_property
    def balances(self) -> list[Matrix]:
        """Balance of every moving frame, 7×1, without unit."""
        found = []
        for carrier, frame in self.couplings.moving.items():
            force, moment = self._resultants[carrier]
            place = self.placements[carrier]
            excess = ca.sumsqr(place.quaternion) - 1
            rows = ca.vertcat(
                -frame.length / frame.unit * force,
                excess * place.quaternion - place.turn.T @ moment / frame.unit,
            )
            found.append(self._closing(rows, self._deviation(carrier)))
        return found

    @cached_property
    def jacobian(self) -> Matrix:
        """∂ residual / ∂x of the whole scene, sparse by blocks."""
        discrete = self.system.discrete
        slices = [*discrete.rod_slices.values(), *discrete.hold_slices, *discrete.tie_slices.values()]
        slices += [*discrete.moving_slices.values(), *discrete.tension_slices]
        blocks = Blocks([place.stop for place in slices])
        for rod, tangent in self.system.tangents.items():
            blocks.add(discrete.rod_slices[rod], discrete.rod_slices[rod], tangent.jacobian)
        self._add_holds(blocks)
        self._add_lengths(blocks)
        for tie in self.couplings.ties:
            self._add_gap(blocks, tie)
            self._add_pull(blocks, tie)
        for carrier in self.couplings.moving:
            self._add_frame(blocks, carrier)
        for carried in self.couplings.carried:
            self._add_reaction(blocks, carried.name)
        return blocks.matrix()

    def _closing(self, equation: Matrix, unknown: Matrix) -> Matrix:
        """Ties and frames on the way to the scene.

        A tie is a spring between the section and its place, from limp to rigid; a frame is held where the unloaded
        scene has it by a spring, from rigid to limp.
        """
        return equation if self.system.whole else self._scaled(equation) + self._give * unknown

    @property
    def _give(self) -> Matrix:
        """Compliance of the springs of ties, stiffness of those of frames, without unit."""
        return (1 - self.system.arguments.factor) ** GIVE

    def _placement(self, carrier: Carrier, frame: MovingFrame) -> Placement:
        moved = self._deviation(carrier)
        position = ca.DM(frame.start.position) + frame.length * moved[:3]
        return Placement(position, ca.DM(frame.start.quaternion) + moved[3:])

    def _deviation(self, carrier: Carrier) -> Matrix:
        return self.system.arguments.x[self.system.discrete.moving_slices[carrier]]

    def _section(self, tie: Tie) -> Pose:
        place = self.system.rods[tie.rod].shape
        return Pose(place.position_at(tie.node), place.quaternion[:, tie.node])

    def _other(self, tie: Tie) -> Placement:
        if tie.other is None:
            return Placement(ca.DM.zeros(3, 1), ca.DM([1, 0, 0, 0]))
        return self.placements[tie.other]

    @cached_property
    def _resultants(self) -> dict[Carrier, tuple[Matrix, Matrix]]:
        """Force (N) and moment about the origin (N m) on every moving frame, world axes."""
        found: dict[Carrier, tuple[Matrix, Matrix]] = {}
        for carrier in self.couplings.moving:
            force, moment = ca.DM.zeros(3, 1), ca.DM.zeros(3, 1)
            for one, other in self._wrenches(carrier):
                force, moment = force + one, moment + other
            found[carrier] = (force, moment)
        return found

    def _wrenches(self, carrier: Carrier) -> list[tuple[Matrix, Matrix]]:
        """What acts on a moving frame: ties that hold on to it, the rod it is the base of, loads on the body."""
        found = []
        for tie in self.couplings.ties:
            if tie.other == carrier:
                force, moment = self._tie_wrench(tie)
                arm = tie.joint.arm(self.placements[carrier])
                found.append((-force, -ca.cross(arm, force) - moment))
        if carrier.kind == "rod":
            statics, rotation = self.system.rods[carrier.name].statics, self.placements[carrier].rotation
            found.append((-(rotation @ statics.base_force), -(rotation @ statics.base_moment)))
        found += [load.resultant for load in self._body_loads(carrier)]
        return found

    def _tie_wrench(self, tie: Tie) -> tuple[Matrix, Matrix]:
        """Force and moment of a tie on its section, world axes."""
        rotation, multipliers = self.base(tie.rod).rotation, self.multipliers(tie)
        moment = tie.joint.moment(multipliers)
        turned = ca.DM.zeros(3, 1) if moment is None else rotation @ moment
        return rotation @ tie.joint.force(multipliers), turned

    def _body_loads(self, carrier: Carrier) -> list[BodyLoad]:
        body, place = self.couplings.moving[carrier].body, self.placements[carrier]
        if body is None:
            return []
        return BodyLoads(self.system.discrete, body, place.position, place.rotation, self.system.arguments).all()

    def _add_holds(self, blocks: Blocks) -> None:
        discrete = self.system.discrete
        for (support, hold, _), place in zip(self.system.holds, discrete.hold_slices, strict=True):
            tangent, rod = self.system.tangents[support.rod], discrete.rod_slices[support.rod]
            moved, turned = tangent.position(-1), tangent.rotation_of(-1)
            blocks.add(rod, place, hold.force_variation(moved, turned))
            blocks.add(place, rod, self._scaled(hold.gap_variation(self.system.tip(support.rod), moved, turned)))
            if not self.system.whole:
                blocks.add(place, place, (1 - self.system.arguments.factor) * ca.MX.eye(hold.size))

    def _add_lengths(self, blocks: Blocks) -> None:
        """Rows of the cables of given length, and their tensions' columns in the rods' residuals."""
        discrete = self.system.discrete
        for length, place in zip(self.system.lengths, discrete.tension_slices, strict=True):
            rod = discrete.rod_slices[length.cable.shape.rod.properties.name]
            blocks.add(rod, place, length.pull)
            blocks.add(place, rod, (length.gap_with_length * length.pull).T)
            blocks.add(place, place, length.gap_with_tension)

    def _add_gap(self, blocks: Blocks, tie: Tie) -> None:
        """Rows of a tie's gap, and its multipliers' columns in the rod's residual."""
        discrete, tangent = self.system.discrete, self.system.tangents[tie.rod]
        rows, rod, joint = discrete.tie_slices[tie.where], discrete.rod_slices[tie.rod], tie.joint
        moved, turned = tangent.position(tie.node), tangent.rotation_of(tie.node)
        sides = (self._section(tie), self.base(tie.rod), self._other(tie))
        blocks.add(rod, rows, joint.force_with_strain(moved, turned))
        blocks.add(rows, rod, self._scaled(joint.gap_with_strain(*sides, moved, turned)))
        own = self.couplings.carrier(tie.rod)
        for carrier, columns in ((own, joint.gap_with_base), (tie.other, joint.gap_with_other)):
            if carrier is not None:
                blocks.add(rows, discrete.moving_slices[carrier], self._scaled(columns(*sides) @ self._motion(carrier)))
        self._add_give(blocks, rows)

    def _add_pull(self, blocks: Blocks, tie: Tie) -> None:
        """What a tie does to the frame on its other side."""
        if tie.other is None:
            return
        base, other, joint = self.base(tie.rod), self.placements[tie.other], tie.joint
        columns, arm = self.system.discrete.tie_slices[tie.where], hat(joint.arm(other))
        force, moment = (base.rotation @ unit for unit in joint.units())
        self._add_rows(blocks, tie.other, columns, -force, -(arm @ force) - moment)
        pulled, twisted = map(hat, self._tie_wrench(tie))
        self._add_turn(blocks, tie.other, tie.other, ca.DM(3, 3), -(pulled @ arm))
        carrier = self.couplings.carrier(tie.rod)
        if carrier is not None:
            self._add_turn(blocks, tie.other, carrier, pulled, arm @ pulled + twisted)

    def _add_frame(self, blocks: Blocks, carrier: Carrier) -> None:
        """What a frame's own turn does to its balance, the length of its quaternion, loads on the body."""
        frame, place = self.couplings.moving[carrier], self.placements[carrier]
        _, moment = self._resultants[carrier]
        q, rows = place.quaternion, self.system.discrete.moving_slices[carrier]
        own = (ca.sumsqr(q) - 1) * ca.DM.eye(4) + 2 * q @ q.T - place.turned_moment(moment) / frame.unit
        blocks.add(rows, rows, self._scaled(ca.diagcat(ca.DM(3, 3), own)))
        for load in self._body_loads(carrier):
            self._add_turn(blocks, carrier, carrier, *load.with_turn)
            if load.with_shift is not None:
                self._add_shift(blocks, carrier, *load.with_shift)
        self._add_give(blocks, rows)

    def _add_reaction(self, blocks: Blocks, name: str) -> None:
        """A carried rod: what it does to its base, and what the turn of its base does to it."""
        discrete, carrier, igm = self.system.discrete, Carrier("rod", name), self.system.rods[name]
        rotation, rod = self.placements[carrier].rotation, discrete.rod_slices[name]
        reaction = Reaction(self.system.tangents[name], self.system.dead_wrenches(name))
        strained = (reaction.force_with_strain, reaction.moment_with_strain)
        self._add_rows(blocks, carrier, rod, *(-(rotation @ columns) for columns in strained))
        residual, force, moment = reaction.with_turn
        blocks.add(rod, discrete.moving_slices[carrier], residual @ rotation.T @ self._motion(carrier)[3:, :])
        force, moment = force - hat(igm.statics.base_force), moment - hat(igm.statics.base_moment)
        self._add_turn(blocks, carrier, carrier, *(-(rotation @ m @ rotation.T) for m in (force, moment)))
        if reaction.with_shift is not None:
            residual, force, moment = reaction.with_shift
            blocks.add(rod, discrete.moving_slices[carrier], residual @ rotation.T @ self._motion(carrier)[:3, :])
            self._add_shift(blocks, carrier, *(-(rotation @ m @ rotation.T) for m in (force, moment)))
        for tie in self.couplings.ties:
            if tie.rod == name:
                self._add_passed(blocks, carrier, tie, tie.joint)

    def _add_passed(self, blocks: Blocks, carrier: Carrier, tie: Tie, joint: Joint) -> None:
        """What a tie on a carried rod passes on to the rod's base."""
        rotation, (force, moment) = self.placements[carrier].rotation, joint.units()
        levered = hat(self._section(tie).position) @ force + moment
        columns = self.system.discrete.tie_slices[tie.where]
        self._add_rows(blocks, carrier, columns, rotation @ force, rotation @ levered)

    def _motion(self, carrier: Carrier) -> Matrix:
        """δp (m) and δθ (rad, world axes) of a moving frame from its unknowns, 6×7."""
        return ca.diagcat(self.couplings.moving[carrier].length * ca.DM.eye(3), self.placements[carrier].turn)

    def _add_turn(self, blocks: Blocks, carrier: Carrier, turning: Carrier, force: Matrix, moment: Matrix) -> None:
        """Variations of force and moment on a frame with the turn of a frame, 3×3 each, world axes."""
        turn = self._motion(turning)[3:, :]
        self._add_rows(blocks, carrier, self.system.discrete.moving_slices[turning], force @ turn, moment @ turn)

    def _add_shift(self, blocks: Blocks, carrier: Carrier, force: Matrix, moment: Matrix) -> None:
        """Variations of force and moment on a frame with its own shift, 3×3 each, world axes."""
        shift = self._motion(carrier)[:3, :]
        self._add_rows(blocks, carrier, self.system.discrete.moving_slices[carrier], force @ shift, moment @ shift)

    def _add_rows(self, blocks: Blocks, carrier: Carrier, columns: slice, force: Matrix, moment: Matrix) -> None:
        """Variations of force and moment on a frame, 3×k each, as rows of its balance."""
        frame, turn = self.couplings.moving[carrier], self.placements[carrier].turn
        rows = ca.vertcat(-frame.length / frame.unit * force, turn.T @ moment / -frame.unit)
        blocks.add(self.system.discrete.moving_slices[carrier], columns, self._scaled(rows))

    def _add_give(self, blocks: Blocks, rows: slice) -> None:
        if not self.system.whole:
            blocks.add(rows, rows, self._give * ca.MX.eye(rows.stop - rows.start))

    def _scaled(self, rows: Matrix) -> Matrix:
        return rows if self.system.whole else self.system.arguments.factor * rows
