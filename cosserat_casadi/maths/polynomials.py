"""Polynomials along a rod at abscissae that are numbers, or expressions where elements move with parameters."""

from __future__ import annotations

import casadi as ca
import numpy as np
from numpy.polynomial import legendre, polynomial

from cosserat_casadi.maths.numbers import Numbers, is_symbolic, known
from cosserat_casadi.maths.typing import Matrix


def legendre_table(count: int, X: Numbers) -> Numbers:
    """The values of P₀ … P_{n−1} at 2X − 1, shape (len(X), n): (k+1) P_{k+1} = (2k+1) x P_k − k P_{k−1}."""
    if not is_symbolic(X):
        return np.asarray(legendre.legvander(2 * known(X) - 1, count - 1), dtype=float)
    x = 2 * X - 1
    columns: list[Matrix] = [ca.DM.ones(X.shape[0], 1), x]
    for k in range(1, count - 1):
        columns.append(((2 * k + 1) * x * columns[k] - k * columns[k - 1]) / (k + 1))
    return ca.horzcat(*columns[:count])


def power_table(count: int, X: Numbers) -> Numbers:
    """The values of 1, X … X^{n−1}, shape (len(X), n)."""
    if not is_symbolic(X):
        return np.asarray(polynomial.polyvander(known(X), count - 1), dtype=float)
    columns: list[Matrix] = [ca.DM.ones(X.shape[0], 1)]
    for _ in range(1, count):
        columns.append(columns[-1] * X)
    return ca.horzcat(*columns)
