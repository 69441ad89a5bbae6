"""What residual and Jacobian of a rod cost, foreseen without building them.

Counting the operations of a model takes longer than solving it. A law of the intervals and the coordinates, its
factors fitted to counted models of every strain model, section and load, is right to a tenth or so, and better where
it only compares discretisations of one rod.
"""

from __future__ import annotations

from cosserat_casadi.rod.discretisation import Discretisation
from cosserat_casadi.rod.properties import RodProperties

_TAYLOR = {"magnus4": 2, "magnus6": 3, "magnus8": 4}


def foreseen_operations(rod: RodProperties, discretisation: Discretisation) -> float:
    """Scalar operations of one rod's residual and Jacobian, approximately.

    Args:
        rod: what the rod is made of.
        discretisation: a candidate; its transport is one of the Magnus methods.
    """
    seen = (discretisation.elements + 1) / 2  # a coordinate moves the elements beyond its own only
    turning, stretching = (
        seen * sum(m for m, c in zip(discretisation.modes, rod.admitted, strict=True) if (c < 3) is angular)
        for angular in (True, False)
    )
    if len(rod.turning_axes) < 2:
        each = 41 + 29 * turning + 19 * stretching + 12 * turning * stretching
    else:
        count = _TAYLOR[discretisation.transport]
        each = (
            (133 + 21 * count**3)
            + (85 + 19 * count**2) * turning
            + 4.7 * turning**2
            + 30 * stretching
            + 9.5 * turning * stretching
        )
    return discretisation.elements * discretisation.nodes * each
