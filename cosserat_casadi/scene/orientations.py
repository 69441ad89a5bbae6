"""Orientations in scenes: a quaternion, a tangent with a twist, a rotation vector, or angles about axes.

The record of a table with an orientation keeps the orientation as a quaternion, in whichever way it is written.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Annotated, ClassVar

import numpy as np
from pydantic import AfterValidator, Field

from cosserat_casadi.maths.rotation import quaternion_from_tangent, quaternion_product
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.scene.faults import Fault, Table, shown
from cosserat_casadi.scene.records import Record, refusal, sound
from cosserat_casadi.scene.values import Direction, Number, Quadruple, Vector

WAYS = ("tangent", "rotation_vector", "euler")
"""Keys that give an orientation instead of a quaternion."""

ORIENTATION_KEYS = ("quaternion", "twist", *WAYS)
"""All keys of an orientation."""


def _three_axes(value: str) -> str:
    """Refuse values that do not name three axes."""
    if len(value) == 3 and (set(value) <= set("xyz") or set(value) <= set("XYZ")):
        return value
    raise refusal(
        [Fault((), f"must name three axes, got {shown(value)}", "such as 'xyz', or 'ZYX' for axes that turn")]
    )


class Euler(Record):
    """Turns about three axes, one after another."""

    example: ClassVar[str] = """\
base = { euler = { sequence = "xyz", angles = [0.1, 0, 1.57] } }     # "XYZ": about axes that turn along
"""

    sequence: Annotated[str, AfterValidator(_three_axes)] = Field(
        description="axes of the turns in their order: 'xyz' those that stand still, 'XYZ' those that turn along"
    )
    angles: Vector = Field(description="angles of the turns in their order, rad")

    @property
    def quaternion(self) -> FloatArray:
        """The orientation as a quaternion, shape (4,)."""
        axes = dict(zip("xyz", np.eye(3), strict=True))
        turns = [quaternion_about(axes[axis.lower()] * angle) for axis, angle in self._turns]
        first, second, third = turns if self.sequence.isupper() else turns[::-1]
        return np.asarray(quaternion_product(quaternion_product(first, second), third))

    @property
    def _turns(self) -> list[tuple[str, float]]:
        return list(zip(self.sequence, self.angles, strict=True))


class Oriented(Record):
    """A table with an orientation, as a quaternion or in another notation, which the record converts to one."""

    tangent: Direction | None = Field(
        None,
        description="direction of the z axis, reached by the shortest rotation, without unit; instead of quaternion",
    )
    twist: Number | None = Field(None, description="angle about that direction, rad; with tangent")
    rotation_vector: Vector | None = Field(
        None, description="axis of a rotation times its angle, rad; instead of quaternion"
    )
    euler: Euler | None = Field(None, description="turns about three axes; instead of quaternion")
    if TYPE_CHECKING:
        quaternion: Quadruple  # each record declares its own, where it stands among its keys

    @property
    def orientation(self) -> Quadruple:
        """The orientation, w, x, y, z."""
        return self.quaternion

    @classmethod
    def conflicts(cls, given: Table) -> Iterator[Fault]:
        """The orientation is given once."""
        yield from super().conflicts(given)
        yield from orientation_faults(given)

    @classmethod
    def settled(cls, given: Table) -> Table:
        """The table with a quaternion in place of the other keys; unchanged if these are faulty."""
        written = {key: given[key] for key in ("twist", *WAYS) if given.get(key) is not None}
        if not written or list(orientation_faults(given)):
            return given
        alternative = sound(_Ways, written)
        if alternative is None:
            return given
        rest = {key: value for key, value in given.items() if key not in written}
        return {**rest, "quaternion": alternative.as_quaternion.tolist()}


class _Ways(Record):
    """The keys that give an orientation instead of a quaternion, as a record."""

    tangent: Direction | None = None
    twist: Number = 0.0
    rotation_vector: Vector | None = None
    euler: Euler | None = None

    @property
    def as_quaternion(self) -> FloatArray:
        """The orientation, shape (4,)."""
        if self.tangent is not None:
            twist = quaternion_about(np.array([0.0, 0.0, self.twist]))
            return np.asarray(quaternion_product(quaternion_from_tangent(self.tangent), twist))
        if self.euler is not None:
            return self.euler.quaternion
        return quaternion_about(np.asarray(self.rotation_vector))


def orientation_faults(given: Table) -> Iterator[Fault]:
    """An orientation is given once; a twist belongs to a tangent."""
    ways = [key for key in ("quaternion", *WAYS) if given.get(key) is not None]
    for key in ways[1:]:
        yield Fault((key,), f"stands beside {ways[0]}", "give one of the two")
    if given.get("twist") is not None and "tangent" not in ways:
        yield Fault(("twist",), "stands without tangent", "it is the angle about that direction")


def quaternion_about(vector: FloatArray) -> FloatArray:
    """Quaternion of a rotation vector, rad, shape (4,)."""
    half = float(np.linalg.norm(vector)) / 2
    return np.concatenate([[np.cos(half)], np.sinc(half / np.pi) / 2 * vector])
