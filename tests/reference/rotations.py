"""Appendix A of the report, beyond what the package needs: exponential and logarithm of rotations, and tangents.

Everything takes and returns SX, MX or DM, and is safe to differentiate twice.

Functions of an angle θ are entire functions of ``u = θ²`` written twice, as a series for small ``u`` and in
closed form elsewhere. The closed form is given a harmless argument where the series is used: a branch that
is not taken still enters the derivatives, multiplied by zero, and zero times infinity is not a number.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from math import factorial

import casadi as ca

from cosserat_casadi.maths.magnus import horner
from cosserat_casadi.maths.rotation import dot, hat, quaternion_to_matrix
from cosserat_casadi.maths.typing import Matrix

_TERMS = 11
_COSINE = [(-1) ** n / factorial(2 * n) for n in range(_TERMS)]
_SINE = [(-1) ** n / factorial(2 * n + 1) for n in range(_TERMS)]
_ONE_MINUS_COSINE = [(-1) ** n / factorial(2 * n + 2) for n in range(_TERMS)]
_ANGLE_MINUS_SINE = [(-1) ** n / factorial(2 * n + 3) for n in range(_TERMS)]
_ARCTANGENT = [(-1) ** n / (2 * n + 1) for n in range(_TERMS)]

# Absolute values of the Bernoulli numbers B_2, B_4, … B_22.
_BERNOULLI = "1/6 1/30 1/42 1/30 5/66 691/2730 7/6 3617/510 43867/798 174611/330 854513/138"
_COTANGENT = [float(Fraction(b) / factorial(2 * n + 2)) for n, b in enumerate(_BERNOULLI.split())]

# The arctangent series is used up to tan²(θ/2) of this: the first term left out is 2⁻⁶⁶ / 23.
_ARCTANGENT_LIMIT = 1.0 / 64.0


def _entire(u: Matrix, coefficients: Sequence[float], closed_form: Callable[[Matrix], Matrix]) -> Matrix:
    """An entire function of ``u ≥ 0``: its series for ``u < 1``, its closed form elsewhere."""
    small = u < 1
    return ca.if_else(small, horner(coefficients, u), closed_form(ca.if_else(small, 1, u)))


def _cosine(u: Matrix) -> Matrix:
    """The function cos √u."""
    return _entire(u, _COSINE, lambda v: ca.cos(ca.sqrt(v)))


def _cardinal_sine(u: Matrix) -> Matrix:
    """The function sin √u / √u."""
    return _entire(u, _SINE, lambda v: ca.sin(ca.sqrt(v)) / ca.sqrt(v))


def _one_minus_cosine(u: Matrix) -> Matrix:
    """The function (1 − cos √u) / u."""
    return _entire(u, _ONE_MINUS_COSINE, lambda v: 2 * ca.sin(ca.sqrt(v) / 2) ** 2 / v)


def _angle_minus_sine(u: Matrix) -> Matrix:
    """The function (√u − sin √u) / u^(3/2)."""
    return _entire(u, _ANGLE_MINUS_SINE, lambda v: (1 - ca.sin(ca.sqrt(v)) / ca.sqrt(v)) / v)


def _cotangent(u: Matrix) -> Matrix:
    """The function (1 − h cot h) / u with h = √u / 2."""

    def closed_form(v: Matrix) -> Matrix:
        h = ca.sqrt(v) / 2
        return (1 - h * ca.cos(h) / ca.sin(h)) / v

    return _entire(u, _COTANGENT, closed_form)


def vee(m: Matrix) -> Matrix:
    """The vector of the skew part of a matrix: inverse of ``hat`` on so(3), after report (A.4).

    Args:
        m: 3×3.

    Returns:
        3×1.
    """
    return ca.vertcat(m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1]) / 2


def quaternion_exp(rotation_vector: Matrix) -> Matrix:
    """Unit quaternion of each rotation vector, smooth everywhere: (cos θ/2, sin θ/2 · v/θ).

    Args:
        rotation_vector: 3×k, radians.

    Returns:
        4×k.
    """
    quarter = dot(rotation_vector, rotation_vector) / 4
    scale = _cardinal_sine(quarter) / 2
    axis = [scale * row for row in ca.vertsplit(rotation_vector)]
    return ca.vertcat(_cosine(quarter), *axis)


def quaternion_log(q: Matrix) -> Matrix:
    """Rotation vector of each quaternion, the short way round, at most π long.

    The length of ``q`` does not matter. The value and two derivatives are exact at the identity and on
    half turns, where ``w = 0`` counts as the limit from ``w > 0``.

    Args:
        q: 4×k, not zero.

    Returns:
        3×k, radians.
    """
    w, *axis = ca.vertsplit(q)
    sign = ca.if_else(w < 0, -1, 1)
    square = sum(x * x for x in axis)
    scale = sign * 2 * _arctangent_ratio(square, sign * w)
    return ca.vertcat(*[scale * x for x in axis])


def _arctangent_ratio(s: Matrix, w: Matrix) -> Matrix:
    """The function atan2(√s, w) / √s for ``s, w ≥ 0``, smooth at ``s = 0``."""
    near = s < _ARCTANGENT_LIMIT * w * w
    safe_w = ca.if_else(near, w, 1)
    safe_root = ca.sqrt(ca.if_else(near, 1, s))
    series = horner(_ARCTANGENT, s / (safe_w * safe_w)) / safe_w
    return ca.if_else(near, series, ca.atan2(safe_root, w) / safe_root)


def rotation_exp(v: Matrix) -> Matrix:
    """Rotation matrix of a rotation vector: the exponential of ``hat(v)``.

    Args:
        v: 3×1, radians.

    Returns:
        3×3.
    """
    return quaternion_to_matrix(quaternion_exp(v))


def rotation_log(m: Matrix) -> Matrix:
    """Rotation vector of a rotation matrix, the short way round; smooth but for half turns.

    Four times ``q qᵀ`` is linear in the matrix (report (A.15) read backwards). Its longest column is the
    quaternion but for its length, which the logarithm ignores: no square root is taken near zero.

    Args:
        m: 3×3 rotation matrix.

    Returns:
        3×1, radians, at most π long.
    """
    squares = _quaternion_squares(m)
    columns = _quaternion_columns(m)
    best = columns[0]
    longest = squares[0]
    for column, square in zip(columns[1:], squares[1:], strict=True):
        longer = square > longest
        best = ca.if_else(longer, column, best)
        longest = ca.if_else(longer, square, longest)
    return quaternion_log(best)


def _quaternion_squares(m: Matrix) -> list[Matrix]:
    """The values 4w², 4x², 4y², 4z² of the quaternion of a rotation matrix."""
    a = m[0, 0]
    b = m[1, 1]
    c = m[2, 2]
    return [1 + a + b + c, 1 + a - b - c, 1 - a + b - c, 1 - a - b + c]


def _quaternion_columns(m: Matrix) -> list[Matrix]:
    """The columns 4wq, 4xq, 4yq, 4zq of the quaternion of a rotation matrix."""
    ww, xx, yy, zz = _quaternion_squares(m)
    wx = m[2, 1] - m[1, 2]
    wy = m[0, 2] - m[2, 0]
    wz = m[1, 0] - m[0, 1]
    xy = m[1, 0] + m[0, 1]
    xz = m[0, 2] + m[2, 0]
    yz = m[2, 1] + m[1, 2]
    rows = [(ww, wx, wy, wz), (wx, xx, xy, xz), (wy, xy, yy, yz), (wz, xz, yz, zz)]
    return [ca.vertcat(*row) for row in rows]


def left_tangent(v: Matrix) -> Matrix:
    """The matrix T(v) with ``d exp(v) exp(v)⁻¹ = T(v) dv``, both sides read through ``hat``.

    Args:
        v: 3×1, radians.

    Returns:
        3×3: I + (1 − cos θ)/θ² v̂ + (θ − sin θ)/θ³ v̂².
    """
    u = dot(v, v)
    skew = hat(v)
    return ca.DM.eye(3) + _one_minus_cosine(u) * skew + _angle_minus_sine(u) * (skew @ skew)


def left_tangent_inverse(v: Matrix) -> Matrix:
    """The inverse of ``left_tangent``, for rotations shorter than a full turn.

    Args:
        v: 3×1, radians, shorter than 2π where the tangent is singular.

    Returns:
        3×3: I − ½ v̂ + (1 − (θ/2) cot(θ/2))/θ² v̂².
    """
    skew = hat(v)
    return ca.DM.eye(3) - skew / 2 + _cotangent(dot(v, v)) * (skew @ skew)
