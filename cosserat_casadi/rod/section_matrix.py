"""Stiffness and viscosity of a rod in its strain coordinates: sums over Gauss points of the elements, report (2.14).

An element that is drawn out by its rate m has the strain Φ q / m along m times its nominal length: its coefficients are
divided by m.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import casadi as ca
import numpy as np

from cosserat_casadi.maths.grid import gauss_legendre
from cosserat_casadi.maths.numbers import (
    Numbers,
    any_symbolic,
    as_matrix,
    column,
    each_times,
    is_symbolic,
    known,
    product,
    reciprocal,
    repeated,
    without_rounding,
)
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.rod.properties import Field

if TYPE_CHECKING:
    from cosserat_casadi.rod.strain import DiscreteRod


def section_matrix(rod: DiscreteRod, diagonal: Field) -> Numbers:
    """ℓ ∫ Φᵀ D Φ dX divided by EI/ℓ for coefficients D of the six strains, shape (n, n)."""
    points = [_gauss_points(rod, e) for e in range(rod.grid.elements)]
    coefficients = [_per_reference_length(rod, diagonal, e, X) for e, (X, _) in enumerate(points)]
    if any_symbolic(coefficients):
        return _symbolic_section_matrix(rod, coefficients)
    result = np.zeros((rod.size, rod.size))
    for e, (X, weight) in enumerate(points):
        weighted = known(coefficients[e]) * weight[:, None]
        element = np.full(len(X), e)
        # Strains do not couple: the tensor is diagonal, and so are its blocks.
        for c, columns in rod.columns.items():
            phi = rod.shape_functions(c, X, element)
            result[columns, columns] += phi.T @ (weighted[:, [c]] * phi)
    return without_rounding(result)


def _gauss_points(rod: DiscreteRod, element: int) -> tuple[FloatArray, FloatArray]:
    """Places of an element in the grid's coordinate, shape (k,), and the weights ℓ w / (EI/ℓ) of a sum over them.

    Enough for the product of two polynomials with a section stiffness of degree four.
    """
    points, weights = gauss_legendre(max(rod.discretisation.modes) + 8)
    start, end = rod.grid.breaks[element : element + 2]
    width = end - start
    X = start + width * (points + 1) / 2
    lengths = weights * width / 2 * rod.length
    return X, lengths / rod.energy_unit


def _per_reference_length(rod: DiscreteRod, diagonal: Field, element: int, X: FloatArray) -> Numbers:
    """Coefficients for strains per reference length at places of an element, shape (k, 6) or one row for all."""
    elements = np.full(len(X), element)
    coefficients = diagonal(rod.grid.on_rod(X, elements))
    rate = rod.grid.rates_in(elements)
    if rate is None:
        return coefficients
    if is_symbolic(rate) and not is_symbolic(coefficients):
        same = coefficients == coefficients[:1]
        coefficients = coefficients[:1] if np.all(same) else coefficients
    # One row for all times the one rate of the element.
    return each_times(coefficients, reciprocal(rate[: coefficients.shape[0]]))


def _symbolic_section_matrix(rod: DiscreteRod, by_element: Sequence[Numbers]) -> Numbers:
    """The section matrix where coefficients are expressions; its entries are linear in the coefficients."""
    points = [_gauss_points(rod, e) for e in range(rod.grid.elements)]
    element = np.repeat(np.arange(rod.grid.elements), [len(X) for X, _ in points])
    X = np.concatenate([X for X, _ in points])
    weights = np.concatenate([weight for _, weight in points])
    uniform = all(part.shape[0] == 1 for part in by_element)
    by_row = None
    if uniform and rod.ends is None:
        # One row stands for all points of all elements.
        coefficients = as_matrix(by_element[0])
    elif uniform:
        # One row stands for all points of its element.
        coefficients = ca.vertcat(*map(as_matrix, by_element))
        by_row = (element[:, None] == np.arange(rod.grid.elements)).astype(float)
    else:
        rows = [repeated(part, len(own)) for part, (own, _) in zip(by_element, points, strict=True)]
        coefficients = ca.vertcat(*map(as_matrix, rows))
    blocks = []
    for c in rod.columns:
        phi = rod.shape_functions(c, X, element)
        # One column a point: the product of two modes there, for every pair of modes.
        pairs = (phi[:, :, None] * phi[:, None, :] * weights[:, None, None]).reshape(len(X), -1).T
        if by_row is not None:
            pairs = without_rounding(pairs @ by_row)
        own = column(coefficients, c)
        size = phi.shape[1]
        blocks.append(ca.reshape(product(pairs, own), size, size))
    matrix = ca.diagcat(*blocks)
    # Parameters may be of strains alone that the rod does not have.
    return matrix if is_symbolic(matrix) else ca.DM(matrix).full()
