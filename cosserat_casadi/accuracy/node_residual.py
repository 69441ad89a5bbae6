"""What polynomials cannot see: the balance of stress at the nodes, where the equations only balance its moments.

Loads of fixed direction go round in the frame of a section that turns: over an element that turns by T the strain may
oscillate with T/(2π) waves. Legendre coefficients of such a wave are nil up to a degree of about T/2, so with fewer
modes nothing shows in the last coefficients, however wrong the rod is.
"""

from __future__ import annotations

from math import ceil

import numpy as np

from cosserat_casadi.equilibrium.solution import Solution
from cosserat_casadi.maths.numbers import known

BEYOND = 2
"""Modes beyond T/2 from which on the coefficients of a wave show."""


def node_residual(solution: Solution) -> float:
    """Largest strain by which stress and internal wrench differ at the nodes; curvatures times the length."""
    largest = 0.0
    for name, discrete_rod in solution.model.discrete.rods.items():
        X = known(discrete_rod.grid.nodes)
        rod = discrete_rod.properties
        fields = solution.model.fields[name](solution.x, solution.inputs)
        wrench = fields[2].full().T
        hooke = rod.hooke(X)
        strain = solution.strain(X, name) - rod.intrinsic_strain(X)
        for component in rod.admitted:
            stress_strain = wrench[:, component] / hooke[:, component]
            difference = stress_strain - strain[:, component]
            # Components 0 to 2 are curvatures, in 1/m; the others have no unit.
            unit = rod.length if component < 3 else 1.0
            largest = max(largest, float(np.abs(difference).max()) * unit)
    return largest


def min_modes(solution: Solution, turn: float, tolerance: float) -> int:
    """Modes for each strain from which on the last coefficients tell how well a rod is resolved; 0 where any do.

    Args:
        solution: an equilibrium of the discrete model.
        turn: largest turn of an element, rad.
        tolerance: strain that does not matter.
    """
    needed = ceil(turn / 2) + BEYOND
    fewest = min(min(d.modes) for d in solution.model.discretisation.values())
    # Within one turn there is no whole wave to miss.
    if fewest >= needed or turn <= 2 * np.pi:
        return 0
    if node_residual(solution) <= tolerance:
        return 0
    return needed
