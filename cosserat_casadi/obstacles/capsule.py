"""A round bar with half a ball at either end: the distance from its axis, less its radius."""

from __future__ import annotations

from typing import Any, final

import casadi as ca
import numpy as np

from cosserat_casadi.maths.typing import FloatArray, Matrix
from cosserat_casadi.obstacles.obstacle import Obstacle, across, rounded_norm
from cosserat_casadi.scene.obstacle_records import Capsule


@final
class CapsuleObstacle(Obstacle[Capsule]):
    """The points nearer to an axis than a radius."""

    record = Capsule

    def distance(self, obstacle: Capsule, point: Matrix) -> Matrix:
        """|r − c| − R, m, with c the point of the axis that is nearest to r."""
        start = np.asarray(obstacle.start)
        axis = np.asarray(obstacle.end) - start
        from_start = point - ca.DM(start)
        # The ends of the axis are nearest to points beyond them.
        share = ca.fmin(ca.fmax(ca.dot(ca.DM(axis), from_start) / float(axis @ axis), 0.0), 1.0)
        return rounded_norm(from_start - share * ca.DM(axis), obstacle.radius) - obstacle.radius

    def mesh(self, obstacle: Capsule, near: FloatArray, size: float) -> FloatArray:
        """Rings along the bar, the half balls included."""
        return capsule_net(np.asarray(obstacle.start), np.asarray(obstacle.end), obstacle.radius)

    def primitive(self, obstacle: Capsule, size: float) -> dict[str, Any]:
        """A capsule between two points."""
        return {"type": "capsule", "size": obstacle.radius, "fromto": [*obstacle.start, *obstacle.end]}


def capsule_net(start: FloatArray, end: FloatArray, radius: float) -> FloatArray:
    """Points of a round bar with half a ball at either end, row by row along it, shape (m, n, 3), m.

    Args:
        start: centre of one half ball, shape (3,), m.
        end: centre of the other half ball, shape (3,), m; ``start`` for a whole ball.
        radius: radius of bar and balls, m.
    """
    axis = end - start
    length = np.linalg.norm(axis)
    direction = axis / length if length > 0.0 else np.array([0.0, 0.0, 1.0])
    first, second = across(direction)
    polar = np.linspace(0.0, np.pi, 14)
    centres = np.where((polar < np.pi / 2)[:, None], start, end)
    along = centres - radius * np.cos(polar)[:, None] * direction
    around = np.linspace(0.0, 2 * np.pi, 25)
    ring = np.cos(around)[:, None] * first + np.sin(around)[:, None] * second
    return np.asarray(along[:, None] + radius * np.sin(polar)[:, None, None] * ring)
