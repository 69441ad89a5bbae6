"""The types that the mathematics takes and returns."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, TypeAlias

import casadi as ca
import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    # CasADi's stubs have an overload for each of the three types but none for their union.
    Matrix: TypeAlias = Any
else:
    Matrix: TypeAlias = ca.SX | ca.MX | ca.DM
"""A CasADi matrix: scalar symbolic, matrix symbolic or numeric."""

FloatArray: TypeAlias = npt.NDArray[np.float64]
"""A NumPy array of 64-bit floats."""
