"""Loads: gravity, and wrenches on sections, along rods and on bodies.

A kind is a record in this folder and a class in `loads/`; load_kinds.py lists the kinds that ship.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Annotated, ClassVar, Literal

from pydantic import Field

from cosserat_casadi.scene.families import Family
from cosserat_casadi.scene.faults import Fault, Table
from cosserat_casadi.scene.input_fields import InputField
from cosserat_casadi.scene.records import Entry
from cosserat_casadi.scene.values import ABOVE_BASE, Name, Names, Number, Polynomials, Vector, above_base


class LoadRecord(Entry):
    """A load on sections of rods or on bodies."""

    name: Name = Field(description="name of the load, a letter, then letters, digits and underscores")
    if TYPE_CHECKING:
        kind: str  # each member declares its own word, where it stands among its keys

    def has_kinks_on(self, rod: str) -> bool:
        """Whether the load on the rod of this name may have a kink along it."""
        return False


LOADS: Family[LoadRecord] = Family("loads")
"""Kinds of loads."""


def force_or_moment(given: Table) -> Iterator[Fault]:
    """A wrench has a force or a moment."""
    if "force" in given or "moment" in given:
        return
    yield Fault(("force",), "missing", "give force, moment or both")


@LOADS.register
class Gravity(LoadRecord):
    """A uniform field of acceleration."""

    example: ClassVar[str] = """\
[[loads]]
name = "weight"
kind = "gravity"
acceleration = [0, 0, -9.81]
"""

    inputs: ClassVar[Mapping[str, InputField]] = {"acceleration": InputField("m/s²", 3, axes="world")}
    references: ClassVar[Mapping[str, str]] = {"rods": "rods", "bodies": "bodies"}

    kind: Literal["gravity"] = Field(description="weight of the rods and bodies")
    acceleration: Vector = Field(description="acceleration in world axes, m/s²")
    rods: Names | None = Field(
        None, description="names of the rods, or tubes, that it acts on; all when neither rods nor bodies are named"
    )
    bodies: Names | None = Field(
        None, description="names of the bodies that it acts on; all bodies when neither rods nor bodies are named"
    )

    @property
    def acts_on_all(self) -> bool:
        """Whether gravity acts on every rod and every body."""
        return self.rods is None and self.bodies is None

    def acts_on_rod(self, rod: str) -> bool:
        """Whether gravity acts on the rod of this name."""
        return self.acts_on_all if self.rods is None else rod in self.rods

    def acts_on_body(self, body: str) -> bool:
        """Whether gravity acts on the body of this name."""
        return self.acts_on_all if self.bodies is None else body in self.bodies


class WrenchRecord(LoadRecord):
    """A force and a moment, at one point unless a kind says otherwise."""

    inputs: ClassVar[Mapping[str, InputField]] = {
        "force": InputField("N", 3, axes="frame"),
        "moment": InputField("N m", 3, axes="frame"),
    }

    @classmethod
    def conflicts(cls, given: Table) -> Iterator[Fault]:
        """A wrench has a force or a moment."""
        yield from force_or_moment(given)


class SectionWrench(WrenchRecord):
    """A force and a moment on sections of one rod."""

    references: ClassVar[Mapping[str, str]] = {"rod": "rods"}

    rod: str = Field(description="name of the rod, or of the tube, that it acts on")
    frame: Literal["world", "body"] = Field(
        "world", description="axes of force and moment: 'world' is a dead load, 'body' follows the section"
    )


@LOADS.register
class TipWrench(SectionWrench):
    """A force and a moment on the tip section."""

    example: ClassVar[str] = """\
[[loads]]
name = "push"
kind = "tip_wrench"
rod = "finger"
force = [0.1, 0, 0]
"""

    kind: Literal["tip_wrench"] = Field(description="force and moment on the tip")
    force: Vector = Field((0.0, 0.0, 0.0), description="force, N")
    moment: Vector = Field((0.0, 0.0, 0.0), description="moment, N m")


@LOADS.register
class PointWrench(SectionWrench):
    """A force and a moment on one section."""

    example: ClassVar[str] = """\
[[loads]]
name = "poke"
kind = "point_wrench"
rod = "finger"
at = 0.5
moment = [0, 0.01, 0]
frame = "body"
"""

    kind: Literal["point_wrench"] = Field(description="force and moment on one section")
    at: Annotated[
        Number,
        above_base("a wrench on the base goes straight into the clamp: leave it out"),
        ABOVE_BASE,
    ] = Field(description="abscissa X of the section relative to the length, without unit, above 0 and at most 1")
    force: Vector = Field((0.0, 0.0, 0.0), description="force, N")
    moment: Vector = Field((0.0, 0.0, 0.0), description="moment, N m")


@LOADS.register
class DistributedWrench(SectionWrench):
    """A force and a moment per length."""

    example: ClassVar[str] = """\
[[loads]]
name = "wind"
kind = "distributed_wrench"
rod = "finger"
force = [{ base = 0.0, tip = 0.4 }, 0, 0]     # N/m
"""

    inputs: ClassVar[Mapping[str, InputField]] = {
        "force": InputField("N/m", 3, polynomial=True, axes="frame"),
        "moment": InputField("N m/m", 3, polynomial=True, axes="frame"),
    }

    kind: Literal["distributed_wrench"] = Field(description="force and moment per length")
    force: Polynomials = Field(
        (0.0, 0.0, 0.0),
        description="force per length, N/m; a component may list Legendre coefficients in 2X − 1",
    )
    moment: Polynomials = Field(
        (0.0, 0.0, 0.0),
        description="moment per length, N m/m; a component may list Legendre coefficients in 2X − 1",
    )


@LOADS.register
class BodyWrench(WrenchRecord):
    """A force and a moment on a rigid body."""

    example: ClassVar[str] = """\
[[loads]]
name = "payload"
kind = "body_wrench"
body = "platform"
force = [0, 0, -1.0]
position = [0.05, 0, 0]
"""

    references: ClassVar[Mapping[str, str]] = {"body": "bodies"}

    kind: Literal["body_wrench"] = Field(description="force and moment on a body")
    body: str = Field(description="name of the body that it acts on")
    force: Vector = Field((0.0, 0.0, 0.0), description="force, N")
    moment: Vector = Field((0.0, 0.0, 0.0), description="moment, N m")
    position: Vector = Field((0.0, 0.0, 0.0), description="point of the body that the force acts on, in its axes, m")
    frame: Literal["world", "body"] = Field(
        "world", description="axes of force and moment: 'world' is a dead load, 'body' turns with the body"
    )
