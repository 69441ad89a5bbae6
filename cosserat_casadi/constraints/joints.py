"""Joints that ship: the directions of a tip that each holds in a body."""

from __future__ import annotations

from typing import final

from cosserat_casadi.constraints.held_directions import ALL, CLAMPED, PINNED, across
from cosserat_casadi.constraints.section_constraint import HeldDirections
from cosserat_casadi.constraints.tip_holder import Joint
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.scene.constraint_records import FixedJoint, PrismaticJoint, RevoluteJoint, SphericalJoint
from cosserat_casadi.scene.families import register

JOINT_KINDS = Joint.kinds
"""Joints by the word of the scene format."""


@final
@register
class Fixed(Joint[FixedJoint]):
    """The tip is clamped in the body."""

    record = FixedJoint

    def held(self, record: FixedJoint, rotation: FloatArray) -> HeldDirections:
        """Position and rotation."""
        return CLAMPED


@final
@register
class Spherical(Joint[SphericalJoint]):
    """The tip stays at a point and turns freely."""

    record = SphericalJoint

    def held(self, record: SphericalJoint, rotation: FloatArray) -> HeldDirections:
        """The position."""
        return PINNED


@final
@register
class Revolute(Joint[RevoluteJoint]):
    """The tip stays at a point and turns about an axis of the body."""

    record = RevoluteJoint

    def held(self, record: RevoluteJoint, rotation: FloatArray) -> HeldDirections:
        """All but the rotation about the axis."""
        return HeldDirections(ALL, across(record.axis, rotation), turn_with_pose=True)


@final
@register
class Prismatic(Joint[PrismaticJoint]):
    """The tip slides along an axis of the body and does not turn."""

    record = PrismaticJoint

    def held(self, record: PrismaticJoint, rotation: FloatArray) -> HeldDirections:
        """All but the displacement along the axis."""
        return HeldDirections(across(record.axis, rotation), ALL, turn_with_pose=True)
