"""Joints that ship: the directions of a tip that each holds in a body."""

from __future__ import annotations

from typing import ClassVar, TypeVar, final

import numpy as np

from cosserat_casadi.constraints.held_directions import ALL, CLAMPED, PINNED, across
from cosserat_casadi.constraints.joint_coordinate import JointEffort, unit_vector
from cosserat_casadi.constraints.section_constraint import Coordinate, HeldDirections
from cosserat_casadi.constraints.tip_holder import Joint
from cosserat_casadi.maths.typing import FloatArray, Matrix
from cosserat_casadi.scene.constraint_records import (
    AxisJoint,
    FixedJoint,
    PrismaticJoint,
    RevoluteJoint,
    SphericalJoint,
)
from cosserat_casadi.scene.families import register

AxisRecord = TypeVar("AxisRecord", bound=AxisJoint)

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


class _OnAxis(Joint[AxisRecord]):
    """A joint with one coordinate."""

    turns: ClassVar[bool]

    def coordinate(self, record: AxisRecord, rotation: FloatArray) -> Coordinate | None:
        """The turn about the axis, or the slide along it."""
        if not record.has_coordinate:
            return None
        return Coordinate(unit_vector(rotation.T @ np.asarray(record.axis, dtype=float)), self.turns)

    def effort(self, record: AxisRecord, motor: Matrix) -> JointEffort:
        """Spring, damper and friction of the record."""
        return JointEffort(record.stiffness, record.rest, record.damping, record.friction, record.slip_rate, motor)


@final
@register
class Revolute(_OnAxis[RevoluteJoint]):
    """The section stays at a point and turns about an axis."""

    record = RevoluteJoint
    turns = True

    def held(self, record: RevoluteJoint, rotation: FloatArray) -> HeldDirections:
        """All directions except the rotation about the axis."""
        return HeldDirections(ALL, across(record.axis, rotation), turn_with_pose=True)


@final
@register
class Prismatic(_OnAxis[PrismaticJoint]):
    """The section slides along an axis and does not turn."""

    record = PrismaticJoint
    turns = False

    def held(self, record: PrismaticJoint, rotation: FloatArray) -> HeldDirections:
        """All directions except the displacement along the axis."""
        return HeldDirections(across(record.axis, rotation), ALL, turn_with_pose=True)
