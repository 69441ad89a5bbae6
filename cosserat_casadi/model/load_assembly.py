"""Loads of a scene on its rods, and the refusal of loads that cannot act on the unloaded rods."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import partial

import casadi as ca
import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.errors import Problem, SceneError, refuse
from cosserat_casadi.loads.load import Site, UnloadedPoses
from cosserat_casadi.loads.load_trace import TracedLoad, stored, traced
from cosserat_casadi.maths.numbers import Numbers, among, any_symbolic, as_matrix, is_symbolic, is_zero, known
from cosserat_casadi.maths.pose import NumericPose, Pose, written_pose
from cosserat_casadi.maths.typing import FloatArray, Matrix
from cosserat_casadi.model.discrete_scene import DiscreteScene
from cosserat_casadi.model.inputs import input_values, scene_value
from cosserat_casadi.model.registry import EFFECTS
from cosserat_casadi.model.scene_rods import written_base_pose
from cosserat_casadi.rod.kinematics import shape
from cosserat_casadi.rod.rod_motion import RodMotion
from cosserat_casadi.rod.strain import Ratio, per_reference_length
from cosserat_casadi.rod.wrenches import LineWrench, PoseWrench, RodLoad, SeenMotion, WrenchAt


@dataclass(frozen=True)
class RodBase:
    """Pose of a rod's base in the world, or in the axes of a body.

    Attributes:
        position: 3×1, axes of the world or of the body, m.
        base_R_world: 3×3, turns coordinates of the world, or of the body, into coordinates of the base.
    """

    position: Matrix
    base_R_world: Matrix

    def in_base_axes(self, vector: Matrix | None, *, follower: bool) -> Matrix | None:
        """Coordinates for the mechanics: in base axes for a dead vector, in section axes for a follower."""
        if vector is None or follower:
            return vector
        return self.base_R_world @ vector

    def seen_from(self, body: Pose) -> RodBase:
        """The pose of the base in the axes of a body, from the pose of the body in the world."""
        world_R_body = body.rotation
        position = world_R_body.T @ (self.position - body.position)
        return RodBase(position, self.base_R_world @ world_R_body)


@dataclass(frozen=True)
class RodLoads:
    """The scene's loads on one rod, as the mechanics of the rod take them.

    Attributes:
        discrete: the scene.
        rod: name of the rod.
        base: pose of its base.
        inputs: stacked inputs.
        ratio: length of the rod relative to the scene's, if the length is free; else None.
        motion: motion of the rod; None at rest.
        body_pose: world pose of a body, by name; None if bodies have no poses: loads of obstacles on bodies are then
            left out.
    """

    discrete: DiscreteScene
    rod: str
    base: RodBase
    inputs: Matrix
    ratio: Ratio
    motion: RodMotion | None = None
    body_pose: Callable[[str], Pose] | None = None

    def all(self) -> list[RodLoad]:
        """All loads on the rod, in the axes of its base."""
        rod_loads: list[RodLoad] = []
        for load in self.discrete.loads:
            rod_loads += self.of(load)
        return rod_loads

    def of(self, load: scenes.LoadRecord) -> list[RodLoad]:
        """One load on the rod; empty if it does not act on this rod."""
        member = EFFECTS[load.kind]
        if not member.acts_on(load, self.rod):
            return []
        if member.seen_from(load) is not None and self.body_pose is None:
            return []
        values = self._values(load)
        site = self.site(load)
        data_size = member.data(load, site).shape[0]
        kernel = traced(member, load, values, data_size)
        motion = None if member.seen_from(load) is not None or kernel.moving is None else self.motion
        if not kernel.pose_free or motion is not None:
            return [self._pose_wrench(kernel, site, motion)]
        # A load that does not depend on poses is constant coefficients times profiles: no kernel for each node.
        given_force, given_moment = kernel.coefficients(values)
        force = self.base.in_base_axes(given_force, follower=kernel.follower)
        moment = self.base.in_base_axes(given_moment, follower=kernel.follower)
        at = member.abscissa(load)
        if at is not None:
            return [WrenchAt(at, force, moment, kernel.follower)]
        return [*self._line_wrenches(kernel, site, force, moment), *self._on_fixed_masses(kernel, force)]

    def seen_in_motion(self, load: scenes.LoadRecord, motion: SeenMotion) -> PoseWrench | None:
        """A load from a body in motion; None if it does not act on the rod, or does not depend on motion."""
        member = EFFECTS[load.kind]
        if not member.acts_on(load, self.rod):
            return None
        site = self.site(load)
        kernel = traced(member, load, self._values(load), member.data(load, site).shape[0])
        return None if kernel.moving_by_body is None else self._pose_wrench(kernel, site, motion)

    def base_of(self, load: scenes.LoadRecord) -> RodBase:
        """The base of the rod in the frame of a load: the world, or the body of its obstacle."""
        seen_from = EFFECTS[load.kind].seen_from(load)
        if seen_from is None:
            return self.base
        assert self.body_pose is not None, "what bodies bear is left out without their poses"
        return self.base.seen_from(self.body_pose(seen_from))

    def _values(self, load: scenes.LoadRecord) -> dict[str, Matrix]:
        """Inputs of a load that are common to all its sections."""
        values = input_values(self.discrete.layout, load, self.inputs)
        values.pop(EFFECTS[load.kind].nodal, None)
        return values

    def site(self, load: scenes.LoadRecord) -> Site:
        """Sections of the rod that a load acts on, with the inputs of the load that have a value for each section."""
        return replace(site_of(self.discrete, self.rod, load), nodal=self._nodal(load))

    def _nodal(self, load: scenes.LoadRecord) -> Matrix | None:
        """Input of a load with values at the M nodes, h×M; None for a load without such an input."""
        entries = self.discrete.layout.of_load(load.name or "", EFFECTS[load.kind].nodal)
        if entries is None:
            return None
        own, remembered = self.discrete.rods[self.rod].grid, self.discrete.remembered[self.rod]
        numbers = ca.reshape(self.inputs[entries], (entries.stop - entries.start) // remembered.size, remembered.size)
        if own is remembered:
            return numbers
        return numbers @ ca.DM(remembered.interpolation_matrix(known(own.nodes)).T)

    def _on_fixed_masses(self, kernel: TracedLoad, force: Matrix | None) -> Iterator[WrenchAt]:
        """A force per mass on the masses that are fixed to sections."""
        if force is None or not kernel.member.per_mass:
            return
        for fixed in self.discrete.rods[self.rod].properties.fixed_masses:
            yield WrenchAt(fixed.at, fixed.mass * force, None, kernel.follower)

    def _line_wrenches(
        self, kernel: TracedLoad, site: Site, force: Matrix | None, moment: Matrix | None
    ) -> Iterator[LineWrench]:
        """Line wrenches of a force and a moment per length, coefficients times profiles; none for zero ones."""
        grid = self.discrete.rods[self.rod].grid
        nodes = grid.nodes_in(*kernel.member.span(kernel.load))
        # Profiles of force and of moment may differ: a line wrench for each.
        for is_force, coefficients in ((True, force), (False, moment)):
            if coefficients is None:
                continue
            within = kernel.member.profiles(kernel.load, site.rod, site.X, coefficients.shape[1])
            # Profiles are zero outside the span.
            profiles = among(within, nodes, grid.size)
            if is_zero(profiles):
                continue
            scaled = per_reference_length(coefficients, self.ratio)
            of_force, of_moment = (scaled, None) if is_force else (None, scaled)
            yield LineWrench(of_force, of_moment, profiles, kernel.follower)

    def _pose_wrench(self, kernel: TracedLoad, site: Site, motion: RodMotion | SeenMotion | None) -> PoseWrench:
        """A load that depends on the pose or the motion of its sections: its kernel, evaluated at each section."""
        at = kernel.member.abscissa(kernel.load)
        values = self._values(kernel.load)
        section_kernel = kernel.kernel
        if motion is not None:
            assert kernel.moving is not None
            section_kernel = kernel.moving
        # A load per length scales with a free length of its rod; a load at a point does not.
        scale: Matrix | float = self.ratio if at is None and self.ratio is not None else 1.0
        base = self.base_of(kernel.load)
        return PoseWrench(
            at=at,
            span=kernel.member.span(kernel.load),
            kernel=section_kernel,
            base_position=base.position,
            base_rotation=base.base_R_world.T,
            parameters=stored(values),
            data=kernel.data(site),
            scale=scale,
            motion=motion,
            growth=partial(kernel.member.growth, kernel.load, site),
            borne_by=kernel.member.seen_from(kernel.load),
            sections=self.discrete.closer_sections.get(kernel.load.name),
        )


def site_of(discrete: DiscreteScene, rod: str, load: scenes.LoadRecord) -> Site:
    """Sections of a rod that a load acts on: one section, the nodes of its span, or closer sections."""
    discrete_rod = discrete.rods[rod]
    grid = discrete_rod.grid
    member = EFFECTS[load.kind]
    closer = discrete.closer_sections.get(load.name)
    at = member.abscissa(load)
    if closer is not None:
        X, interpolation = closer.placed.X, closer.placed.to_sections
    else:
        nodes = grid.nodes_in(*member.span(load)) if at is None else np.array([grid.node_at(at)])
        X, interpolation = grid.nodes_at(nodes), np.eye(grid.size)[nodes]
    # The poses are a function, since few loads need them and they take the poses of all carriers.
    poses = partial(unloaded_poses, discrete, rod, interpolation)
    return Site(discrete_rod.properties, X, poses)


def unloaded_poses(discrete: DiscreteScene, rod: str, interpolation: FloatArray) -> UnloadedPoses:
    """World poses of sections in the unloaded scene: expressions where a parameter moves the rod or its elements.

    Args:
        discrete: the scene.
        rod: name of the rod.
        interpolation: matrix from values at the M nodes to those at the k sections, shape (k, M).

    Raises:
        SceneError: parameters move the carrier of the rod.
    """
    discrete_rod = discrete.rods[rod]
    base = _unloaded_base(discrete, rod)
    unloaded = shape(discrete_rod, ca.MX.zeros(discrete_rod.size), discrete_rod.properties.ratio)
    nodal_position = _constant(unloaded.position)
    directors = [_constant(director) for director in unloaded.directors]
    to_sections = interpolation.T
    if isinstance(base, Pose) or any_symbolic([nodal_position, *directors]):
        origin = ca.repmat(as_matrix(base.position), 1, to_sections.shape[1])
        rotation = as_matrix(base.rotation)
        columns = [rotation @ as_matrix(director) @ ca.DM(to_sections) for director in directors]
        position = origin + rotation @ as_matrix(nodal_position) @ ca.DM(to_sections)
        # Directors of a straight rod stay numbers where a parameter moves its nodes.
        return ca.MX(position), ca.MX(ca.vertcat(*columns))
    known_position = base.position[:, None] + base.rotation @ known(nodal_position) @ to_sections
    # Column a of the rotation matrix is director a.
    return known_position, np.concatenate([base.rotation @ (known(director) @ to_sections) for director in directors])


def _unloaded_base(discrete: DiscreteScene, rod: str) -> NumericPose | Pose:
    """World pose of the base of an unloaded rod: an expression if parameters move it.

    Raises:
        SceneError: parameters move the carrier of the rod.
    """
    if discrete.carrier_moves(rod):
        problem = "holds to the place of the unloaded rod, whose carrier the parameters move"
        remedy = "name no length, base or intrinsic strain of the carriers of this rod"
        raise SceneError(Problem(f"a load on {rod!r}", problem, remedy))
    record = discrete.records[rod]
    written = written_pose(*written_base_pose(record))
    # The carrier of the rod has its pose by the scene's own numbers.
    unloaded = (discrete.nominal if discrete.parameters.size else discrete).own_unloaded
    if isinstance(written, NumericPose):
        return unloaded.base(rod)
    if record.base.rod is None:
        return written
    return unloaded.section(record.base.rod, record.base.at).pose.then(written)


def _constant(field: Matrix) -> Numbers:
    """Numbers of a constant expression; an expression of parameters is returned unchanged."""
    if is_symbolic(field) and ca.symvar(field):
        return field
    return ca.evalf(ca.densify(field)).full()


def nonlinear_inputs(discrete: DiscreteScene) -> list[int]:
    """Indices of the inputs in which equations may be nonlinear: declared so, or of loads that depend on poses."""
    layout = discrete.layout
    indices = layout.indices("nonlinear")
    # A load depends on poses or does not, whatever its numbers are.
    discrete = discrete.nominal
    for load in discrete.loads:
        free = [span for entry, span in layout if entry.owner == load.name and not entry.of_rod]
        if not free:
            continue
        # Ones, since an input that is zero in the scene may get another value.
        values = {field: ca.DM.ones(*scene_value(load, field).shape) for field in load.inputs}
        if all(kernel.pose_free for kernel in kernels_of(discrete, load, values)):
            continue
        for span in free:
            indices.extend(range(span.start, span.stop))
    return indices


def kernels_of(discrete: DiscreteScene, load: scenes.LoadRecord, values: Mapping[str, Matrix]) -> list[TracedLoad]:
    """The kernel of a load for each rod and body that it acts on."""
    member = EFFECTS[load.kind]
    data_sizes = []
    for rod in discrete.rods:
        if member.acts_on(load, rod):
            site = site_of(discrete, rod, load)
            data_sizes.append(member.data(load, site).shape[0])
    # Data differ from section to section: a body has none.
    data_sizes += [0 for body in discrete.scene.bodies if member.on_body(load, body) is not None]
    return [traced(member, load, values, size) for size in data_sizes]


LOOKED_AT = np.linspace(0.0, 1.0, 201)
"""Abscissae of the unloaded sections at which loads are checked."""


def check_loads(discrete: DiscreteScene) -> None:
    """Refuse a scene whose loads cannot act on its unloaded rods.

    Raises:
        SceneError: a load cannot act; it lists the faults of all loads.
    """
    problems: list[Problem] = []
    for load in discrete.loads:
        member = EFFECTS[load.kind]
        for rod, discrete_rod in discrete.rods.items():
            if member.acts_on(load, rod):
                site = Site(discrete_rod.properties, LOOKED_AT, partial(_unloaded_poses, discrete, rod))
                problems += member.faults(load, site)
    refuse(problems)


def _unloaded_poses(discrete: DiscreteScene, rod: str) -> UnloadedPoses:
    to_sections = discrete.rods[rod].grid.interpolation_matrix(LOOKED_AT)
    return unloaded_poses(discrete, rod, to_sections)
