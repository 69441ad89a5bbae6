"""A round bar with half a ball at either end: the distance from its axis, less its radius."""

from __future__ import annotations

from typing import Any, final

import casadi as ca
import numpy as np

from cosserat_casadi.maths.typing import FloatArray, Matrix
from cosserat_casadi.obstacles.obstacle import Obstacle, capsule_net, rounded_norm
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
