"""Rows of disks on rods: masses that are fixed to sections and add no unknowns."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Annotated, Any, ClassVar

from pydantic import Field

from cosserat_casadi.scene.faults import Fault, Table, list_of, not_ascending, numbers_of
from cosserat_casadi.scene.records import Entry, sound
from cosserat_casadi.scene.values import ABOVE_BASE, Name, NotEmpty, NotNegative, Number, Positive, Whole, above_base

MOST_DISKS = 1000
"""Largest number of disks of a row; each disk ends an element of its rod."""


def lead_through_disks(tables: dict[str, Any]) -> None:
    """Write the holes of tendons that run through disks: places of the disks of their rods within their spans."""
    for tendon in tables_of(tables, "actuators"):
        if tendon.get("routing") != "disks" or "holes" in tendon:
            continue
        span = numbers_of(tendon.get("span", [0.0, 1.0]))
        rows = [sound(Disks, row) for row in tables_of(tables, "disks") if row.get("rod") == tendon.get("rod")]
        places = sorted({at for row in rows if row is not None for at in row.places})
        holes = [at for at in places if len(span) == 2 and span[0] <= at <= span[1]]
        if holes:
            tendon["holes"] = holes
        # A faulty row has its own fault; its tendons are not also said to lack disks.
        if holes or None in rows:
            del tendon["routing"]


def tables_of(tables: dict[str, Any], key: str) -> list[dict[str, Any]]:
    """The tables in a list of the scene, which may be faulty."""
    return [table for table in list_of(tables.get(key)) if isinstance(table, dict)]


Section = Annotated[Number, above_base("at its base a rod does not move: leave that disk out"), ABOVE_BASE]


class Disks(Entry):
    """A row of equal rigid disks, each fixed to a section of one rod, with its centre on the centreline."""

    example: ClassVar[str] = """\
[[disks]]
rod = "finger"
count = 10
mass = 0.003
radius = 0.01
thickness = 0.002
"""

    references: ClassVar[Mapping[str, str]] = {"rod": "rods"}

    name: Name | None = Field(None, description="name of the row, a letter, then letters, digits and underscores")
    rod: str = Field(description="name of the rod that carries the disks")
    count: Annotated[Whole, Field(ge=1, le=MOST_DISKS)] | None = Field(
        None, description="number of disks, evenly along the rod, the last at its tip; or at"
    )
    at: Annotated[tuple[Section, ...], NotEmpty()] | None = Field(
        None, description="abscissae X of the disks, ascending, without unit, above 0 and at most 1; or count"
    )
    mass: NotNegative = Field(0.0, description="mass of each disk, kg")
    radius: Positive = Field(description="radius of each disk, m")
    thickness: NotNegative = Field(0.0, description="thickness of each disk, m")

    @classmethod
    def conflicts(cls, given: Table) -> Iterator[Fault]:
        """Require one of count and abscissae, which ascend and are not too many."""
        if ("count" in given) == ("at" in given):
            problem = "stands beside at" if "at" in given else "missing"
            yield Fault(("count",), problem, "give count or at")
        places = numbers_of(given.get("at"))
        if len(places) > MOST_DISKS:
            yield Fault(("at",), f"must have at most {MOST_DISKS} entries, got {len(places)}")
        yield from not_ascending(places, ("at",), "place")

    @property
    def places(self) -> tuple[float, ...]:
        """Abscissae X of the disks, ascending."""
        if self.at is not None:
            return self.at
        assert self.count is not None
        return tuple(number / self.count for number in range(1, self.count + 1))
