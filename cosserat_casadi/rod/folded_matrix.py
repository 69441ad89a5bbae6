"""Matrices whose rows mirror each other, so that products with them cost half.

Polynomials of a strain are even or odd about the middle of their element, and the grid mirrors itself there. A product
with such a matrix needs the even columns for the sums of mirrored rows alone, and the odd ones for their differences;
docs/theory.md section 7, end.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import casadi as ca

from cosserat_casadi.maths.block_operators import mirror_factors
from cosserat_casadi.maths.grid import Indices
from cosserat_casadi.maths.typing import FloatArray, Matrix


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
