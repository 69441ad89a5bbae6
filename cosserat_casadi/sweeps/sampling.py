"""Representative rows of a table: the rows nearest to its corners, and some random rows."""

from __future__ import annotations

from itertools import product

import numpy as np
import numpy.typing as npt

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.sweeps.scratch import MEMORY, Scratch

SEED = 20
"""Seed of the draw of random rows: the same table gives the same sample."""

MOST_CORNERS = 3
"""Most columns for which every corner of the box of a table is searched."""


def representative_rows(values: FloatArray, count: int, scratch: Scratch = MEMORY) -> list[int]:
    """Indices of the rows on which a discretisation is chosen, ascending.

    Args:
        values: values of the table, shape (rows, columns).
        count: number of rows; two thirds may be corners, the rest are drawn at random.
        scratch: storage of the values.
    """
    rng = np.random.default_rng(SEED)
    low, high = column_ends(values, scratch)
    # Varying columns, each over its range.
    varies = np.flatnonzero(high > low)
    columns = len(varies)
    if columns <= MOST_CORNERS:
        signs = list(product((1.0, -1.0), repeat=columns))
        corners = np.array(signs).reshape(2**columns, columns)
    else:
        corners = rng.choice([-1.0, 1.0], (2**MOST_CORNERS, columns))
    most_corners = max(1, 2 * count // 3)
    directions = np.zeros((len(corners[:most_corners]), values.shape[1]))
    directions[:, varies] = corners[:most_corners]
    # The row that is farthest in the direction of a corner is nearest to it.
    chosen = set(farthest_rows(values, directions, low, high - low, scratch))
    missing = min(max(0, count - len(chosen)), len(values))
    # A permutation of all rows would need memory for each row.
    chosen.update(rng.choice(len(values), missing, replace=False).tolist())
    return sorted(chosen)


def column_ends(values: FloatArray, scratch: Scratch) -> tuple[FloatArray, FloatArray]:
    """Least and largest value of each column."""
    low = np.full(values.shape[1], np.inf)
    high = -low
    for block in scratch.blocks(len(values)):
        low = np.minimum(low, values[block].min(axis=0))
        high = np.maximum(high, values[block].max(axis=0))
    return low, high


def farthest_rows(
    values: FloatArray, directions: FloatArray, origin: FloatArray, units: FloatArray, scratch: Scratch
) -> list[int]:
    """Index of the row that is farthest in each direction, the first one of several.

    Args:
        values: shape (rows, columns).
        directions: shape (k, columns).
        origin: origin of the columns, shape (columns,).
        units: units of the columns, shape (columns,); a column that does not vary has unit 0.
        scratch: storage of the values.
    """
    lengths = np.where(units > 0.0, units, 1.0)
    farthest = np.full(len(directions), -np.inf)
    rows = np.zeros(len(directions), dtype=np.int64)
    for block in scratch.blocks(len(values)):
        scaled = (values[block] - origin) / lengths
        along = scaled @ directions.T
        best = along.argmax(axis=0)
        reached = along[best, np.arange(len(directions))]
        ahead = reached > farthest
        farthest = np.where(ahead, reached, farthest)
        rows = np.where(ahead, block.start + best, rows)
    return [int(row) for row in rows]


def from_neighbour_to_neighbour(values: FloatArray) -> npt.NDArray[np.int64]:
    """An order of a few rows, beginning with the first, in which the nearest remaining row follows each.

    Args:
        values: shape (rows, columns).
    """
    spread = np.ptp(values, axis=0)
    scaled = values / np.where(spread > 0.0, spread, 1.0)
    order = np.zeros(len(values), np.int64)
    left = np.arange(1, len(values))
    for place in range(1, len(values)):
        squares = np.square(scaled[left] - scaled[order[place - 1]]).sum(axis=1)
        nearest = int(squares.argmin())
        order[place] = left[nearest]
        left = np.delete(left, nearest)
    return order
