"""Poses: position and rotation of a frame in another, as expressions and as numbers."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import casadi as ca
import numpy as np

from cosserat_casadi.maths.numbers import Numbers, any_symbolic, as_matrix, known
from cosserat_casadi.maths.rotation import quaternion_conjugate, quaternion_product, quaternion_to_matrix, rotate
from cosserat_casadi.maths.typing import FloatArray, Matrix

POSE_SIZE = 7
"""Numbers of a pose: position and quaternion."""


@dataclass(frozen=True)
class Pose:
    """A pose as expressions.

    Attributes:
        position: 3×1, m.
        quaternion: of norm 1, 4×1.
    """

    position: Matrix
    quaternion: Matrix

    @cached_property
    def rotation(self) -> Matrix:
        """Rotation matrix outer_R_inner, 3×3."""
        return quaternion_to_matrix(self.quaternion)

    def then(self, inner: Pose) -> Pose:
        """Pose, in the outer axes, of a frame whose pose in this frame is ``inner``."""
        position = self.position + rotate(self.quaternion, inner.position)
        return Pose(position, quaternion_product(self.quaternion, inner.quaternion))

    def seen(self, outer: Pose) -> Pose:
        """Pose, in this frame, of a frame whose pose in the outer frame is ``outer``."""
        back = quaternion_conjugate(self.quaternion)
        position = rotate(back, outer.position - self.position)
        return Pose(position, quaternion_product(back, outer.quaternion))

    @property
    def inverse(self) -> Pose:
        """Pose of the outer frame in this one."""
        back = quaternion_conjugate(self.quaternion)
        return Pose(-rotate(back, self.position), back)

    def varied(self, variation: Matrix) -> Pose:
        """This pose after a small motion [δθ; δr] in its outer axes, 6×1, exact to first order."""
        spin = ca.vertcat(0, variation[:3] / 2)
        quaternion = self.quaternion + quaternion_product(spin, self.quaternion)
        return Pose(self.position + variation[3:], quaternion)


@dataclass(frozen=True)
class NumericPose:
    """A pose as numbers.

    Attributes:
        position: shape (3,), m.
        quaternion: of norm 1, shape (4,).
    """

    position: FloatArray
    quaternion: FloatArray

    @property
    def pose(self) -> Pose:
        """The pose as constants of CasADi, for expressions."""
        return Pose(ca.DM(self.position), ca.DM(self.quaternion))

    @cached_property
    def rotation(self) -> FloatArray:
        """Rotation matrix outer_R_inner, shape (3, 3)."""
        return quaternion_to_matrix(self.quaternion)

    def then(self, inner: NumericPose) -> NumericPose:
        """Pose, in the outer axes, of a frame whose pose in this frame is ``inner``."""
        position = self.position + self.rotation @ inner.position
        return NumericPose(position, quaternion_product(self.quaternion, inner.quaternion))

    @cached_property
    def inverse(self) -> NumericPose:
        """Pose of the outer frame in this one."""
        return NumericPose(-self.rotation.T @ self.position, quaternion_conjugate(self.quaternion))


def written_pose(position: Numbers, quaternion: Numbers) -> NumericPose | Pose:
    """A pose of numbers, or of expressions if one of its parts is an expression."""
    if any_symbolic([position, quaternion]):
        return Pose(as_matrix(position), as_matrix(quaternion))
    return NumericPose(known(position), known(quaternion))


def numeric(pose: Pose) -> NumericPose:
    """The numbers of a pose with constant expressions."""
    stacked = ca.densify(ca.vertcat(ca.MX(pose.position), ca.MX(pose.quaternion)))
    numbers = np.asarray(ca.evalf(stacked).full()[:, 0])
    return NumericPose(numbers[:3], numbers[3:])


IDENTITY = NumericPose(np.zeros(3), np.array([1.0, 0.0, 0.0, 0.0]))
"""The pose of a frame in itself."""
