"""One direction of a space in which all are alike: the same one whatever rounding, modes and nodes are."""

from __future__ import annotations

import numpy as np

from cosserat_casadi.maths.typing import FloatArray

TIE = 1e-6
"""Relative difference below which two entries of a basis are equally large."""


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
