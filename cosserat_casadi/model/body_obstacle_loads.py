"""Loads on rods whose reaction a body bears: the push of obstacles that are fixed to bodies.

Such a load is written in the axes of its body: the forces on a rod depend on the pose of the rod relative to the body,
and on nothing else. Two things follow. The body bears the wrench of a clamp that holds the rod against this load alone:
the wrench on the body is the base wrench of that load, about another point. And a motion of the body changes the rod's
residual as the opposite motion of its base does, whose derivatives rod/reaction.py has. No derivative is new here.

With o the origin of the body relative to the base of the rod, base axes, a motion [δθ; δr] of the body is the motion
δφ = −δθ, δp = −δr − o × δθ of the base. Docs/theory.md, section 8.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import casadi as ca

from cosserat_casadi.maths.rotation import hat
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.model.floating_frames import FrameName
from cosserat_casadi.model.system import System
from cosserat_casadi.rod.pose_load import LoadedSections
from cosserat_casadi.rod.reaction import Reaction
from cosserat_casadi.rod.statics import Statics


def borne_loads(system: System) -> Iterator[BorneLoad]:
    """All loads on rods whose reaction a body bears, at the load factor of the system."""
    for rod, model in system.rods.items():
        for load in model.statics.pose_loads:
            if load.load.borne_by is not None:
                yield BorneLoad(system, rod, load)


@dataclass(frozen=True)
class BorneLoad:
    """One load on a rod whose reaction a body bears. Wrenches are [moment; force], motions [δθ; δr]."""

    system: System
    rod: str
    load: LoadedSections

    @property
    def body(self) -> FrameName:
        """The frame of the body."""
        assert self.load.load.borne_by is not None, "a body bears it"
        return FrameName("body", self.load.load.borne_by)

    @property
    def base_frame(self) -> FrameName | None:
        """The floating frame of the rod's base; None if the base rests in the world."""
        return self.system.discrete.unloaded.floating_base(self.rod)

    @cached_property
    def wrench(self) -> Matrix:
        """Wrench on the body about its origin, world axes, 6×1, N m and N."""
        return self._to_world @ self._about_body @ self._clamp

    @cached_property
    def wrench_with_strain(self) -> Matrix:
        """Derivative of the wrench on the body with the strains of the rod, world axes, 6×n."""
        by_strain = ca.vertcat(self._reaction.moment_with_strain, self._reaction.force_with_strain)
        return self._to_world @ self._about_body @ by_strain

    @cached_property
    def residual_with_body(self) -> Matrix:
        """Derivative of the residual of the rod with the motion of the body, world axes, n×6."""
        by_turn, _, _ = self._reaction.with_turn
        by_shift, _, _ = self._with_shift
        return self._of_body(by_turn, by_shift)

    def with_motions(self, frame: FrameName) -> Iterator[tuple[FrameName, Matrix]]:
        """Derivatives of the load's wrench on a frame with the motions of frames, 6×6 each.

        For the frame of the body these are all derivatives. For the base of the rod it is the derivative with respect
        to the motion of the body alone: the rod's reaction has the others.
        """
        if frame == self.body:
            yield self.body, self._wrench_with_body
            if self.base_frame is not None:
                yield self.base_frame, self._wrench_with_base
        elif frame == self.base_frame:
            _, force_with_turn, moment_with_turn = self._reaction.with_turn
            _, force_with_shift, moment_with_shift = self._with_shift
            by_turn = ca.vertcat(moment_with_turn, force_with_turn)
            by_shift = ca.vertcat(moment_with_shift, force_with_shift)
            yield self.body, -self._to_world @ self._of_body(by_turn, by_shift)

    @cached_property
    def _wrench_with_base(self) -> Matrix:
        """Derivative of the wrench on the body with the motion of the rod's base, 6×6."""
        by_turn, by_shift = self._about_body_with_base
        return self._to_world @ ca.horzcat(by_turn, by_shift) @ self._to_world.T

    @cached_property
    def _wrench_with_body(self) -> Matrix:
        """Derivative of the wrench on the body with its own motion, 6×6.

        If body and base move as one rigid body the wrench turns with them, by M × and F ×, and does not change
        otherwise: the derivative with respect to the base alone is subtracted from that.
        """
        by_turn, by_shift = self._about_body_with_base
        moment, force = ca.vertsplit(self._about_body @ self._clamp, 3)
        turned = -ca.vertcat(hat(moment), hat(force))
        alone = ca.horzcat(turned - by_turn - by_shift @ hat(self._origin), -by_shift)
        return self._to_world @ alone @ self._to_world.T

    @cached_property
    def _about_body_with_base(self) -> tuple[Matrix, Matrix]:
        """Derivatives of the wrench on the body with a turn and a shift of the base, base axes, 6×3 each."""
        moment, force = ca.vertsplit(self._clamp, 3)
        _, force_with_turn, moment_with_turn = self._reaction.with_turn
        _, force_with_shift, moment_with_shift = self._with_shift
        # In the world a wrench given in the axes of the base also turns with the base, by δθ × M.
        turned = ca.vertcat(moment_with_turn - hat(moment), force_with_turn - hat(force))
        shifted = ca.vertcat(moment_with_shift, force_with_shift)
        # A shift of the base shifts the point about which the moment of the clamp is taken.
        lever = ca.vertcat(-hat(force), ca.DM(3, 3))
        return self._about_body @ turned, self._about_body @ shifted + lever

    def _of_body(self, by_turn: Matrix, by_shift: Matrix) -> Matrix:
        """Derivatives by a motion of the body, k×6, from derivatives by a turn and by a shift of the base, k×3 each."""
        in_base_axes = ca.horzcat(-by_turn - by_shift @ hat(self._origin), -by_shift)
        return in_base_axes @ self._to_world.T

    @cached_property
    def _clamp(self) -> Matrix:
        """Wrench, about the base, of a clamp that holds the rod against this load alone, base axes, 6×1."""
        statics = Statics(self.load.shape, (), (self.load,))
        return ca.vertcat(statics.base_moment, statics.base_force)

    @cached_property
    def _reaction(self) -> Reaction:
        """Variations of the rod's residual and of the clamp's wrench under this load alone."""
        return Reaction(self.system.tangents[self.rod].under(self.load), ())

    @property
    def _with_shift(self) -> tuple[Matrix, Matrix, Matrix]:
        variation = self._reaction.with_shift
        assert variation is not None, "the load hangs on where the rod is"
        return variation

    @cached_property
    def _origin(self) -> Matrix:
        """Origin o of the body relative to the base of the rod, 3×1, base axes, m."""
        base = self.system.base(self.rod)
        return base.rotation.T @ (self.system.frame(self.body).position - base.position)

    @cached_property
    def _about_body(self) -> Matrix:
        """Matrix from wrenches about the base to wrenches about the origin of the body, M − o × F, 6×6."""
        moment_rows = ca.horzcat(ca.DM.eye(3), -hat(self._origin))
        force_rows = ca.horzcat(ca.DM(3, 3), ca.DM.eye(3))
        return ca.vertcat(moment_rows, force_rows)

    @cached_property
    def _to_world(self) -> Matrix:
        """Rotation of wrenches from the axes of the base into the axes of the world, 6×6."""
        rotation = self.system.base(self.rod).rotation
        return ca.diagcat(rotation, rotation)
