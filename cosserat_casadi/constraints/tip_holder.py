"""Members that hold the tip of a rod: a support in the world, or a joint at a body.

A kind differs from others only in the directions that it holds. A member is one class with :meth:`TipHolder.held`, and
everything follows from these directions: multipliers, wrenches, their reduction for rods in a plane, whether the tip
slides, and its mark in figures.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import Any, Generic, TypeVar

from cosserat_casadi.constraints.joint_coordinate import JointEffort
from cosserat_casadi.constraints.section_constraint import Coordinate, HeldDirections
from cosserat_casadi.maths.numbers import Scalar, as_vector, known
from cosserat_casadi.maths.pose import IDENTITY, NumericPose
from cosserat_casadi.maths.typing import FloatArray, Matrix
from cosserat_casadi.scene.constraint_records import JOINTS, SUPPORTS, CarriedBody, JointRecord, SupportRecord
from cosserat_casadi.scene.families import Kind, Kinds

RecordType = TypeVar("RecordType", bound=JointRecord | SupportRecord)


class TipHolder(Kind, ABC, Generic[RecordType]):
    """One kind of support or joint. The methods take its frozen record of the scene."""

    @abstractmethod
    def held(self, record: RecordType, rotation: FloatArray) -> HeldDirections:
        """Directions along and about which the tip is held.

        Directions in the axes of the tip turn with the held pose: ``HeldDirections(…, turn_with_pose=True)``.

        Args:
            record: the record of the scene.
            rotation: turns the axes of the tip, as the record orients it, into the axes of the world or of the body,
                shape (3, 3); the identity where the record leaves the orientation free.
        """

    def axis(self, record: RecordType) -> Sequence[Scalar] | None:
        """Axis, in the world or in the body, with which the held directions turn if a parameter moves it."""
        return getattr(record, "axis", None)

    def directions(self, record: RecordType) -> HeldDirections:
        """Directions that are held at the place of the record."""
        return self.held(record, place_of(record).rotation)


class Support(TipHolder[RecordType]):
    """One kind of support."""

    family = SUPPORTS
    kinds = Kinds(SUPPORTS)


class Joint(TipHolder[RecordType]):
    """One kind of joint."""

    family = JOINTS
    kinds = Kinds(JOINTS)

    def coordinate(self, record: RecordType, rotation: FloatArray) -> Coordinate | None:
        """Free coordinate of the joint along which something acts; None if nothing does.

        Args:
            record: the record of the scene.
            rotation: turns the axes of the section into the axes that the axis of the record is in, shape (3, 3).
        """
        return None

    def effort(self, record: RecordType, motor: Matrix) -> JointEffort:
        """Spring, damper and motor along the coordinate, with the effort of the motor, 1×1."""
        raise NotImplementedError(f"{type(self).__name__} has no coordinate")


def place_of(record: JointRecord | SupportRecord | CarriedBody) -> NumericPose:
    """Pose of the tip in the world or in the body; without rotation if its record leaves the rotation free."""
    orientation: Any = record.orientation
    if orientation is None:
        orientation = IDENTITY.quaternion
    return NumericPose(known(as_vector(record.position)), known(as_vector(orientation)))
