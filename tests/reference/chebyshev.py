"""Appendix B and chapter 3 of the report, beyond what the package needs: more matrices on the Chebyshev points."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from cosserat_casadi.maths.chebyshev import barycentric_weights, check_intervals, integration_matrix
from cosserat_casadi.maths.typing import FloatArray


def backward_integration_matrix(N: int) -> FloatArray:
    """The integrals to the tip, ∫_{X_i}¹, of the interpolant of degree N through all points.

    Args:
        N: number of intervals, at least 1.

    Returns:
        (N + 1, N + 1); the last row is zero, the first holds the quadrature weights.
    """
    return integration_matrix(N)[::-1, ::-1].copy()


def collocation_integration_matrix(N: int) -> FloatArray:
    """The inverse of D_NN of report (3.16), known at the base, without inverting anything.

    Integrates from the base the interpolant of degree N − 1 through the points 1 … N. The base value of
    that polynomial follows from the others: the N-th divided difference of all N + 1 values vanishes.

    Args:
        N: number of intervals, at least 1.

    Returns:
        (N, N), rows and columns for the points 1 … N.
    """
    S = integration_matrix(N)
    weights = barycentric_weights(N)
    base_value = weights[1:] / weights[0]
    return S[1:, 1:] - np.outer(S[1:, 0], base_value)


def chebyshev_values(coefficients: npt.ArrayLike) -> FloatArray:
    """The values at the points of Σ coefficients[k] T_k(2X − 1): inverse of ``chebyshev_coefficients``.

    Args:
        coefficients: (N + 1,) or (N + 1, m), N at least 1.

    Returns:
        shaped as ``coefficients``, base to tip.
    """
    c = np.asarray(coefficients, dtype=float)
    N = len(c) - 1
    check_intervals(N)
    # T_k(2X_j − 1) = (−1)^k cos(πjk/N), with the angle taken modulo a turn.
    k = np.arange(N + 1)
    turns = np.outer(k, k) % (2 * N)
    signs = np.where(k % 2 == 0, 1.0, -1.0)
    values: FloatArray = (np.cos(np.pi / N * turns) * signs) @ c
    return values
