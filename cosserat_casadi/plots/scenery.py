"""Rods, supports, actuators, bodies, disks and targets of a solved scene."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from cosserat_casadi.actuators.routing import drawn_places, offset_at
from cosserat_casadi.constraints.joints import JOINT_KINDS
from cosserat_casadi.constraints.supports import SUPPORT_KINDS
from cosserat_casadi.control.targets import TARGET_KINDS
from cosserat_casadi.equilibrium.solution import Solution
from cosserat_casadi.maths.grid import Indices
from cosserat_casadi.maths.numbers import known
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.floating_frames import UnloadedScene
from cosserat_casadi.model.registry import EFFECTS
from cosserat_casadi.plots.canvas import Canvas
from cosserat_casadi.plots.colours import AXES, BODIES, TARGETS, actuator_colour, disk_colour, rod_style
from cosserat_casadi.plots.solved_shapes import SAMPLES, RodShapes, in_world
from cosserat_casadi.scene import Body, Disks, Joint, Scene

SLACK = 1e-6
"""Threshold of the tension of slack cables, in units of EI/ℓ²."""

AXES_SECTIONS = 9
"""Largest number of drawn section axes, shared among the rods; none are drawn with fewer than two per rod."""

AXES_LENGTH = 0.06
"""Length of drawn section axes, over the size of the scene."""

RIM = 33
"""Number of points of the rim of a disk."""

CLAMP: dict[str, Any] = {"color": "0.2", "marker": "s", "markersize": 9}

FIXED: dict[str, Any] = {"marker": "s", "markersize": 7, "color": "0.35"}
HINGE: dict[str, Any] = {"marker": "o", "markersize": 7, "color": "0.35"}
BALL: dict[str, Any] = {"marker": "o", "markersize": 8, "markerfacecolor": "white", "markeredgecolor": "0.2"}
SLIDE: dict[str, Any] = {"marker": "D", "markersize": 6, "markerfacecolor": "white", "markeredgecolor": "0.2"}
"""Markers of joints, by held directions; rods that start on rods without a joint have FIXED."""

TARGET_STYLE: dict[str, Any] = {
    "marker": "+",
    "markersize": 13,
    "markeredgewidth": 2.0,
    "color": TARGETS,
    "zorder": 10,
}


def draw_rods(canvas: Canvas, solution: Solution, shapes: RodShapes) -> None:
    """Draw rods, unloaded dashed and deformed thick, with their bases and section axes."""
    several = len(shapes.deformed) > 1
    unloaded = solution.model.discrete.unloaded
    for index, (name, deformed) in enumerate(shapes.deformed.items()):
        canvas.line(shapes.unloaded[name], label="unloaded", color="0.55", linestyle="--", linewidth=1.2)
        canvas.line(deformed, linewidth=3.5, label=name if several else "deformed", **rod_style(index))
        canvas.markers(deformed[:1], **base_style(unloaded, name))
        _draw_section_axes(canvas, solution, name, AXES_SECTIONS // len(shapes.deformed))


def base_style(unloaded: UnloadedScene, rod: str) -> dict[str, Any]:
    """Marker of a rod's base: joint, start on another rod, or clamp."""
    for joint in unloaded.scene.joints:
        if joint.rod == rod and joint.holds_base:
            return joint_style(joint)
    return CLAMP if unloaded.floating_base(rod) is None else FIXED


def _draw_section_axes(canvas: Canvas, solution: Solution, name: str, count: int) -> None:
    """Draw the axes of ``count`` sections of a rod, including both ends; with a count below two draw none."""
    if count < 2:
        return
    pose = solution.pose(np.linspace(0.0, 1.0, count), name)
    length = AXES_LENGTH * canvas.size
    for position, rotation in zip(pose.position, pose.rotation, strict=True):
        for axis, colour in enumerate(AXES):
            direction = rotation[:, axis]
            ends = np.array([position, position + length * direction])
            canvas.line(ends, color=colour, linewidth=1.1)


def draw_supports(canvas: Canvas, scene: Scene) -> None:
    """Mark the supports of tips."""
    for support in scene.supports:
        turns = not SUPPORT_KINDS[support.kind].directions(support).rotations.size
        marker = "^" if turns else "s"
        position = np.array([support.position])
        label = f"{support.kind} tip"
        canvas.markers(position, marker=marker, markersize=10, color="0.2", label=label)


def draw_actuators(canvas: Canvas, solution: Solution) -> None:
    """Draw the routing of every actuator; the legend shows efforts, also of actuators without a routing."""
    for index, actuator in enumerate(solution.model.scene.actuators):
        colour = actuator_colour(index)
        label = _effort_label(solution, actuator)
        if not hasattr(actuator, "offset"):
            canvas.legend_entry(label, linestyle="none")
            continue
        routing = actuator_routing(solution, actuator)
        drawn_as = EFFECTS[actuator.kind].drawn_as
        style = {**ACTUATOR_STYLES[drawn_as]}
        if drawn_as == "cable":
            # The point at which the cable is fixed to its section.
            canvas.markers(routing[-1:], marker="o", markersize=4, color=colour)
            if _is_limp(solution, actuator):
                style["linestyle"] = ":"
        canvas.line(routing, color=colour, label=label, **style)


def _effort_label(solution: Solution, actuator: Any) -> str:
    """Name and effort of an actuator, or that it is slack."""
    member = EFFECTS[actuator.kind]
    if getattr(actuator, "slack", False) and _is_limp(solution, actuator):
        return f"{actuator.name}: slack"
    effort = solution.actuator(actuator.name)[member.effort]
    return f"{actuator.name}: {effort:.3g} {member.effort_unit}"


