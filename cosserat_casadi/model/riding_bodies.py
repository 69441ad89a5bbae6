"""Bodies that ride on a section of a rod: one rigid joint carries them, so that their poses are no unknowns.

Loads on such a body, and its inertia, are moved to the section with their arms. All of them are loads on the rod, whose
equations and derivatives take them like any other (rod/pose_load.py, rod/motion_load.py). See docs/theory.md, sections
8 and 11.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import casadi as ca
import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.loads.load import BodyPoint
from cosserat_casadi.loads.load_trace import TracedLoad, stored, traced
from cosserat_casadi.maths.numbers import Numbers, Scalar, as_matrix, as_vector, is_symbolic, is_zero, sparse_known
from cosserat_casadi.maths.pose import IDENTITY, NumericPose, Pose, written_pose
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.model.discrete_scene import DiscreteScene
from cosserat_casadi.model.frame_motion import BodyInertia, body_inertia
from cosserat_casadi.model.inputs import input_values
from cosserat_casadi.model.load_assembly import RodBase
from cosserat_casadi.model.registry import EFFECTS
from cosserat_casadi.model.scene_rods import unit_quaternion
from cosserat_casadi.rod.rod_motion import FrameMotion, RodMotion
from cosserat_casadi.rod.section_kernel import ARGUMENTS, RATES, SectionKernel
from cosserat_casadi.rod.wrenches import PoseWrench, RodLoad, WrenchAt

WORLD_ARGUMENTS = [ARGUMENTS[0], ARGUMENTS[1], *ARGUMENTS[4:]]
"""Arguments of a wrench in world axes."""


@dataclass(frozen=True)
class RidingBody:
    """A body that rides on a section.

    Attributes:
        discrete: the scene.
        body: the body.
    """

    discrete: DiscreteScene
    body: scenes.Body

    @cached_property
    def joint(self) -> scenes.Joint:
        """The joint that carries it."""
        return self.discrete.scene.joints[self.discrete.unloaded.riding[self.body.name]]

    @property
    def rod(self) -> str:
        """Name of the rod that it rides on."""
        return self.joint.rod

    @property
    def node(self) -> int:
        """Node of its section."""
        return self.discrete.rods[self.rod].grid.node_at(self.joint.at)

    @cached_property
    def in_section(self) -> Pose:
        """Pose of the body in the axes of the section."""
        orientation = unit_quaternion(self.joint.orientation or IDENTITY.quaternion.tolist())
        held = written_pose(as_vector(self.joint.position), orientation)
        return (held.pose if isinstance(held, NumericPose) else held).inverse

    @cached_property
    def _rotation(self) -> Matrix:
        """Rotation section_R_body, 3×3; zeros of a constant rotation are not stored."""
        return sparse_known(self.in_section.rotation)

    def _arm(self, point: Sequence[Scalar]) -> Matrix:
        """Vector from the centre of the section to a point of the body, section axes, 3×1, m."""
        return sparse_known(self.in_section.position + self._rotation @ as_matrix(as_vector(point)))

    def loads(self, base: RodBase, inputs: Matrix) -> Iterator[RodLoad]:
        """The loads on the body as loads on its section.

        Args:
            base: base of the rod.
            inputs: stacked inputs.
        """
        for load in self.discrete.loads:
            member = EFFECTS[load.kind]
            point = member.on_body(load, self.body)
            if point is None:
                continue
            values = input_values(self.discrete.layout, load, inputs)
            kernel = traced(member, load, values)
            if kernel.pose_free:
                yield from self._free_of_pose(kernel, point, base, values)
            else:
                yield self._pose_wrench(kernel, point, base, values)

    def _free_of_pose(
        self, kernel: TracedLoad, point: BodyPoint, base: RodBase, values: Mapping[str, Matrix]
    ) -> Iterator[RodLoad]:
        """A load of fixed direction, or a follower of the body, on the section; nothing if it is always zero."""
        force, moment = kernel.coefficients(values)
        if force is None and moment is None:
            return
        arm = self._arm(point.position)
        if not kernel.follower and force is not None and not is_zero(arm):
            # The moment of its arm changes as the section turns.
            yield self._pose_wrench(kernel, point, base, values)
            return
        if kernel.follower:
            force = None if force is None else self._rotation @ force
            moment = None if moment is None else self._rotation @ moment
            if force is not None and not is_zero(arm):
                lever = ca.cross(arm, force)
                moment = lever if moment is None else moment + lever
        parts = [None if part is None else point.factor * part for part in (force, moment)]
        force, moment = (base.in_base_axes(part, follower=kernel.follower) for part in parts)
        yield WrenchAt(self.joint.at, force, moment, kernel.follower)

    def _pose_wrench(
        self, kernel: TracedLoad, point: BodyPoint, base: RodBase, values: Mapping[str, Matrix]
    ) -> PoseWrench:
        """A load with a wrench on the section that depends on the section's pose, if only by its arm."""
        of_point = kernel.kernel
        parameters, data = (of_point.world_wrench.size1_in(number) for number in (2, 3))
        given = _Given()
        arm, rotation = given(self._arm(point.position)), given(self._rotation)

        def at_point(section: _Section) -> list[ca.SX]:
            position = section.position + section.rotation @ arm
            return [position, section.rotation @ rotation, section.parameters[:parameters], section.data]

        def wrench(section: _Section) -> Sequence[Matrix]:
            force, moment = of_point.world_wrench.call(at_point(section))
            return force, moment + ca.cross(section.rotation @ arm, force)

        def energy(section: _Section) -> Matrix:
            pose = at_point(section)
            if of_point.world_energy is not None:
                (value,) = of_point.world_energy.call(pose)
            else:
                force, _ = of_point.world_wrench.call(pose)
                value = -ca.dot(force, pose[0])
            return ca.SX(value)

        # A dead force has an energy, whatever moment its arm makes.
        is_dead_force = kernel.pose_free and not kernel.follower and not of_point.world_wrench.nnz_out(1)
        has_energy = is_dead_force or of_point.world_energy is not None
        on_section = _kernel(given, (parameters, data), wrench, energy if has_energy else None)
        stacked = ca.vertcat(stored(values), *given.values)
        # Profiles belong to loads per length: for a load at a point they are one.
        load = self._on_section(on_section, base, stacked, np.ones((data, 1)))
        scale = as_matrix(as_vector([point.factor])) if is_symbolic(point.factor) else point.factor
        return replace(load, scale=scale)

    def inertia(self, base: RodBase, motion: RodMotion) -> PoseWrench | None:
        """Inertia of the body in motion as a load on its section; None for a body without inertia."""
        inertia = body_inertia(self.body)
        if is_zero(self.body.mass) and is_zero(inertia):
            return None
        given = _Given()
        origin, rotation = given(sparse_known(self.in_section.position)), given(self._rotation)
        mass, centre, moments = (given(part) for part in (self.body.mass, as_vector(self.body.centre_of_mass), inertia))

        def wrench(section: _Section) -> Sequence[Matrix]:
            arm = section.rotation @ origin
            moved = FrameMotion(*section.rates).at(arm)
            of_body = BodyInertia(mass, centre, moments, section.rotation @ rotation, moved)
            return of_body.force, of_body.moment + ca.cross(arm + of_body.arm, of_body.force)

        kernel = _kernel(given, (0, 0), wrench, None, RATES)
        parameters = ca.vertcat(ca.DM(0, 1), *given.values)
        return replace(self._on_section(kernel, base, parameters, np.zeros((0, 1))), motion=motion)

    def _on_section(self, kernel: SectionKernel, base: RodBase, parameters: Matrix, data: Numbers) -> PoseWrench:
        """A kernel on the section of the body."""
        return PoseWrench(
            at=self.joint.at,
            span=(0.0, 1.0),
            kernel=kernel,
            base_position=base.position,
            base_rotation=base.base_R_world.T,
            parameters=parameters,
            data=data,
            scale=1.0,
        )


