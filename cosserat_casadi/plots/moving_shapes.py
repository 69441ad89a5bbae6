"""Shapes of the rods, bodies and disks of a motion over time, for its figure and its animation."""

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
"""Abscissae of the drawn points of rods."""


@dataclass(frozen=True)
class MovingShapes:
    """Lines in world axes at T times.

    Attributes:
        times: times, shape (T,), s.
        rods: centre lines at SECTIONS, by rod, shape (T, len(SECTIONS), 3), m.
        outlines: closed outlines of bodies, and rims of disks, by legend label, shape (T, k, 3), m.
        colours: colours of the outlines, by the same labels.
        courses: courses of cables and chambers by actuator, shape (T, k, 3), m.
        followed: points with drawn paths, by the name of their rod or body, shape (T, 3), m.
        marks: style and position, shape (T, 1, 3), m, of the markers of joints and clamps.
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
        """Style of an outline by its label; a body without extent is a dot."""
        style: dict[str, Any] = {"color": self.colours[name]}
        if np.ptp(self.outlines[name][0], axis=0).max() <= FLAT * self.size:
            style |= {"marker": "o", "markersize": 7}
        return style

    @property
    def view(self) -> View:
        """The plane of a planar motion, or space."""
        return view_of(self.points, FLAT * self.size)


def moving_shapes(model: Model, times: FloatArray, x: FloatArray, inputs: FloatArray) -> MovingShapes:
    """Lines of all rods, bodies, disks and actuators over time.

    Args:
        model: the model.
        times: times, shape (T,), s; at least one.
        x: unknowns at the times, shape (T, model.size).
        inputs: stacked inputs at the times, shape (T, model.inputs.size).
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
            # Labels that begin with an underscore are not in the legend, which has one entry for each row of disks.
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
    """Path of each tip, shape (T, 3), m; of the middle if the tip is held; none for a tip that is jointed to a body."""
    followed = {}
    carrying = {joint.rod for joint in model.scene.joints if joint.at == 1.0}
    held = {support.rod for support in model.scene.supports}
    for name, lines in rods.items():
        if name in held:
            # A held tip is fixed; the middle moves.
            followed[name] = lines[:, len(SECTIONS) // 2]
        elif name not in carrying:
            # Tips of rods that carry a body follow the path of the body, which is drawn once.
            followed[name] = lines[:, -1]
    return followed


def _marks(
    model: Model, rods: dict[str, FloatArray], bodies: dict[str, Poses]
) -> Iterator[tuple[dict[str, Any], FloatArray]]:
    """Style and place of the marks of clamps, and of joints of bodies that are no disks."""
    unloaded = model.discrete.unloaded
    for rod in model.scene.rods:
        # A free rod has no mark.
        if not rod.base.free:
            yield base_style(unloaded, rod.name), rods[rod.name][:, :1]
    disks = {body.name for body in model.scene.bodies if body.thickness is not None}
    for joint in model.scene.joints:
        for place in joint.places:
            if place.body in bodies and place.body not in disks:
                poses = bodies[place.body]
                arms = rotations(poses.quaternion) @ np.array(place.position)
                yield joint_style(joint), (poses.position + arms)[:, None]
