"""The form in which a Jacobian is printed by columns: what computes one computes four in the lanes of a vector."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from cosserat_casadi.compiling.listing import LANES
from cosserat_casadi.maths.typing import FloatArray


@dataclass(frozen=True)
class ColumnForm:
    """A Jacobian, or some entries of one, by the columns of one rod.

    Attributes:
        function: (arguments, …, columns, turns) ↦ (results, …, column). The column follows from the turns,
            and the results from the matrix of all columns, one row of it after the other.
        turns: constant turns of all columns, shape (entries, stride), with zeros behind the last one.
        rows: rows of the matrix of columns.
        turns_behind: None, or number of constants behind which the turns stand in the argument before the columns,
            as :func:`in_groups` orders them; they may then differ from call to call.
    """

    function: ca.Function
    turns: FloatArray
    rows: int
    turns_behind: int | None = None

    @property
    def stride(self) -> int:
        """Columns of that matrix, a multiple of LANES."""
        return int(self.turns.shape[1])

    @property
    def columns_argument(self) -> int:
        """Number of the argument with the matrix of columns."""
        number: int = self.function.n_in() - 2
        return number

    @property
    def turns_argument(self) -> int:
        """Number of the argument with the turns of one column."""
        number: int = self.function.n_in() - 1
        return number


def in_groups(turns: FloatArray) -> FloatArray:
    """The turns of LANES columns after those of the LANES before, one entry of the group after the other."""
    entries, stride = turns.shape
    return turns.reshape(entries, stride // LANES, LANES).transpose(1, 0, 2).ravel()
