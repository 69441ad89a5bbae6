"""Drag: the part of loads on or from bodies that motion makes, such as damping and friction of contact.

A load on a rod from an obstacle on a body depends on the rod's motion relative to the body, a load on a body on the
body's motion. The part that motion adds to the load at rest is its drag. In the world it is a wrench on the sections,
and the opposite on the body. At fixed drag the equations are as for dead loads; how the drag changes is added to their
derivatives in model/motion_functions.py.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import casadi as ca

from cosserat_casadi import scene as scenes
from cosserat_casadi.maths.numbers import as_matrix
from cosserat_casadi.maths.rotation import cross
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.model.body_loads import BodyLoads
from cosserat_casadi.model.floating_frames import FrameName
from cosserat_casadi.model.registry import EFFECTS
from cosserat_casadi.rod.pose_load import LoadedSections
from cosserat_casadi.rod.wrenches import PoseWrench, SeenMotion, Wrench, WrenchAt

if TYPE_CHECKING:
    from cosserat_casadi.model.system import System


def drags_of(system: System) -> Iterator[RodDrag | BodyDrag]:
    """The drags of a scene in motion."""
    for load in system.discrete.loads:
        member = EFFECTS[load.kind]
        body = member.seen_from(load)
        for rod in system.discrete.rods if body is not None else ():
            wrench = system.rod_loads(rod).seen_in_motion(load, seen_motion(system, rod, body))
            if wrench is not None:
                yield RodDrag(system, f"{load.name} on {rod}", rod, wrench)
        for name, record in system.discrete.bodies.items():
            if member.on_body(load, record) is not None:
                drag = BodyDrag(system, f"{load.name} on body {name}", FrameName("body", name), load)
                if drag.own is not None:
                    yield drag


def seen_motion(system: System, rod: str, body: str | None) -> SeenMotion:
    """Motion of the sections of a rod relative to a body, or to the world, axes of the rod's base."""
    own = system.motions[rod]
    if body is None:
        return SeenMotion(own.velocity, own.angular_velocity)
    name = FrameName("body", body)
    base = system.base(rod)
    base_R_world = base.rotation.T
    of_body = system.frame_motions[name].motion.in_axes(base_R_world)
    count = own.velocity.shape[1]
    turning = ca.repmat(of_body.angular_velocity, 1, count)
    origin = base_R_world @ (system.frame(name).position - base.position)
    arms = system.shapes[rod].position - ca.repmat(origin, 1, count)
    carried = ca.repmat(of_body.velocity, 1, count) + cross(turning, arms)
    return SeenMotion(own.velocity - carried, own.angular_velocity - turning)


class Drag(ABC):
    """A drag with its derivatives."""

    @property
    @abstractmethod
    def frictions(self) -> Sequence[Matrix]:
        """Wrenches of the drag and of its reaction on a body or a section, world axes."""

    def friction_jacobian(self, argument: Matrix) -> Matrix:
        """Derivative of the drag on the rod and on the body, stacked, with respect to an argument."""
        return ca.jacobian(ca.vertcat(*map(ca.vec, self.frictions)), argument)


