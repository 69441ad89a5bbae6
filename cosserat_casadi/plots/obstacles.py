"""Obstacles of a solved scene: cut by the plane that is shown, or as a net in space; and where rods touch them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from cosserat_casadi.equilibrium.contact.gaps import touching_points
from cosserat_casadi.equilibrium.contact.surfaces import distances
from cosserat_casadi.equilibrium.solution import Solution
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.obstacles.registry import SURFACES
from cosserat_casadi.plots.canvas import SPACE, Canvas
from cosserat_casadi.plots.colours import OBSTACLES
from cosserat_casadi.plots.shapes import RodShapes
from cosserat_casadi.scene import ObstacleRecord

RESOLUTION = 161
"""Points along each axis of a cut at which the distance is looked at."""

MARGIN = 0.12
"""What of an obstacle is shown beyond the rods, relative to the scene."""


def draw_obstacles(canvas: Canvas, solution: Solution, shapes: RodShapes) -> None:
    """Draw all obstacles and mark the contacts."""
    draw_surfaces(canvas, solution.model.scene.obstacles, shapes.points)
    _mark_contacts(canvas, solution)


def draw_surfaces(canvas: Canvas, obstacles: Sequence[ObstacleRecord], points: FloatArray) -> None:
    """Draw obstacles about points that are shown, shape (k, 3)."""
    for obstacle in obstacles:
        if canvas.plane is None:
            _draw_net(canvas, SURFACES[obstacle.kind].mesh(obstacle, points.mean(axis=0), canvas.size))
        else:
            _draw_cut(canvas, obstacle, points)
        canvas.legend_entry(obstacle.name, color=OBSTACLES, linewidth=6, alpha=0.5)


def _draw_net(canvas: Canvas, mesh: FloatArray) -> None:
    """Draw lines through the points of a surface, both ways."""
    style = {"color": OBSTACLES, "linewidth": 0.6, "alpha": 0.6}
    for row in [*mesh, *mesh.transpose(1, 0, 2)]:
        canvas.line(row, **style)


def _draw_cut(canvas: Canvas, obstacle: ObstacleRecord, shown: FloatArray) -> None:
    """Fill what of the plane that is shown is inside an obstacle, about the rods."""
    assert canvas.plane is not None, "asked for in a plane"
    coordinates = shown @ canvas.view_axes.T
    spare = MARGIN * canvas.size
    lowest = coordinates.min(axis=0) - spare
    highest = coordinates.max(axis=0) + spare
    right, up = canvas.plane
    (across,) = set(SPACE) - set(canvas.plane)
    across_at = float(coordinates[:, across].mean())
    columns = np.linspace(lowest[right], highest[right], RESOLUTION)
    rows = np.linspace(lowest[up], highest[up], RESOLUTION)
    points = np.zeros((RESOLUTION, RESOLUTION, 3))
    points[:, :, right] = columns[None, :]
    points[:, :, up] = rows[:, None]
    points[:, :, across] = across_at
    world = points.reshape(-1, 3) @ canvas.view_axes
    values = distances(obstacle, world).reshape(RESOLUTION, RESOLUTION)
    if not np.any(values < 0.0):
        return
    inside = [min(float(values.min()), -1e-12), 0.0]
    canvas.axes.contourf(columns, rows, values, levels=inside, colors=[OBSTACLES], alpha=0.35, zorder=0)
    canvas.axes.contour(columns, rows, values, levels=[0.0], colors=[OBSTACLES], linewidths=1.2, zorder=0)


def _mark_contacts(canvas: Canvas, solution: Solution) -> None:
    """Mark points of contact, and draw stretches that lie on an obstacle once more."""
    label: str | None = "contact"
    for contact in solution.contacts:
        if contact.of_body and contact.width is not None:
            continue
        is_stretch = contact.start < contact.end
        points = touching_points(solution, contact, 41)
        if is_stretch:
            canvas.line(points, color="black", linewidth=1.6, zorder=8)
        canvas.markers(points[[0, -1]], marker="o", markersize=5, color="black", zorder=9, label=label)
        # The legend names contacts once.
        label = None
