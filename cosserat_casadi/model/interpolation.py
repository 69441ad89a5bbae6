"""Values of a rod at any section, from those at its nodes."""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca
import numpy as np

from cosserat_casadi.maths import chebyshev
from cosserat_casadi.maths.numbers import Scalar, any_symbolic
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.model.discrete_scene import DiscreteScene


def interpolation_weights(discrete: DiscreteScene, rod: str, X: Matrix) -> Matrix:
    """Weights of the nodal values at X, M×1: Chebyshev series of the element that holds X."""
    grid = discrete.rods[rod].grid
    to_coefficients = chebyshev.chebyshev_coefficients(np.eye(grid.intervals + 1))
    rows = []
    for element in range(grid.elements):
        start, end = grid.places[element : element + 2]
        local = (X - start) / (end - start)
        weights = ca.DM(to_coefficients).T @ _chebyshev_values(grid.intervals, local)
        if grid.elements > 1:
            weights = _inside(grid.places, element, X) * weights
        rows.append(weights)
    return ca.vertcat(*rows)


def section_weights(discrete: DiscreteScene, rod: str, X: Sequence[float]) -> Matrix:
    """Weights of the nodal values at k known abscissae, M×k: numbers unless a parameter moves element ends."""
    grid = discrete.rods[rod].grid
    if any_symbolic(grid.places):
        return ca.horzcat(*[interpolation_weights(discrete, rod, ca.MX(abscissa)) for abscissa in X])
    return ca.sparsify(ca.DM(grid.interpolation_matrix(np.asarray(X, dtype=float)).T))


def _inside(breaks: tuple[Scalar, ...], element: int, X: Matrix) -> Matrix | int:
    """1 where X lies in the element, which owns its tip-side end, else 0."""
    above: Matrix | int = 1
    below: Matrix | int = 1
    # The first and the last element hold what lies before and beyond the rod: their polynomials extrapolate.
    if element > 0:
        above = breaks[element] < X
    if element + 2 < len(breaks):
        below = breaks[element + 1] >= X
    return above * below


def _chebyshev_values(degree: int, X: Matrix) -> Matrix:
    """Chebyshev polynomials on [0, 1] up to a degree at X, (degree + 1)×1, by their recurrence."""
    x = 2 * X - 1
    values = [ca.MX(1.0), x]
    for _ in range(degree - 1):
        following = 2 * x * values[-1] - values[-2]
        values.append(following)
    return ca.vertcat(*values[: degree + 1])
