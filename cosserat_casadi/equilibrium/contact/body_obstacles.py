"""Obstacles that are fixed to bodies: contact is computed in the axes of the body, in which they are at rest."""

from __future__ import annotations

import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.equilibrium.solution import Solution, SolvedPoses
from cosserat_casadi.maths.typing import FloatArray


def in_axes_of(body: SolvedPoses, positions: FloatArray) -> FloatArray:
    """World positions, shape (k, 3) in m, in the axes of a body."""
    return np.asarray((positions - body.position) @ body.rotation)


def seen_positions(solution: Solution, obstacle: scenes.ObstacleRecord, positions: FloatArray) -> FloatArray:
    """World positions, shape (k, 3) in m, in the axes of an obstacle: the axes of its body, or of the world."""
    if obstacle.body is None:
        return positions
    return in_axes_of(solution.body(obstacle.body), positions)


def seen_directions(solution: Solution, obstacle: scenes.ObstacleRecord, directions: FloatArray) -> FloatArray:
    """World directions, shape (k, 3), in the axes of an obstacle."""
    if obstacle.body is None:
        return directions
    return np.asarray(directions @ solution.body(obstacle.body).rotation)


def world_directions(solution: Solution, obstacle: scenes.ObstacleRecord, directions: FloatArray) -> FloatArray:
    """Directions in world axes, shape (k, 3), from directions in the axes of an obstacle."""
    if obstacle.body is None:
        return directions
    return np.asarray(directions @ solution.body(obstacle.body).rotation.T)
