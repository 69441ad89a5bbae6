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
draws = 256
"""

    starts: Annotated[Whole, Field(ge=1, le=1000)] = Field(
        3,
        description="values between the bounds of unknown parameters, such as places along a rod, from which the "
        "search of every row begins; one search where no parameter is unknown",
    )
    draws: Annotated[Whole, Field(ge=0, le=100_000)] = Field(
        0,
        description="draws from the posterior of every row in each of two rounds, from which the deviations follow, "
        "without unit; 0 for those of the model linearised there",
    )
