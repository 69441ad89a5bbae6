"""Reach of a disk against the normal of an obstacle, R √(1 − s²) + h/2 |s| with s = n·t, and the point of it.

The disk has the radius R, the thickness h and the axis t. Its corners are rounded, so that the reach is smooth where a
face lies on the obstacle, and where a rim stands on it.
"""

from __future__ import annotations

import casadi as ca

from cosserat_casadi.maths.numbers import Scalar
from cosserat_casadi.maths.typing import Matrix

ROUNDED = 1e-2
"""Rounding of a disk: share of its radius at the rim, and sine of the angle at its face."""


def disk_reach(normal: Matrix, axis: Matrix, radius: Scalar, thickness: Scalar) -> tuple[Matrix, Matrix]:
    """Reach of a disk against a normal, 1×1, m, and vector from its centre to the farthest point, 3×1, m.

    Args:
        normal: normal of the obstacle, 3×1.
        axis: axis of the disk, 3×1.
        radius: radius of the disk, m.
        thickness: thickness of the disk, m.
    """
    half = thickness / 2
    slant = ca.dot(normal, axis)
    flattened = (1 - ROUNDED**2) * slant
    across = ca.sqrt(1 - flattened * slant)
    along = ca.sqrt(slant**2 + ROUNDED**2)
    reach = radius * across + half * (along - ROUNDED)
    touching = -radius / across * (normal - flattened * axis) - half * slant / along * axis
    return reach, touching
