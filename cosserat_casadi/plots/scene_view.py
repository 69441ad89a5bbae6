"""From where a scene is looked at: in space, or across the plane that holds all of it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from cosserat_casadi.loads.arrow import Arrow
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.plots.arrows import lies_in_plane
from cosserat_casadi.plots.canvas import FLAT, WORLD, Plane
from cosserat_casadi.plots.shapes import RodShapes

PLANES: tuple[tuple[int, Plane], ...] = ((1, (0, 2)), (2, (0, 1)), (0, (1, 2)))
"""Normal and axes of the coordinate planes, in the order in which they are tried."""

UPRIGHT = 1e-6
"""Length of the vertical in a plane, relative to its own, from which it points upwards in the picture."""


def scene_view(shapes: RodShapes, arrows: Sequence[Arrow]) -> tuple[Plane | None, FloatArray]:
    """The plane that holds all rods and forces, moments across it, as axes to the right and upwards.

    Returns:
        the two axes, or None where the scene fills space; and the axes that they are counted in, a row each, shape
        (3, 3): those of the world, or for a plane that stands askew its own, with its normal second.
    """
    points = np.concatenate(list(shapes.deformed.values()))
    for normal, plane in PLANES:
        if _holds(normal, WORLD, points, arrows, shapes.size):
            return plane, WORLD
    askew = _fitted_axes(points)
    if askew is not None and _holds(1, askew, points, arrows, shapes.size):
        return (0, 2), askew
    return None, WORLD


def _holds(normal: int, axes: FloatArray, points: FloatArray, arrows: Sequence[Arrow], size: float) -> bool:
    """Whether points and arrows lie in a plane across one of the axes."""
    if np.ptp(points @ axes[normal]) > FLAT * size:
        return False
    turned = [replace(arrow, vector=axes @ arrow.vector) for arrow in arrows]
    return all(lies_in_plane(arrow, normal) for arrow in turned)


def _fitted_axes(points: FloatArray) -> FloatArray | None:
    """Axes of the plane that fits points best: to the right, its normal, upwards; None for points of a line."""
    _, spreads, directions = np.linalg.svd(points - points.mean(axis=0), full_matrices=False)
    if spreads[1] <= UPRIGHT * spreads[0]:
        return None
    normal = directions[2]
    # World z as far as the plane has it, else world y.
    up = WORLD[2] - normal * normal[2]
    if np.linalg.norm(up) < UPRIGHT:
        up = WORLD[1] - normal * normal[1]
    up /= np.linalg.norm(up)
    right = np.cross(normal, up)
    # Of the two sides of the plane it is seen from the one from which world x, or y, points to the right.
    if right[np.argmax(np.abs(right) > UPRIGHT)] < 0:
        normal = -normal
        right = -right
    # As in the x–z plane, whose y axis points away from the reader: right × normal = up.
    return np.array([right, np.cross(up, right), up])
