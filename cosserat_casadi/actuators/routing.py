"""Where an actuator runs through the sections of a rod."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.polynomial import polynomial

from cosserat_casadi import scene as scenes
from cosserat_casadi.maths.grid import Grid
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.rod.cable import Routing


def routing(actuator: Any, grid: Grid) -> Routing:
    """Routing of a tendon or a chamber through the nodes of its span."""
    nodes = grid.nodes_in(*actuator.span)
    offset, slope = offset_at(actuator, grid.nodes[nodes])
    return Routing(nodes, offset, slope)


def offset_at(actuator: Any, X: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Offset D and its derivative dD/dX at any abscissae, shape (2, k) each, m."""
    helix = getattr(actuator, "helix", None)
    if helix is not None:
        return _helix(helix, X)
    return _polynomial(actuator.offset, X)


def span_ends(actuator: Any) -> tuple[float, ...]:
    """Where an actuator begins and ends: the stress jumps there."""
    start, end = actuator.span
    return (float(start), float(end))


def _polynomial(offset: Any, X: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Polynomials of X and their derivatives, shape (2, k) each, m."""
    values = []
    slopes = []
    for component in offset:
        coefficients = np.atleast_1d(np.asarray(component, dtype=float))
        # A constant polynomial gives one number; all abscissae are wanted.
        values.append(polynomial.polyval(X, coefficients) + 0.0 * X)
        slopes.append(polynomial.polyval(X, polynomial.polyder(coefficients)) + 0.0 * X)
    return np.array(values), np.array(slopes)


def _helix(helix: scenes.Helix, X: FloatArray) -> tuple[FloatArray, FloatArray]:
    """A helix of constant pitch and its derivative, shape (2, k) each, m."""
    angular_rate = 2 * np.pi * helix.turns
    angle = angular_rate * X + helix.phase
    sine = np.sin(angle)
    cosine = np.cos(angle)
    outward = np.array([cosine, sine])
    around = np.array([-sine, cosine])
    rate = angular_rate * helix.radius
    return helix.radius * outward, rate * around
