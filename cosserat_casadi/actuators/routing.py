"""Where an actuator runs through the sections of a rod."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.polynomial import polynomial

from cosserat_casadi import scene as scenes
from cosserat_casadi.maths.grid import Grid, Indices
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.rod.cable import Routing


def routing(actuator: Any, grid: Grid) -> Routing:
    """Routing of a tendon or a chamber through the nodes of its span."""
    nodes = _nodes_in(actuator.span, grid)
    return Routing(nodes, *offset_at(actuator, grid.nodes[nodes]))


def offset_at(actuator: Any, X: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Offset D and its derivative dD/dX at any abscissae, shape (2, k) each, m."""
    helix = getattr(actuator, "helix", None)
    return _polynomial(actuator.offset, X) if helix is None else _wound(helix, X)


def span_ends(actuator: Any) -> tuple[float, ...]:
    """Where an actuator begins and ends: the stress jumps there."""
    start, end = actuator.span
    return (float(start), float(end))


def _nodes_in(span: tuple[float, float], grid: Grid) -> Indices:
    """Nodes of the elements inside a span, each side of a break with its own."""
    middles = grid.nodes.reshape(grid.elements, -1).mean(axis=1)
    inside = (middles > span[0]) & (middles < span[1])
    return np.flatnonzero(np.repeat(inside, grid.intervals + 1))


def _polynomial(offset: Any, X: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Polynomials of X and their derivatives, shape (2, k) each, m."""
    coefficients = [np.atleast_1d(np.asarray(component, dtype=float)) for component in offset]
    values = np.array([polynomial.polyval(X, c) + 0.0 * X for c in coefficients])
    return values, np.array([polynomial.polyval(X, polynomial.polyder(c)) + 0.0 * X for c in coefficients])


def _wound(helix: scenes.Helix, X: FloatArray) -> tuple[FloatArray, FloatArray]:
    angle = 2 * np.pi * helix.turns * X + helix.phase
    rate = 2 * np.pi * helix.turns * helix.radius
    place = helix.radius * np.array([np.cos(angle), np.sin(angle)])
    return place, rate * np.array([-np.sin(angle), np.cos(angle)])
