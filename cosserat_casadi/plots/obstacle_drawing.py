"""Obstacles of a solved scene, as a cut by the plane of the picture or as a net in space, and their contacts."""

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
"""Number of points along each axis of a cut at which the distance is evaluated."""

MARGIN = 0.12
"""Margin around the rods in which obstacles are drawn, relative to the size of the scene."""


def draw_obstacles(canvas: Canvas, solution: Solution, shapes: RodShapes) -> None:
    """Draw all obstacles, in the poses of their bodies, and mark the contacts."""
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
    """Draw obstacles near the displayed points.

    Args:
        canvas: canvas.
        obstacles: obstacles.
        points: displayed points, world axes, shape (k, 3), m.
        bodies: poses of bodies with obstacles, by name.
        strength: colour strength, 0 to 1.
        named: whether obstacles near the points get legend entries.
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
    """Points of the surface of an obstacle near the displayed points, world axes, shape (m, n, 3), m."""
    member = SURFACES[obstacle.kind]
    near = points.mean(axis=0)
    if body is None:
        return np.asarray(member.mesh(obstacle, near, size))
    (seen,) = in_axes_of(body, near[None])
    return np.asarray(body.position + member.mesh(obstacle, seen, size) @ body.rotation.T)


def _draw_cut(
    canvas: Canvas, obstacle: ObstacleRecord, shown: FloatArray, body: SolvedPoses | None, strength: float
) -> bool:
    """Fill the region of the picture's plane inside an obstacle, near the rods; return whether it is nonempty.

    Around a straight rod, axes with equal scales show a larger region, which is searched too, e.g. for a table below.
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
    """Lines of an obstacle, world axes, each of shape (k, 3), m: outlines of its cut, or of its net in space."""
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
    # Only its lines are needed, for moving them between frames.
    drawn.remove()
    return lines


def _points_of_plane(canvas: Canvas, shown: FloatArray, *, square: bool = False) -> FloatArray:
    """Grid of points of the picture's plane near the rods, in the axes of the view, m.

    Args:
        canvas: canvas.
        shown: displayed points, world axes, shape (k, 3), m.
        square: whether all sides have the length of the longest side.
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
    """Horizontal and vertical coordinates of points of a plane, and their distances to an obstacle, m."""
    assert canvas.plane is not None, "asked for in a plane"
    right, up = canvas.plane
    world = points.reshape(-1, 3) @ canvas.view_axes
    seen = world if body is None else in_axes_of(body, world)
    values = distances(obstacle, seen).reshape(RESOLUTION, RESOLUTION)
    return points[0, :, right], points[:, 0, up], values


def _mark_contacts(canvas: Canvas, solution: Solution) -> None:
    """Mark points of contact, and highlight intervals of contact."""
    for contact in solution.contacts:
        if contact.of_body and contact.width is not None:
            continue
        is_stretch = contact.start < contact.end
        points = touching_points(solution, contact, 41)
        if is_stretch:
            canvas.line(points, color="black", linewidth=1.6, zorder=8)
        canvas.markers(points[[0, -1]], marker="o", markersize=5, color="black", zorder=9, label="contact")
