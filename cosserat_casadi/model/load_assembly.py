"""What the loads of a scene do to its rods and bodies, and whether they have a potential."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import casadi as ca
import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.loads.load import BodyPoint, Poses, Site, constant
from cosserat_casadi.loads.trace import TracedLoad, has_potential, stored, traced
from cosserat_casadi.maths.rotation import hat
from cosserat_casadi.maths.typing import FloatArray, Matrix
from cosserat_casadi.model.discrete_scene import DiscreteScene
from cosserat_casadi.model.homotopy import LoadFactor
from cosserat_casadi.model.inputs import InputLayout, load_values, scene_value
from cosserat_casadi.model.registry import EFFECTS
from cosserat_casadi.rod.actuation import Actuation
from cosserat_casadi.rod.kinematics import shape
from cosserat_casadi.rod.strain import Ratio, per_reference_length
from cosserat_casadi.rod.wrenches import LineWrench, PointWrench, PoseWrench, RodLoad


@dataclass(frozen=True)
class RodBase:
    """Pose of a rod's base.

    Attributes:
        position: 3×1, world axes, m.
        base_R_world: 3×3, turns world coordinates into those of the base.
    """

    position: Matrix
    base_R_world: Matrix

    def in_base_axes(self, vector: Matrix | None, *, follower: bool) -> Matrix | None:
        """Coordinates that the mechanics want: of the base for a dead vector, of the section for a follower."""
        return vector if vector is None or follower else self.base_R_world @ vector


@dataclass(frozen=True)
class RodLoads:
    """The scene's loads on one rod, as the mechanics of the rod take them.

    Attributes:
        discrete: the scene.
        rod: name of the rod.
        base: pose of its base.
        inputs: stacked inputs.
        ratio: length of the rod relative to the scene's, where that is free.
    """

    discrete: DiscreteScene
    rod: str
    base: RodBase
    inputs: Matrix
    ratio: Ratio

    def all(self) -> list[RodLoad]:
        """What all loads do to the rod, in the axes of its base."""
        found: list[RodLoad] = []
        for load in self.discrete.scene.loads:
            if EFFECTS[load.kind].acts_on(load, self.rod):
                found += self._of(load)
        return found

    def _of(self, load: scenes.Load) -> list[RodLoad]:
        member = EFFECTS[load.kind]
        values = input_values(self.discrete.layout, load, self.inputs)
        site = _site(self.discrete, self.rod, load)
        kernel = traced(member, load, values, len(member.data(load, site)))
        if not kernel.pose_free:
            return [self._pose_wrench(kernel, site)]
        force, moment = (self.base.in_base_axes(v, follower=kernel.follower) for v in kernel.coefficients(values))
        at = member.abscissa(load)
        if at is not None:
            return [PointWrench(at, force, moment, kernel.follower)]
        # Profiles of force and of moment may differ: a line wrench for each.
        lines = [self._line_wrench(kernel, site, force, None), self._line_wrench(kernel, site, None, moment)]
        return [line for line in lines if line is not None]

    def _line_wrench(
        self, kernel: TracedLoad, site: Site, force: Matrix | None, moment: Matrix | None
    ) -> LineWrench | None:
        """Coefficients of a force or of a moment per length, times their profiles; None where there is nothing."""
        coefficients = moment if force is None else force
        if coefficients is None:
            return None
        profiles = kernel.member.profiles(kernel.load, site.rod, site.X, coefficients.shape[1])
        if not np.any(profiles):
            return None
        scaled = per_reference_length(coefficients, self.ratio)
        if force is None:
            return LineWrench(None, scaled, profiles, kernel.follower)
        return LineWrench(scaled, None, profiles, kernel.follower)

    def _pose_wrench(self, kernel: TracedLoad, site: Site) -> PoseWrench:
        at = kernel.member.abscissa(kernel.load)
        return PoseWrench(
            at=at,
            kernel=kernel.kernel,
            base_position=self.base.position,
            base_rotation=self.base.base_R_world.T,
            parameters=stored(input_values(self.discrete.layout, kernel.load, self.inputs)),
            data=kernel.data(site),
            scale=1.0 if at is not None or self.ratio is None else self.ratio,
        )


def _site(discrete: DiscreteScene, rod: str, load: scenes.Load) -> Site:
    """Sections of a rod that a load acts on: one, or those of all nodes."""
    discrete_rod, at = discrete.rods[rod], EFFECTS[load.kind].abscissa(load)
    grid = discrete_rod.grid
    nodes = np.arange(grid.size) if at is None else np.array([grid.node_at(at)])
    at_nodes = np.eye(grid.size)[nodes]
    return Site(discrete_rod.properties, grid.nodes[nodes], lambda: unloaded_poses(discrete, rod, at_nodes))


def unloaded_poses(discrete: DiscreteScene, rod: str, interpolation: FloatArray) -> Poses:
    """World poses of sections in the unloaded scene, at the lengths and bases that the scene gives.

    Args:
        discrete: the scene.
        rod: name of the rod.
        interpolation: matrix from values at the M nodes to those at the k sections, shape (k, M).
    """
    discrete_rod, base = discrete.rods[rod], discrete.unloaded.base(rod)
    unloaded = shape(discrete_rod, ca.MX.zeros(discrete_rod.size))
    position, *directors = (ca.evalf(ca.densify(field)).full() for field in (unloaded.position, *unloaded.directors))
    # Column a of the rotation matrix is director a.
    rotations = np.stack([director @ interpolation.T for director in directors], axis=-1).transpose(1, 0, 2)
    return base.position[:, None] + base.rotation @ position @ interpolation.T, base.rotation @ rotations


def nonlinear_inputs(discrete: DiscreteScene) -> list[int]:
    """Indices of the inputs of loads that depend on poses: the equations need not be linear in them."""
    layout = discrete.layout
    found: list[int] = []
    for load in discrete.scene.loads:
        free = [own for entry, own in layout if entry.owner == load.name and not entry.of_rod]
        values = {field: ca.DM.ones(*scene_value(load, field).shape) for field in load.inputs}
        if free and not all(kernel.pose_free for kernel in _kernels(discrete, load, values)):
            for own in free:
                found += range(layout.size)[own]
    return found


def _kernels(discrete: DiscreteScene, load: scenes.Load, values: Mapping[str, Matrix]) -> list[TracedLoad]:
    """The kernel of a load for each rod and body that it acts on."""
    member = EFFECTS[load.kind]
    sizes = [len(member.data(load, _site(discrete, rod, load))) for rod in discrete.rods if member.acts_on(load, rod)]
    sizes += [0 for body in discrete.scene.bodies if member.on_body(load, body) is not None]
    return [traced(member, load, values, size) for size in sizes]


def input_values(layout: InputLayout, cause: scenes.Load | scenes.Actuator, inputs: Matrix) -> dict[str, Matrix]:
    """Inputs of a load or an actuator; zero for good is a matrix that stores nothing."""
    values = {}
    for field in cause.inputs:
        value = input_value(layout, cause, field, inputs)
        values[field] = ca.DM(*scene_value(cause, field).shape) if value is None else value
    return values


def input_value(layout: InputLayout, cause: scenes.Load | scenes.Actuator, field: str, inputs: Matrix) -> Matrix | None:
    """One input of a load or an actuator; None where it is zero for good."""
    entries = layout.of_load(cause.name, field)
    default = scene_value(cause, field)
    if entries is None:
        return constant(default)
    return ca.reshape(inputs[entries], *default.shape)


# Bodies


@dataclass(frozen=True)
class BodyLoad:
    """A load on a rigid body in its pose, world axes.

    Attributes:
        position: the loaded point in the axes of the body, m.
        arm: that point from the origin of the body, 3×1, m.
        force: 3×1, N.
        moment: 3×1, N m.
        follower: whether force and moment turn with the body.
        aligns: whether it can hold the orientation of the body: a force that keeps its direction, or a load that
            depends on the pose.
        stiffness: 6×6 derivative of [force; moment] with the [δr; δθ] of the point; None for a dead load or a follower.
    """

    position: tuple[float, float, float]
    arm: Matrix
    force: Matrix
    moment: Matrix
    follower: bool
    aligns: bool
    stiffness: Matrix | None = None

    def scaled(self, load_factor: LoadFactor) -> BodyLoad:
        """The load at a load factor."""
        if load_factor is None:
            return self
        stiffness = None if self.stiffness is None else load_factor * self.stiffness
        force = load_factor * self.force
        moment = load_factor * self.moment
        return replace(self, force=force, moment=moment, stiffness=stiffness)

    @property
    def wrench(self) -> Matrix:
        """Wrench [moment about the origin; force] on the body, 6×1."""
        return ca.vertcat(ca.cross(self.arm, self.force) + self.moment, self.force)

    @property
    def variation(self) -> Matrix:
        """Derivative of the wrench with the motion [δθ; δr] of the body, world axes, 6×6."""
        if self.follower:
            by_turn = ca.vertcat(-hat(ca.cross(self.arm, self.force) + self.moment), -hat(self.force))
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
        return ca.vertcat(hat(self.arm) @ force + moment, force)


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
        """What all loads do to the body."""
        found = []
        for load in self.discrete.scene.loads:
            point = EFFECTS[load.kind].on_body(load, self.body)
            if point is not None:
                found.append(self._of(load, point))
        return [load for load in found if load is not None]

    def _of(self, load: scenes.Load, point: BodyPoint) -> BodyLoad | None:
        values = input_values(self.discrete.layout, load, self.inputs)
        kernel = traced(EFFECTS[load.kind], load, values)
        if not kernel.pose_free:
            return self._pose_dependent(kernel, point)
        given_force, given_moment = kernel.coefficients(values)
        if given_force is None and given_moment is None:
            return None
        force = ca.DM.zeros(3, 1) if given_force is None else point.factor * given_force
        moment = ca.DM.zeros(3, 1) if given_moment is None else point.factor * given_moment
        if kernel.follower:
            force, moment = self.rotation @ force, self.rotation @ moment
        aligns = given_force is not None and not kernel.follower
        return BodyLoad(point.position, self._arm(point), force, moment, kernel.follower, aligns)

    def _pose_dependent(self, kernel: TracedLoad, point: BodyPoint) -> BodyLoad:
        arm = self._arm(point)
        parameters = stored(input_values(self.discrete.layout, kernel.load, self.inputs))
        profiles = ca.DM.ones(sum(kernel.columns), 1)
        # A body is seen from the world: its base is the origin.
        base = [ca.DM.zeros(3, 1), ca.DM.eye(3)]
        given = [self.position + arm, self.rotation, *base, parameters, profiles]
        force, moment = (point.factor * part for part in kernel.kernel.wrench.call(given))
        stiffness = point.factor * kernel.kernel.stiffness.call(given)[0]
        return BodyLoad(point.position, arm, force, moment, follower=False, aligns=True, stiffness=stiffness)

    def _arm(self, point: BodyPoint) -> Matrix:
        return self.rotation @ ca.DM(point.position)


# Potential


def loads_have_potential(discrete: DiscreteScene, inputs: FloatArray) -> bool:
    """Whether all loads of a scene have a potential at these inputs."""
    values = load_values(discrete.scene, discrete.layout, inputs)
    for load in discrete.scene.loads:
        member = EFFECTS[load.kind]
        on_bodies = any(member.on_body(load, body) is not None for body in discrete.scene.bodies)
        if on_bodies and not has_potential(
            member, load, values[load.name], 0, one_axis=discrete.unloaded.all_in_parallel_planes
        ):
            return False
        for rod in discrete.rods:
            if member.acts_on(load, rod) and not _has_potential_on(discrete, rod, load, values[load.name]):
                return False
    return True


def _has_potential_on(discrete: DiscreteScene, rod: str, load: scenes.Load, values: Mapping[str, FloatArray]) -> bool:
    member = EFFECTS[load.kind]
    data_size = len(member.data(load, _site(discrete, rod, load)))
    return has_potential(member, load, values, data_size, one_axis=_turns_about_one_axis(discrete, rod))


def _turns_about_one_axis(discrete: DiscreteScene, rod: str) -> bool:
    """Whether all sections of a rod turn about one axis of the world; one that is carried about may not."""
    if discrete.unloaded.floating_base(rod) is not None and discrete.unloaded.plane(rod) is None:
        return False
    return len(discrete.rods[rod].properties.turning_axes) < 2


# Actuators


def rod_actuation(discrete: DiscreteScene, rod: str, inputs: Matrix) -> list[Actuation]:
    """Efforts on one rod that the scene or its inputs give."""
    found = []
    for actuator in discrete.scene.actuators:
        member = EFFECTS[actuator.kind]
        if not member.acts_on(actuator, rod) or member.prescribes_conjugate(actuator):
            continue
        effort = input_value(discrete.layout, actuator, member.effort, inputs)
        if effort is not None:
            quantity = member.quantity(actuator, discrete.rods[rod].grid)
            found.append(Actuation(quantity, member.energy_sign * effort))
    return found
