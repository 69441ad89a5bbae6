"""Distances of solved rods from obstacles, between the nodes too."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import numpy.typing as npt

from cosserat_casadi import scene as scenes
from cosserat_casadi.equilibrium.contact.surfaces import distance_from, surface
from cosserat_casadi.equilibrium.solution import Solution
from cosserat_casadi.loads.penetration import section_radius
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.rod.properties import RodProperties

DENSE = np.linspace(0.0, 1.0, 801)
"""Abscissae at which rods are held against obstacles; they are no nodes."""


def pairs(scene: scenes.Scene) -> Iterator[tuple[str, scenes.ObstacleRecord]]:
    """Every rod with every obstacle that it touches exactly, if at all."""
    for rod in scene.rods:
        for obstacle in scene.obstacles:
            if obstacle.concerns(rod.name) and not obstacle.is_smooth:
                yield rod.name, obstacle


def gap_along(solution: Solution, rod: str, obstacle: scenes.ObstacleRecord, X: FloatArray) -> FloatArray:
    """Distance of a rod's surface from an obstacle at abscissae X, over the length of the rod, shape (k,)."""
    properties = solution.model.discrete.rods[rod].properties
    return section_gaps(obstacle, properties, solution.pose(X, rod).position, X) / properties.length


def section_gaps(
    obstacle: scenes.ObstacleRecord, properties: RodProperties, positions: FloatArray, X: FloatArray
) -> FloatArray:
    """Distances of a rod's sections at abscissae X from an obstacle, shape (k,), m, for positions of shape (k, 3)."""
    distances = distance_from(obstacle).map(len(X))(positions.T)
    return np.asarray(distances.full()[0] - section_radius(properties, X))


def normals(solution: Solution, rod: str, obstacle: scenes.ObstacleRecord, X: FloatArray) -> FloatArray:
    """Normals of an obstacle at the sections of a rod, shape (k, 3)."""
    positions = solution.pose(X, rod).position
    _, gradient, _ = surface(obstacle).map(len(X))(positions.T)
    return np.asarray(gradient.full().T)


def runs(chosen: npt.NDArray[np.bool_]) -> Iterator[slice]:
    """Stretches of neighbours that are chosen."""
    padded = np.concatenate([[False], chosen, [False]]).astype(int)
    steps = np.diff(padded)
    starts = np.flatnonzero(steps == 1)
    ends = np.flatnonzero(steps == -1)
    for start, end in zip(starts, ends, strict=True):
        yield slice(int(start), int(end))
