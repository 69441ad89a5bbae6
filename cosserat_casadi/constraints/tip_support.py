"""Prescribed tips: what the tip must meet, and the unknown wrench that makes it.

The multipliers are the support's force (unit EI/ℓ²) and moment (unit EI/ℓ) on the tip in the rod's base frame,
so they are of the order of the dimensionless residual. In a planar rod only the components of its plane exist.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Any, ClassVar, Protocol, final

import casadi as ca

from cosserat_casadi.maths.rotation import hat, quaternion_conjugate, quaternion_product, rotate
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.rod.properties import RodProperties
from cosserat_casadi.rod.wrenches import PointWrench


@dataclass(frozen=True)
class Pose:
    """Position (3×1, m) and unit quaternion (4×1) of a section in the rod's base frame."""

    position: Matrix
    quaternion: Matrix


class Tied(Protocol):
    """What holds a section of a rod along and about some of the axes of its base frame."""

    @property
    def rod(self) -> RodProperties:
        """The rod."""

    @property
    def position_axes(self) -> tuple[int, ...]:
        """Axes along which the section is held."""

    @property
    def rotation_axes(self) -> tuple[int, ...]:
        """Axes about which the section is held."""


def force_with_strain(tied: Tied, moved: Matrix, turned: Matrix) -> Matrix:
    """Derivative of a rod's residual with respect to multipliers, n×size, from δr and δθ of the section, 3×n each."""
    rows = [moved[list(tied.position_axes), :] / -tied.rod.length]
    if tied.rotation_axes:
        rows.append(-turned[list(tied.rotation_axes), :])
    return ca.vertcat(*rows).T


def gap_with_strain(tied: Tied, left: Matrix | None, moved: Matrix, turned: Matrix) -> Matrix:
    """Variation of the gap, size×n, from δr and δθ of the section and the quaternion of the turn that is left."""
    parts = [moved[list(tied.position_axes), :] / tied.rod.length]
    if left is not None:
        parts.append(((left[0] * ca.DM.eye(3) - hat(left[1:])) @ turned)[list(tied.rotation_axes), :])
    return ca.vertcat(*parts)


@dataclass(frozen=True)
class Hold:
    """A support on a rod.

    Attributes:
        rod: the rod whose tip it holds.
        unit: EI/ℓ, J.
        turns: whether the orientation is prescribed too.
        target: pose of the tip that closes the gap.
    """

    rod: RodProperties
    unit: float
    turns: bool
    target: Pose

    @property
    def position_axes(self) -> tuple[int, ...]:
        """Base axes along which the tip is held."""
        return (0, 2) if self._planar else (0, 1, 2)

    @property
    def rotation_axes(self) -> tuple[int, ...]:
        """Base axes about which the tip is held."""
        if not self.turns:
            return ()
        return (1,) if self._planar else (0, 1, 2)

    @property
    def size(self) -> int:
        """Number of multipliers."""
        return len(self.position_axes) + len(self.rotation_axes)

    def wrench(self, multipliers: Matrix) -> PointWrench:
        """Wrench on the tip for given multipliers."""
        force = ca.SX(3, 1) if isinstance(multipliers, ca.SX) else ca.MX(3, 1)
        moment = type(force)(3, 1)
        for i, axis in enumerate(self.position_axes):
            force[axis] = self.unit / self.rod.length * multipliers[i]
        for i, axis in enumerate(self.rotation_axes):
            moment[axis] = self.unit * multipliers[len(self.position_axes) + i]
        return PointWrench(1.0, force, moment if self.turns else None, follower=False)

    def gap(self, tip: Pose) -> Matrix:
        """What is left to close, size×1: position relative to the length, then the rotation left, rad."""
        left = (tip.position - self.target.position) / self.rod.length
        parts = [left[list(self.position_axes)]]
        if self.turns:
            turn = 2 * quaternion_product(tip.quaternion, quaternion_conjugate(self.target.quaternion))[1:]
            parts.append(turn[list(self.rotation_axes)])
        return ca.vertcat(*parts)

    def gap_variation(self, tip: Pose, moved: Matrix, turned: Matrix) -> Matrix:
        """Variation of the gap, size×n, from those of the tip: δr and δθ, 3×n each."""
        left = quaternion_product(tip.quaternion, quaternion_conjugate(self.target.quaternion)) if self.turns else None
        return gap_with_strain(self, left, moved, turned)

    def force_variation(self, moved: Matrix, turned: Matrix) -> Matrix:
        """Derivative of the rod's residual with respect to the multipliers, n×size."""
        return force_with_strain(self, moved, turned)

    @property
    def _planar(self) -> bool:
        return stays_in_plane(self.rod)


def stays_in_plane(rod: RodProperties) -> bool:
    """Whether nothing takes a rod out of the local x–z plane of its base."""
    in_plane = not any(rod.intrinsic[3:][1]) and 4 not in rod.admitted
    return rod.turning_axes in ((), (1,)) and in_plane


class Support(ABC):
    """One kind of support.

    Attributes:
        kind: the word of the scene format.
        turns: whether the orientation is prescribed.
    """

    kind: ClassVar[str]
    turns: ClassVar[bool]

    @abstractmethod
    def target(self, support: Any, base: Pose) -> Pose:
        """Pose that the tip must meet, in the base frame.

        Args:
            support: the support as the scene has it.
            base: world pose of the rod's base, numeric.
        """


def _position(support: Any, base: Pose) -> Matrix:
    return rotate(quaternion_conjugate(base.quaternion), ca.DM(support.position) - base.position)


@final
class Clamped(Support):
    """Position and orientation of the tip are prescribed."""

    kind = "clamped"
    turns = True

    def target(self, support: Any, base: Pose) -> Pose:
        """The scene's pose."""
        quaternion = quaternion_product(quaternion_conjugate(base.quaternion), ca.DM(support.quaternion))
        return Pose(_position(support, base), quaternion)


@final
class Pinned(Support):
    """Position of the tip is prescribed, its orientation is free."""

    kind = "pinned"
    turns = False

    def target(self, support: Any, base: Pose) -> Pose:
        """The scene's position; the orientation is not read."""
        return Pose(_position(support, base), ca.DM([1, 0, 0, 0]))
