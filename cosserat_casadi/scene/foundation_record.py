"""Elastic foundations: springs all along a rod, such as the tissue around a needle."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Annotated, ClassVar, Literal

from pydantic import Field

from cosserat_casadi.scene.actuator_records import Span
from cosserat_casadi.scene.faults import Fault, Table
from cosserat_casadi.scene.input_fields import InputField
from cosserat_casadi.scene.load_records import LOADS, LoadRecord
from cosserat_casadi.scene.values import NotNegative, Polynomials, listed

Stiffnesses = Annotated[tuple[NotNegative, NotNegative, NotNegative], listed(3, "3 numbers")]


@LOADS.register
class Foundation(LoadRecord):
    """Springs per length between the sections of a rod and where they were in the unloaded scene, or a curve."""

    example: ClassVar[str] = """\
[[loads]]
name = "tissue"
kind = "foundation"
rod = "finger"
stiffness = [500.0, 500.0, 0.0]
frame = "body"
span = [0.4, 1.0]
"""

    inputs: ClassVar[Mapping[str, InputField]] = {"stiffness": InputField("N/m²", 3, lower=0.0, axes="frame")}
    references: ClassVar[Mapping[str, str]] = {"rod": "rods"}

    kind: Literal["foundation"] = Field(description="springs per length")
    rod: str = Field(description="name of the rod that lies in the foundation")
    stiffness: Stiffnesses = Field(description="force per length and displacement along three axes, N/m²")
    frame: Literal["world", "body"] = Field(
        "world", description="axes of the stiffness: 'body' are those of the sections of the unloaded rod"
    )
    curve: Polynomials | None = Field(
        None,
        description="points of the world that the sections X are tied to, m, in place of those of the "
        "unloaded rod; a "
        "component may list Legendre coefficients in 2X − 1",
    )
    span: Span = Field((0.0, 1.0), description="abscissae X between which the rod lies in the foundation")

    @classmethod
    def conflicts(cls, given: Table) -> Iterator[Fault]:
        """The stiffnesses of a foundation are not all zero."""
        stiffness = given.get("stiffness")
        if isinstance(stiffness, list | tuple) and stiffness and all(value == 0 for value in stiffness):
            yield Fault(("stiffness",), "must not be zero", "springs that hold nothing: leave the load out")
