"""What residual and Jacobian of a rod cost, foreseen without building them.

Counting the operations of a model takes longer than solving it. A law of the intervals and the coordinates, its
factors fitted to counted models of every strain model, section and load, is right to a tenth or so, and better where
it only compares discretisations of one rod.
"""

from __future__ import annotations

from cosserat_casadi.rod.discretisation import Discretisation
from cosserat_casadi.rod.properties import RodProperties

_LAWS = {
    "magnus4": (433.0, 84.0, 1.3),
    "magnus6": (937.0, 116.0, 2.1),
    "magnus8": (5120.0, 108.0, 5.1),
}
"""For each interval: a constant, and the factors of the turning coordinates and of their square."""

_PLANAR = (114.0, 8.8, 0.5)
"""The same for a rod that turns about one axis, where all methods are one."""


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
    constant, linear, square = _PLANAR if len(rod.turning_axes) < 2 else _LAWS[discretisation.transport]
    each = constant + linear * turning + square * turning**2 + 32 * stretching + 0.6 * turning * stretching
    return discretisation.elements * discretisation.nodes * each
