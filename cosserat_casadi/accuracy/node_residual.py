"""The residual that polynomials cannot see: the balance of stress at nodes, where equations only balance its moments.

Loads of fixed direction go round in the frame of a section that turns: over an element that turns by T the strain may
oscillate with T/(2π) waves. Legendre coefficients of such a wave are nil up to a degree of about T/2, so with fewer
modes nothing shows in the last coefficients, however wrong the rod is.
"""

from __future__ import annotations

from math import ceil

import numpy as np

from cosserat_casadi.equilibrium.solution import Solution
from cosserat_casadi.maths.numbers import known
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.rod.material_functions import stress_beyond_hooke

BEYOND = 2
"""Modes beyond T/2 from which on the coefficients of a wave show."""


def node_residual(solution: Solution) -> float:
    """Largest strain by which stress and internal wrench differ at the nodes; curvatures times the length."""
    largest = 0.0
    for name, discrete_rod in solution.model.discrete.rods.items():
        X = known(discrete_rod.grid.nodes)
        rod = discrete_rod.properties
        fields = solution.model.fields[name](solution.x, solution.inputs)
        wrench = fields[2].full().T - _stress_beyond_hooke(solution, name)
        hooke = rod.hooke(X)
        strain = solution.strain(X, name) - rod.intrinsic_strain(X)
        for component in rod.admitted:
            stress_strain = wrench[:, component] / hooke[:, component]
            difference = stress_strain - strain[:, component]
            # Components 0 to 2 are curvatures, in 1/m; the others have no unit.
            unit = rod.length if component < 3 else 1.0
            largest = max(largest, float(np.abs(difference).max()) * unit)
    return largest


def _stress_beyond_hooke(solution: Solution, name: str) -> FloatArray:
    """Stress of the material at the nodes beyond its Hooke tensor's, shape (nodes, 6), N m and N."""
    discrete_rod = solution.model.discrete.rods[name]
    law = discrete_rod.properties.beyond_hooke
    X = known(discrete_rod.grid.nodes)
    if law is None:
        return np.zeros((len(X), 6))
    data = known(law.data(X)).T
    stress = stress_beyond_hooke(law, len(data)).map(len(X))
    changes = solution.strain(X, name) - discrete_rod.properties.intrinsic_strain(X)
    return np.asarray(stress(changes.T, data).full().T)


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
