"""The view of a scene or a motion: in space, or normal to its plane if it is planar."""

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
"""Indices of the axes to the right and upwards, None for space; and the axes, one per row, shape (3, 3)."""

PLANES: tuple[tuple[int, Plane], ...] = ((1, (0, 2)), (2, (0, 1)), (0, (1, 2)))
"""Normals and axes of the coordinate planes, in the order of the search."""

UPRIGHT = 1e-6
"""Least length of the vertical's projection onto a plane for which it points upwards in the picture."""


def scene_view(shapes: RodShapes, arrows: Sequence[Arrow]) -> View:
    """View of the plane of all rods and forces, with moments normal to it, or of space."""
    points = np.concatenate(list(shapes.deformed.values()))
    return view_of(points, FLAT * shapes.size, arrows)


def view_of(points: FloatArray, thickness: float, arrows: Sequence[Arrow] = ()) -> View:
    """View of the plane of all points and arrows, with moments normal to it, or of space.

    Args:
        points: points, shape (n, 3), m.
        thickness: largest extent normal to the plane due to rounding, m.
        arrows: arrows of loads.

    Returns:
        indices of the two axes of the plane, or None for space; and the axes: world axes, or for an oblique plane axes
        of the plane, with its normal second.
    """
    for normal, plane in PLANES:
        if _holds(normal, WORLD, points, arrows, thickness):
            return plane, WORLD
    askew = _fitted_axes(points)
    if askew is not None and _holds(1, askew, points, arrows, thickness):
        return (0, 2), askew
    return None, WORLD


def _holds(normal: int, axes: FloatArray, points: FloatArray, arrows: Sequence[Arrow], thickness: float) -> bool:
    """Whether points and arrows lie in a plane normal to one of the axes."""
    if np.ptp(points @ axes[normal]) > thickness:
        return False
    turned = [replace(arrow, vector=axes @ arrow.vector) for arrow in arrows]
    return all(lies_in_plane(arrow, normal) for arrow in turned)


def _fitted_axes(points: FloatArray) -> FloatArray | None:
    """Axes of the best-fit plane of points: to the right, normal, upwards; None for collinear points."""
    _, spreads, directions = np.linalg.svd(points - points.mean(axis=0), full_matrices=False)
    if spreads[1] <= UPRIGHT * spreads[0]:
        return None
    normal = directions[2]
    # Projection of world z onto the plane, or of world y if that is too short.
    up = WORLD[2] - normal * normal[2]
    if np.linalg.norm(up) < UPRIGHT:
        up = WORLD[1] - normal * normal[1]
    up /= np.linalg.norm(up)
    right = np.cross(normal, up)
    # The plane is seen from the side on which world x, or y, points to the right.
    if right[np.argmax(np.abs(right) > UPRIGHT)] < 0:
        normal = -normal
        right = -right
    # As in the x–z plane, the normal points away from the viewer: right × normal = up.
    return np.array([right, np.cross(up, right), up])
