"""Branch switching: the first point of the branch that crosses a curve at a bifurcation.

The crossing branch leaves along a null vector of ∂g/∂y across the curve. A point at a small distance along it is
corrected onto the branch in the plane across that vector: E. L. Allgower, K. Georg, *Introduction to Numerical
Continuation Methods*, SIAM 2003, chapter 8.
"""

from __future__ import annotations

import numpy as np

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.numerics.arclength import ArcPoint, Curve, Plane

DISTANCES = (0.02, 0.05, 0.01, 0.1, 0.002)
"""Distances from the bifurcation at which the branch is looked for, one after the other."""

TIE = 1e-6
"""Relative difference below which two entries of the null space are equally large."""


def switch(curve: Curve, at: ArcPoint, multiplicity: int, side: int = 1) -> ArcPoint | None:
    """First point of the branch that crosses at a bifurcation, with its tangent away from it.

    Of the two halves of the branch side 1 is the one on which the largest strain coordinate of the null vector grows,
    side −1 the other. Where symmetry makes a whole circle of branches, the one nearest to the first such coordinate.

    Args:
        curve: the curve.
        at: the bifurcation.
        multiplicity: branches that cross, the dimension of the null space across the curve.
        side: which half, 1 or −1.
    """
    direction = side * crossing_direction(curve.derivative(at.y), at.tangent, multiplicity)
    for distance in DISTANCES:
        guess = at.y + distance * direction
        found = curve.correct(guess, Plane(direction, float(direction @ guess)))
        if found is None or np.linalg.norm(found[0] - guess) > distance:
            continue
        # The chord, not the null vector: where the factor turns the branch has left the null vector already.
        point = curve.point(found[0], found[0] - at.y, at.length + distance)
        if point is not None:
            return point
    return None


def crossing_direction(derivative: FloatArray, tangent: FloatArray, multiplicity: int) -> FloatArray:
    """Unit vector of the null space of ∂g/∂y, shape (n, n + 1), across the tangent, shape (n + 1,)."""
    _, _, rows = np.linalg.svd(np.vstack([derivative, tangent]))
    basis = rows[-multiplicity:].T
    sizes = np.linalg.norm(basis[:-1], axis=1)
    largest = int(np.argmax(sizes >= (1 - TIE) * sizes.max()))
    direction = basis @ basis[largest]
    return np.asarray(direction / np.linalg.norm(direction))
