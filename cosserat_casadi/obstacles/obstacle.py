"""Base class of obstacles: a kind of obstacle gives the distance of a point of space from it.

A member is one file and one line of the registry. It gives :meth:`Obstacle.distance`, a small function of a point.
Normals and curvatures are its derivatives, which CasADi forms.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator
from typing import Any, ClassVar, Generic, TypeVar

import casadi as ca
import numpy as np

from cosserat_casadi.errors import Problem
from cosserat_casadi.maths.typing import FloatArray, Matrix
from cosserat_casadi.scene.families import Kind, Kinds
from cosserat_casadi.scene.obstacle_records import OBSTACLES, ObstacleRecord

RecordType = TypeVar("RecordType", bound=ObstacleRecord)

ROUNDING = 1e-8
"""Distance from the middle of an obstacle, relative to its size, for smoothing: (1e-8)²/2 is below rounding."""


class Obstacle(Kind, ABC, Generic[RecordType]):
    """One kind of obstacle.

    Attributes:
        record: the record of the scene, whose word is the obstacle's.
        kind: the word of the scene format.
        forbidden: the side of its surface where a rod must not be, in sentences.
    """

    record: ClassVar[type[ObstacleRecord]]
    forbidden: ClassVar[str] = "inside"
    family = OBSTACLES
    kinds = Kinds(OBSTACLES)

    @abstractmethod
    def distance(self, obstacle: RecordType, point: Matrix) -> Matrix:
        """Distance of a point from the surface, negative where a rod must not be, 1×1, m.

        Args:
            obstacle: the record of the scene.
            point: 3×1, world axes, m.
        """

    def faults(self, obstacle: RecordType, radius: float) -> Iterator[Problem]:
        """Problems of an obstacle for rods whose sections have this radius, m; none by default."""
        yield from ()

    @abstractmethod
    def mesh(self, obstacle: RecordType, near: FloatArray, size: float) -> FloatArray:
        """Points of the surface as a figure draws it, shape (m, n, 3), m.

        Args:
            obstacle: the record of the scene.
            near: a point about which an infinite surface is drawn, shape (3,), m.
            size: size of the scene, m.
        """

    def primitive(self, obstacle: RecordType, size: float) -> dict[str, Any]:
        """The shape as attributes of a geom of MuJoCo, with its type; empty if MuJoCo does not have the shape.

        Args:
            obstacle: the record of the scene.
            size: size of the scene, m, for drawing an infinite surface.
        """
        return {}

    def function(self, obstacle: RecordType) -> ca.Function:
        """Point ↦ distance, its gradient 3×1 and its second derivative 3×3."""
        point = ca.SX.sym("point", 3)
        distance = ca.SX(self.distance(obstacle, point))
        hessian, gradient = ca.hessian(distance, point)
        results = ca.cse([distance, gradient, ca.densify(hessian)])
        return ca.Function("distance", [point], results, ["point"], ["distance", "gradient", "hessian"])


def rounded_norm(vector: Matrix, size: float) -> Matrix:
    """Norm of a vector with derivatives at zero too, exact to rounding from 1e-8 of a size on."""
    return ca.sqrt(ca.sumsqr(vector) + (ROUNDING * size) ** 2)


def across(direction: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Two unit vectors that are normal to a direction and to each other."""
    # The axis that is farthest from the direction is the best start.
    axis = np.eye(3)[int(np.argmin(np.abs(direction)))]
    first = np.cross(direction, axis)
    first /= np.linalg.norm(first)
    second = np.cross(direction, first) / np.linalg.norm(direction)
    return first, second


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
