"""Polynomials on the Chebyshev points of [0, 1]: nodes, derivatives, integrals, interpolation.

``N`` is the number of intervals. The ``N + 1`` Gauss–Lobatto points run from base to tip,
``X_j = (1 − cos(πj/N)) / 2``, ends included. Report appendix B has them from tip to base on [−1, 1]; here
``x = 2X − 1`` and every derivative carries ``dx/dX = 2``. Matrices act on columns of values at the points.
See docs/theory.md, sections 3 and 13 (the errata of appendix B).

All cosines are made from sines of small angles: near the ends of [0, 1] the points lie as close as 1/N², and a
difference of two cosines would lose as many digits.
"""

from __future__ import annotations

from functools import lru_cache
from math import fsum

import numpy as np
import numpy.typing as npt
from numpy.polynomial import chebyshev

from cosserat_casadi.maths.numbers import without_rounding
from cosserat_casadi.maths.typing import FloatArray

# How far an abscissa may lie outside [0, 1], and below what distance it is taken for a point.
_ROUNDING = 1e-12
_SAME_POINT = 1e-300


def check_intervals(N: int) -> None:
    """Refuse a number of intervals below one."""
    if N < 1:
        raise ValueError(f"at least one interval is needed, but N = {N}")


def _half_angle_sine(N: int, m: npt.NDArray[np.int_]) -> FloatArray:
    """The values sin(πm / 2N) for integers |m| ≤ 2N, to full relative accuracy."""
    size = np.abs(m)
    # Folded into [0, π/2], where the sine of a rounded angle is as exact as the angle.
    folded = np.minimum(size, 2 * N - size)
    step = np.pi / (2 * N)
    return np.asarray(np.sign(m) * np.sin(step * folded))


def _cosine_matrix(N: int) -> FloatArray:
    """The values cos(πjk/N) at row j, column k, from angles folded into [0, π/2]."""
    j = np.arange(N + 1)
    m = np.outer(j, j) % (2 * N)
    folded = np.minimum(m, 2 * N - m)
    # cos α = sin(π/2 − α)
    return _half_angle_sine(N, N - 2 * folded)


def _differences(N: int) -> FloatArray:
    """The differences X_i − X_j without cancellation, and ones on the diagonal."""
    j = np.arange(N + 1)
    i = j[:, None]
    # (cos a − cos b) / 2 = sin((a + b)/2) sin((b − a)/2)
    of_sum = _half_angle_sine(N, i + j)
    of_difference = _half_angle_sine(N, i - j)
    return of_sum * of_difference + np.eye(N + 1)


def nodes(N: int) -> FloatArray:
    """The Chebyshev points of [0, 1], base to tip: report (B.1) corrected and mapped.

    Args:
        N: number of intervals, at least 1.

    Returns:
        (N + 1,) increasing from 0 to 1, symmetric about ½ to rounding.
    """
    check_intervals(N)
    j = np.arange(N + 1)
    # (1 − cos α) / 2 = sin²(α/2), measured from the nearer end.
    from_nearer_end = _half_angle_sine(N, np.minimum(j, N - j)) ** 2
    points = np.where(2 * j < N, from_nearer_end, 1 - from_nearer_end)
    points[2 * j == N] = 0.5
    return points


def barycentric_weights(N: int) -> FloatArray:
    """The weights of barycentric interpolation: (−1)^j, halved at both ends.

    Args:
        N: number of intervals, at least 1.

    Returns:
        (N + 1,).
    """
    check_intervals(N)
    j = np.arange(N + 1)
    weights: FloatArray = np.where(j % 2 == 0, 1.0, -1.0)
    weights[[0, -1]] /= 2
    return weights


def differentiation_matrix(N: int, order: int = 1) -> FloatArray:
    """The matrix that differentiates the interpolant with respect to X: report (B.13)–(B.17) corrected.

    Recursion over the orders (B. D. Welfert, SIAM J. Numer. Anal. 34 (1997) 1640), with differences of points from
    sines and each diagonal entry the negative sum of the others (R. Baltensperger, M. R. Trummer, SIAM J. Sci.
    Comput. 24 (2003) 1465): constants have a zero derivative, and the error is the smallest known.

    Args:
        N: number of intervals, at least 1.
        order: order of the derivative, at least 1.

    Returns:
        (N + 1, N + 1).

    Raises:
        ValueError: ``N`` or ``order`` is below 1.
    """
    check_intervals(N)
    if order < 1:
        raise ValueError(f"the order of a derivative is at least 1, but it is {order}")
    weights = barycentric_weights(N)
    ratios = weights / weights[:, None]
    differences = _differences(N)
    D = np.eye(N + 1)
    for k in range(1, order + 1):
        off_diagonal = k * (ratios * np.diag(D)[:, None] - D) / differences
        D = _with_zero_row_sums(off_diagonal)
    return D


def _with_zero_row_sums(matrix: FloatArray) -> FloatArray:
    """The matrix with its diagonal replaced by the negative sum of the rest of each row."""
    np.fill_diagonal(matrix, 0.0)
    diagonal = [-fsum(row) for row in matrix]
    np.fill_diagonal(matrix, diagonal)
    return matrix


@lru_cache(maxsize=64)
def _points_and_weights(N: int) -> tuple[FloatArray, FloatArray]:
    """Points and weights of interpolation; contact in motion asks for one row over and over."""
    return nodes(N), barycentric_weights(N)


