"""The pose error that a tolerance bounds, from rotation matrices: the package takes it from quaternions."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt


def angle_between(one: npt.ArrayLike, other: npt.ArrayLike) -> float:
    """Angle of the rotation between two rotation matrices: their difference has the Frobenius norm 2 √2 sin(θ/2)."""
    norm = float(np.linalg.norm(np.subtract(one, other)))
    return 2 * float(np.arcsin(min(norm / (2 * 2**0.5), 1.0)))


def distance_between(one: npt.ArrayLike, other: npt.ArrayLike) -> float:
    return float(np.linalg.norm(np.subtract(one, other)))


def pose_error(
    one: tuple[npt.ArrayLike, npt.ArrayLike],
    other: tuple[npt.ArrayLike, npt.ArrayLike],
    length: float,
) -> float:
    """The larger of distance over length and angle, of two poses as position and rotation matrix."""
    return max(distance_between(one[0], other[0]) / length, angle_between(one[1], other[1]))
