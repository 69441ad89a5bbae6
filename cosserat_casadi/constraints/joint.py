"""Joints between a section of a rod and something that moves: a body, the base of another rod, or the world at rest.

The multipliers are the joint's force (unit EI/ℓ²) and moment (unit EI/ℓ) on the section, in the rod's base frame; the
opposite acts on the other side. The gap is that of the section against the place that the other side offers it.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import casadi as ca

from cosserat_casadi.constraints import tip_support as support
from cosserat_casadi.constraints.tip_support import Pose
from cosserat_casadi.maths.rotation import hat, quaternion_conjugate, quaternion_product, quaternion_to_matrix
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.rod.properties import RodProperties
from cosserat_casadi.rod.wrenches import PointWrench


@dataclass(frozen=True)
class Placement:
    """World pose of a frame that may move.

    Attributes:
        position: 3×1, m.
        quaternion: 4×1, not zero; only its direction counts.
    """

    position: Matrix
    quaternion: Matrix

    @cached_property
    def direction(self) -> Matrix:
        """The unit quaternion, 4×1."""
        return self.quaternion / ca.sqrt(ca.sumsqr(self.quaternion))

    @cached_property
    def rotation(self) -> Matrix:
        """Rotation matrix world_R_frame, 3×3."""
        return quaternion_to_matrix(self.direction)

    @cached_property
    def turn(self) -> Matrix:
        """Matrix from δQ to δθ in world axes, 3×4: δθ = 2 vec(δQ ⊗ Q*) / Q·Q."""
        w, x, y, z = ca.vertsplit(2 * self.quaternion / ca.sumsqr(self.quaternion))
        return ca.blockcat([[-x, w, -z, y], [-y, z, w, -x], [-z, -y, x, w]])

    def turned_moment(self, moment: Matrix) -> Matrix:
        """∂(turnᵀ moment)/∂Q at a fixed moment, 4×4."""
        x, y, z = ca.vertsplit(moment)
        o, square = ca.DM(1, 1), ca.sumsqr(self.quaternion)
        left = ca.blockcat([[o, -x, -y, -z], [x, o, -z, y], [y, z, o, -x], [z, -y, x, o]])
        return 2 / square * (left - (self.turn.T @ moment) @ self.quaternion.T)


@dataclass(frozen=True)
class Joint:
    """A section of a rod tied to a place on another frame.

    Attributes:
        rod: the rod.
        unit: EI/ℓ of the rod, J.
        at: abscissa of the section, a break of the rod's grid.
        position_axes: base axes of the rod along which the section is tied.
        rotation_axes: base axes of the rod about which the section is tied.
        place: pose of the section in the other frame that closes the gap, numeric.
    """

    rod: RodProperties
    unit: float
    at: float
    position_axes: tuple[int, ...]
    rotation_axes: tuple[int, ...]
    place: Pose

    @property
    def size(self) -> int:
        """Number of multipliers."""
        return len(self.position_axes) + len(self.rotation_axes)

    def force(self, multipliers: Matrix) -> Matrix:
        """Force on the section, base frame of the rod, 3×1, N."""
        chosen = multipliers[: len(self.position_axes)]
        return self.unit / self.rod.length * (_columns(self.position_axes) @ chosen)

    def moment(self, multipliers: Matrix) -> Matrix | None:
        """Moment on the section, base frame of the rod, 3×1, N m; None where the joint takes none."""
        if not self.rotation_axes:
            return None
        return self.unit * (_columns(self.rotation_axes) @ multipliers[len(self.position_axes) :])

    def wrench(self, multipliers: Matrix) -> PointWrench:
        """Wrench on the section."""
        return PointWrench(self.at, self.force(multipliers), self.moment(multipliers), follower=False)

    def arm(self, other: Placement) -> Matrix:
        """The joint from the origin of the other frame, world axes, 3×1, m."""
        return other.rotation @ self.place.position

    def gap(self, section: Pose, base: Placement, other: Placement) -> Matrix:
        """What is left to close, size×1: position relative to the rod's length, then the rotation left, rad."""
        distance = section.position - base.rotation.T @ self._distance(base, other)
        parts = [distance[list(self.position_axes)] / self.rod.length]
        if self.rotation_axes:
            parts.append(2 * self._turn_left(section, base, other)[1:][list(self.rotation_axes)])
        return ca.vertcat(*parts)

    def gap_with_strain(
        self, section: Pose, base: Placement, other: Placement, moved: Matrix, turned: Matrix
    ) -> Matrix:
        """Variation of the gap, size×n, from those of the section: δr and δθ, 3×n each, base frame."""
        left = self._turn_left(section, base, other) if self.rotation_axes else None
        return support.gap_with_strain(self, left, moved, turned)

    def gap_with_other(self, section: Pose, base: Placement, other: Placement) -> Matrix:
        """Variation of the gap with the other frame's δp (m) and δθ (world axes), size×6."""
        turned = base.rotation.T
        return self._gap_columns(section, base, other, -turned, turned @ hat(self.arm(other)), turned)

    def gap_with_base(self, section: Pose, base: Placement, other: Placement) -> Matrix:
        """Variation of the gap with the δp (m) and δθ (world axes) of the rod's own base, size×6."""
        turned = base.rotation.T
        return self._gap_columns(section, base, other, turned, -turned @ hat(self._distance(base, other)), -turned)

    def force_with_strain(self, moved: Matrix, turned: Matrix) -> Matrix:
        """Derivative of the rod's residual with respect to the multipliers, n×size."""
        return support.force_with_strain(self, moved, turned)

    def units(self) -> tuple[Matrix, Matrix]:
        """Force (N) and moment (N m) on the section for a unit of each multiplier, 3×size each, base frame."""
        positions, rotations = _columns(self.position_axes), _columns(self.rotation_axes)
        force = ca.horzcat(self.unit / self.rod.length * positions, ca.DM(3, len(self.rotation_axes)))
        return force, ca.horzcat(ca.DM(3, len(self.position_axes)), self.unit * rotations)

    def _distance(self, base: Placement, other: Placement) -> Matrix:
        """From the rod's base to the joint, world axes, 3×1, m."""
        return other.position + self.arm(other) - base.position

    def _turn_left(self, section: Pose, base: Placement, other: Placement) -> Matrix:
        """Quaternion of the section against its place, base frame of the rod, 4×1."""
        target = quaternion_product(other.direction, self.place.quaternion)
        target = quaternion_product(quaternion_conjugate(base.direction), target)
        return quaternion_product(section.quaternion, quaternion_conjugate(target))

    def _gap_columns(
        self, section: Pose, base: Placement, other: Placement, moved: Matrix, levered: Matrix, turned: Matrix
    ) -> Matrix:
        """Rows of the gap from those of the position (δp and δθ) and of the target's own turn, base frame."""
        rows = [ca.horzcat(moved, levered)[list(self.position_axes), :] / self.rod.length]
        if self.rotation_axes:
            left = self._turn_left(section, base, other)
            spun = -((left[0] * ca.DM.eye(3) + hat(left[1:])) @ turned)
            rows.append(ca.horzcat(ca.DM(3, 3), spun)[list(self.rotation_axes), :])
        return ca.vertcat(*rows)


def _columns(axes: tuple[int, ...]) -> ca.DM:
    """Unit vectors of some axes side by side, 3×k."""
    return ca.DM(ca.Sparsity.triplet(3, len(axes), list(axes), list(range(len(axes)))), 1.0)
