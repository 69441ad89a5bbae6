"""The types that the mathematics takes and returns."""

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
"""One of CasADi's three types, for functions that return the type of their argument."""

Columns = TypeVar("Columns", ca.SX, ca.MX, ca.DM, Matrix, FloatArray)
"""Vectors side by side, one a column, in CasADi or in NumPy, for functions that return the type of their argument."""
