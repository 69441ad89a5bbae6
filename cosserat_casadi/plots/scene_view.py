"""The view of a scene or a motion: in space, or across the plane that holds all of it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from cosserat_casadi.loads.load import Arrow
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.plots.arrows import lies_in_plane
from cosserat_casadi.plots.canvas import FLAT, WORLD, Plane
from cosserat_casadi.plots.solved_shapes import RodShapes

View = tuple[Plane | None, FloatArray]
"""Two axes to the right and upwards, None for space; and the axes they are of, a row each, shape (3, 3)."""

PLANES: tuple[tuple[int, Plane], ...] = ((1, (0, 2)), (2, (0, 1)), (0, (1, 2)))
"""Normal and axes of the coordinate planes, in the order in which they are tried."""

UPRIGHT = 1e-6
"""Length of the vertical within a plane, relative to a unit, from which it points upwards in the picture."""


def scene_view(shapes: RodShapes, arrows: Sequence[Arrow]) -> View:
    """The plane that holds all rods and forces, moments across it."""
    points = np.concatenate(list(shapes.deformed.values()))
    return view_of(points, FLAT * shapes.size, arrows)


def view_of(points: FloatArray, thickness: float, arrows: Sequence[Arrow] = ()) -> View:
    """The plane that holds all points and arrows, moments across it.

    Args:
        points: shape (n, 3), m.
        thickness: extent across a plane that counts as rounding, m.
        arrows: of loads.

    Returns:
        the two axes of the plane, or None where points and arrows fill space; and the axes that they are counted in:
        the world's, or for a plane that stands askew its own axes, with its normal second.
    """
    for normal, plane in PLANES:
        if _holds(normal, WORLD, points, arrows, thickness):
            return plane, WORLD
    askew = _fitted_axes(points)
    if askew is not None and _holds(1, askew, points, arrows, thickness):
        return (0, 2), askew
    return None, WORLD


def _holds(normal: int, axes: FloatArray, points: FloatArray, arrows: Sequence[Arrow], thickness: float) -> bool:
    """Whether points and arrows lie in a plane across one of the axes."""
    if np.ptp(points @ axes[normal]) > thickness:
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
