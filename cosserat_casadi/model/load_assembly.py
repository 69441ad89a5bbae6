"""What the loads of a scene do to its rods and bodies, and whether they have a potential."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import partial

import casadi as ca
import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.errors import Problem, SceneError
from cosserat_casadi.loads.expressions import expressions_in
from cosserat_casadi.loads.load import BodyPoint, Site, UnloadedPoses, constant
from cosserat_casadi.loads.trace import TracedLoad, has_potential, stored, traced
from cosserat_casadi.maths.numbers import (
    Numbers,
    Scalar,
    among,
    any_symbolic,
    as_matrix,
    as_vector,
    is_symbolic,
    is_zero,
    known,
)
from cosserat_casadi.maths.rotation import hat
from cosserat_casadi.maths.typing import FloatArray, Matrix
from cosserat_casadi.model.discrete_scene import DiscreteScene
from cosserat_casadi.model.homotopy import LoadFactor
from cosserat_casadi.model.inputs import InputLayout, load_values, scene_value
from cosserat_casadi.model.registry import EFFECTS
from cosserat_casadi.rod.kinematics import shape
from cosserat_casadi.rod.motion import RodMotion
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
        if vector is None or follower:
            return vector
        return self.base_R_world @ vector


@dataclass(frozen=True)
class RodLoads:
    """The scene's loads on one rod, as the mechanics of the rod take them.

    Attributes:
        discrete: the scene.
        rod: name of the rod.
        base: pose of its base.
        inputs: stacked inputs.
        ratio: length of the rod relative to the scene's, where that is free.
        motion: of the rod; None at rest.
    """

    discrete: DiscreteScene
    rod: str
    base: RodBase
    inputs: Matrix
    ratio: Ratio
    motion: RodMotion | None = None

    def all(self) -> list[RodLoad]:
        """What all loads do to the rod, in the axes of its base."""
        rod_loads: list[RodLoad] = []
        for load in self.discrete.loads:
            rod_loads += self.of(load)
        return rod_loads

    def of(self, load: scenes.LoadRecord) -> list[RodLoad]:
        """What one load does to the rod: nothing where it does not act there."""
        member = EFFECTS[load.kind]
        if not member.acts_on(load, self.rod):
            return []
        values = input_values(self.discrete.layout, load, self.inputs)
        site = _site(self.discrete, self.rod, load)
        data_size = member.data(load, site).shape[0]
        kernel = traced(member, load, values, data_size)
        if not kernel.pose_free or self._feels_motion(kernel):
            return [self._pose_wrench(kernel, site)]
        # Free of the pose, the load is constant coefficients times profiles: it costs a rotation, not a kernel a node.
        given_force, given_moment = kernel.coefficients(values)
        force = self.base.in_base_axes(given_force, follower=kernel.follower)
        moment = self.base.in_base_axes(given_moment, follower=kernel.follower)
        at = member.abscissa(load)
        if at is not None:
            return [PointWrench(at, force, moment, kernel.follower)]
        # Profiles of force and of moment may differ: a line wrench for each.
        force_line = self._line_wrench(kernel, site, force, None)
        moment_line = self._line_wrench(kernel, site, None, moment)
        return [line for line in (force_line, moment_line) if line is not None]

    def _line_wrench(
        self, kernel: TracedLoad, site: Site, force: Matrix | None, moment: Matrix | None
    ) -> LineWrench | None:
        """Coefficients of a force or of a moment per length, times their profiles; None where there is nothing."""
        coefficients = force
        if coefficients is None:
            coefficients = moment
        if coefficients is None:
            return None
        grid = self.discrete.rods[self.rod].grid
        # Zero outside the span.
        nodes = grid.nodes_in(*kernel.member.span(kernel.load))
        within = kernel.member.profiles(kernel.load, site.rod, site.X, coefficients.shape[1])
        profiles = among(within, nodes, grid.size)
        if is_zero(profiles):
            return None
        scaled = per_reference_length(coefficients, self.ratio)
        if force is None:
            return LineWrench(None, scaled, profiles, kernel.follower)
        return LineWrench(scaled, None, profiles, kernel.follower)

    def _pose_wrench(self, kernel: TracedLoad, site: Site) -> PoseWrench:
        """A load that depends on the pose of its sections: its kernel, evaluated at each of them."""
        at = kernel.member.abscissa(kernel.load)
        values = input_values(self.discrete.layout, kernel.load, self.inputs)
        section_kernel = kernel.kernel
        motion = None
        if self._feels_motion(kernel):
            assert kernel.moving is not None
            section_kernel = kernel.moving
            motion = self.motion
        # A load per length of a rod whose length is free acts on that length; a load at a point does not.
        scale: Matrix | float = 1.0
        if at is None and self.ratio is not None:
            scale = self.ratio
        return PoseWrench(
            at=at,
            span=kernel.member.span(kernel.load),
            kernel=section_kernel,
            base_position=self.base.position,
            base_rotation=self.base.base_R_world.T,
            parameters=stored(values),
            data=kernel.data(site),
            scale=scale,
            motion=motion,
            growth=kernel.member.growth,
        )

    def _feels_motion(self, kernel: TracedLoad) -> bool:
        """Whether the rod moves and the load depends on how."""
        return self.motion is not None and kernel.moving is not None


def _site(discrete: DiscreteScene, rod: str, load: scenes.LoadRecord) -> Site:
    """Sections of a rod that a load acts on: one, or those of the nodes of its span."""
    discrete_rod = discrete.rods[rod]
    grid = discrete_rod.grid
    member = EFFECTS[load.kind]
    at = member.abscissa(load)
    if at is None:
        nodes = grid.nodes_in(*member.span(load))
    else:
        nodes = np.array([grid.node_at(at)])
    at_nodes = np.eye(grid.size)[nodes]
    # A function: few loads ask for the unloaded poses, which take a walk along all carriers.
    poses = partial(unloaded_poses, discrete, rod, at_nodes)
    return Site(discrete_rod.properties, grid.nodes_at(nodes), poses)


def unloaded_poses(discrete: DiscreteScene, rod: str, interpolation: FloatArray) -> UnloadedPoses:
    """World poses of sections in the unloaded scene: expressions where a parameter moves elements of the rod.

    Args:
        discrete: the scene.
        rod: name of the rod.
        interpolation: matrix from values at the M nodes to those at the k sections, shape (k, M).

    Raises:
        SceneError: parameters move the unloaded rod.
    """
    if discrete.moves_unloaded(rod):
        problem = "is bound to where the unloaded rod was, which parameters move"
        raise SceneError(Problem(f"a load on {rod!r}", problem, "name no length, base or intrinsic strain of this rod"))
    discrete_rod = discrete.rods[rod]
    # Where no parameter moves the unloaded rod, its base is where the scene's own numbers put it.
    own = discrete.nominal if discrete.parameters.size else discrete
    base = own.own_unloaded.base(rod)
    unloaded = shape(discrete_rod, ca.MX.zeros(discrete_rod.size), discrete_rod.properties.ratio)
    nodal_position = _constant(unloaded.position)
    directors = [_constant(director) for director in unloaded.directors]
    to_sections = interpolation.T
    if any_symbolic([nodal_position, *directors]):
        origin = ca.repmat(ca.DM(base.position), 1, to_sections.shape[1])
        columns = [ca.DM(base.rotation) @ as_matrix(director) @ ca.DM(to_sections) for director in directors]
        return origin + ca.DM(base.rotation) @ as_matrix(nodal_position) @ ca.DM(to_sections), ca.vertcat(*columns)
    position = base.position[:, None] + base.rotation @ known(nodal_position) @ to_sections
    # Column a of the rotation matrix is director a.
    return position, np.concatenate([base.rotation @ (known(director) @ to_sections) for director in directors])


def _constant(field: Matrix) -> Numbers:
    """Values of a constant expression; an expression of parameters as it is."""
    if is_symbolic(field) and ca.symvar(field):
        return field
    values: FloatArray = ca.evalf(ca.densify(field)).full()
    return values


def nonlinear_inputs(discrete: DiscreteScene) -> list[int]:
    """Indices of the inputs that equations need not be linear in: of loads that depend on poses, and declared so."""
    layout = discrete.layout
    indices: list[int] = []
    for entry, span in layout:
        if entry.declared.nonlinear:
            indices.extend(range(span.start, span.stop))
    # What depends on a pose does so whatever its numbers are.
    discrete = discrete.nominal
    for load in discrete.loads:
        free = [span for entry, span in layout if entry.owner == load.name and not entry.of_rod]
        if not free:
            continue
        # Ones, since an input that is zero in the scene may be given another value.
        values = {field: ca.DM.ones(*scene_value(load, field).shape) for field in load.inputs}
        if all(kernel.pose_free for kernel in _kernels(discrete, load, values)):
            continue
        for span in free:
            indices.extend(range(span.start, span.stop))
    return indices


def _kernels(discrete: DiscreteScene, load: scenes.LoadRecord, values: Mapping[str, Matrix]) -> list[TracedLoad]:
    """The kernel of a load for each rod and body that it acts on."""
    member = EFFECTS[load.kind]
    data_sizes = []
    for rod in discrete.rods:
        if member.acts_on(load, rod):
            site = _site(discrete, rod, load)
            data_sizes.append(member.data(load, site).shape[0])
    # A body has no data that differ from section to section.
    data_sizes += [0 for body in discrete.scene.bodies if member.on_body(load, body) is not None]
    return [traced(member, load, values, size) for size in data_sizes]


def input_values(layout: InputLayout, record: scenes.LoadRecord | scenes.Actuator, inputs: Matrix) -> dict[str, Matrix]:
    """Inputs of a load or an actuator, and its numbers that are expressions of parameters.

    What is zero for good is a matrix that stores nothing.
    """
    values = expressions_in(record)
    for field in record.inputs:
        value = input_value(layout, record, field, inputs)
        if value is None:
            value = ca.DM(*scene_value(record, field).shape)
        values[field] = value
    return values


def input_value(
    layout: InputLayout, record: scenes.LoadRecord | scenes.Actuator, field: str, inputs: Matrix
) -> Matrix | None:
    """One input of a load or an actuator; None where it is zero for good."""
    entries = layout.of_load(record.name, field)
    default = scene_value(record, field)
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
        energy: 1×1, J; None for a load that is not given by one.
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
        stiffness = self.stiffness
        if stiffness is not None:
            stiffness = load_factor * stiffness
        force = load_factor * self.force
        moment = load_factor * self.moment
        return replace(self, force=force, moment=moment, stiffness=stiffness)

    @property
    def wrench(self) -> Matrix:
        """Wrench [moment about the origin; force] on the body, 6×1."""
        moment = ca.cross(self.arm, self.force) + self.moment
        return ca.vertcat(moment, self.force)

    @property
    def variation(self) -> Matrix:
        """Derivative of the wrench with the motion [δθ; δr] of the body, world axes, 6×6."""
        # A shift δr moves the origin, which the moment is about, and the point alike.
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
        """What all loads do to the body."""
        body_loads = []
        for load in self.discrete.loads:
            body_load = self.of(load)
            if body_load is not None:
                body_loads.append(body_load)
        return body_loads

    def of(self, load: scenes.LoadRecord) -> BodyLoad | None:
        """What one load does to the body; None where it does not act there, or is zero for good."""
        point = EFFECTS[load.kind].on_body(load, self.body)
        if point is None:
            return None
        values = input_values(self.discrete.layout, load, self.inputs)
        kernel = traced(EFFECTS[load.kind], load, values)
        if kernel.moving is not None:
            raise ValueError(f"{load.name!r} depends on rates, and loads on bodies do not know them")
        if not kernel.pose_free:
            return self._pose_dependent(kernel, point)
        given_force, given_moment = kernel.coefficients(values)
        if given_force is None and given_moment is None:
            return None
        force: Matrix = ca.DM.zeros(3, 1)
        moment: Matrix = ca.DM.zeros(3, 1)
        if given_force is not None:
            force = point.factor * given_force
        if given_moment is not None:
            moment = point.factor * given_moment
        if kernel.follower:
            force = self.rotation @ force
            moment = self.rotation @ moment
        aligns = given_force is not None and not kernel.follower
        return BodyLoad(point.position, self._arm(point), force, moment, kernel.follower, aligns)

    def _pose_dependent(self, kernel: TracedLoad, point: BodyPoint) -> BodyLoad:
        """A load that depends on the pose of the point: its kernel, evaluated there."""
        section_kernel = kernel.kernel
        arm = self._arm(point)
        parameters = stored(input_values(self.discrete.layout, kernel.load, self.inputs))
        # Profiles are those of a load per length: at a point they are one.
        profiles = ca.DM.ones(sum(kernel.columns), 1)
        # A body is seen from the world: its base is the origin.
        base = [ca.DM.zeros(3, 1), ca.DM.eye(3)]
        arguments = [self.position + arm, self.rotation, *base, parameters, profiles]
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


# Potential


def loads_have_potential(discrete: DiscreteScene, inputs: FloatArray) -> bool:
    """Whether all loads of a scene have a potential at these inputs."""
    values = load_values(discrete.scene, discrete.layout, inputs)
    for load in discrete.loads:
        numbers = values.get(load.name, {})
        if not _has_potential_on_bodies(discrete, load, numbers):
            return False
        if not all(_has_potential_on_rod(discrete, rod, load, numbers) for rod in discrete.rods):
            return False
    return True


def _has_potential_on_bodies(
    discrete: DiscreteScene, load: scenes.LoadRecord, values: Mapping[str, FloatArray]
) -> bool:
    """Whether a load has a potential on the bodies that it acts on; it has on none."""
    member = EFFECTS[load.kind]
    if all(member.on_body(load, body) is None for body in discrete.scene.bodies):
        return True
    return has_potential(member, load, values, 0, one_axis=discrete.unloaded.all_in_parallel_planes)


def _has_potential_on_rod(
    discrete: DiscreteScene, rod: str, load: scenes.LoadRecord, values: Mapping[str, FloatArray]
) -> bool:
    """Whether a load has a potential on a rod, be it that it does not act there."""
    if not EFFECTS[load.kind].acts_on(load, rod):
        return True
    member = EFFECTS[load.kind]
    data_size = member.data(load, _site(discrete, rod, load)).shape[0]
    return has_potential(member, load, values, data_size, one_axis=_turns_about_one_axis(discrete, rod))


def _turns_about_one_axis(discrete: DiscreteScene, rod: str) -> bool:
    """Whether all sections of a rod turn about one axis of the world; one that is carried about may not."""
    if discrete.unloaded.floating_base(rod) is not None and discrete.unloaded.plane(rod) is None:
        return False
    return len(discrete.rods[rod].properties.turning_axes) < 2


def is_dead_force(discrete: DiscreteScene, load: scenes.LoadRecord) -> bool:
    """Whether a load is a force of fixed direction and no moment, whatever its inputs: it has the energy −Σ f·r."""
    # Ones, since what the inputs may change need not stay zero; a moment that they may not change stores nothing.
    values = input_values(discrete.layout, load, ca.DM.ones(discrete.layout.size, 1))
    return all(_is_dead_force(kernel, values) for kernel in _kernels(discrete, load, values))


def _is_dead_force(kernel: TracedLoad, values: Mapping[str, Matrix]) -> bool:
    # What depends on rates may be nothing at rest, and do work in motion.
    if kernel.follower or not kernel.pose_free or kernel.moving is not None:
        return False
    _, moment = kernel.coefficients(values)
    return moment is None
