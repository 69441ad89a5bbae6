"""Distance of two poses, which a tolerance bounds.

Positions count by their distance over the length of the rod, rotations by the angle of the relative rotation. Neither
depends on the axes of the poses.

A *change* is an array of rows of three numbers, each of which counts by its norm: displacements over the length and
rotation vectors of sections, lengths of cables as rows with one number. Small changes add up row by row.
"""

from __future__ import annotations

import numpy as np

from cosserat_casadi.maths.rotation import quaternion_conjugate, quaternion_product
from cosserat_casadi.maths.typing import FloatArray


def rotation_vectors(first: FloatArray, second: FloatArray) -> FloatArray:
    """Rotation vectors from some orientations to others: axes times angles, in the axes of the first.

    Args:
        first: unit quaternions world_Q_section, w x y z, shape (4,) or (k, 4).
        second: other unit quaternions, in the shape of ``first``.

    Returns:
        shape (3,) or (k, 3), rad; the norms are in [0, π].
    """
    difference = quaternion_product(quaternion_conjugate(first.T), second.T)
    # Q and −Q are one rotation: the sign that turns by less.
    difference = np.where(difference[0] < 0, -difference, difference)
    cosine = difference[0]
    vector = difference[1:]
    sine = np.linalg.norm(vector, axis=0)
    # The arc tangent is exact near 0 and near π, where arc cosine and arc sine are not.
    angle = 2 * np.arctan2(sine, cosine)
    # Equal orientations have no axis: θ / sin(θ/2) tends to 2.
    ratio = np.divide(angle, sine, out=np.full_like(sine, 2.0), where=sine > 0)
    return np.asarray((ratio * vector).T)


def rotation_angles(first: FloatArray, second: FloatArray) -> FloatArray:
    """Angles of the rotations between two sets of orientations, shape () or (k,), rad, in [0, π].

    Args:
        first: unit quaternions, w x y z, shape (4,) or (k, 4).
        second: other unit quaternions, in the shape of ``first``.
    """
    return np.asarray(np.linalg.norm(rotation_vectors(first, second), axis=-1))


def change_size(change: FloatArray) -> float:
    """The largest norm among the rows of a change; infinite where an entry is not finite, 0 without rows.

    Args:
        change: shape (m, 3).
    """
    if not np.all(np.isfinite(change)):
        return float("inf")
    norms = np.linalg.norm(change, axis=1)
    return float(norms.max(initial=0.0))
