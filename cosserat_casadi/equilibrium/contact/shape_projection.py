"""A solved shape on other elements: the start of a solve after contacts have moved, come or gone."""

from __future__ import annotations

import numpy as np

from cosserat_casadi.equilibrium.solution import Solution
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.unknowns import BlockKind


def projected(solution: Solution, model: Model) -> FloatArray:
    """Unknowns of a model with these rods on other elements, shape (model.size,): strains are fitted in each."""
    old = solution.model.discrete
    blocks = []
    for name, rod in model.discrete.rods.items():
        old_rod = old.rods[name]
        q = solution.x[old.unknowns.strain(name)]
        points = max(rod.discretisation.modes) + 2
        # Chebyshev points inside each element: a break belongs to neither side.
        local = (1 - np.cos(np.pi * (np.arange(points) + 0.5) / points)) / 2
        breaks = np.asarray(rod.grid.breaks)
        X = (breaks[:-1, None] + np.diff(breaks)[:, None] * local).ravel()
        element = np.repeat(np.arange(rod.grid.elements), points)
        old_element = old_rod.grid.element_of(X)
        for component in rod.columns:
            wanted = old_rod.shape_functions(component, X, old_element) @ q[old_rod.columns[component]]
            fitted, *_ = np.linalg.lstsq(rod.shape_functions(component, X, element), wanted, rcond=None)
            blocks.append(fitted)
    # Multipliers and tensions do not depend on the elements.
    blocks.append(solution.x[old.unknowns.count(BlockKind.STRAIN) :])
    return np.concatenate(blocks)
