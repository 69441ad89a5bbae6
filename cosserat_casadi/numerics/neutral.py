"""Directions that symmetry leaves neutral: inverses that move nothing along them, and one direction among them."""

from __future__ import annotations

import numpy as np

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.numerics.broyden import SINGULAR

TIE = 1e-6
"""Relative difference below which two entries of a basis are equally large."""


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


def direction_in(basis: FloatArray, leading: int | None = None) -> FloatArray:
    """The direction of a space that is nearest to the largest coordinate in it, which grows along it.

    A basis of eigenvectors or singular vectors is known but for rotations in the space, for one vector but for its
    sign; this direction does not hang on them.

    Args:
        basis: orthonormal, one vector a column, shape (n, k).
        leading: number of coordinates that are looked at; by default all.

    Returns:
        unit vector, shape (n,).
    """
    sizes = np.linalg.norm(basis[:leading], axis=1)
    # The first of equals: which of two alike entries is larger by rounding must not decide.
    among_largest = sizes >= (1 - TIE) * sizes.max()
    largest = int(np.argmax(among_largest))
    direction = basis @ basis[largest]
    length = np.linalg.norm(direction)
    return np.asarray(direction / length)
