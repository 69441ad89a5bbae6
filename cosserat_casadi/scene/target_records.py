"""The inverse problem: targets of sections and bodies, and ranges of the inputs that it determines.

They do not act on the rods: a scene with targets is solved like a scene without them.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Annotated, ClassVar, Literal

from pydantic import Field

from cosserat_casadi.scene.families import Family
from cosserat_casadi.scene.faults import Fault, Table, faults_of_ends, frame_faults
from cosserat_casadi.scene.orientations import Oriented
from cosserat_casadi.scene.records import Entry
from cosserat_casadi.scene.values import Component, NotEmpty, Positive, Quaternion, Share, Vector


class TargetRecord(Entry):
    """A target of the inverse problem."""

    weight: Positive = Field(1.0, description="weight against other targets where not all can be met, without unit")
    if TYPE_CHECKING:
        kind: str  # each member declares its own word, where it stands among its keys


TARGETS: Family[TargetRecord] = Family("targets")
"""Kinds of targets."""


class FrameTarget(TargetRecord):
    """A target for a section of a rod, or for a body."""

    references: ClassVar[Mapping[str, str]] = {"rod": "rods", "body": "bodies"}

    rod: str | None = Field(None, description="name of the rod, or of the tube; or body")
    at: Share = Field(1.0, description="abscissa X of the rod's section, without unit; the tip when left out")
    body: str | None = Field(None, description="name of the body; or rod")

    @classmethod
    def conflicts(cls, given: Table) -> Iterator[Fault]:
        """A rod or a body; only rods have sections."""
        yield from frame_faults(given)


@TARGETS.register
class PoseTarget(Oriented, FrameTarget):
    """Target for the position and orientation of a section or a body."""

    example: ClassVar[str] = """\
[[targets]]
kind = "pose"
rod = "finger"
position = [0.05, 0, 0.15]
quaternion = [1, 0, 0, 0]
"""

    kind: Literal["pose"] = Field(description="position and orientation")
    position: Vector = Field(description="wanted position in world axes, m")
    quaternion: Quaternion = Field(description="wanted orientation w, x, y, z, of norm 1, without unit")


@TARGETS.register
class PositionTarget(FrameTarget):
    """Target for the position of a section or a body, with a free orientation."""

    example: ClassVar[str] = """\
[[targets]]
kind = "position"
body = "platform"
position = [0.05, 0, 0.15]
"""

    kind: Literal["position"] = Field(description="position, the orientation is free")
    position: Vector = Field(description="wanted position in world axes, m")


@TARGETS.register
class CurveTarget(TargetRecord):
    """Points that the centreline of a rod should approach as nearly as it can."""

    example: ClassVar[str] = """\
[[targets]]
kind = "curve"
rod = "finger"
at = [0.5, 1.0]
points = [[0.01, 0, 0.1], [0.05, 0, 0.18]]
"""

    references: ClassVar[Mapping[str, str]] = {"rod": "rods"}

    kind: Literal["curve"] = Field(description="points along a rod")
    rod: str = Field(description="name of the rod")
    at: Annotated[tuple[Share, ...], NotEmpty()] = Field(description="abscissae X of the sections, without unit")
    points: Annotated[tuple[Vector, ...], NotEmpty()] = Field(
        description="wanted positions of these sections in world axes, one for each, m"
    )

    @classmethod
    def conflicts(cls, given: Table) -> Iterator[Fault]:
        """A point for each section."""
        at = given.get("at")
        points = given.get("points")
        if not isinstance(at, list) or not isinstance(points, list):
            return
        if len(at) != len(points):
            yield Fault(("points",), f"must have one point for each of {len(at)} sections, got {len(points)}")


Target = Annotated[PoseTarget | PositionTarget | CurveTarget, TARGETS]


class Bound(Entry):
    """The range of an input; without a lower or upper end it is not bounded on that side."""

    example: ClassVar[str] = """\
[[bounds]]
input = "push.force"
lower = [-1.0, -1.0, 0.0]
upper = 1.0
"""

    input: str = Field(description="'load.field' of the input")
    lower: Component | None = Field(
        None, description="least value in the unit of the input; a number for all entries, or a list of one for each"
    )
    upper: Component | None = Field(
        None, description="largest value in the unit of the input; a number for all entries, or a list of one for each"
    )

    @classmethod
    def conflicts(cls, given: Table) -> Iterator[Fault]:
        """The lower bound is below the upper one."""
        if "lower" not in given and "upper" not in given:
            yield Fault(("lower",), "missing", "give lower, upper or both")
        yield from faults_of_ends(given, equal=True)
