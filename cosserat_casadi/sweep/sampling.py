"""Which rows of a table stand for all of them: those nearest to its corners, and some at random."""

from __future__ import annotations

from itertools import product

import numpy as np

from cosserat_casadi.maths.typing import FloatArray

SEED = 20
"""Of the random rows: the same table gives the same sample."""

MOST_CORNERS = 3
"""Columns up to which every corner of the box of a table is looked for."""


def representative_rows(values: FloatArray, count: int) -> list[int]:
    """Rows that a discretisation is chosen on, ascending.

    Args:
        values: of the table, shape (rows, columns).
        count: rows wanted; two thirds may be corners, the others are drawn at random.
    """
    rng = np.random.default_rng(SEED)
    shares = _shares(values)
    dimension = shares.shape[1]
    if dimension <= MOST_CORNERS:
        corners = np.array(list(product((1.0, -1.0), repeat=dimension))).reshape(2**dimension, dimension)
    else:
        corners = rng.choice([-1.0, 1.0], (2**MOST_CORNERS, dimension))
    farthest = [int(np.argmax(shares @ corner)) for corner in corners[: max(1, 2 * count // 3)]]
    chosen = set(farthest)
    chosen.update(rng.permutation(len(values))[: max(0, count - len(chosen))].tolist())
    return sorted(chosen)


def _shares(values: FloatArray) -> FloatArray:
    """Columns that vary, each over its range, from -1 to 1."""
    low, high = values.min(axis=0), values.max(axis=0)
    varies = high > low
    shares: FloatArray = 2 * (values[:, varies] - low[varies]) / (high - low)[varies] - 1
    return shares
