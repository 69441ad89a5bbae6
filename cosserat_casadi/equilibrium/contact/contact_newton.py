"""Newton's method for rods in contact at unknown places.

Forces on a short stretch hardly affect the shape, so that their errors make a large residual although the shape is near
the solution: the residual is no measure of progress. Full steps are taken instead, after a first solve of shape and
forces with fixed places; a step is shortened only if it would squeeze an element. Steps end where they are no larger
than rounding, and not at a given residual: forces on a short stretch are less accurate than the shape by the cube of
its length, and the sign of a force tells whether it presses or pulls.
"""

from __future__ import annotations

import numpy as np

from cosserat_casadi.equilibrium.contact.contact_equations import ContactEquations
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.numerics.broyden import solved
from cosserat_casadi.numerics.newton import NewtonSettings, relative_norm

HELD_STEPS = 6
"""Most steps with fixed places."""

HELD_ENOUGH = 1e-6
"""Residual below which the places are released."""

MOST_STEPS = 25
"""Most steps with unknown places."""

SQUEEZED = 0.5
"""Share of its width that an element may lose in a step."""

COLLAPSED = 1e-4
"""Width of an element, over the length of the rod, below which its ends have met."""


def sought(equations: ContactEquations, start: FloatArray, settings: NewtonSettings) -> tuple[FloatArray, bool, int]:
    """Solve for shape, forces and places from a start.

    Args:
        equations: equations of one state.
        start: z, shape (n,).
        settings: settings, of which only the tolerance counts; steps end at rounding, not at the aim.

    Returns:
        the last z, whether it solves the equations, and the number of steps.
    """
    z, taken = _held(equations, start)
    if z is None:
        return start, False, taken
    best = z
    least = np.inf
    for _ in range(MOST_STEPS):
        residual = equations.residual(z, equations.given)
        norm = relative_norm(residual, z)
        if not np.isfinite(norm):
            break
        if max(least, norm) <= settings.tolerance and norm >= 0.5 * least:
            # Only rounding is left; forces that change much may enlarge a small residual once.
            break
        if least > settings.tolerance or norm < least:
            best = z
            least = norm
        if _widths(equations, z).min() < COLLAPSED:
            break
        step = solved(equations.jacobian(z, equations.given), -residual)
        if step is None:
            break
        z = z + _share(equations, z, step) * step
        taken += 1
    return best, bool(least <= settings.tolerance), taken


def _held(equations: ContactEquations, start: FloatArray) -> tuple[FloatArray | None, int]:
    """Shape and forces in equilibrium with contacts at fixed places, without the condition on the slope."""
    count = len(equations.state.places)
    size = len(start)
    known = np.arange(size - count)
    rows = np.setdiff1d(np.arange(size), equations.slope_rows)
    z = start.copy()
    for number in range(HELD_STEPS):
        residual = equations.residual(z, equations.given)[rows]
        if not np.isfinite(residual).all():
            return None, number
        if relative_norm(residual, z) <= HELD_ENOUGH:
            return z, number
        jacobian = equations.jacobian(z, equations.given)
        step = solved(jacobian[np.ix_(rows, known)], -residual)
        if step is None:
            return None, number
        z[known] += step
    return z, HELD_STEPS


def _widths(equations: ContactEquations, z: FloatArray) -> FloatArray:
    """Widths of the elements of all rods."""
    _, _, places = equations.parts(z)
    return np.concatenate([np.diff(equations.ends(rod, places)) for rod in equations.grids.rods])


def _share(equations: ContactEquations, z: FloatArray, step: FloatArray) -> float:
    """Largest share of a step in which no element loses too much of its width."""
    before = _widths(equations, z)
    lost = (before - _widths(equations, z + step)) / before
    return float(min(1.0, SQUEEZED / max(lost.max(), SQUEEZED)))
