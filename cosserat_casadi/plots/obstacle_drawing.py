"""Obstacles of a solved scene: cut by the plane that is shown, or as a net in space; and where rods touch them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from cosserat_casadi.equilibrium.contact.body_obstacles import in_axes_of
from cosserat_casadi.equilibrium.contact.gaps import touching_points
from cosserat_casadi.equilibrium.contact.obstacle_surfaces import distances
from cosserat_casadi.equilibrium.solution import Solution, SolvedPoses
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.obstacles.registry import SURFACES
from cosserat_casadi.plots.canvas import SPACE, Canvas
from cosserat_casadi.plots.colours import OBSTACLES
from cosserat_casadi.plots.solved_shapes import RodShapes
from cosserat_casadi.scene import ObstacleRecord

RESOLUTION = 161
"""Points along each axis of a cut at which the distance is looked at."""

MARGIN = 0.12
"""Margin of an obstacle that is shown beyond the rods, relative to the scene."""


def draw_obstacles(canvas: Canvas, solution: Solution, shapes: RodShapes) -> None:
    """Draw all obstacles, those on bodies where these are, and mark the contacts."""
    scene = solution.model.scene
    bodies = {body.name: solution.body(body.name) for body in scene.bodies}
    draw_surfaces(canvas, scene.obstacles, shapes.points, bodies)
    _mark_contacts(canvas, solution)


def draw_surfaces(
    canvas: Canvas,
    obstacles: Sequence[ObstacleRecord],
    points: FloatArray,
    bodies: Mapping[str, SolvedPoses],
    *,
    strength: float = 1.0,
    named: bool = True,
) -> None:
    """Draw obstacles about points that are shown.

    Args:
        canvas: where to draw.
        obstacles: what to draw.
        points: points that are shown, world axes, shape (k, 3), m.
        bodies: poses of the bodies that obstacles are fixed to, by name.
        strength: share of its colour that an obstacle has.
        named: whether the legend names them; it names no obstacle that is far from the points.
    """
    for obstacle in obstacles:
        body = None if obstacle.body is None else bodies[obstacle.body]
        is_shown = True
        if canvas.plane is None:
            for line in surface_lines(canvas, obstacle, points, body):
                canvas.line(line, color=OBSTACLES, linewidth=0.6, alpha=0.6 * strength)
        else:
            is_shown = _draw_cut(canvas, obstacle, points, body, strength)
        if named and is_shown:
            canvas.legend_entry(obstacle.name, color=OBSTACLES, linewidth=6, alpha=0.5)


def surface_net(obstacle: ObstacleRecord, points: FloatArray, size: float, body: SolvedPoses | None) -> FloatArray:
    """Points of the surface of an obstacle about points that are shown, world axes, shape (m, n, 3), m."""
    member = SURFACES[obstacle.kind]
    near = points.mean(axis=0)
    if body is None:
        return np.asarray(member.mesh(obstacle, near, size))
    (seen,) = in_axes_of(body, near[None])
    return np.asarray(body.position + member.mesh(obstacle, seen, size) @ body.rotation.T)


def _draw_cut(
    canvas: Canvas, obstacle: ObstacleRecord, shown: FloatArray, body: SolvedPoses | None, strength: float
) -> bool:
    """Fill the part of the shown plane that lies inside an obstacle, about the rods; return whether there is one.

    Beside a straight rod axes of one scale show more than its surroundings: a table below it is looked for there.
    """
    columns, rows, values = _cut(canvas, obstacle, _points_of_plane(canvas, shown), body)
    if not np.any(values < 0.0):
        columns, rows, values = _cut(canvas, obstacle, _points_of_plane(canvas, shown, square=True), body)
    if not np.any(values < 0.0):
        return False
    inside = [min(float(values.min()), -1e-12), 0.0]
    canvas.axes.contourf(columns, rows, values, levels=inside, colors=[OBSTACLES], alpha=0.35 * strength, zorder=0)
    outline = {"colors": [OBSTACLES], "linewidths": 1.2, "alpha": strength, "zorder": 0}
    canvas.axes.contour(columns, rows, values, levels=[0.0], **outline)
    return True


def surface_lines(
    canvas: Canvas, obstacle: ObstacleRecord, shown: FloatArray, body: SolvedPoses | None
) -> list[FloatArray]:
    """Lines that show an obstacle, world axes, shape (k, 3) each, m: about a cut, or of a net in space."""
    if canvas.plane is None:
        mesh = surface_net(obstacle, shown, canvas.size, body)
        return [*mesh, *mesh.transpose(1, 0, 2)]
    points = _points_of_plane(canvas, shown)
    columns, rows, values = _cut(canvas, obstacle, points, body)
    drawn = canvas.axes.contour(columns, rows, values, levels=[0.0])
    lines = []
    for segment in drawn.allsegs[0]:
        line = np.tile(points[0, 0], (len(segment), 1))
        line[:, canvas.plane] = segment
        lines.append(line @ canvas.view_axes)
    # Only its lines are wanted: they are moved from frame to frame.
    drawn.remove()
    return lines


def _points_of_plane(canvas: Canvas, shown: FloatArray, *, square: bool = False) -> FloatArray:
    """Points of the plane that is shown about the rods, in the axes of the view, rows of points, m.

    Args:
        canvas: where to draw.
        shown: points that are shown, world axes, shape (k, 3), m.
        square: whether all sides are as long as the longest one.
    """
    assert canvas.plane is not None, "asked for in a plane"
    coordinates = shown @ canvas.view_axes.T
    lowest = coordinates.min(axis=0)
    highest = coordinates.max(axis=0)
    spare = np.full(3, MARGIN * canvas.size)
    if square:
        spare += (np.max(highest - lowest) - (highest - lowest)) / 2
    lowest -= spare
    highest += spare
    right, up = canvas.plane
    (across,) = set(SPACE) - set(canvas.plane)
    points = np.zeros((RESOLUTION, RESOLUTION, 3))
    points[:, :, right] = np.linspace(lowest[right], highest[right], RESOLUTION)[None, :]
    points[:, :, up] = np.linspace(lowest[up], highest[up], RESOLUTION)[:, None]
    points[:, :, across] = float(coordinates[:, across].mean())
    return points


def _cut(
    canvas: Canvas, obstacle: ObstacleRecord, points: FloatArray, body: SolvedPoses | None
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Coordinates to the right and upwards of points of a plane, and the distances of these from an obstacle, m."""
    assert canvas.plane is not None, "asked for in a plane"
    right, up = canvas.plane
    world = points.reshape(-1, 3) @ canvas.view_axes
    seen = world if body is None else in_axes_of(body, world)
    values = distances(obstacle, seen).reshape(RESOLUTION, RESOLUTION)
    return points[0, :, right], points[:, 0, up], values


def _mark_contacts(canvas: Canvas, solution: Solution) -> None:
    """Mark points of contact, and draw stretches that lie on an obstacle once more."""
    for contact in solution.contacts:
        if contact.of_body and contact.width is not None:
            continue
        is_stretch = contact.start < contact.end
        points = touching_points(solution, contact, 41)
        if is_stretch:
            canvas.line(points, color="black", linewidth=1.6, zorder=8)
        canvas.markers(points[[0, -1]], marker="o", markersize=5, color="black", zorder=9, label="contact")
