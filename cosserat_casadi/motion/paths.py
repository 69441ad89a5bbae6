"""The paths that a tolerance of a motion binds: those of the tips of rods and of bodies."""

from __future__ import annotations

import numpy as np

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.motion.history import History
from cosserat_casadi.motion.poses import body_poses, tip_poses

WATCHED = 401
"""Times at which paths are compared, evenly spaced."""


def watched_times(history: History, duration: float) -> FloatArray:
    """Times at which paths are compared, as far as a motion reaches them, shape (T,), s."""
    times = np.linspace(0.0, duration, WATCHED)
    return times[times <= history.end.time]


def paths(history: History, times: FloatArray) -> FloatArray:
    """Positions of all tips and bodies over the length, shape (T, points, 3), without unit."""
    model = history.model
    x, inputs = history.rough_positions(times)
    points = []
    for name, rod in model.discrete.rods.items():
        position = tip_poses(model, name, x, inputs).position
        points.append(position / rod.properties.length)
    longest = longest_rod(model)
    points += [body_poses(model, body.name, x, inputs).position / longest for body in model.scene.bodies]
    return np.stack(points, axis=1)


def path_distance(first: FloatArray, second: FloatArray) -> float:
    """Largest distance of two sets of paths at the times that both reach."""
    rows = min(len(first), len(second))
    distances = np.linalg.norm(first[:rows] - second[:rows], axis=2)
    return float(distances.max(initial=0.0))


def longest_rod(model: Model) -> float:
    """Length of the longest rod, m."""
    return max(rod.properties.length for rod in model.discrete.rods.values())