@dataclass(frozen=True)
class _Section:
    """Symbols of a section for a kernel, world axes."""

    position: ca.SX
    rotation: ca.SX
    parameters: ca.SX
    data: ca.SX
    rates: list[ca.SX]


class _Given:
    """Numbers in a kernel: constants, or symbols for expressions, which become parameters of the kernel."""

    def __init__(self) -> None:
        self.symbols: list[ca.SX] = []
        self.values: list[Matrix] = []

    def __call__(self, numbers: Scalar | Numbers) -> ca.SX:
        if not is_symbolic(numbers):
            return ca.SX(ca.sparsify(ca.DM(numbers)))
        symbol = ca.SX.sym("given", numbers.sparsity())
        self.symbols += symbol.nonzeros()
        self.values.append(ca.reshape(numbers.nz[:], numbers.nnz(), 1))
        return symbol


def _kernel(
    given: _Given,
    sizes: tuple[int, int],
    wrench: Callable[[_Section], Sequence[Matrix]],
    energy: Callable[[_Section], Matrix] | None,
    rates: tuple[str, ...] = (),
) -> SectionKernel:
    """A kernel of a section.

    Args:
        given: numbers in the kernel; their symbols follow its other parameters.
        sizes: number of the other parameters, and of the data.
        wrench: force and moment, world axes, 3×1 each.
        energy: energy of the wrench, 1×1, J; None if it has none.
        rates: names of the rates of the section that the wrench depends on.
    """
    own, data = sizes
    section = _Section(
        ca.SX.sym("position", 3),
        ca.SX.sym("rotation", 3, 3),
        ca.vertcat(ca.SX.sym("parameters", own), *given.symbols),
        ca.SX.sym("data", data),
        [ca.SX.sym(rate, 3) for rate in rates],
    )
    arguments = [section.position, section.rotation, section.parameters, section.data]
    names = [*WORLD_ARGUMENTS, *rates]
    results = [ca.sparsify(part) for part in wrench(section)]
    of_section = ca.Function("wrench", [*arguments, *section.rates], results, names, ["force", "moment"])
    if energy is None:
        return SectionKernel(of_section, rates=rates)
    return SectionKernel(of_section, ca.Function("energy", arguments, [energy(section)], WORLD_ARGUMENTS, ["energy"]))
