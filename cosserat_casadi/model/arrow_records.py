"""The loads of a scene as arrows: every load's kernel evaluated on the sections and bodies it is drawn at."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any, TypeAlias

import casadi as ca
import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.loads.load import Arrow, Load, Site
from cosserat_casadi.loads.load_trace import TracedLoad, stored, traced
from cosserat_casadi.maths.numbers import known
from cosserat_casadi.maths.typing import FloatArray, Matrix
from cosserat_casadi.model.discrete_scene import DiscreteScene
from cosserat_casadi.model.inputs import input_values
from cosserat_casadi.model.load_assembly import unloaded_poses
from cosserat_casadi.model.registry import EFFECTS

DRAWN_SECTIONS = np.linspace(0.05, 0.95, 8)
"""Abscissae at which a load per length is drawn, as shares of its span."""

DrawnPoses: TypeAlias = tuple[Matrix | FloatArray, Sequence[Matrix] | FloatArray]
"""World positions, 3×k in m, and rotation matrices world_R_section, k of 3×3: numbers or expressions."""


@dataclass(frozen=True)
class DrawnLoad:
    """A load at the drawn sections of one rod, or on one body.

    Attributes:
        member: the kind of load.
        load: record of the load in the scene.
        label: its name in the legend; empty where the legend names it already.
        on_body: whether it acts on a body; its arrays then have one column.
        position: positions of the k sections, world axes, 3×k, m.
        force: force on these sections, world axes, 3×k, N or N/m.
        moment: moment on these sections, world axes, 3×k, N m or N m/m.
    """

    member: Load[Any]
    load: scenes.LoadRecord
    label: str
    on_body: bool
    position: Matrix | FloatArray
    force: Matrix
    moment: Matrix

    @property
    def at_point(self) -> bool:
        """Whether the load is a force, N, and a moment, N m; otherwise both are per length."""
        return self.on_body or self.member.abscissa(self.load) is not None

    def arrows(self) -> list[Arrow]:
        """Arrows of the load; its force, moment and positions must be numbers."""
        numbers = [ca.DM(part).full() for part in (self.position, self.force, self.moment)]
        position, force, moment = numbers
        if self.on_body:
            return self.member.point_arrows(self.label, position, force, moment)
        return self.member.arrows(self.load, self.label, position, force, moment)


@dataclass(frozen=True)
class LoadArrows:
    """Arrows of the loads of a scene in one equilibrium, in numbers or in symbols.

    Attributes:
        discrete: the scene.
        inputs: the stacked inputs.
        rod_poses: function from the name of a rod and abscissae to the poses of these sections.
        body_pose: function from the name of a body to its pose, in the form of the pose of one section.
    """

    discrete: DiscreteScene
    inputs: Matrix
    rod_poses: Callable[[str, FloatArray], DrawnPoses]
    body_pose: Callable[[str], DrawnPoses]

    def all(self) -> list[Arrow]:
        """Arrows of all loads, in the order of the scene."""
        return [arrow for drawn in self.drawn() for arrow in drawn.arrows()]

    def drawn(self) -> Iterator[DrawnLoad]:
        """Every load on every rod and body that it acts on, in the order of the scene."""
        for load in self.discrete.loads:
            values = input_values(self.discrete.layout, load, self.inputs)
            yield from self._on_rods(load, values)
            yield from self._on_bodies(load, values)

    def _on_rods(self, load: scenes.LoadRecord, values: dict[str, Matrix]) -> Iterator[DrawnLoad]:
        member = EFFECTS[load.kind]
        at = member.abscissa(load)
        start, end = member.span(load)
        X = start + (end - start) * DRAWN_SECTIONS if at is None else np.array([at])
        # The legend names a load once: the arrows of its first rod carry the label.
        label = load.name
        for rod, discrete_rod in self.discrete.rods.items():
            if not member.acts_on(load, rod):
                continue
            to_sections = discrete_rod.grid.interpolation_matrix(X)
            site = Site(discrete_rod.properties, X, partial(unloaded_poses, self.discrete, rod, to_sections))
            data_size = member.data(load, site).shape[0]
            kernel = traced(member, load, values, data_size)
            positions, rotations = self.rod_poses(rod, X)
            data = known(kernel.data(site))
            seen_from = member.seen_from(load)
            if seen_from is None:
                force, moment = _wrench(kernel, stored(values), (positions, rotations), data)
            else:
                origin, (world_R_body,) = self.body_pose(seen_from)
                body_R_world = world_R_body.T
                places = [body_R_world @ (positions[:, k] - origin[:, 0]) for k in range(positions.shape[1])]
                in_body = ca.horzcat(*places), [body_R_world @ rotation for rotation in rotations]
                force, moment = (world_R_body @ part for part in _wrench(kernel, stored(values), in_body, data))
            yield DrawnLoad(member, load, label, False, positions, force, moment)
            label = ""

    def _on_bodies(self, load: scenes.LoadRecord, values: dict[str, Matrix]) -> Iterator[DrawnLoad]:
        member = EFFECTS[load.kind]
        for body in self.discrete.scene.bodies:
            point = member.on_body(load, body)
            if point is None:
                continue
            position, rotation = self.body_pose(body.name)
            start = position + rotation[0] @ np.array(point.position)[:, None]
            kernel = traced(member, load, values)
            # Profiles belong to loads per length: for a load at a point they are one.
            profiles = np.ones((sum(kernel.columns), 1))
            force, moment = _wrench(kernel, stored(values), (start, rotation), profiles)
            # A load that acts on bodies without naming one, such as weight, has a label for each body.
            label = load.name if getattr(load, "body", None) is not None else f"{load.name} of {body.name}"
            yield DrawnLoad(member, load, label, True, start, point.factor * force, point.factor * moment)


def _wrench(kernel: TracedLoad, parameters: Matrix, poses: DrawnPoses, data: FloatArray) -> tuple[Matrix, Matrix]:
    """Force and moment at sections, world axes, 3×k each."""
    position, rotation = poses
    wrench = kernel.kernel.world_wrench
    wrenches = [wrench(position[:, k], rotation[k], parameters, data[:, k]) for k in range(data.shape[1])]
    return ca.horzcat(*[force for force, _ in wrenches]), ca.horzcat(*[moment for _, moment in wrenches])
