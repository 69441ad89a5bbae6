"""A ball: the distance |r − c| − R from a sphere."""

from __future__ import annotations

from typing import Any, final

import casadi as ca
import numpy as np

from cosserat_casadi.maths.typing import FloatArray, Matrix
from cosserat_casadi.obstacles.obstacle import Obstacle, rounded_norm
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
        polar = np.linspace(0.0, np.pi, 13)[:, None]
        around = np.linspace(0.0, 2 * np.pi, 25)[None, :]
        ring = np.sin(polar)
        directions = np.stack(
            [ring * np.cos(around), ring * np.sin(around), np.cos(polar) * np.ones_like(around)], axis=-1
        )
        return np.asarray(np.asarray(obstacle.centre) + obstacle.radius * directions)

    def primitive(self, obstacle: Sphere, size: float) -> dict[str, Any]:
        """A ball."""
        return {"type": "sphere", "size": obstacle.radius, "pos": obstacle.centre}
