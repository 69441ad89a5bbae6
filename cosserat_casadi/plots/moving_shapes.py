"""Where the rods, bodies and disks of a motion lie over time: what its figure and its animation are drawn from."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from cosserat_casadi.actuators.routing import drawn_places, offset_at
from cosserat_casadi.equilibrium.solution import rotations
from cosserat_casadi.maths.numbers import known
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.motion.pose_series import Poses, poses_of, section_poses
from cosserat_casadi.plots.canvas import FLAT
from cosserat_casadi.plots.colours import BODIES, disk_colour
from cosserat_casadi.plots.scene_view import View, view_of
from cosserat_casadi.plots.scenery import base_style, body_outline, disk_rim, joint_style

SECTIONS = np.linspace(0.0, 1.0, 101)
"""Abscissae at which rods are drawn."""


@dataclass(frozen=True)
class MovingShapes:
    """Lines in world axes at T times.

    Attributes:
        times: shape (T,), s.
        rods: centre lines at SECTIONS, by rod, shape (T, len(SECTIONS), 3), m.
        outlines: closed outlines of bodies, and rims of disks, by what a legend calls them, shape (T, k, 3), m.
        colours: of the outlines, by the same words.
        courses: courses of cables and chambers by actuator, shape (T, k, 3), m.
        followed: points whose paths are drawn, by the name of their rod or body, shape (T, 3), m.
        marks: of joints and clamps: style of the marker, and its place, shape (T, 1, 3), m.
    """

    times: FloatArray
    rods: dict[str, FloatArray]
    outlines: dict[str, FloatArray]
    colours: dict[str, str]
    courses: dict[str, FloatArray]
    followed: dict[str, FloatArray]
    marks: tuple[tuple[dict[str, Any], FloatArray], ...]

    @property
    def points(self) -> FloatArray:
        """All points of all times, shape (n, 3), m."""
        lines = [*self.rods.values(), *self.outlines.values(), *self.followed.values()]
        return np.concatenate([line.reshape(-1, 3) for line in lines])

    @property
    def size(self) -> float:
        """Largest extent of the whole motion, m."""
        extents = np.ptp(self.points, axis=0)
        return float(extents.max())

    def outline_style(self, name: str) -> dict[str, Any]:
        """Style of an outline: its colour; a body without extent is a dot."""
        style: dict[str, Any] = {"color": self.colours[name]}
        if np.ptp(self.outlines[name][0], axis=0).max() <= FLAT * self.size:
            style |= {"marker": "o", "markersize": 7}
        return style

    @property
    def view(self) -> View:
        """The plane that holds the whole motion, or space."""
        return view_of(self.points, FLAT * self.size)


def moving_shapes(model: Model, times: FloatArray, x: FloatArray, inputs: FloatArray) -> MovingShapes:
    """Lines of all rods, bodies and disks.

    Args:
        model: the model.
        times: shape (T,), s; at least one.
        x: unknowns there, shape (T, model.size).
        inputs: stacked inputs there, shape (T, model.inputs.size).
    """
    rods = {name: section_poses(model, name, SECTIONS, x, inputs).position for name in model.discrete.rods}
    outlines = {}
    colours = {}
    bodies = {body.name: poses_of(model.body[body.name], x, inputs) for body in model.scene.bodies}
    followed = _followed(model, rods)
    for body in model.scene.listed_bodies:
        poses = bodies[body.name]
        world_R_body = rotations(poses.quaternion)
        outline = body_outline(model.scene, body)
        colours[body.name] = BODIES
        outlines[body.name] = poses.position[:, None, :] + np.einsum("tij,kj->tki", world_R_body, outline)
        followed[body.name] = poses.position
    for number, row in enumerate(model.scene.disks):
        sections = section_poses(model, row.rod, np.array(row.places), x, inputs)
        for disk in range(len(row.places)):
            world_R_section = rotations(sections.quaternion[:, disk])
            rim = np.einsum("tij,kj->tki", world_R_section, disk_rim(row))
            # A legend leaves out what begins with an underscore: it names a row once.
            name = f"_{number}_{disk}" if disk else row.name or "disks"
            colours[name] = disk_colour(number)
            outlines[name] = sections.position[:, disk, None, :] + rim
    courses = {}
    for actuator in model.scene.actuators:
        if hasattr(actuator, "offset"):
            X = drawn_places(actuator, SECTIONS)
            sections = section_poses(model, actuator.rod, X, x, inputs)
            across = np.stack([rotations(quaternions)[:, :, :2] for quaternions in sections.quaternion])
            courses[actuator.name] = sections.position + np.einsum(
                "tkij,jk->tki", across, known(offset_at(actuator, X)[0])
            )
    return MovingShapes(times, rods, outlines, colours, courses, followed, tuple(_marks(model, rods, bodies)))


def _followed(model: Model, rods: dict[str, FloatArray]) -> dict[str, FloatArray]:
    """The point of each rod whose path is drawn."""
    followed = {}
    carrying = {joint.rod for joint in model.scene.joints if joint.at == 1.0}
    held = {support.rod for support in model.scene.supports}
    for name, lines in rods.items():
        if name in held:
            # The tip rests; the middle does not.
            followed[name] = lines[:, len(SECTIONS) // 2]
        elif name not in carrying:
            # The tips of rods that carry a body go where the body goes, whose own path says it once.
            followed[name] = lines[:, -1]
    return followed


def _marks(
    model: Model, rods: dict[str, FloatArray], bodies: dict[str, Poses]
) -> Iterator[tuple[dict[str, Any], FloatArray]]:
    """Style and place of the marks of clamps, and of joints of bodies that are no disks."""
    unloaded = model.discrete.unloaded
    for rod in model.scene.rods:
        # A rod that nothing holds has no mark.
        if not rod.base.free:
            yield base_style(unloaded, rod.name), rods[rod.name][:, :1]
    disks = {body.name for body in model.scene.bodies if body.thickness is not None}
    for joint in model.scene.joints:
        for place in joint.places:
            if place.body in bodies and place.body not in disks:
                poses = bodies[place.body]
                arms = rotations(poses.quaternion) @ np.array(place.position)
                yield joint_style(joint), (poses.position + arms)[:, None]
