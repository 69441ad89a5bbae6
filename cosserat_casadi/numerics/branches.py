"""Branch switching: the first point of the branch that crosses a curve at a bifurcation.

The crossing branch leaves along a null vector of ∂g/∂y across the curve. A point at a small distance along it is
corrected onto the branch in the plane across that vector: E. L. Allgower, K. Georg, *Introduction to Numerical
Continuation Methods*, SIAM 2003, chapter 8. See docs/theory.md, section 12.
"""

from __future__ import annotations

import numpy as np

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.numerics.arclength import ArcPoint, Curve, plane_through
from cosserat_casadi.numerics.neutral import direction_in

DISTANCES = (0.02, 0.05, 0.01, 0.1, 0.002)
"""Distances from the bifurcation at which the branch is looked for, one after the other."""


def switch(curve: Curve, bifurcation: ArcPoint, multiplicity: int, side: int = 1) -> ArcPoint | None:
    """First point of the branch that crosses at a bifurcation, with its tangent away from it.

    Of the two halves of the branch side 1 is the one on which the largest strain coordinate of the null vector grows,
    side −1 the other. Where symmetry makes a whole circle of branches, the one nearest to the first such coordinate.

    Args:
        curve: the curve.
        bifurcation: where to leave it.
        multiplicity: branches that cross, the dimension of the null space across the curve.
        side: which half, 1 or −1.

    Returns:
        the point; None where none of the distances leads to one.
    """
    derivative = curve.derivative(bifurcation.y)
    direction = side * crossing_direction(derivative, bifurcation.tangent, multiplicity)
    for distance in DISTANCES:
        guess = bifurcation.y + distance * direction
        corrected = curve.correct(guess, plane_through(guess, direction))
        # A correction as long as the distance may lead back to the curve.
        if corrected is None or np.linalg.norm(corrected.y - guess) > distance:
            continue
        # The chord, not the null vector: where the factor turns the branch has left the null vector already.
        chord = corrected.y - bifurcation.y
        point = curve.point(corrected.y, chord, bifurcation.length + distance)
        if point is not None:
            return point
    return None


def crossing_direction(derivative: FloatArray, tangent: FloatArray, multiplicity: int) -> FloatArray:
    """Direction of the null space of ∂g/∂y across the tangent, nearest to the largest unknown in it.

    Args:
        derivative: ∂g/∂y, shape (n, n + 1).
        tangent: shape (n + 1,).
        multiplicity: dimension of the null space across the tangent.

    Returns:
        unit vector, shape (n + 1,), in which that unknown grows.
    """
    bordered = np.vstack([derivative, tangent])
    _, _, rows = np.linalg.svd(bordered)
    basis = rows[-multiplicity:].T
    unknowns = len(tangent) - 1
    return direction_in(basis, unknowns)
