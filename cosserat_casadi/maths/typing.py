"""Types of matrices that the mathematics takes and returns, and a check of their shapes.

Shapes are checked as matrices enter a record, since CasADi broadcasts scalars silently.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeAlias, TypeVar

import casadi as ca
import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    # The common base of SX, MX and DM in tests/stubs: CasADi's own stubs have no type for "any of the three".
    from casadi import Matrix as Matrix
else:
    Matrix: TypeAlias = ca.SX | ca.MX | ca.DM
"""A CasADi matrix: scalar symbolic, matrix symbolic or numeric."""

FloatArray: TypeAlias = npt.NDArray[np.float64]
"""A NumPy array of 64-bit floats."""

AnyMatrix = TypeVar("AnyMatrix", ca.SX, ca.MX, ca.DM, Matrix)
"""Any of CasADi's three types, for functions that return the type of their argument."""

Columns = TypeVar("Columns", ca.SX, ca.MX, ca.DM, Matrix, FloatArray)
"""Vectors side by side, one a column, in CasADi or in NumPy, for functions that return the type of their argument."""


def check_shape(name: str, matrix: Matrix | FloatArray, rows: int | None, columns: int | None) -> None:
    """Refuse a matrix with another shape.

    Args:
        name: what the matrix is, for the message.
        matrix: CasADi or NumPy.
        rows: number of rows; None admits any.
        columns: number of columns; None admits any.

    Raises:
        ValueError: the shape differs, or a NumPy array has not two axes.
    """
    shape = matrix.shape
    # Only NumPy has arrays with other numbers of axes.
    if len(shape) == 2:
        rows_agree = rows in (None, shape[0])
        columns_agree = columns in (None, shape[1])
        if rows_agree and columns_agree:
            return
    wanted_rows = "n" if rows is None else rows
    wanted_columns = "k" if columns is None else columns
    raise ValueError(f"{name} is {wanted_rows}×{wanted_columns}, but its shape is {shape}")
