"""A ball: the distance |r − c| − R from a sphere."""

from __future__ import annotations

from typing import Any, final

import casadi as ca
import numpy as np

from cosserat_casadi.maths.typing import FloatArray, Matrix
from cosserat_casadi.obstacles.obstacle import Obstacle, capsule_net, rounded_norm
from cosserat_casadi.scene.obstacle_records import Sphere


@final
class SphereObstacle(Obstacle[Sphere]):
    """The points in a ball."""

    record = Sphere

    def distance(self, obstacle: Sphere, point: Matrix) -> Matrix:
        """|r − c| − R, m."""
        return rounded_norm(point - ca.DM(obstacle.centre), obstacle.radius) - obstacle.radius

    def mesh(self, obstacle: Sphere, near: FloatArray, size: float) -> FloatArray:
        """Circles of latitude."""
        centre = np.asarray(obstacle.centre)
        return capsule_net(centre, centre, obstacle.radius)

    def primitive(self, obstacle: Sphere, size: float) -> dict[str, Any]:
        """A ball."""
        return {"type": "sphere", "size": obstacle.radius, "pos": obstacle.centre}
