"""Kinks of least-squares problems: surfaces in the unknowns over which residuals are continuous and derivatives jump.

Two states on either side of a kink have linear models r₁ + J₁ (x − x₁) and r₂ + J₂ (x − x₂), which are equal on it: so
J₁ − J₂ = u gᵀ has rank one, g is normal to the kink, and uᵀ of the difference of both models is zero there.
"""

from __future__ import annotations

import numpy as np

from cosserat_casadi.maths.typing import FloatArray

WEIGHT = 1e6
"""Weight of the row that keeps a step on a kink, relative to the rows of the block."""


def kink_row(here: FloatArray, there: FloatArray, change: FloatArray, scales: FloatArray) -> FloatArray:
    """The row of a linear model that is zero on the kink between two states, shape (1, 1 + n).

    Args:
        here: residual and derivatives at one state, shape (m, 1 + n).
        there: residual and derivatives at the other state, shape (m, 1 + n).
        change: change of the unknowns, from here to there, shape (n,).
        scales: sizes of the derivatives by each unknown, shape (n,).
    """
    jump = here - there
    jump[:, 0] += there[:, 1:] @ change
    directions, sizes, _ = np.linalg.svd(jump[:, 1:] / scales)
    row = directions[:, :1].T @ jump
    if sizes[0] == 0.0:
        return np.zeros_like(row)
    return np.asarray(WEIGHT * float(np.linalg.norm(here[:, 1:] / scales)) / sizes[0] * row)
