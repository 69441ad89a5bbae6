"""How `cosserat estimate` looks for what differs from row to row."""

from __future__ import annotations

from typing import Annotated, ClassVar

from pydantic import Field

from cosserat_casadi.scene.records import Record
from cosserat_casadi.scene.values import Whole


class Estimation(Record):
    """How `cosserat estimate` looks for the unknowns of each row; all other commands leave it aside."""

    example: ClassVar[str] = """\
[estimation]
starts = 8
"""

    starts: Annotated[Whole, Field(ge=1, le=1000)] = Field(
        3,
        description="values between the bounds of unknown parameters, such as places along a rod, from which the "
        "search of every row begins; one search where no parameter is unknown",
    )
