"""Obstacles as functions of a point, made once for each."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from typing import NamedTuple

import casadi as ca
import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.obstacles.registry import SURFACES


@lru_cache(maxsize=64)
def distance_from(obstacle: scenes.ObstacleRecord) -> ca.Function:
    """Point ↦ distance from an obstacle."""
    point = ca.SX.sym("point", 3)
    return ca.Function("distance", [point], ca.cse([ca.SX(SURFACES[obstacle.kind].distance(obstacle, point))]))


@lru_cache(maxsize=64)
def _distances_from(obstacle: scenes.ObstacleRecord, count: int) -> ca.Function:
    """Points, 3×count ↦ their distances from an obstacle, 1×count, m."""
    return distance_from(obstacle).map(count)


@lru_cache(maxsize=64)
def surface(obstacle: scenes.ObstacleRecord) -> ca.Function:
    """Point ↦ distance from an obstacle, its gradient and its second derivative."""
    return SURFACES[obstacle.kind].function(obstacle)


@lru_cache(maxsize=64)
def surface_at_once(obstacle: scenes.ObstacleRecord) -> ca.Function:
    """Point ↦ the results of :func:`surface`, stacked, 13×1."""
    point = ca.SX.sym("point", 3)
    parts = surface(obstacle).expand().call([point])
    return ca.Function("surface", [point], [ca.cse(ca.vertcat(*(ca.densify(ca.vec(part)) for part in parts)))])


def distances(obstacle: scenes.ObstacleRecord, positions: FloatArray) -> FloatArray:
    """Distances of points of shape (k, 3) from an obstacle, shape (k,), m."""
    found = _distances_from(obstacle, len(positions))(positions.T)
    return np.asarray(found.full()[0])


class DistanceAlong(NamedTuple):
    """Distance of a curve from an obstacle at one of its points, with its derivatives.

    Attributes:
        value: the distance, m.
        slope: its derivative by the parameter of the curve, m.
        bend: its second derivative, m.
        normal: normal of the obstacle, shape (3,).
        curvature: second derivative of the distance by the point, shape (3, 3), 1/m.
    """

    value: float
    slope: float
    bend: float
    normal: FloatArray
    curvature: FloatArray


def distance_along(
    obstacle: scenes.ObstacleRecord, position: FloatArray, first: FloatArray, second: FloatArray
) -> DistanceAlong:
    """Distance of a curve r from an obstacle at one of its points: d, n·r′ and r′·∇²d r′ + n·r″.

    Args:
        obstacle: the obstacle.
        position: the point, shape (3,), m.
        first: derivative of the curve by its parameter, shape (3,), m.
        second: second derivative, shape (3,), m.
    """
    return along_curve([part.full() for part in surface(obstacle)(position)], first, second)


def along_curve(parts: Sequence[FloatArray], first: FloatArray, second: FloatArray) -> DistanceAlong:
    """Distance of a curve from an obstacle at one of its points, from the results of :func:`surface`, as matrices."""
    distance, gradient, curvature = parts
    normal = gradient[:, 0]
    slope = float(normal @ first)
    bend = float(first @ curvature @ first + normal @ second)
    return DistanceAlong(float(distance[0, 0]), slope, bend, normal, curvature)
