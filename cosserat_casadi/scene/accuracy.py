"""How exact a result is to be, or with what it is computed."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal

from pydantic import Field, StrictBool

from cosserat_casadi.scene.records import Record
from cosserat_casadi.scene.values import BY_LENGTH, SEVERAL, SINGLE, NotEmpty, Number, Whole

Modes = Annotated[Whole, Field(ge=1, le=200)]
ModesChoice = Annotated[
    Annotated[Modes, SINGLE] | Annotated[tuple[Modes, ...], NotEmpty(), SEVERAL],
    BY_LENGTH,
]


class Accuracy(Record):
    """How exact the result is to be, or with what it is computed."""

    example: ClassVar[str] = """\
[accuracy]
tolerance = 1e-8
shape = true
"""

    tolerance: Annotated[Number, Field(ge=1e-12, le=1e-1)] = Field(
        1e-6,
        description="wanted error of poses (distance over the rod length, angle in rad) and of lengths of cables "
        "over the rod length, without unit",
    )
    shape: StrictBool = Field(False, description="whether the tolerance binds all sections, not the tip alone")
    modes: ModesChoice | None = Field(
        None, description="polynomial modes per strain component, a whole number or a list of one per admitted strain"
    )
    nodes: Annotated[Whole, Field(ge=2, le=1000)] | None = Field(
        None, description="intervals of the Chebyshev grid, a whole number"
    )
    rotation: Literal["magnus4", "magnus6", "magnus8", "permuted"] | None = Field(
        None,
        description="how the rotation is integrated: products of exponentials of order 4, 6 or 8, or the literal "
        "'permuted' linear system",
    )

    @property
    def fixed(self) -> bool:
        """Whether the scene itself chooses what it is computed with, or part of that."""
        if self.modes is not None or self.nodes is not None:
            return True
        return self.rotation is not None
