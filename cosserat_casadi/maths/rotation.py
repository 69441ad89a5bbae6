"""Rotations as matrices and quaternions, in symbols and in numbers.

What takes vectors or quaternions side by side takes and returns SX, MX, DM or NumPy arrays. Where the shapes say
``3×k`` or ``4×k``, column ``i`` holds the object of section ``i`` and any ``k ≥ 1`` will do; a NumPy array may also be
a single vector of shape ``(3,)`` or ``(4,)``. The formulas are written once, by rows, for all these types.

A row without entries (a structural zero of CasADi) stays without entries, so that a planar rod costs what a planar
rod should.

Quaternions are ``(w, x, y, z)``, scalar first, and read ``world_Q_body``: they carry the coordinates of a
vector in the body frame to its coordinates in the world frame (docs/theory.md, section 1).
"""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca
import numpy as np
import numpy.typing as npt

from cosserat_casadi.maths.typing import AnyMatrix, Columns, FloatArray, Matrix

# Largest entry of RᵀR − 1 in what still passes for a rotation matrix.
ROTATION_TOLERANCE = 1e-6

# Square of tan(θ/2) below which a rotation vector is a series: its error is below rounding there.
NEAR_IDENTITY = 1e-3


def cross(a: Columns, b: Columns) -> Columns:
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
    if isinstance(a, np.ndarray):
        return np.cross(a, b, axis=0)
    return ca.cross(a, b, 1)


def dot(a: AnyMatrix, b: AnyMatrix) -> AnyMatrix:
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


def cross_matrix(vector: FloatArray) -> FloatArray:
    """The matrix of the cross product with a vector, 3×3."""
    x, y, z = vector
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def hat(v: AnyMatrix) -> AnyMatrix:
    """The skew matrix in so(3) with ``hat(v) u = v × u``: report (A.3), (A.4).

    Args:
        v: 3×1.

    Returns:
        3×3, with structural zeros on the diagonal.
    """
    x, y, z = _rows(v, 3)
    # No entry is stored, so that CasADi does not carry a zero along.
    zero = ca.DM(1, 1)
    return ca.vertcat(
        ca.horzcat(zero, -z, y),
        ca.horzcat(z, zero, -x),
        ca.horzcat(-y, x, zero),
    )


def quaternion_product(p: Columns, q: Columns) -> Columns:
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
    return _from_rows(
        pw * qw - px * qx - py * qy - pz * qz,
        pw * qx + px * qw + py * qz - pz * qy,
        pw * qy - px * qz + py * qw + pz * qx,
        pw * qz + px * qy - py * qx + pz * qw,
    )


def quaternion_conjugate(q: Columns) -> Columns:
    """The conjugate, which is the inverse of a unit quaternion.

    Args:
        q: 4×k.

    Returns:
        4×k.
    """
    w, x, y, z = _rows(q, 4)
    return _from_rows(w, -x, -y, -z)


def directors(q: Columns) -> tuple[Columns, Columns, Columns]:
    """The directors d₁, d₂, d₃ of every section: the columns of the matrix of report (A.15).

    Args:
        q: 4×k unit quaternions.

    Returns:
        Three 3×k matrices, world coordinates.
    """
    w, x, y, z = _rows(q, 4)
    twice_w = 2 * w
    twice_x = 2 * x
    twice_y = 2 * y
    wx = twice_w * x
    wy = twice_w * y
    wz = twice_w * z
    xx = twice_x * x
    xy = twice_x * y
    xz = twice_x * z
    yy = twice_y * y
    yz = twice_y * z
    zz = 2 * z * z
    d1 = _from_rows(1 - yy - zz, xy + wz, xz - wy)
    d2 = _from_rows(xy - wz, 1 - xx - zz, yz + wx)
    d3 = _from_rows(xz + wy, yz - wx, 1 - xx - yy)
    return d1, d2, d3


def quaternion_to_matrix(q: Columns) -> Columns:
    """The rotation matrix of a unit quaternion: report (A.15).

    Args:
        q: 4×1 in CasADi; shape (4,) or (4, k) in NumPy.

    Returns:
        3×3 in CasADi; shape (3, 3) or (3, 3, k) in NumPy.
    """
    columns = directors(q)
    if isinstance(q, np.ndarray):
        return np.stack(columns, axis=1)
    return ca.horzcat(*columns)


def rotate(q: Columns, v: Columns) -> Columns:
    """Rotate each column of ``v`` by the same column of ``q``: report (A.15) times ``v``.

    Args:
        q: 4×k unit quaternions.
        v: 3×k.

    Returns:
        3×k.
    """
    # With Q = (w, a) the matrix is 1 + 2 w â + 2 â²: two cross products, and no product of quaternions.
    w, x, y, z = _rows(q, 4)
    axis = _from_rows(x, y, z)
    double = 2 * cross(axis, v)
    scaled = [w * row for row in _rows(double, 3)]
    return v + _from_rows(*scaled) + cross(axis, double)


