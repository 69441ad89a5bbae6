"""Polynomials on the Chebyshev points of [0, 1]: nodes, derivatives, integrals, interpolation.

``N`` is the number of intervals. The ``N + 1`` Gauss–Lobatto points run from base to tip,
``X_j = (1 − cos(πj/N)) / 2``, ends included. Report appendix B has them from tip to base on [−1, 1]; here
``x = 2X − 1`` and every derivative carries ``dx/dX = 2``. Matrices act on columns of values at the points.
"""

from __future__ import annotations

from collections.abc import Callable
from math import fsum

import numpy as np
import numpy.typing as npt

from cosserat_casadi.maths.typing import FloatArray

_ROUNDING = 1e-12


def _check_intervals(N: int) -> None:
    """Refuse a number of intervals below one."""
    if N < 1:
        raise ValueError(f"at least one interval is needed, but N = {N}")


def _half_angle_sine(N: int, m: npt.NDArray[np.int_]) -> FloatArray:
    """The values sin(πm / 2N) for integers |m| ≤ 2N, to full relative accuracy."""
    size = np.abs(m)
    sines: FloatArray = np.sign(m) * np.sin(np.pi / (2 * N) * np.minimum(size, 2 * N - size))
    return sines


def _cosine_matrix(N: int) -> FloatArray:
    """The values cos(πjk/N) at row j, column k, from angles folded into [0, π/2]."""
    j = np.arange(N + 1)
    m = np.outer(j, j) % (2 * N)
    m = np.minimum(m, 2 * N - m)
    return _half_angle_sine(N, N - 2 * m)


def _differences(N: int) -> FloatArray:
    """The differences X_i − X_j without cancellation, and ones on the diagonal."""
    j = np.arange(N + 1)
    i = j[:, None]
    return _half_angle_sine(N, i + j) * _half_angle_sine(N, i - j) + np.eye(N + 1)


def nodes(N: int) -> FloatArray:
    """The Chebyshev points of [0, 1], base to tip: report (B.1) corrected and mapped.

    Args:
        N: number of intervals, at least 1.

    Returns:
        (N + 1,) increasing from 0 to 1, symmetric about ½ to rounding.
    """
    _check_intervals(N)
    j = np.arange(N + 1)
    nearer = _half_angle_sine(N, np.minimum(j, N - j)) ** 2
    return np.where(2 * j < N, nearer, np.where(2 * j == N, 0.5, 1 - nearer))


def barycentric_weights(N: int) -> FloatArray:
    """The weights of barycentric interpolation: (−1)^j, halved at both ends.

    Args:
        N: number of intervals, at least 1.

    Returns:
        (N + 1,).
    """
    _check_intervals(N)
    weights: FloatArray = np.where(np.arange(N + 1) % 2 == 0, 1.0, -1.0)
    weights[[0, -1]] /= 2
    return weights


def differentiation_matrix(N: int, order: int = 1) -> FloatArray:
    """The matrix that differentiates the interpolant with respect to X: report (B.13)–(B.17) corrected.

    Welfert's recursion over the orders, with differences of points from sines and each diagonal entry
    the negative sum of the others: constants have a zero derivative, and the error is the smallest known.

    Args:
        N: number of intervals, at least 1.
        order: order of the derivative, at least 1.

    Returns:
        (N + 1, N + 1).

    Raises:
        ValueError: ``N`` or ``order`` is below 1.
    """
    _check_intervals(N)
    if order < 1:
        raise ValueError(f"the order of a derivative is at least 1, but it is {order}")
    weights = barycentric_weights(N)
    ratios = weights / weights[:, None]
    differences = _differences(N)
    D = np.eye(N + 1)
    for k in range(1, order + 1):
        D = _with_zero_row_sums(k * (ratios * np.diag(D)[:, None] - D) / differences)
    return D


def _with_zero_row_sums(matrix: FloatArray) -> FloatArray:
    """The matrix with its diagonal replaced by the negative sum of the rest of each row."""
    np.fill_diagonal(matrix, 0.0)
    np.fill_diagonal(matrix, [-fsum(row) for row in matrix])
    return matrix


def interpolation_matrix(N: int, X: npt.ArrayLike) -> FloatArray:
    """The matrix from values at the points to values of the interpolant elsewhere, exact at the points.

    Args:
        N: number of intervals, at least 1.
        X: (n,) abscissae in [0, 1].

    Returns:
        (n, N + 1).

    Raises:
        ValueError: an abscissa outside [0, 1], where interpolation would be extrapolation.
    """
    at = np.atleast_1d(np.asarray(X, dtype=float))
    if not np.all((at >= -_ROUNDING) & (at <= 1 + _ROUNDING)):
        raise ValueError(f"abscissae lie between 0 and 1, but these are {at.tolist()}")
    gaps = at[:, None] - nodes(N)
    on_node = np.abs(gaps) < 1e-300
    terms: FloatArray = barycentric_weights(N) / np.where(on_node, 1.0, gaps)
    terms = np.where(on_node.any(axis=1, keepdims=True), on_node, terms)
    terms /= terms.sum(axis=1, keepdims=True)
    return terms


