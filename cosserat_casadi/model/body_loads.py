"""Loads of a scene on its bodies."""

from __future__ import annotations

from dataclasses import dataclass, replace

import casadi as ca

from cosserat_casadi import scene as scenes
from cosserat_casadi.loads.load import BodyPoint
from cosserat_casadi.loads.load_trace import TracedLoad, stored, traced
from cosserat_casadi.maths.numbers import Scalar, as_matrix, as_vector
from cosserat_casadi.maths.rotation import hat
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.model.discrete_scene import DiscreteScene
from cosserat_casadi.model.homotopy import LoadFactor
from cosserat_casadi.model.inputs import input_values
from cosserat_casadi.model.registry import EFFECTS
from cosserat_casadi.rod.rod_motion import FrameMotion


@dataclass(frozen=True)
class BodyLoad:
    """A load on a rigid body at the body's pose, world axes.

    Attributes:
        position: the loaded point in the axes of the body, m.
        arm: the loaded point from the origin of the body, world axes, 3×1, m.
        force: 3×1, N.
        moment: 3×1, N m.
        follower: whether force and moment turn with the body.
        aligns: whether it can hold the orientation of the body: a force that keeps its direction, or a load that
            depends on the pose.
        stiffness: 6×6 derivative of [force; moment] with the [δr; δθ] of the point; None for a dead load or a follower.
        energy: 1×1, J; None for a load that is not written by an energy.
    """

    position: tuple[Scalar, Scalar, Scalar]
    arm: Matrix
    force: Matrix
    moment: Matrix
    follower: bool
    aligns: bool
    stiffness: Matrix | None = None
    energy: Matrix | None = None

    def scaled(self, load_factor: LoadFactor) -> BodyLoad:
        """The load at a load factor."""
        if load_factor is None:
            return self
        stiffness = None if self.stiffness is None else load_factor * self.stiffness
        return replace(self, force=load_factor * self.force, moment=load_factor * self.moment, stiffness=stiffness)

    @property
    def wrench(self) -> Matrix:
        """Wrench [moment about the origin; force] on the body, 6×1."""
        moment = ca.cross(self.arm, self.force) + self.moment
        return ca.vertcat(moment, self.force)

    @property
    def variation(self) -> Matrix:
        """Derivative of the wrench with the motion [δθ; δr] of the body, world axes, 6×6."""
        # A shift δr moves the loaded point and the origin, about which the moment is taken, alike.
        if self.follower:
            # All of the wrench turns with the body: δθ × M = −M^ δθ.
            moment = ca.cross(self.arm, self.force) + self.moment
            by_turn = ca.vertcat(-hat(moment), -hat(self.force))
            return ca.horzcat(by_turn, ca.DM(6, 3))
        # The arm turns: (δθ × arm) × f = f^ arm^ δθ.
        by_turn = ca.vertcat(hat(self.force) @ hat(self.arm), ca.DM(3, 3))
        if self.stiffness is None:
            return ca.horzcat(by_turn, ca.DM(6, 3))
        # The point shifts by δθ × arm + δr and turns by δθ.
        turned = self._changed(ca.vertcat(-hat(self.arm), ca.DM.eye(3)))
        shifted = self._changed(ca.vertcat(ca.DM.eye(3), ca.DM(3, 3)))
        return ca.horzcat(by_turn + turned, shifted)

    def _changed(self, motion: Matrix) -> Matrix:
        """Change of the wrench [moment about the origin; force] for three motions [δr; δθ] of the point, 6×3."""
        assert self.stiffness is not None
        force, moment = ca.vertsplit(self.stiffness @ motion, 3)
        moment_about_origin = hat(self.arm) @ force + moment
        return ca.vertcat(moment_about_origin, force)


@dataclass(frozen=True)
class BodyLoads:
    """The scene's loads on one body in its pose.

    Attributes:
        discrete: the scene.
        body: the body.
        position: of its origin, 3×1, world axes, m.
        rotation: world_R_body, 3×3.
        inputs: stacked inputs.
    """

    discrete: DiscreteScene
    body: scenes.Body
    position: Matrix
    rotation: Matrix
    inputs: Matrix

    def all(self) -> list[BodyLoad]:
        """All loads on the body."""
        return [own for own in map(self.of, self.discrete.loads) if own is not None]

    def of(self, load: scenes.LoadRecord) -> BodyLoad | None:
        """One load on the body; None if it does not act on the body, or is always zero."""
        point = EFFECTS[load.kind].on_body(load, self.body)
        if point is None:
            return None
        values = input_values(self.discrete.layout, load, self.inputs)
        kernel = traced(EFFECTS[load.kind], load, values)
        if not kernel.pose_free:
            return self._pose_dependent(kernel, point)
        given_force, given_moment = kernel.coefficients(values)
        if given_force is None and given_moment is None:
            return None
        none = ca.DM.zeros(3, 1)
        force, moment = (none if part is None else point.factor * part for part in (given_force, given_moment))
        if kernel.follower:
            force, moment = self.rotation @ force, self.rotation @ moment
        aligns = given_force is not None and not kernel.follower
        return BodyLoad(point.position, self._arm(point), force, moment, kernel.follower, aligns)

    def drag(self, load: scenes.LoadRecord, motion: FrameMotion) -> Matrix | None:
        """The drag of a load, [force; moment about the origin], 6×1; None for a load that does not depend on motion.

        Args:
            load: a load on the body.
            motion: motion of the body, world axes.
        """
        point = EFFECTS[load.kind].on_body(load, self.body)
        kernel = traced(EFFECTS[load.kind], load, input_values(self.discrete.layout, load, self.inputs))
        moving = kernel.moving_by_body
        if point is None or moving is None:
            return None
        arm = self._arm(point)
        at_point = replace(motion, velocity=motion.velocity + ca.cross(motion.angular_velocity, arm))
        rates = [getattr(at_point, rate) for rate in moving.rates]
        force, moment = moving.drag.call([*self._arguments(kernel, arm), *rates])
        drag: Matrix = point.factor * ca.vertcat(force, moment + ca.cross(arm, force))
        return drag

    def _arguments(self, kernel: TracedLoad, arm: Matrix) -> list[Matrix]:
        """Arguments of a kernel at a point of the body."""
        parameters = stored(input_values(self.discrete.layout, kernel.load, self.inputs))
        # Profiles belong to loads per length: for a load at a point they are one.
        profiles = ca.DM.ones(sum(kernel.columns), 1)
        # The kernel of a load on a body has the world as its base.
        base = [ca.DM.zeros(3, 1), ca.DM.eye(3)]
        return [self.position + arm, self.rotation, *base, parameters, profiles]

    def _pose_dependent(self, kernel: TracedLoad, point: BodyPoint) -> BodyLoad:
        """A load that depends on the pose of its point: its kernel at this pose."""
        section_kernel = kernel.kernel
        arm = self._arm(point)
        arguments = self._arguments(kernel, arm)
        force, moment = section_kernel.wrench.call(arguments)
        (stiffness,) = section_kernel.stiffness.call(arguments)
        energy = None
        if section_kernel.energy is not None:
            energy = point.factor * section_kernel.energy(*arguments)
        return BodyLoad(
            position=point.position,
            arm=arm,
            force=point.factor * force,
            moment=point.factor * moment,
            follower=False,
            aligns=True,
            stiffness=point.factor * stiffness,
            energy=energy,
        )

    def _arm(self, point: BodyPoint) -> Matrix:
        return self.rotation @ as_matrix(as_vector(point.position))
