"""Obstacles as functions of a point, made once for each."""

from __future__ import annotations

from functools import lru_cache

import casadi as ca

from cosserat_casadi import scene as scenes
from cosserat_casadi.obstacles.registry import SURFACES


@lru_cache(maxsize=64)
def distance_from(obstacle: scenes.ObstacleRecord) -> ca.Function:
    """Point ↦ distance from an obstacle."""
    point = ca.SX.sym("point", 3)
    return ca.Function("distance", [point], ca.cse([ca.SX(SURFACES[obstacle.kind].distance(obstacle, point))]))


@lru_cache(maxsize=64)
def surface(obstacle: scenes.ObstacleRecord) -> ca.Function:
    """Point ↦ distance from an obstacle, its gradient and its second derivative."""
    function: ca.Function = SURFACES[obstacle.kind].function(obstacle)
    return function