def quadrature_weights(N: int) -> FloatArray:
    """The weights of Clenshaw–Curtis quadrature on [0, 1].

    Args:
        N: number of intervals, at least 1.

    Returns:
        (N + 1,) positive, of sum 1; exact for polynomials up to degree N, N + 1 if N is even.
    """
    _check_intervals(N)
    k = np.arange(2, N + 1, 2)
    factors = np.where(k == N, 1.0, 2.0) / (k * k - 1.0)
    weights: FloatArray = (1 - _cosine_matrix(N)[:, k] @ factors) / N
    weights[[0, -1]] /= 2
    return weights


def integration_matrix(N: int) -> FloatArray:
    """The integrals from the base, ∫₀^{X_i}, of the interpolant of degree N through all points.

    Built from the antiderivative of each Chebyshev polynomial, in angles measured from the base so that
    the short integrals near it lose no digits.

    Args:
        N: number of intervals, at least 1.

    Returns:
        (N + 1, N + 1); the first row is zero, the last holds the quadrature weights.
    """
    _check_intervals(N)
    j = np.arange(N + 1)
    # ∫₀^φ cos kψ sin ψ dψ = sin²((k+1)φ/2)/(k+1) − sin²((k−1)φ/2)/(k−1), and x = −cos φ, dX = dx/2.
    squares = _half_angle_sine(N, np.outer(j, np.arange(N + 2)) % (2 * N)) ** 2
    upper = squares[:, j + 1] / (j + 1)
    lower = np.where(j == 1, 0.0, squares[:, np.abs(j - 1)] / np.where(j == 1, 1, j - 1))
    antiderivatives: FloatArray = (upper - lower) / 2
    return antiderivatives @ _cosine_transform(N)


def _cosine_transform(N: int) -> FloatArray:
    """The matrix from values at the points to coefficients of cos kφ, where x = −cos φ."""
    halves = np.ones(N + 1)
    halves[[0, -1]] = 0.5
    return np.outer(halves, halves) * _cosine_matrix(N) * (2 / N)


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
    return S[1:, 1:] - np.outer(S[1:, 0], weights[1:] / weights[0])


def chebyshev_polynomials(n: int, X: npt.ArrayLike) -> FloatArray:
    """The values of T₀ … T_{n−1} at 2X − 1: report (B.2) corrected, T_{k+1} = 2x T_k − T_{k−1}.

    Args:
        n: how many polynomials, at least 1.
        X: (m,) abscissae in [0, 1].

    Returns:
        (m, n).
    """
    return _recurrence(n, X, lambda k, x, now, before: 2 * x * now - before)


def legendre_polynomials(n: int, X: npt.ArrayLike) -> FloatArray:
    """The values of P₀ … P_{n−1} at 2X − 1 (report 2.4): (k+1) P_{k+1} = (2k+1) x P_k − k P_{k−1}.

    Args:
        n: how many polynomials, at least 1.
        X: (m,) abscissae in [0, 1].

    Returns:
        (m, n).
    """
    return _recurrence(n, X, lambda k, x, now, before: ((2 * k + 1) * x * now - k * before) / (k + 1))


def _recurrence(
    n: int,
    X: npt.ArrayLike,
    successor: Callable[[int, FloatArray, FloatArray, FloatArray], FloatArray],
) -> FloatArray:
    """Polynomials 1, x, … of x = 2X − 1, each made by ``successor(k, x, p_k, p_{k−1})``."""
    if n < 1:
        raise ValueError(f"at least one polynomial is needed, but n = {n}")
    x = 2 * np.atleast_1d(np.asarray(X, dtype=float)) - 1
    values = [np.ones_like(x), x]
    for k in range(1, n - 1):
        values.append(successor(k, x, values[k], values[k - 1]))
    return np.stack(values[:n], axis=1)


def chebyshev_coefficients(values: npt.ArrayLike) -> FloatArray:
    """The coefficients of the interpolant in T₀ … T_N of 2X − 1, from its values at the points.

    Args:
        values: (N + 1,) or (N + 1, m), base to tip, N at least 1.

    Returns:
        shaped as ``values``.
    """
    v = np.asarray(values, dtype=float)
    N = len(v) - 1
    _check_intervals(N)
    signs = np.where(np.arange(N + 1) % 2 == 0, 1.0, -1.0)
    coefficients: FloatArray = (signs[:, None] * _cosine_transform(N)) @ v
    return coefficients


def chebyshev_values(coefficients: npt.ArrayLike) -> FloatArray:
    """The values at the points of Σ coefficients[k] T_k(2X − 1): inverse of ``chebyshev_coefficients``.

    Args:
        coefficients: (N + 1,) or (N + 1, m), N at least 1.

    Returns:
        shaped as ``coefficients``, base to tip.
    """
    c = np.asarray(coefficients, dtype=float)
    N = len(c) - 1
    _check_intervals(N)
    signs = np.where(np.arange(N + 1) % 2 == 0, 1.0, -1.0)
    values: FloatArray = (_cosine_matrix(N) * signs) @ c
    return values
