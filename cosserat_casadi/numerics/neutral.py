"""Directions that symmetry leaves neutral: inverses that do not move along them, and the choice of one of them."""

from __future__ import annotations

import numpy as np

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.numerics.broyden import SINGULAR

TIE = 1e-6
"""Relative difference below which two entries of a basis are equally large."""


def regular(matrix: FloatArray) -> FloatArray:
    """Add the largest singular value of a square matrix as stiffness in its neutral directions."""
    left, singular, right = np.linalg.svd(matrix)
    largest = float(singular.max(initial=0.0))
    neutral = singular <= SINGULAR * largest
    return np.asarray(matrix + largest * left[:, neutral] @ right[neutral])


def regular_inverse(matrix: FloatArray) -> FloatArray:
    """Invert the matrix of :func:`regular`, without singular values if the matrix is clearly regular."""
    try:
        inverse = np.linalg.inv(matrix)
    except np.linalg.LinAlgError:
        return np.asarray(np.linalg.inv(regular(matrix)))
    # Norms of Frobenius are above the largest singular values, of the matrix and of its inverse.
    if np.linalg.norm(matrix) * np.linalg.norm(inverse) < 1.0 / SINGULAR:
        return np.asarray(inverse)
    return np.asarray(np.linalg.inv(regular(matrix)))


def direction_in(basis: FloatArray, leading: int | None = None) -> FloatArray:
    """Choose the direction of a space that is nearest to the axis of its largest coordinate.

    A basis of eigenvectors or singular vectors is unique up to rotations in the space, or up to the sign of a single
    vector; the chosen direction does not depend on these.

    Args:
        basis: orthonormal vectors as columns, shape (n, k).
        leading: number of leading coordinates that are compared; by default all.

    Returns:
        the unit vector, shape (n,).
    """
    sizes = np.linalg.norm(basis[:leading], axis=1)
    # The first of equals: which of two alike entries is larger by rounding must not decide.
    among_largest = sizes >= (1 - TIE) * sizes.max()
    largest = int(np.argmax(among_largest))
    direction = basis @ basis[largest]
    length = np.linalg.norm(direction)
    return np.asarray(direction / length)


def kept_by(constraints: FloatArray, share: float) -> FloatArray:
    """Orthonormal basis of the changes of n unknowns that keep constraints, shape (n, k).

    Args:
        constraints: rows of linear constraints, shape (m, n).
        share: singular value over the largest one up to which a constraint counts as dependent on others.
    """
    _, singular, rows = np.linalg.svd(constraints)
    rank = int(np.sum(singular > share * singular.max(initial=0.0)))
    return np.asarray(rows[rank:].T)
