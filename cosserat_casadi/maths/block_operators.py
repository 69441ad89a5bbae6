"""Block operators on fields, stacked component by component.

A field of m components at k points is one column of m·k entries: the first component at all points, then the
second. A matrix that acts point by point is then a sparse m×n arrangement of diagonal blocks; products with it cost
only its entries. The points are the nodes of a grid, or the intervals between them.
"""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca
import numpy as np

from cosserat_casadi.maths.grid import Indices
from cosserat_casadi.maths.numbers import without_rounding
from cosserat_casadi.maths.typing import AnyMatrix, FloatArray, Matrix


def stack(field: AnyMatrix) -> AnyMatrix:
    """Column of m·k entries from an m×k field."""
    return ca.vec(field.T)


def unstack(column: AnyMatrix, components: int) -> AnyMatrix:
    """The m×k field of a column of m·k entries."""
    return ca.reshape(column, -1, components).T


def block_diagonal(blocks: Matrix, pattern: ca.Sparsity) -> Matrix:
    """Operator that multiplies the field by another matrix at each point.

    Args:
        blocks: the matrices side by side, m×(n·k), every one with the sparsity ``pattern``.
        pattern: m×n sparsity of one block.

    Returns:
        (m·k)×(n·k), acting on stacked fields.
    """
    rows_of_block, columns_of_block = pattern.shape
    points = blocks.size2() // columns_of_block
    shape = (rows_of_block * points, columns_of_block * points)
    if pattern.nnz() == 0:
        return ca.DM(*shape)
    block_rows, block_columns = (np.asarray(indices) for indices in pattern.get_triplet())
    # CasADi may have dropped structural zeros: here zeros are entries like any other.
    blocks = ca.project(blocks, ca.repmat(pattern, 1, points))
    # Entry (r, c) of the block of a point stands in the diagonal block (r, c), on the row of that point.
    point = np.repeat(np.arange(points), pattern.nnz())
    rows = np.tile(block_rows, points) * points + point
    columns = np.tile(block_columns, points) * points + point
    # CasADi sorts by columns; `order` says which entry went where.
    sparsity, order = ca.Sparsity.triplet(
        *shape,
        rows.tolist(),
        columns.tolist(),
        False,
    )
    entries = ca.vec(blocks.nz[order])
    return type(blocks)(sparsity, entries)


def hat_operator(field: AnyMatrix) -> AnyMatrix:
    """Operator v ↦ field × v on stacked fields, from a 3×k field: (3k)×(3k), report (A.4) at every point."""
    return hat_blocks(*(ca.diag(row) for row in ca.vertsplit(field)))


def hat_blocks(x: AnyMatrix, y: AnyMatrix, z: AnyMatrix) -> AnyMatrix:
    """The matrix v^ of a vector, report (A.4), with blocks for the components of the vector."""
    zero = type(x)(*x.shape)
    rows = [
        [zero, -z, y],
        [z, zero, -x],
        [-y, x, zero],
    ]
    return ca.blockcat(rows)


def summed(terms: Sequence[Matrix]) -> Matrix | None:
    """Sum of the terms in their order; None without any."""
    return sum(terms[1:], terms[0]) if terms else None


def sum_of_products(*factors: tuple[Matrix, Matrix]) -> Matrix:
    """Sum of products, each added to the ones before while it is formed."""
    patterns = [ca.mtimes(left.sparsity(), right.sparsity()) for left, right in factors]
    pattern = patterns[0]
    for other in patterns[1:]:
        pattern = pattern + other
    total: Matrix = ca.DM(pattern, 0.0)
    for left, right in factors:
        total = ca.mac(left, right, total)
    return total


def with_product(total: Matrix, left: Matrix, right: Matrix) -> Matrix:
    """A sum plus a product left right, which is added while it is formed."""
    pattern = total.sparsity() + ca.mtimes(left.sparsity(), right.sparsity())
    added: Matrix = ca.mac(left, right, ca.project(total, pattern))
    return added


def cumulative_sum(columns: AnyMatrix, points: int) -> AnyMatrix:
    """Cumulative sums over the points of stacked fields, one field in each column."""
    # Made dense first: CasADi 3.8.2 sums a sparse MX wrongly.
    parts = ca.vertsplit(columns, points)
    sums = [ca.cumsum(ca.densify(part), 0) for part in parts]
    return ca.vertcat(*sums)


def reversed_places(columns: AnyMatrix, points: int) -> AnyMatrix:
    """Stacked fields with the points in reverse order."""
    parts = ca.vertsplit(columns, points)
    turned = [part[::-1, :] for part in parts]
    return ca.vertcat(*turned)


def mirror_factors(matrix: FloatArray, mirror: Indices, signs: FloatArray, parities: FloatArray) -> tuple[ca.DM, ca.DM]:
    """Factors (fold, half) with foldᵀ half = matrix, where products with even and odd columns cost half.

    Row mirror[r] of column j is signs[r]·parities[j] times its row r. Even columns multiply signed sums of mirrored
    rows, odd columns their differences: ``fold`` forms both, ``half`` has the entries, without zeros by rounding. See
    the end of docs/theory.md, section 7.

    Args:
        matrix: k×n.
        mirror: the row that mirrors each row, an involution, shape (k,).
        signs: 1 or −1, the same for both of a pair, shape (k,).
        parities: 1 for an even column, −1 for an odd one, shape (n,).

    Returns:
        fold and half, sparse.
    """
    rows = np.arange(len(matrix))
    first = rows[rows < mirror]
    second = mirror[first]
    middle = rows[rows == mirror]
    pair_signs = signs[first]
    even = parities > 0
    mirrored = pair_signs[:, None] * matrix[second]
    # Half of the sum is the even part of a column, half of the difference the odd part: the other part is rounding and
    # dropped.
    sums = (matrix[first] + mirrored) / 2 * even
    differences = (matrix[first] - mirrored) / 2 * ~even
    # A row that mirrors itself is zero in the columns of the other parity.
    own_parity = signs[middle, None] == parities
    own = matrix[middle] * own_parity
    half = without_rounding(np.vstack([sums, differences, own]))
    return _fold(first, second, pair_signs, middle), sparse(half)


def sparse(matrix: FloatArray) -> ca.DM:
    """A matrix without its zeros; far faster than through a dense one where it is large."""
    rows, columns = np.nonzero(matrix)
    entries = ca.DM(matrix[rows, columns])
    return ca.DM.triplet(
        rows.tolist(),
        columns.tolist(),
        entries,
        *matrix.shape,
    )


def _fold(first: Indices, second: Indices, signs: FloatArray, middle: Indices) -> ca.DM:
    """Signed sums of mirrored rows, then their differences, then the rows that mirror themselves.

    Args:
        first: the first row of every pair, shape (p,).
        second: the row that mirrors it, shape (p,).
        signs: 1 or −1 of every pair, shape (p,).
        middle: the rows that mirror themselves, shape (s,).

    Returns:
        (2p + s)×(2p + s).
    """
    pairs = len(first)
    count = 2 * pairs + len(middle)
    sums = np.arange(pairs)
    differences = pairs + sums
    own = np.arange(2 * pairs, count)
    one_a_pair = np.ones(pairs)
    one_a_middle = np.ones(len(middle))
    rows = np.concatenate([sums, sums, differences, differences, own])
    columns = np.concatenate([first, second, first, second, middle])
    entries = np.concatenate([one_a_pair, signs, one_a_pair, -signs, one_a_middle])
    return ca.DM.triplet(
        rows.tolist(),
        columns.tolist(),
        ca.DM(entries),
        count,
        count,
    )
