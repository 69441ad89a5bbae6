"""Numbers that are known, or expressions of parameters: common functions for NumPy arrays and CasADi's MX.

Known numbers stay NumPy, to the last bit; a number that depends on a parameter is an MX. A vector of k numbers is an
array of shape (k,) or an MX of shape (k, 1), a table an array or an MX of shape (k, m).
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, TypeAlias

import casadi as ca
import numpy as np
import numpy.typing as npt
from numpy.polynomial import legendre, polynomial

from cosserat_casadi.maths.typing import FloatArray, Matrix

if TYPE_CHECKING:
    from typing_extensions import TypeIs

Numbers: TypeAlias = FloatArray | Matrix
"""Numbers that are known, or expressions of parameters."""

Scalar: TypeAlias = float | Matrix
"""A number that is known, or an expression of parameters."""

ROUNDING = 1e-15
"""Share of the largest entry below which an entry is zero by orthogonality."""

SAME = 1e-14
"""Relative difference of equal entries by rounding in linear algebra."""


IndexArray: TypeAlias = npt.NDArray[np.int64]


def is_symbolic(value: object) -> TypeIs[Matrix]:
    """Whether a value is an expression."""
    return isinstance(value, ca.MX)


def is_same(one: Scalar, other: Scalar) -> bool:
    """Whether two numbers are equal; an expression equals only an identical expression."""
    if is_symbolic(one) or is_symbolic(other):
        return is_symbolic(one) and is_symbolic(other) and bool(ca.is_equal(one, other))
    return bool(one == other)


def any_symbolic(values: Iterable[object]) -> bool:
    """Whether there is an expression among values, or in a sequence among them."""
    for value in values:
        if isinstance(value, ca.MX):
            return True
        if isinstance(value, tuple | list) and any_symbolic(value):
            return True
    return False


def known(numbers: Numbers) -> FloatArray:
    """Numbers without parameters, as an array."""
    assert isinstance(numbers, np.ndarray), "asked for where no parameter is free"
    return numbers


def entries(vector: Numbers) -> list[Scalar]:
    """The entries of a vector."""
    if is_symbolic(vector):
        return list(ca.vertsplit(vector))
    return list(map(float, known(vector)))


def least(values: Sequence[Scalar]) -> Scalar:
    """The least of some values."""
    return ca.mmin(ca.vertcat(*values)) if any_symbolic(values) else min(values)


def largest(values: Sequence[Scalar]) -> Scalar:
    """The largest of some values."""
    return ca.mmax(ca.vertcat(*values)) if any_symbolic(values) else max(values)


def is_zero(value: Scalar | Numbers | Sequence[Scalar]) -> bool:
    """Whether all numbers are known to be zero."""
    if isinstance(value, tuple | list):
        return all(is_zero(entry) for entry in value)
    if isinstance(value, ca.MX | ca.SX | ca.DM):
        return bool(value.nnz() == 0)
    return not np.any(np.asarray(value))


def as_matrix(numbers: Numbers) -> Matrix:
    """Numbers as a CasADi matrix; a vector is a column."""
    if isinstance(numbers, ca.MX | ca.SX | ca.DM):
        return numbers
    return ca.DM(numbers)


def as_vector(values: Sequence[Scalar]) -> Numbers:
    """Scalars as a vector; if one is an expression, zeros are not stored."""
    if not any_symbolic(values):
        return np.asarray(values, dtype=float)
    entries = [value if isinstance(value, ca.MX) else ca.sparsify(ca.DM(value)) for value in values]
    return ca.vertcat(*entries)


def side_by_side(columns: Sequence[Numbers]) -> Numbers:
    """Vectors of one length as the columns of a table."""
    if not any_symbolic(columns):
        return np.stack([known(own) for own in columns], axis=-1)
    # Zeros are not stored.
    return ca.horzcat(*[own if is_symbolic(own) else ca.sparsify(as_matrix(own)) for own in columns])


def column(table: Numbers, index: int) -> Numbers:
    """A column of a table, as a vector."""
    return table[:, index]


def rows_of(table: Numbers) -> list[Numbers]:
    """The rows of a table, each as a vector."""
    if is_symbolic(table):
        return [row.T for row in ca.vertsplit(table)]
    return list(known(table))


def stacked_rows(rows: Sequence[Numbers]) -> Numbers:
    """Vectors of one length as the rows of a table."""
    if any_symbolic(rows):
        return side_by_side(rows).T
    return np.stack([known(row) for row in rows])


def among(table: Numbers, columns: Sequence[int] | IndexArray, count: int) -> Numbers:
    """A table with ``count`` columns: the given columns at their indices, zeros elsewhere."""
    if is_symbolic(table):
        chosen = ca.sparsify(ca.DM(np.eye(count)[np.asarray(columns)]))
        return as_matrix(repeated(table.T, len(columns))).T @ chosen
    whole = np.zeros((table.shape[0], count))
    whole[:, columns] = known(table)
    return whole


def columns_times(table: Numbers, factors: Numbers) -> Numbers:
    """A table, each column times a factor."""
    if not any_symbolic([table, factors]):
        return known(table) * known(factors)
    count = table.shape[1]
    return as_matrix(table) @ ca.diag(as_matrix(repeated(factors, count)))


def row_times(factors: Numbers, numbers: Numbers) -> Numbers:
    """A vector, each entry times a factor; one expression for all entries is repeated."""
    if not any_symbolic([factors, numbers]):
        return np.asarray(known(factors) * known(numbers))
    return as_matrix(factors) * as_matrix(numbers)


def each_times(numbers: Numbers, factors: Numbers | None) -> Numbers:
    """A vector, or each column of a table, entry by entry times factors, shape (k,); unchanged without factors."""
    if factors is None or is_zero(numbers):
        return numbers
    if not any_symbolic([numbers, factors]):
        own = known(numbers)
        return own * known(factors).reshape(-1, *[1] * (own.ndim - 1))
    table = as_matrix(repeated(numbers, factors.shape[0]))
    return ca.horzcat(*[part * as_matrix(factors) for part in ca.horzsplit(table)])


def reciprocal(numbers: Numbers | None) -> Numbers | None:
    """The reciprocal of each entry; None for None."""
    if numbers is None:
        return None
    return 1 / numbers


def repeated(numbers: Numbers, count: int) -> Numbers:
    """A vector of ``count`` entries; a single entry is repeated."""
    if numbers.shape[0] != 1 or count == 1:
        return numbers
    if is_symbolic(numbers):
        return ca.repmat(numbers, count, 1)
    return np.repeat(known(numbers), count)


def product(linear_map: FloatArray, numbers: Numbers) -> Matrix:
    """A known matrix times a vector, with as few multiplications as the expressions allow.

    Args:
        linear_map: shape (m, k).
        numbers: shape (k,); or one expression that stands for all k.
    """
    if is_symbolic(numbers) and not ca.symvar(numbers):
        # A column of a table of expressions may be known all the same.
        numbers = repeated(ca.evalf(numbers).full()[:, 0], linear_map.shape[1])
    if not is_symbolic(numbers):
        return ca.sparsify(ca.DM(without_rounding(linear_map @ known(numbers))))
    if numbers.shape[0] == 1 and linear_map.shape[1] != 1:
        total = without_rounding(linear_map.sum(axis=1))
        return ca.sparsify(ca.DM(total)) * numbers
    affine = _affine(numbers)
    if affine is None:
        return ca.sparsify(ca.DM(linear_map)) @ numbers
    symbol, constant, slope = affine
    # The product of the known matrices is known: one multiplication for each parameter is left.
    columns = (linear_map @ slope).T
    by_symbol = np.stack([without_rounding(own) for own in columns], axis=-1)
    at_zero = without_rounding(linear_map @ constant)
    return ca.sparsify(ca.DM(at_zero)) + ca.sparsify(ca.DM(by_symbol)) @ symbol


def sparse_known(entries: Matrix) -> Matrix:
    """Entries that are known, without rounding and zeros; expressions as they are."""
    return ca.sparsify(ca.DM(without_rounding(entries.full()))) if isinstance(entries, ca.DM) else entries


def without_rounding(entries: FloatArray, noise: float = ROUNDING) -> FloatArray:
    """Entries, made equal where rounding alone makes them differ, so that their expressions can be shared.

    Entries that are rounding errors beside the largest one are zero: orthogonal polynomials leave them. Entries whose
    sizes differ by rounding alone take the size of the middle one, or a whole number: symmetric rows leave them.

    Args:
        entries: of any shape.
        noise: share of the largest entry below which an entry is zero.
    """
    # Large matrices are nearly all zeros.
    places = np.flatnonzero(entries)
    values = entries.ravel()[places]
    sizes = np.abs(values)
    order = np.argsort(sizes)
    ascending = sizes[order]
    largest = ascending[-1:].max(initial=0.0)
    before = np.concatenate([[-1.0], ascending[:-1]])
    with np.errstate(invalid="ignore"):
        # Not "above": what is no finite number is like no other, and stays as it is.
        begins = np.flatnonzero(~(ascending - before <= SAME * before))
    counts = np.diff(begins, append=len(ascending))
    middle = ascending[begins + counts // 2]
    whole = np.round(middle)
    with np.errstate(invalid="ignore"):
        middle = np.where(np.abs(middle - whole) <= SAME * middle, whole, middle)
    sizes[order] = np.repeat(middle, counts)
    sizes[sizes < noise * largest] = 0.0
    equal = np.zeros(entries.size)
    # No zero is a negative one.
    equal[places] = np.copysign(sizes, values) + 0.0
    return equal.reshape(entries.shape)


def _affine(numbers: Matrix) -> tuple[Matrix, FloatArray, FloatArray] | None:
    """The symbol p, constant and slope of numbers that are constant + slope p; None where they are not affine."""
    symbols = ca.symvar(numbers)
    if len(symbols) != 1:
        return None
    (symbol,) = symbols
    if any(ca.which_depends(numbers, symbol, 2, False)):
        return None
    at_zero = ca.Function("numbers", [symbol], [numbers, ca.jacobian(numbers, symbol)])
    constant, slope = at_zero(0)
    return symbol, constant.full()[:, 0], slope.full()


def legendre_table(count: int, X: Numbers) -> Numbers:
    """The values of P₀ … P_{n−1} at 2X − 1, shape (len(X), n): (k+1) P_{k+1} = (2k+1) x P_k − k P_{k−1}."""
    if not is_symbolic(X):
        return np.asarray(legendre.legvander(2 * known(X) - 1, count - 1), dtype=float)
    x = 2 * X - 1
    columns: list[Matrix] = [ca.DM.ones(X.shape[0], 1), x]
    for k in range(1, count - 1):
        columns.append(((2 * k + 1) * x * columns[k] - k * columns[k - 1]) / (k + 1))
    return ca.horzcat(*columns[:count])


def power_table(count: int, X: Numbers) -> Numbers:
    """The values of 1, X … X^{n−1}, shape (len(X), n)."""
    if not is_symbolic(X):
        return np.asarray(polynomial.polyvander(known(X), count - 1), dtype=float)
    columns: list[Matrix] = [ca.DM.ones(X.shape[0], 1)]
    for _ in range(1, count):
        columns.append(columns[-1] * X)
    return ca.horzcat(*columns)
