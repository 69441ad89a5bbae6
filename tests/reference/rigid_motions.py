"""Appendix A of the report, beyond what the package needs: transforms, twists and wrenches, angular part first.

A twist or strain is ``[angular; linear]``, the wrench dual to it ``[couple; force]``, so that their scalar
product is a power. A transform ``a_T_b`` carries the coordinates of a point in frame b to those in frame a.
Everything takes and returns SX, MX or DM.
"""

from __future__ import annotations

import casadi as ca

from cosserat_casadi.maths.rotation import hat
from cosserat_casadi.maths.typing import Matrix

from .rotations import left_tangent, left_tangent_inverse, rotation_exp, rotation_log


def transform(R: Matrix, r: Matrix) -> Matrix:
    """The homogeneous matrix of a rotation and a translation: report (A.5).

    Args:
        R: 3×3 rotation matrix.
        r: 3×1, metres.

    Returns:
        4×4.
    """
    return ca.vertcat(ca.horzcat(R, r), ca.horzcat(ca.DM(1, 3), 1))


def transform_inverse(T: Matrix) -> Matrix:
    """The inverse of a transform: report (A.11).

    Args:
        T: 4×4.

    Returns:
        4×4.
    """
    Rt = T[:3, :3].T
    return transform(Rt, -(Rt @ T[:3, 3]))


def twist_hat(xi: Matrix) -> Matrix:
    """The matrix ξ̂ of a twist, with T' = T ξ̂: report (A.19), (1.8).

    Args:
        xi: 6×1, angular first.

    Returns:
        4×4 in se(3), last row structurally zero.
    """
    return ca.vertcat(ca.horzcat(hat(xi[:3]), xi[3:]), ca.DM(1, 4))


def adjoint(T: Matrix) -> Matrix:
    """The adjoint of a transform: ``a_ξ = Ad(a_T_b) b_ξ``.

    Angular first, [[R, 0], [p̂ R, R]], as report (A.29) has it; report (A.23) has the blocks of the
    opposite order.

    Args:
        T: 4×4.

    Returns:
        6×6.
    """
    R = T[:3, :3]
    upper = ca.horzcat(R, ca.DM(3, 3))
    lower = ca.horzcat(hat(T[:3, 3]) @ R, R)
    return ca.vertcat(upper, lower)


def ad(xi: Matrix) -> Matrix:
    """The Lie bracket with a twist, [[K̂, 0], [Γ̂, K̂]]: report (A.28), (A.29).

    Args:
        xi: 6×1, angular first.

    Returns:
        6×6.
    """
    K = hat(xi[:3])
    upper = ca.horzcat(K, ca.DM(3, 3))
    lower = ca.horzcat(hat(xi[3:]), K)
    return ca.vertcat(upper, lower)


def wrench_transform(b_T_a: Matrix, b_wrench: Matrix) -> Matrix:
    """The wrench at frame a equivalent to one at frame b: ``Ad(b_T_a)ᵀ b_W``, report (A.26) corrected.

    Args:
        b_T_a: 4×4, the pose of frame a in frame b.
        b_wrench: 6×k, [couple in N m; force in N] at the origin of b, in its axes.

    Returns:
        6×k, at the origin of a, in its axes.
    """
    return adjoint(b_T_a).T @ b_wrench


def rigid_exp(xi: Matrix) -> Matrix:
    """The transform reached by following a constant twist for unit time; smooth everywhere.

    Args:
        xi: 6×1, angular first: radians, metres.

    Returns:
        4×4, the exponential of ``twist_hat(xi)``.
    """
    turn = xi[:3]
    return transform(rotation_exp(turn), left_tangent(turn) @ xi[3:])


def rigid_log(T: Matrix) -> Matrix:
    """The twist whose exponential is a transform, the short way round; smooth but for half turns.

    Args:
        T: 4×4.

    Returns:
        6×1, angular first: radians (at most π long), metres.
    """
    turn = rotation_log(T[:3, :3])
    return ca.vertcat(turn, left_tangent_inverse(turn) @ T[:3, 3])