def _is_limp(solution: Solution, actuator: Any) -> bool:
    """Whether an actuator is a cable with negligible tension."""
    effort = solution.actuator(actuator.name)[EFFECTS[actuator.kind].effort]
    smallest_taut = SLACK * solution.model.discrete.tension_unit(actuator.rod)
    return bool(effort <= smallest_taut)


ACTUATOR_STYLES: dict[str, dict[str, Any]] = {
    "cable": {"linewidth": 1.4, "linestyle": "-"},
    "channel": {"linewidth": 4.0, "alpha": 0.5},
}
"""Drawing styles of actuators, by the style of their kind."""


def actuator_routing(solution: Solution, actuator: Any) -> FloatArray:
    """Points r + R D of an actuator's routing in world axes, shape (len(SAMPLES), 3), m."""
    X = drawn_places(actuator, SAMPLES)
    pose = solution.pose(X, actuator.rod)
    offset = known(offset_at(actuator, X)[0])
    # Offsets of a routing are along the axes x and y of its sections.
    across = pose.rotation[:, :, :2]
    return np.asarray(pose.position + np.einsum("kij,jk->ki", across, offset))


def draw_bodies(canvas: Canvas, solution: Solution) -> None:
    """Draw every body as the polygon through its joints, or as a line from its single joint to its centre of mass."""
    scene = solution.model.scene
    for body in scene.bodies:
        pose = solution.body(body.name)
        outline = in_world(pose, body_outline(scene, body))
        if body.thickness is not None:
            # Disks of a row that are bodies, for contact, are drawn with their row.
            if body.listed:
                canvas.line(outline, color=BODIES, linewidth=1.6, label=body.name)
            continue
        canvas.polygon(outline[:-1], BODIES)
        canvas.line(outline, color=BODIES, linewidth=2.0, label=body.name)
        ends = [(joint, place) for joint in scene.joints for place in joint.places if place.body == body.name]
        for (joint, _), point in zip(ends, in_world(pose, places_in(scene, body.name)), strict=True):
            canvas.markers(point[None], **joint_style(joint))


def joint_style(joint: Joint) -> dict[str, Any]:
    """Marker of a joint, by its held directions."""
    held = JOINT_KINDS[joint.kind].directions(joint)
    if held.slides:
        return SLIDE
    if not held.rotations.size:
        return BALL
    return FIXED if held.rotations.shape[1] == 3 else HINGE


def places_in(scene: Scene, body: str) -> FloatArray:
    """Positions of the joints of a body in its axes, shape (k, 3), m."""
    return np.array([place.position for joint in scene.joints for place in joint.places if place.body == body])


def body_outline(scene: Scene, body: Body) -> FloatArray:
    """Outline of a body in body axes, shape (k, 3), m: the rims of a disk, else a closed polygon."""
    if body.thickness is not None:
        return disk_rim(body)
    corners = body_corners(scene, body)
    return np.concatenate([corners, corners[:1]])


def body_corners(scene: Scene, body: Any) -> FloatArray:
    """Corners of the polygon of a body in body axes, shape (k, 3), m."""
    points = places_in(scene, body.name)
    corners = points[_order_around_mean(points)]
    # A body on one joint extends from the joint to its centre of mass.
    if len(corners) < 2:
        corners = np.concatenate([corners, np.array([body.centre_of_mass])])
    return corners


def _order_around_mean(points: FloatArray) -> Indices:
    """Order of points, shape (k, 3), for a polygon without self-intersection.

    Points are ordered by angle about their mean, in the plane of their two principal directions.
    """
    arms = points - points.mean(axis=0)
    # For fewer than three points the basis has to be completed.
    _, _, directions = np.linalg.svd(arms, full_matrices=len(points) < 3)
    # Singular vectors are in descending order of their singular values.
    across = arms @ directions[0]
    up = arms @ directions[1]
    angles = np.arctan2(up, across)
    return np.argsort(angles, kind="stable").astype(np.int64)


def draw_disks(canvas: Canvas, solution: Solution) -> None:
    """Draw the rims of disks; the legend has one entry for each row."""
    for index, row in enumerate(solution.model.scene.disks):
        for at in row.places:
            rim = in_world(solution.pose(at, row.rod), disk_rim(row))
            canvas.line(rim, color=disk_colour(index), linewidth=1.6, label=row.name or "disks")


def disk_rim(row: Disks | Body) -> FloatArray:
    """The rims of both faces of a disk as one line, in the axes of its section or body, shape (k, 3), m."""
    assert row.radius is not None and row.thickness is not None, "a disk has both"
    angles = np.linspace(0.0, 2.0 * np.pi, RIM)
    around = row.radius * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    faces = [np.column_stack([around, np.full(RIM, height)]) for height in (-row.thickness / 2, row.thickness / 2)]
    return np.concatenate(faces)


def draw_targets(canvas: Canvas, scene: Scene) -> None:
    """Mark the targets of an inverse problem."""
    points = target_points(scene)
    if points:
        canvas.markers(np.array(points), label="targets", **TARGET_STYLE)


def target_points(scene: Scene) -> list[Sequence[float]]:
    """Target points of a scene, world axes, m."""
    return [point for target in scene.targets for point in TARGET_KINDS[target.kind].points(target)]