@dataclass(frozen=True)
class RodDrag(Drag):
    """The drag of a load on a rod, with its reaction on a body.

    Attributes:
        system: the scene in motion.
        name: names of the load and the rod.
        rod: name of the rod.
        load: the load in motion.
    """

    system: System
    name: str
    rod: str
    load: PoseWrench

    @property
    def body(self) -> FrameName:
        """The frame of the body."""
        assert self.load.borne_by is not None, "a body bears it"
        return FrameName("body", self.load.borne_by)

    @cached_property
    def sections(self) -> LoadedSections:
        """The loaded sections."""
        return LoadedSections(self.load, self.system.shapes[self.rod])

    @cached_property
    def frictions(self) -> Sequence[Matrix]:
        """[Force; moment] on the k sections, 6×k, N/m and N, and on the body about its origin, 6×1; world axes."""
        if self.name in self.system.friction:
            return self.system.friction[self.name]
        base = self.system.base(self.rod)
        force, moment = (base.rotation @ part for part in self.sections.drag)
        weights = as_matrix(self.sections.weights)
        origin = base.rotation.T @ (self.system.frame(self.body).position - base.position)
        arms = base.rotation @ (self.sections.position - ca.repmat(origin, 1, force.shape[1]))
        on_body = -ca.vertcat(force @ weights, (moment + cross(arms, force)) @ weights)
        return [ca.vertcat(force, moment), on_body]

    def wrenches(self, rod: str) -> list[Wrench]:
        """The drag on a rod, base axes; nothing on other rods."""
        if rod != self.rod:
            return []
        base_R_world = self.system.base(rod).rotation.T
        force, moment = ca.vertsplit(self.frictions[0], 3)
        return [self.sections.dead(base_R_world @ force, base_R_world @ moment)]

    @property
    def on_body(self) -> Matrix:
        """Wrench [moment; force] on the body, 6×1, world axes."""
        return _moment_first(self.frictions[1])

    @property
    def dissipated_power(self) -> Matrix:
        """Power that the drag dissipates, 1×1, W: the power of its forces on the motion relative to the body."""
        force, moment = self.sections.drag
        assert self.load.motion is not None, "a drag is one of motion"
        velocity, spin = map(self.sections.at_sections, (self.load.motion.velocity, self.load.motion.angular_velocity))
        along = force * velocity + moment * spin
        return -ca.sum1(along) @ as_matrix(self.sections.weights)


@dataclass(frozen=True)
class BodyDrag(Drag):
    """The drag of a load on a body.

    Attributes:
        system: the scene in motion.
        name: names of the load and the body.
        body: the frame of the body.
        load: the load.
    """

    system: System
    name: str
    body: FrameName
    load: scenes.LoadRecord

    @cached_property
    def own(self) -> Matrix | None:
        """[Force; moment about the origin] on the body, 6×1, world axes; None for a load without drag."""
        body = self.system.discrete.bodies[self.body.name]
        pose = self.system.frame(self.body)
        loads = BodyLoads(self.system.discrete, body, pose.position, pose.rotation, self.system.arguments.inputs)
        return loads.drag(self.load, self.system.body_motions[self.body.name])

    @cached_property
    def frictions(self) -> Sequence[Matrix]:
        """The drag on the body, 6×1; for a body that rides also on its section, about the centre of the section."""
        if self.name in self.system.friction:
            return self.system.friction[self.name]
        assert self.own is not None, "a drag is there"
        riding = self.system.riding.get(self.body.name)
        if riding is None:
            return [self.own]
        force, moment = ca.vertsplit(self.own, 3)
        base = self.system.base(riding.rod)
        centre = base.position + base.rotation @ self.system.shapes[riding.rod].position_at(riding.node)
        arm = self.system.frame(self.body).position - centre
        return [self.own, ca.vertcat(force, moment + ca.cross(arm, force))]

    def wrenches(self, rod: str) -> list[Wrench]:
        """The drag on a rod, base axes: on the section that the body rides on; nothing on other rods."""
        riding = self.system.riding.get(self.body.name)
        if riding is None or riding.rod != rod:
            return []
        base_R_world = self.system.base(rod).rotation.T
        force, moment = (base_R_world @ part for part in ca.vertsplit(self.frictions[1], 3))
        return [WrenchAt(riding.joint.at, force, moment, follower=False)]

    @property
    def on_body(self) -> Matrix:
        """Wrench [moment; force] on the body, 6×1, world axes."""
        return _moment_first(self.frictions[0])

    @property
    def dissipated_power(self) -> Matrix:
        """Power that the drag dissipates, 1×1, W."""
        motion = self.system.body_motions[self.body.name]
        return -ca.dot(self.on_body, ca.vertcat(motion.angular_velocity, motion.velocity))


def _moment_first(wrench: Matrix) -> Matrix:
    """[moment; force] of [force; moment], 6×1."""
    return ca.vertcat(wrench[3:], wrench[:3])