def rotation_vector(q: AnyMatrix) -> Matrix:
    """The rotation vector of a unit quaternion, angle times axis, rad: of an angle up to π.

    It can be differentiated everywhere but where the angle is π.

    Args:
        q: 4×1; q and −q are the same rotation.

    Returns:
        3×1.
    """
    quaternion = ca.MX(q)
    upper = ca.if_else(quaternion[0] < 0, -quaternion, quaternion)
    cosine = upper[0]
    axis = upper[1:]
    # tan²(θ/2) decides between the quotient and its series: a root has no derivative at zero.
    square = ca.sumsqr(axis)
    near = square < NEAR_IDENTITY * cosine**2
    sine = ca.sqrt(ca.if_else(near, 1.0, square))
    quotient = 2 * ca.atan2(sine, cosine) / sine
    some_cosine = ca.if_else(near, cosine, 1.0)
    ratio = ca.if_else(near, square, 0.0) / some_cosine**2
    series = 1 - ratio / 3 + ratio**2 / 5 - ratio**3 / 7 + ratio**4 / 9
    factor: Matrix = ca.if_else(near, 2 * series / some_cosine, quotient)
    return factor * axis


def quaternion_rate_matrix(k: AnyMatrix) -> AnyMatrix:
    """The matrix A(K) of report (A.16): ``Q' = ½ A(K) Q`` is ``½ Q ⊗ (0, K)``.

    Args:
        k: 3×1 rate of rotation in the body frame.

    Returns:
        4×4 skew matrix, with structural zeros on the diagonal.
    """
    x, y, z = _rows(k, 3)
    zero = ca.DM(1, 1)
    return ca.vertcat(
        ca.horzcat(zero, -x, -y, -z),
        ca.horzcat(x, zero, z, -y),
        ca.horzcat(y, -z, zero, x),
        ca.horzcat(z, y, -x, zero),
    )


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
    # Scaled, so that neither a very long nor a very short tangent overflows or vanishes in the root.
    scaled = t / np.abs(t).max()
    x, y, z = scaled
    across = np.hypot(x, y)
    if across == 0 and z > 0:
        return np.array([1.0, 0.0, 0.0, 0.0])
    if across == 0:
        return np.array([0.0, 1.0, 0.0, 0.0])
    half_angle = np.arctan2(across, z) / 2
    cosine = np.cos(half_angle)
    sine = np.sin(half_angle)
    # The axis is the direction of z × t, in the plane of x and y.
    return np.array(
        [
            cosine,
            -y / across * sine,
            x / across * sine,
            0.0,
        ]
    )


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
    deviation = np.abs(m.T @ m - np.eye(3)).max()
    # This comparison refuses NaN; a reflection passes (A.7), but its determinant is −1.
    if not (deviation < ROTATION_TOLERANCE and np.linalg.det(m) > 0):
        raise ValueError(f"not a rotation matrix: {m.tolist()}")
    # Each column of 4 q qᵀ is q but for its length and sign; the longest one loses no digits.
    longest = max(_quaternion_squares(m), key=np.linalg.norm)
    q: FloatArray = longest / np.linalg.norm(longest)
    if q[0] < 0:
        return -q
    return q


def _quaternion_squares(m: FloatArray) -> FloatArray:
    """The symmetric matrix 4 q qᵀ of the quaternion of a rotation matrix, in which it is linear, 4×4."""
    a, b, c = np.diag(m)
    # (A.15) solved for the products of the entries: 4w² = 1 + tr m, 4wx = m₃₂ − m₂₃, 4xy = m₂₁ + m₁₂, and so on.
    ww = 1 + a + b + c
    xx = 1 + a - b - c
    yy = 1 - a + b - c
    zz = 1 - a - b + c
    wx = m[2, 1] - m[1, 2]
    wy = m[0, 2] - m[2, 0]
    wz = m[1, 0] - m[0, 1]
    xy = m[1, 0] + m[0, 1]
    xz = m[0, 2] + m[2, 0]
    yz = m[2, 1] + m[1, 2]
    return np.array(
        [
            [ww, wx, wy, wz],
            [wx, xx, xy, xz],
            [wy, xy, yy, yz],
            [wz, xz, yz, zz],
        ]
    )


def _rows(matrix: Columns, count: int) -> Sequence[Columns]:
    """The rows of a matrix that must have ``count`` of them."""
    if matrix.shape[0] != count:
        raise ValueError(f"expected {count} rows, one object per column, but the shape is {matrix.shape}")
    if isinstance(matrix, np.ndarray):
        return list(matrix)
    return ca.vertsplit(matrix)


def _from_rows(*rows: Columns) -> Columns:
    """The matrix of given rows; a NumPy vector has numbers for rows."""
    if isinstance(rows[0], np.ndarray | np.number):
        return np.stack(rows)
    return ca.vertcat(*rows)


def _same_shape(a: Matrix | FloatArray, b: Matrix | FloatArray) -> None:
    """Refuse what CasADi would broadcast in silence."""
    if a.shape != b.shape:
        raise ValueError(f"the shapes {a.shape} and {b.shape} differ")