def interpolation_matrix(N: int, X: npt.ArrayLike) -> FloatArray:
    """The matrix from values at the points to values of the interpolant elsewhere, exact at the points.

    The second barycentric formula (J.-P. Berrut, L. N. Trefethen, SIAM Review 46 (2004) 501), which is (B.4)
    without its loss of digits.

    Args:
        N: number of intervals, at least 1.
        X: (n,) abscissae in [0, 1].

    Returns:
        (n, N + 1).

    Raises:
        ValueError: an abscissa outside [0, 1], where interpolation would be extrapolation.
    """
    abscissae = np.atleast_1d(np.asarray(X, dtype=float))
    inside = (abscissae >= -_ROUNDING) & (abscissae <= 1 + _ROUNDING)
    if not np.all(inside):
        raise ValueError(f"abscissae lie between 0 and 1, but these are {abscissae.tolist()}")
    points, weights = _points_and_weights(N)
    gaps = abscissae[:, None] - points
    on_node = np.abs(gaps) < _SAME_POINT
    divisors = np.where(on_node, 1.0, gaps)
    terms: FloatArray = weights / divisors
    # The row of an abscissa on a node picks the value there.
    picks = on_node.any(axis=1, keepdims=True)
    terms = np.where(picks, on_node, terms)
    terms /= terms.sum(axis=1, keepdims=True)
    return terms


def quadrature_weights(N: int) -> FloatArray:
    """The weights of Clenshaw–Curtis quadrature on [0, 1]: C. W. Clenshaw, A. R. Curtis, Numer. Math. 2 (1960) 197.

    Args:
        N: number of intervals, at least 1.

    Returns:
        (N + 1,) positive, of sum 1; exact for polynomials up to degree N, N + 1 if N is even.
    """
    check_intervals(N)
    k = np.arange(2, N + 1, 2)
    # ∫₀¹ T_k dX is −1/(k² − 1) for an even k and zero for an odd one; the last coefficient counts half.
    shares = np.where(k == N, 1.0, 2.0)
    factors = shares / (k * k - 1.0)
    cosines = _cosine_matrix(N)[:, k]
    weights: FloatArray = (1 - cosines @ factors) / N
    weights[[0, -1]] /= 2
    return without_rounding(weights)


def integration_matrix(N: int) -> FloatArray:
    """The integrals from the base, ∫₀^{X_i}, of the interpolant of degree N through all points.

    Built from the antiderivative of each Chebyshev polynomial, in angles measured from the base so that
    the short integrals near it lose no digits.

    Args:
        N: number of intervals, at least 1.

    Returns:
        (N + 1, N + 1); the first row is zero, the last holds the quadrature weights.
    """
    check_intervals(N)
    j = np.arange(N + 1)
    # ∫₀^φ cos kψ sin ψ dψ = sin²((k+1)φ/2)/(k+1) − sin²((k−1)φ/2)/(k−1), and x = −cos φ, dX = dx/2.
    angles = np.outer(j, np.arange(N + 2)) % (2 * N)
    squares = _half_angle_sine(N, angles) ** 2
    first = squares[:, j + 1] / (j + 1)
    # For k = 1 the second term is zero, and so would be its denominator.
    divisors = np.where(j == 1, 1, j - 1)
    second = squares[:, np.abs(j - 1)] / divisors
    second[:, j == 1] = 0.0
    antiderivatives: FloatArray = (first - second) / 2
    integrals = antiderivatives @ _cosine_transform(N)
    integrals[-1] = quadrature_weights(N)
    return without_rounding(integrals)


def _cosine_transform(N: int) -> FloatArray:
    """The matrix from values at the points to coefficients of cos kφ, where x = −cos φ."""
    # The discrete cosine transform of the first kind: both ends count half, in the values and in the coefficients.
    halves = np.ones(N + 1)
    halves[[0, -1]] = 0.5
    shares = np.outer(halves, halves)
    return shares * _cosine_matrix(N) * (2 / N)


def chebyshev_polynomials(n: int, X: npt.ArrayLike) -> FloatArray:
    """The values of T₀ … T_{n−1} at 2X − 1: report (B.2) corrected, T_{k+1} = 2x T_k − T_{k−1}.

    Args:
        n: how many polynomials, at least 1.
        X: (m,) abscissae in [0, 1].

    Returns:
        (m, n).
    """
    return np.asarray(chebyshev.chebvander(_centred(n, X), n - 1), dtype=float)


def legendre_polynomials(n: int, X: npt.ArrayLike) -> FloatArray:
    """The values of P₀ … P_{n−1} at 2X − 1 (report 2.4): (k+1) P_{k+1} = (2k+1) x P_k − k P_{k−1}.

    Args:
        n: how many polynomials, at least 1.
        X: (m,) abscissae in [0, 1].

    Returns:
        (m, n).
    """
    x = _centred(n, X)
    values = [np.ones_like(x), x]
    for k in range(1, n - 1):
        growth = (2 * k + 1) * x * values[k]
        values.append((growth - k * values[k - 1]) / (k + 1))
    return np.stack(values[:n], axis=1)


def _centred(n: int, X: npt.ArrayLike) -> FloatArray:
    """Abscissae 2X − 1 at which n polynomials are wanted."""
    if n < 1:
        raise ValueError(f"at least one polynomial is needed, but n = {n}")
    return 2 * np.atleast_1d(np.asarray(X, dtype=float)) - 1


def chebyshev_coefficients(values: npt.ArrayLike) -> FloatArray:
    """The coefficients of the interpolant in T₀ … T_N of 2X − 1, from its values at the points.

    Args:
        values: (N + 1,) or (N + 1, m), base to tip, N at least 1.

    Returns:
        shaped as ``values``.
    """
    v = np.asarray(values, dtype=float)
    N = len(v) - 1
    check_intervals(N)
    # The cosines count from the base, where x = −1: T_k(−cos φ) = (−1)^k cos kφ.
    k = np.arange(N + 1)
    signs = np.where(k % 2 == 0, 1.0, -1.0)
    transform = signs[:, None] * _cosine_transform(N)
    return np.asarray(transform @ v)
