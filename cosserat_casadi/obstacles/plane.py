"""Half of space: the distance n·(r − p) from a plane."""

from __future__ import annotations

from typing import Any, final

import casadi as ca
import numpy as np

from cosserat_casadi.maths.rotation import quaternion_from_tangent
from cosserat_casadi.maths.typing import FloatArray, Matrix
from cosserat_casadi.obstacles.obstacle import Obstacle, across
from cosserat_casadi.scene.obstacle_records import Plane


@final
class PlaneObstacle(Obstacle[Plane]):
    """The points behind a plane."""

    record = Plane

    def distance(self, obstacle: Plane, point: Matrix) -> Matrix:
        """n·(r − p), m."""
        return ca.dot(ca.sparsify(ca.DM(obstacle.normal)), point - ca.DM(obstacle.point))

    def mesh(self, obstacle: Plane, near: FloatArray, size: float) -> FloatArray:
        """A square about the foot of the point."""
        normal = np.asarray(obstacle.normal)
        foot = near - normal * (normal @ (near - np.asarray(obstacle.point)))
        first, second = across(normal)
        half = 0.6 * size * np.linspace(-1.0, 1.0, 5)
        return np.asarray(foot + half[:, None, None] * first + half[None, :, None] * second)

    def primitive(self, obstacle: Plane, size: float) -> dict[str, Any]:
        """A plane with its normal along z."""
        turned = quaternion_from_tangent(obstacle.normal)
        return {"type": "plane", "size": [5 * size, 5 * size, size], "pos": obstacle.point, "quat": turned}
