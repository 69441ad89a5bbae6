"""Rotations as matrices, quaternions and rotation vectors, safe to differentiate twice.

Everything takes and returns SX, MX or DM. Where the shapes say ``3×k`` or ``4×k``, column ``i`` holds the
object of section ``i`` and any ``k ≥ 1`` will do. A row without entries (a structural zero) stays without
entries, so that a planar rod costs what a planar rod should.

Quaternions are ``(w, x, y, z)``, scalar first, and read ``world_Q_body``: they carry the coordinates of a
vector in the body frame to its coordinates in the world frame. Rotation vectors are in radians.

Functions of an angle θ are entire functions of ``u = θ²`` written twice, as a series for small ``u`` and in
closed form elsewhere. The closed form is given a harmless argument where the series is used: a branch that
is not taken still enters the derivatives, multiplied by zero, and zero times infinity is not a number.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from math import factorial

import casadi as ca
import numpy as np
import numpy.typing as npt

from cosserat_casadi.maths.typing import FloatArray, Matrix

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


def horner(coefficients: Sequence[float], u: Matrix) -> Matrix:
    """Value of Σ coefficients[n] uⁿ, entrywise in u."""
    value = coefficients[-1]
    for coefficient in reversed(coefficients[:-1]):
        value = coefficient + u * value
    return value


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


def _rows(matrix: Matrix, count: int) -> list[Matrix]:
    """The rows of a matrix that must have ``count`` of them."""
    if matrix.shape[0] != count:
        raise ValueError(f"expected {count} rows, one object per column, but the shape is {matrix.shape}")
    return list(ca.vertsplit(matrix))


def _same_shape(a: Matrix, b: Matrix) -> None:
    """Refuse what CasADi would broadcast in silence."""
    if a.shape != b.shape:
        raise ValueError(f"the shapes {a.shape} and {b.shape} differ")


def cross(a: Matrix, b: Matrix) -> Matrix:
    """Cross product of each column of ``a`` with the same column of ``b``: report (A.2).

    Args:
        a: 3×k.
        b: 3×k.

    Returns:
        3×k.

    Raises:
        ValueError: the shapes differ.
    """
    _same_shape(a, b)
    return ca.cross(a, b, 1)


def dot(a: Matrix, b: Matrix) -> Matrix:
    """Scalar product of each column of ``a`` with the same column of ``b``.

    Args:
        a: n×k.
        b: n×k.

    Returns:
        1×k.

    Raises:
        ValueError: the shapes differ.
    """
    _same_shape(a, b)
    return ca.sum1(a * b)


def hat(v: Matrix) -> Matrix:
    """The skew matrix in so(3) with ``hat(v) u = v × u``: report (A.3), (A.4).

    Args:
        v: 3×1.

    Returns:
        3×3, with structural zeros on the diagonal.
    """
    x, y, z = _rows(v, 3)
    o = ca.DM(1, 1)
    return ca.vertcat(ca.horzcat(o, -z, y), ca.horzcat(z, o, -x), ca.horzcat(-y, x, o))


def vee(m: Matrix) -> Matrix:
    """The vector of the skew part of a matrix: inverse of ``hat`` on so(3), after report (A.4).

    Args:
        m: 3×3.

    Returns:
        3×1.
    """
    return ca.vertcat(m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1]) / 2


def quaternion_product(p: Matrix, q: Matrix) -> Matrix:
    """Product ``p ⊗ q``, the rotation ``q`` followed by ``p``, from the rules of report (A.13).

    Args:
        p: 4×k.
        q: 4×k.

    Returns:
        4×k.

    Raises:
        ValueError: the shapes differ or there are not four rows.
    """
    _same_shape(p, q)
    pw, px, py, pz = _rows(p, 4)
    qw, qx, qy, qz = _rows(q, 4)
    return ca.vertcat(
        pw * qw - px * qx - py * qy - pz * qz,
        pw * qx + px * qw + py * qz - pz * qy,
        pw * qy - px * qz + py * qw + pz * qx,
        pw * qz + px * qy - py * qx + pz * qw,
    )


def quaternion_conjugate(q: Matrix) -> Matrix:
    """The conjugate, which is the inverse of a unit quaternion.

    Args:
        q: 4×k.

    Returns:
        4×k.
    """
    w, x, y, z = _rows(q, 4)
    return ca.vertcat(w, -x, -y, -z)


def directors(q: Matrix) -> tuple[Matrix, Matrix, Matrix]:
    """The directors d₁, d₂, d₃ of every section: the columns of the matrix of report (A.15).

    Args:
        q: 4×k unit quaternions.

    Returns:
        Three 3×k matrices, world coordinates.
    """
    w, x, y, z = _rows(q, 4)
    d1 = ca.vertcat(1 - 2 * y * y - 2 * z * z, 2 * x * y + 2 * w * z, 2 * x * z - 2 * w * y)
    d2 = ca.vertcat(2 * x * y - 2 * w * z, 1 - 2 * x * x - 2 * z * z, 2 * y * z + 2 * w * x)
    d3 = ca.vertcat(2 * x * z + 2 * w * y, 2 * y * z - 2 * w * x, 1 - 2 * x * x - 2 * y * y)
    return d1, d2, d3


def quaternion_to_matrix(q: Matrix) -> Matrix:
    """The rotation matrix of a unit quaternion: report (A.15).

    Args:
        q: 4×1.

    Returns:
        3×3.
    """
    return ca.horzcat(*directors(q))


def rotate(q: Matrix, v: Matrix) -> Matrix:
    """Rotate each column of ``v`` by the same column of ``q``: report (A.15) times ``v``.

    Args:
        q: 4×k unit quaternions.
        v: 3×k.

    Returns:
        3×k.
    """
    w, *axis = _rows(q, 4)
    a = ca.vertcat(*axis)
    double = 2 * cross(a, v)
    return v + ca.vertcat(*(w * row for row in _rows(double, 3))) + cross(a, double)


def quaternion_rate_matrix(k: Matrix) -> Matrix:
    """The matrix A(K) of report (A.16): ``Q' = ½ A(K) Q`` is ``½ Q ⊗ (0, K)``.

    Args:
        k: 3×1 rate of rotation in the body frame.

    Returns:
        4×4 skew matrix, with structural zeros on the diagonal.
    """
    x, y, z = _rows(k, 3)
    o = ca.DM(1, 1)
    return ca.vertcat(
        ca.horzcat(o, -x, -y, -z), ca.horzcat(x, o, z, -y), ca.horzcat(y, -z, o, x), ca.horzcat(z, y, -x, o)
    )


def quaternion_exp(rotation_vector: Matrix) -> Matrix:
    """Unit quaternion of each rotation vector, smooth everywhere: (cos θ/2, sin θ/2 · v/θ).

    Args:
        rotation_vector: 3×k, radians.

    Returns:
        4×k.
    """
    quarter = dot(rotation_vector, rotation_vector) / 4
    scale = _cardinal_sine(quarter) / 2
    return ca.vertcat(_cosine(quarter), *(scale * row for row in _rows(rotation_vector, 3)))


def quaternion_log(q: Matrix) -> Matrix:
    """Rotation vector of each quaternion, the short way round, at most π long.

    The length of ``q`` does not matter. The value and two derivatives are exact at the identity and on
    half turns, where ``w = 0`` counts as the limit from ``w > 0``.

    Args:
        q: 4×k, not zero.

    Returns:
        3×k, radians.
    """
    w, *axis = _rows(q, 4)
    sign = ca.if_else(w < 0, -1, 1)
    w = sign * w
    a = sign * 2 * _arctangent_ratio(sum(x * x for x in axis), w)
    return ca.vertcat(*(a * x for x in axis))


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
    best, longest = columns[0], squares[0]
    for column, square in zip(columns[1:], squares[1:], strict=True):
        longer = square > longest
        best = ca.if_else(longer, column, best)
        longest = ca.if_else(longer, square, longest)
    return quaternion_log(best)


def _quaternion_squares(m: Matrix) -> list[Matrix]:
    """The values 4w², 4x², 4y², 4z² of the quaternion of a rotation matrix."""
    a, b, c = m[0, 0], m[1, 1], m[2, 2]
    return [1 + a + b + c, 1 + a - b - c, 1 - a + b - c, 1 - a - b + c]


def _quaternion_columns(m: Matrix) -> list[Matrix]:
    """The columns 4wq, 4xq, 4yq, 4zq of the quaternion of a rotation matrix."""
    ww, xx, yy, zz = _quaternion_squares(m)
    wx, wy, wz = m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1]
    xy, xz, yz = m[1, 0] + m[0, 1], m[0, 2] + m[2, 0], m[2, 1] + m[1, 2]
    rows = [(ww, wx, wy, wz), (wx, xx, xy, xz), (wy, xy, yy, yz), (wz, xz, yz, zz)]
    return [ca.vertcat(*row) for row in rows]


def left_tangent(v: Matrix) -> Matrix:
    """The matrix T(v) with ``d exp(v) exp(v)⁻¹ = T(v) dv``, both sides read through ``hat``.

    Args:
        v: 3×1, radians.

    Returns:
        3×3: I + (1 − cos θ)/θ² v̂ + (θ − sin θ)/θ³ v̂².
    """
    u, skew = dot(v, v), hat(v)
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


def quaternion_from_tangent(tangent: npt.ArrayLike) -> FloatArray:
    """The shortest rotation that carries the local z axis to a direction.

    Args:
        tangent: 3 numbers of any length but zero.

    Returns:
        4 numbers, a unit quaternion without twist (z = 0). The direction −z, which no shortest rotation
        singles out, gives the half turn about x.

    Raises:
        ValueError: the tangent is zero, not finite, or does not have three entries.
    """
    t = np.asarray(tangent, dtype=float)
    if t.shape != (3,) or not np.all(np.isfinite(t)) or not np.any(t):
        raise ValueError(f"a tangent is three finite numbers, not all zero, but this is {tangent!r}")
    x, y, z = t / np.abs(t).max()
    across = np.hypot(x, y)
    if across == 0:
        return np.array([1.0, 0.0, 0.0, 0.0]) if z > 0 else np.array([0.0, 1.0, 0.0, 0.0])
    half = np.arctan2(across, z) / 2
    return np.array([np.cos(half), -y / across * np.sin(half), x / across * np.sin(half), 0.0])


def matrix_to_quaternion(matrix: npt.ArrayLike) -> FloatArray:
    """The unit quaternion of a rotation matrix, with ``w ≥ 0``: report (A.15) read backwards.

    Args:
        matrix: 3×3 numbers, a rotation matrix up to rounding.

    Returns:
        4 numbers.

    Raises:
        ValueError: the matrix is not 3×3, or not a rotation to 1e-6.
    """
    m = np.asarray(matrix, dtype=float)
    if m.shape != (3, 3):
        raise ValueError(f"a rotation matrix is 3×3, but the shape is {m.shape}")
    if not (np.abs(m.T @ m - np.eye(3)).max() < 1e-6 and np.linalg.det(m) > 0):
        raise ValueError(f"not a rotation matrix: {m.tolist()}")
    columns = [column.full().ravel() for column in _quaternion_columns(ca.DM(m))]
    best = max(columns, key=np.linalg.norm)
    q: FloatArray = best / np.linalg.norm(best)
    return -q if q[0] < 0 else q
