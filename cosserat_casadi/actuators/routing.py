"""Routing of actuators through the sections of a rod."""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np
from numpy.polynomial import polynomial

from cosserat_casadi import scene as scenes
from cosserat_casadi.maths.grid import Grid
from cosserat_casadi.maths.numbers import (
    Numbers,
    Scalar,
    any_symbolic,
    as_matrix,
    as_vector,
    is_same,
    is_symbolic,
    known,
    power_table,
    stacked_rows,
)
from cosserat_casadi.maths.typing import FloatArray, Matrix
from cosserat_casadi.rod.cable import Routing
from cosserat_casadi.rod.straight_cable import HoleRouting


def routing(actuator: Any, grid: Grid) -> Routing:
    """Routing of a tendon or a chamber through the nodes of its span."""
    nodes = grid.nodes_in(*actuator.span)
    offset, slope = offset_at(actuator, grid.nodes_at(nodes))
    return Routing(nodes, offset, slope)


def holes(actuator: Any) -> tuple[Scalar, ...] | None:
    """Abscissae of the holes of a tendon that is straight between them, its entry first; None for a continuous one."""
    inside = getattr(actuator, "holes", None)
    if inside is None:
        return None
    start, end = actuator.span
    return (start, *(at for at in inside if not (is_same(at, start) or is_same(at, end))), end)


def drawn_places(actuator: Any, samples: FloatArray) -> FloatArray:
    """Abscissae at which the course of an actuator is drawn: its holes, or samples of its span, shape (k,)."""
    through = holes(actuator)
    if through is not None:
        return known(as_vector(through))
    start, end = actuator.span
    return np.asarray(start + (end - start) * samples)


def straight_routing(actuator: Any, grid: Grid, friction: Matrix | None = None) -> HoleRouting:
    """Holes of a tendon that is straight between them; ``friction``: μ p of a tendon with friction."""
    through = holes(actuator)
    assert through is not None, "asked for of a tendon with holes"
    nodes = np.array([grid.node_at(at) for at in through])
    offset, _ = offset_at(actuator, as_vector(through))
    return HoleRouting(nodes, offset, friction)


def offset_at(actuator: Any, X: Numbers) -> tuple[Numbers, Numbers]:
    """Offset D and its derivative dD/dX at any abscissae, shape (2, k) each, m."""
    helix = getattr(actuator, "helix", None)
    if helix is not None:
        return _helix(helix, X)
    return _polynomial(actuator.offset, X)


def span_ends(actuator: Any) -> tuple[Scalar, ...]:
    """Abscissae of an actuator's beginning and end, at which the stress jumps."""
    start, end = actuator.span
    return (start, end)


def _polynomial(offset: Any, X: Numbers) -> tuple[Numbers, Numbers]:
    """Polynomials of X and their derivatives, shape (2, k) each, m."""
    values: list[Numbers] = []
    slopes: list[Numbers] = []
    for component in offset:
        if any_symbolic([component]) or (is_symbolic(X) and isinstance(component, tuple)):
            powers = as_matrix(as_vector(component if isinstance(component, tuple) else (component,)))
            degree = powers.shape[0] - 1
            table = as_matrix(power_table(degree + 1, X))
            values.append(table @ powers)
            if degree:
                rates = table[:, :-1] @ ca.diag(ca.DM(np.arange(1, degree + 1)))
                slopes.append((rates if is_symbolic(rates) else ca.sparsify(rates)) @ powers[1:])
            else:
                slopes.append(ca.MX(X.shape[0], 1))
            continue
        coefficients = np.atleast_1d(np.asarray(component, dtype=float))
        if is_symbolic(X):
            values.append(np.full(X.shape[0], coefficients[0]))
            slopes.append(np.zeros(X.shape[0]))
            continue
        # A constant polynomial gives one number, which is repeated for all abscissae.
        abscissae = known(X)
        values.append(polynomial.polyval(abscissae, coefficients) + 0.0 * abscissae)
        slopes.append(polynomial.polyval(abscissae, polynomial.polyder(coefficients)) + 0.0 * abscissae)
    return stacked_rows(values), stacked_rows(slopes)


def _helix(helix: scenes.Helix, X: Numbers) -> tuple[Numbers, Numbers]:
    """A helix of constant pitch and its derivative, shape (2, k) each, m."""
    angular_rate = 2 * np.pi * helix.turns
    angle = angular_rate * X + helix.phase
    trigonometry: Any = ca if is_symbolic(angle) else np
    sine = trigonometry.sin(angle)
    cosine = trigonometry.cos(angle)
    outward = stacked_rows([cosine, sine])
    around = stacked_rows([-sine, cosine])
    rate = angular_rate * helix.radius
    return helix.radius * outward, rate * around
