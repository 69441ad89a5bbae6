"""The loads of a solved scene as arrows: every load's kernel evaluated on the sections it is drawn at."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial

import casadi as ca
import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.loads.arrow import Arrow
from cosserat_casadi.loads.load import Poses, Site
from cosserat_casadi.loads.trace import TracedLoad, stored, traced
from cosserat_casadi.maths.numbers import known
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.discrete_scene import DiscreteScene
from cosserat_casadi.model.inputs import load_values
from cosserat_casadi.model.load_assembly import unloaded_poses
from cosserat_casadi.model.registry import EFFECTS

DRAWN_SECTIONS = np.linspace(0.05, 0.95, 8)
"""Where a load per length is drawn, as shares of its span."""


@dataclass(frozen=True)
class LoadArrows:
    """Arrows of the loads of a scene in one equilibrium.

    Attributes:
        discrete: the scene.
        inputs: the stacked inputs.
        rod_poses: poses of sections, from a rod's name and abscissae.
        body_pose: pose of a body, from its name, as that of one section.
    """

    discrete: DiscreteScene
    inputs: FloatArray
    rod_poses: Callable[[str, FloatArray], Poses]
    body_pose: Callable[[str], Poses]

    def all(self) -> list[Arrow]:
        """Arrows of all loads, in the order of the scene."""
        values = load_values(self.discrete.scene, self.discrete.layout, self.inputs)
        arrows: list[Arrow] = []
        for load in self.discrete.scene.loads:
            numbers = {name: ca.sparsify(ca.DM(value)) for name, value in values[load.name].items()}
            arrows += self._on_rods(load, numbers)
            arrows += self._on_bodies(load, numbers)
        return arrows

    def _on_rods(self, load: scenes.Load, values: Mapping[str, ca.DM]) -> list[Arrow]:
        member = EFFECTS[load.kind]
        at = member.abscissa(load)
        start, end = member.span(load)
        X = start + (end - start) * DRAWN_SECTIONS
        if at is not None:
            X = np.array([at])
        arrows: list[Arrow] = []
        for rod, discrete_rod in self.discrete.rods.items():
            if not member.acts_on(load, rod):
                continue
            to_sections = discrete_rod.grid.interpolation_matrix(X)
            site = Site(discrete_rod.properties, X, partial(unloaded_poses, self.discrete, rod, to_sections))
            data_size = member.data(load, site).shape[0]
            kernel = traced(member, load, values, data_size)
            poses = self.rod_poses(rod, X)
            force, moment = _wrench(kernel, values, poses, known(kernel.data(site)))
            # The legend names a load once: the arrows of its first rod carry the label.
            label = "" if arrows else load.name
            positions, _ = poses
            arrows += member.arrows(load, label, positions, force, moment)
        return arrows

    def _on_bodies(self, load: scenes.Load, values: Mapping[str, ca.DM]) -> list[Arrow]:
        member = EFFECTS[load.kind]
        arrows: list[Arrow] = []
        for body in self.discrete.scene.bodies:
            point = member.on_body(load, body)
            if point is None:
                continue
            position, rotation = self.body_pose(body.name)
            start = position + rotation[0] @ np.array(point.position)[:, None]
            kernel = traced(member, load, values)
            # Profiles are those of a load per length: at a point they are one.
            profiles = np.ones((sum(kernel.columns), 1))
            force, moment = _wrench(kernel, values, (start, rotation), profiles)
            label = _body_label(load, body)
            arrows += member.point_arrows(label, start, point.factor * force, point.factor * moment)
        return arrows


def _body_label(load: scenes.Load, body: scenes.Body) -> str:
    """Name of a load, with the body where the load acts on bodies that it does not name, as a weight does."""
    if getattr(load, "body", None) is not None:
        return load.name
    return f"{load.name} of {body.name}"


def _wrench(
    kernel: TracedLoad, values: Mapping[str, ca.DM], poses: Poses, data: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Force and moment at sections, world axes, shape (3, k) each."""
    position, rotation = poses
    parameters = stored(values)
    forces = []
    moments = []
    for k, section_rotation in enumerate(rotation):
        force, moment = kernel.kernel.world_wrench(position[:, k], section_rotation, parameters, data[:, k])
        forces.append(force.full()[:, 0])
        moments.append(moment.full()[:, 0])
    return np.array(forces).T, np.array(moments).T
