"""Matrices with directions that symmetry leaves neutral, and their inverses that move nothing along these."""

from __future__ import annotations

import numpy as np

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.numerics.broyden import SINGULAR


def regular(matrix: FloatArray) -> FloatArray:
    """A square matrix with a stiffness, as large as its largest one, in the directions in which it has none."""
    left, singular, right = np.linalg.svd(matrix)
    largest = float(singular.max(initial=0.0))
    neutral = singular <= SINGULAR * largest
    return np.asarray(matrix + largest * left[:, neutral] @ right[neutral])


def regular_inverse(matrix: FloatArray) -> FloatArray:
    """The inverse of :func:`regular`, without singular values where the matrix is regular by far."""
    try:
        inverse = np.linalg.inv(matrix)
    except np.linalg.LinAlgError:
        return np.asarray(np.linalg.inv(regular(matrix)))
    # Norms of Frobenius are above the largest singular values, of the matrix and of its inverse.
    if np.linalg.norm(matrix) * np.linalg.norm(inverse) < 1.0 / SINGULAR:
        return np.asarray(inverse)
    return np.asarray(np.linalg.inv(regular(matrix)))
