"""Shapes of matrices, checked where they enter a record: CasADi broadcasts scalars in silence."""

from __future__ import annotations

from cosserat_casadi.maths.typing import FloatArray, Matrix


def check_shape(name: str, matrix: Matrix | FloatArray, rows: int | None, columns: int | None) -> None:
    """Refuse a matrix of another shape than wanted.

    Args:
        name: what the matrix is, for the message.
        matrix: CasADi or NumPy.
        rows: number of rows; None admits any.
        columns: number of columns; None admits any.

    Raises:
        ValueError: the shape differs, or a NumPy array has not two axes.
    """
    shape = matrix.shape
    # Only NumPy has arrays of another number of axes.
    if len(shape) == 2:
        rows_agree = rows in (None, shape[0])
        columns_agree = columns in (None, shape[1])
        if rows_agree and columns_agree:
            return
    wanted_rows = "n" if rows is None else rows
    wanted_columns = "k" if columns is None else columns
    raise ValueError(f"{name} is {wanted_rows}×{wanted_columns}, but its shape is {shape}")
