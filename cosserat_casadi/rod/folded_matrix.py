"""Matrices whose rows mirror each other, so that products with them cost half.

Polynomials of a strain are even or odd about the middle of their element, and the grid mirrors itself there. A product
with such a matrix needs the even columns for the sums of mirrored rows alone, and the odd ones for their differences;
docs/theory.md section 7, end.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache, cached_property

import casadi as ca
import numpy as np
import numpy.typing as npt

from cosserat_casadi.maths.block_operators import mirror_factors
from cosserat_casadi.maths.calls import KEPT
from cosserat_casadi.maths.grid import Indices
from cosserat_casadi.maths.typing import FloatArray, Matrix

Mirrored = npt.NDArray[np.bool_]


@dataclass(frozen=True)
class FoldedMatrix:
    """The matrix foldᵀ half, k×n.

    Attributes:
        fold: sums and differences of mirrored rows, k×k.
        half: the entries that are not zero by parity, k×n.
    """

    fold: ca.DM
    half: ca.DM

    def __matmul__(self, columns: Matrix) -> Matrix:
        """Product with columns, n×m."""
        return self.fold.T @ (self.half @ columns)

    def __mul__(self, factor: float) -> FoldedMatrix:
        """The matrix times a number."""
        return FoldedMatrix(self.fold, self.half * factor)

    def __truediv__(self, divisor: float) -> FoldedMatrix:
        """The matrix divided by a number."""
        return FoldedMatrix(self.fold, self.half / divisor)

    @property
    def T(self) -> FoldedTranspose:
        """The transpose, n×k."""
        return FoldedTranspose(self)

    @cached_property
    def unfolded(self) -> ca.DM:
        """The matrix itself, k×n."""
        return self.fold.T @ self.half

    @cached_property
    def unfold(self) -> ca.Function:
        """The map (half, column) ↦ foldᵀ half column."""
        return _kernels(*self._pattern)[0]

    @cached_property
    def fold_in(self) -> ca.Function:
        """The map (half, column) ↦ halfᵀ fold column."""
        return _kernels(*self._pattern)[1]

    @property
    def _pattern(self) -> tuple[tuple[int, ...], tuple[float, ...], tuple[int, ...]]:
        fold = self.fold
        return tuple(fold.sparsity().compress()), tuple(fold.nonzeros()), tuple(self.half.sparsity().compress())

    def first_columns(self, count: int) -> FoldedMatrix:
        """The matrix of the first columns."""
        return FoldedMatrix(self.fold, self.half[:, :count])


@dataclass(frozen=True)
class FoldedTranspose:
    """The transpose of a folded matrix.

    Attributes:
        matrix: the matrix, k×n.
    """

    matrix: FoldedMatrix

    def __matmul__(self, columns: Matrix) -> Matrix:
        """Product with columns, k×m."""
        return self.matrix.half.T @ (self.matrix.fold @ columns)


@dataclass(frozen=True)
class FoldedAxes:
    """Folded matrices of several axes, as one matrix on fields that are stacked axis by axis, order after order.

    Generated code calls one function for products with matrices of equal pattern: their numbers are an argument. About
    one axis there is one product, which is written where it stands.

    Attributes:
        matrices: of each axis, k×n.
        orders: parts of the rows of each matrix.
    """

    matrices: Sequence[FoldedMatrix]
    orders: int

    def joined(self, size: int) -> FoldedMatrix:
        """The one matrix, with columns of zeros up to so many."""
        if not self.matrices:
            return FoldedMatrix(ca.DM(0, 0), ca.DM(0, size))
        rows = len(self.matrices) * [self.matrices[0].fold.shape[0]]
        places = np.arange(sum(rows)).reshape(len(rows), self.orders, -1).swapaxes(0, 1)
        fold = ca.diagcat(*[matrix.fold for matrix in self.matrices])[:, places.ravel().tolist()]
        half = ca.diagcat(*[matrix.half for matrix in self.matrices])
        return FoldedMatrix(fold, ca.horzcat(half, ca.DM(half.shape[0], size - half.shape[1])))

    def times(self, column: Matrix) -> Matrix:
        """Product with a column of the entries of all axes, axis after axis."""
        if len(self.matrices) == 1:
            return self.matrices[0] @ column[: self.matrices[0].half.shape[1]]
        products = []
        start = 0
        for matrix in self.matrices:
            end = start + matrix.half.shape[1]
            product = matrix.unfold(matrix.half, column[start:end])
            products.append(ca.vertsplit(product, product.shape[0] // self.orders))
            start = end
        stacked: Matrix = ca.vertcat(*[of_axis[order] for order in range(self.orders) for of_axis in products])
        return stacked

    def transposed_times(self, stacked: Matrix) -> Matrix:
        """Product of the transpose with one stacked field, a column."""
        if len(self.matrices) == 1:
            return self.matrices[0].T @ stacked
        count = len(self.matrices)
        parts = ca.vertsplit(stacked, stacked.shape[0] // (count * self.orders))
        columns = [ca.vertcat(*parts[axis::count]) for axis in range(count)]
        products = [own.fold_in(own.half, column) for own, column in zip(self.matrices, columns, strict=True)]
        every: Matrix = ca.vertcat(*products)
        return every


def folded(matrix: FloatArray, mirror: Indices, signs: FloatArray, parities: FloatArray) -> FoldedMatrix:
    """A matrix whose rows mirror each other.

    Args:
        matrix: k×n; row mirror[r] of column j is signs[r]·parities[j] times its row r.
        mirror: the row that mirrors each row, shape (k,).
        signs: 1 or −1, the same for both rows of a pair, shape (k,).
        parities: 1 for an even column, −1 for an odd one, shape (n,).
    """
    fold, half = mirror_factors(matrix, mirror, signs, parities)
    return FoldedMatrix(fold, half)


@cache
def _kernels(fold: tuple[int, ...], signs: tuple[float, ...], half: tuple[int, ...]) -> tuple[ca.Function, ca.Function]:
    """Products with a folded matrix of these patterns, and with its transpose: one function for all such matrices."""
    first, second, middle, mirrored = _pairs(ca.DM(ca.Sparsity.compressed(fold), signs).full())
    entries = ca.MX.sym("half", ca.Sparsity.compressed(half))
    modes, rows = ca.MX.sym("modes", entries.shape[1]), ca.MX.sym("rows", entries.shape[0])
    # Rows that mirror each other with a change of sign change their parts in sums and differences.
    count = len(first)
    swapped = np.where(mirrored, 0, count) + np.arange(count)
    kept = np.where(mirrored, count, 0) + np.arange(count)
    ahead, behind = rows[first.tolist()], rows[second.tolist()]
    both = ca.vertcat(ahead + behind, ahead - behind)
    parts = both[np.concatenate([kept, swapped]).tolist()] if count else both
    folded_rows = ca.vertcat(parts, rows[middle.tolist()])
    product = entries @ modes
    halves, own = ca.vertsplit(product, [0, 2 * count, entries.shape[0]])
    sums, differences = halves[:count], halves[count:]
    mirror = halves[kept.tolist()] - halves[swapped.tolist()] if count else halves
    order = np.argsort(np.concatenate([first, second, middle]))
    unfolded = ca.vertcat(sums + differences, mirror, own)[order.tolist()]
    # The numbers are constants of a rod.
    words = ["half", "column"], ["product"], {**KEPT, "is_diff_in": [False, True]}
    unfold = ca.Function("unfold", [entries, modes], [unfolded], *words)
    return unfold, ca.Function("fold", [entries, rows], [entries.T @ folded_rows], *words)


def _pairs(fold: FloatArray) -> tuple[Indices, Indices, Indices, Mirrored]:
    """The first and the second row of each pair, rows that mirror themselves, and which pairs change their sign."""
    paired = np.count_nonzero(fold, axis=1) == 2
    count = np.count_nonzero(paired) // 2
    first = np.argmax(fold != 0, axis=1)
    second = fold.shape[1] - 1 - np.argmax(fold[:, ::-1] != 0, axis=1)
    sums = np.arange(count)
    return first[sums], second[sums], first[~paired], fold[sums, second[sums]] < 0
