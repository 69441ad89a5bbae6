"""Block operators on fields, stacked component by component.

A field of m components at k places is one column of m·k entries: the first component at all places, then the
second. A matrix that acts place by place is then a sparse m×n arrangement of diagonal blocks; products with it cost
only its entries.
"""

from __future__ import annotations

import casadi as ca
import numpy as np
import numpy.typing as npt

from cosserat_casadi.maths.typing import FloatArray, Matrix


def stack(field: Matrix) -> Matrix:
    """Column of m·k entries from an m×k field."""
    return ca.vec(field.T)


def unstack(column: Matrix, components: int) -> Matrix:
    """The m×k field of a column of m·k entries."""
    return ca.reshape(column, -1, components).T


def block_diagonal(blocks: Matrix, pattern: ca.Sparsity) -> Matrix:
    """Operator that acts at each place by a matrix of its own.

    Args:
        blocks: the matrices side by side, m×(n·k), every one with the sparsity ``pattern``.
        pattern: m×n sparsity of one block.

    Returns:
        (m·k)×(n·k), acting on stacked fields.
    """
    places = blocks.size2() // pattern.size2()
    if pattern.nnz() == 0:
        return ca.DM(pattern.size1() * places, pattern.size2() * places)
    r, c = (np.asarray(indices) for indices in pattern.get_triplet())
    place = np.repeat(np.arange(places), len(r))
    rows = np.tile(r, places) * places + place
    columns = np.tile(c, places) * places + place
    shape = (pattern.size1() * places, pattern.size2() * places)
    sparsity, order = ca.Sparsity.triplet(*shape, rows.tolist(), columns.tolist(), False)
    return type(blocks)(sparsity, ca.vec(blocks.nz[order]))


def hat_operator(field: Matrix) -> Matrix:
    """Operator v ↦ field × v on stacked fields, from a 3×k field: (3k)×(3k)."""
    x, y, z = (ca.diag(row) for row in ca.vertsplit(field))
    zero = type(x)(x.shape[0], x.shape[0])
    return ca.blockcat([[zero, -z, y], [z, zero, -x], [-y, x, zero]])


def cumulative_sum(columns: Matrix, places: int) -> Matrix:
    """Running sums over the places of stacked fields, one field a column.

    Made dense first: CasADi 3.8.2 sums a sparse MX wrongly.
    """
    return ca.vertcat(*[ca.cumsum(ca.densify(part), 0) for part in ca.vertsplit(columns, places)])


def reversed_places(columns: Matrix, places: int) -> Matrix:
    """Stacked fields with the order of the places turned round."""
    parts = ca.vertsplit(columns, places)
    return ca.vertcat(*[part[::-1, :] for part in parts])


def mirror_factors(
    matrix: FloatArray, mirror: npt.NDArray[np.int64], signs: FloatArray, parities: FloatArray
) -> tuple[ca.DM, ca.DM]:
    """Factors (fold, half) with foldᵀ half = matrix, where products with even and odd columns cost half.

    Row mirror[r] of column j is signs[r]·parities[j] times its row r. Even columns meet signed sums of mirrored rows,
    odd ones differences: ``fold`` forms both, ``half`` holds the entries, without what is not zero by rounding alone.

    Args:
        matrix: k×n.
        mirror: the row that mirrors each row, an involution, shape (k,).
        signs: 1 or −1, the same for both of a pair, shape (k,).
        parities: 1 for an even column, −1 for an odd one, shape (n,).

    Returns:
        fold and half, sparse.
    """
    rows = np.arange(len(matrix))
    first, middle = rows[rows < mirror], rows[rows == mirror]
    second, sign = mirror[first], signs[first, None]
    identity, even = np.eye(len(matrix)), parities > 0
    fold = [identity[first] + sign * identity[second], identity[first] - sign * identity[second], identity[middle]]
    half = [
        (matrix[first] + sign * matrix[second]) / 2 * even,
        (matrix[first] - sign * matrix[second]) / 2 * ~even,
        matrix[middle] * (signs[middle, None] == parities),
    ]
    return ca.sparsify(ca.DM(np.vstack(fold))), ca.sparsify(ca.DM(np.vstack(half)))
