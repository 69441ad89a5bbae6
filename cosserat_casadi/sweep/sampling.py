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
    scaled = _scaled(values)
    columns = scaled.shape[1]
    if columns <= MOST_CORNERS:
        signs = list(product((1.0, -1.0), repeat=columns))
        corners = np.array(signs).reshape(2**columns, columns)
    else:
        corners = rng.choice([-1.0, 1.0], (2**MOST_CORNERS, columns))
    most_corners = max(1, 2 * count // 3)
    # Nearest to a corner is what lies farthest in its direction.
    chosen = {int(np.argmax(scaled @ corner)) for corner in corners[:most_corners]}
    drawn = rng.permutation(len(values)).tolist()
    missing = max(0, count - len(chosen))
    chosen.update(drawn[:missing])
    return sorted(chosen)


def _scaled(values: FloatArray) -> FloatArray:
    """Columns that vary, each over its range, from -1 to 1."""
    low = values.min(axis=0)
    high = values.max(axis=0)
    varies = high > low
    width = (high - low)[varies]
    scaled: FloatArray = 2 * (values[:, varies] - low[varies]) / width - 1
    return scaled
