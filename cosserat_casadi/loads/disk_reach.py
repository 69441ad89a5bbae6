"""How far a disk reaches against the normal of an obstacle, and where it does: R √(1 − s²) + h/2 |s| with s = n·t.

The disk has the radius R, the thickness h and the axis t. Its corners are rounded, so that the reach is smooth where a
face lies on the obstacle, and where a rim stands on it.
"""

from __future__ import annotations

import casadi as ca

from cosserat_casadi.maths.numbers import Scalar
from cosserat_casadi.maths.typing import Matrix

ROUNDED = 1e-2
"""Share of its radius that the rim of a disk, and sine of the angle that its face, is rounded by."""


def disk_reach(normal: Matrix, axis: Matrix, radius: Scalar, thickness: Scalar) -> tuple[Matrix, Matrix]:
    """How far a disk reaches against a normal, 1×1, m, and from its centre to where it does, 3×1, m.

    Args:
        normal: of the obstacle, 3×1.
        axis: of the disk, 3×1.
        radius: of the disk, m.
        thickness: of the disk, m.
    """
    half = thickness / 2
    slant = ca.dot(normal, axis)
    flattened = (1 - ROUNDED**2) * slant
    across = ca.sqrt(1 - flattened * slant)
    along = ca.sqrt(slant**2 + ROUNDED**2)
    reach = radius * across + half * (along - ROUNDED)
    touching = -radius / across * (normal - flattened * axis) - half * slant / along * axis
    return reach, touching
