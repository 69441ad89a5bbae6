"""What polynomials cannot see: the balance of stress at the nodes, where the equations only balance its moments.

Loads of fixed direction go round in the frame of a section that turns: over an element that turns by T the strain may
oscillate with T/(2π) waves. Legendre coefficients of such a wave are nil up to a degree of about T/2, so with fewer
modes nothing shows in the last coefficients, however wrong the rod is.
"""

from __future__ import annotations

from math import ceil

import numpy as np

from cosserat_casadi.equilibrium.solution import Solution

BEYOND = 2
"""Modes beyond T/2 from which on the coefficients of a wave show."""


def node_residual(solution: Solution) -> float:
    """Largest strain by which stress and internal wrench differ at the nodes; curvatures times the length."""
    largest = 0.0
    for name, discrete_rod in solution.model.discrete.rods.items():
        X, rod = discrete_rod.grid.nodes, discrete_rod.properties
        wrench = solution.model.fields[name](solution.x, solution.inputs)[2].full().T
        strain = solution.strain(X, name) - rod.intrinsic_strain(X)
        for c in rod.admitted:
            missing = wrench[:, c] / rod.hooke(X)[:, c] - strain[:, c]
            largest = max(largest, float(np.abs(missing).max()) * (rod.length if c < 3 else 1.0))
    return largest


def modes_to_see(solution: Solution, turn: float, tolerance: float) -> int:
    """Modes for each strain from which on the last coefficients tell how well a rod is resolved; 0 where any do.

    Args:
        solution: an equilibrium of the discrete model.
        turn: largest turn of an element, rad.
        tolerance: strain that does not matter.
    """
    wanted = ceil(turn / 2) + BEYOND
    fewest = min(min(d.modes) for d in solution.model.discretisation.values())
    return wanted if fewest < wanted and turn > 2 * np.pi and node_residual(solution) > tolerance else 0
