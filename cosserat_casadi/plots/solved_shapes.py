"""Centre lines of the rods of a solution, for all parts of its figure."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cosserat_casadi.equilibrium.solution import Solution, SolvedPoses
from cosserat_casadi.maths.typing import FloatArray

SAMPLES = np.linspace(0.0, 1.0, 201)
"""Abscissae of the drawn points of rods."""


@dataclass(frozen=True)
class RodShapes:
    """Centre lines at SAMPLES, in world axes.

    Attributes:
        deformed: positions by rod, shape (len(SAMPLES), 3), m.
        unloaded: positions without loads by rod, shape (len(SAMPLES), 3), m.
    """

    deformed: dict[str, FloatArray]
    unloaded: dict[str, FloatArray]

    @property
    def points(self) -> FloatArray:
        """All points, shape (k, 3), m."""
        lines = [*self.deformed.values(), *self.unloaded.values()]
        return np.concatenate(lines)

    @property
    def size(self) -> float:
        """Largest extent of the scene, m."""
        extents = np.ptp(self.points, axis=0)
        return float(extents.max())


def rod_shapes(solution: Solution) -> RodShapes:
    """Centre lines of all rods of a solution, deformed and unloaded."""
    model = solution.model
    # Solution at the unloaded unknowns; only its poses are used.
    unloaded = Solution(model, solution.inputs, model.unloaded(), solution.outcome, "", 0.0, 0)
    names = model.discrete.rods
    return RodShapes(
        {name: solution.pose(SAMPLES, name).position for name in names},
        {name: unloaded.pose(SAMPLES, name).position for name in names},
    )


def in_world(pose: SolvedPoses, points: FloatArray) -> FloatArray:
    """World coordinates of points given in the axes of a body, shape (k, 3), m."""
    return np.asarray(pose.position + points @ pose.rotation.T)
