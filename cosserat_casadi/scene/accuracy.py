"""Accuracy of a result, or modes, nodes and rotation to compute it with."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, ClassVar, Literal

from pydantic import AfterValidator, Field, StrictBool

from cosserat_casadi.scene.faults import Fault, Table, shown
from cosserat_casadi.scene.number_table import finite_number
from cosserat_casadi.scene.records import Record, refusal
from cosserat_casadi.scene.values import BY_LENGTH, SEVERAL, SINGLE, NotEmpty, Number, Whole

MOST_MODES = 200
"""Polynomials per strain component and element that a scene may ask for."""

MOST_NODES = 1000
"""Intervals of a grid that a scene may ask for."""

MOST_SECTIONS = 1500
"""Most sections of an element, at which layers are summed, that a scene may ask for."""

MOST_FIBRES = 12
"""Most points across half of a section, at which a law is summed, that a scene may ask for."""

Modes = Annotated[Whole, Field(ge=1, le=MOST_MODES)]
ModesChoice = Annotated[
    Annotated[Modes, SINGLE] | Annotated[tuple[Modes, ...], NotEmpty(), SEVERAL],
    BY_LENGTH,
]


def _ascending(value: str) -> str:
    """Refuse a text that is not the name of a column and two ascending numbers."""
    column, _, ends = value.rpartition("=")
    low, _, high = ends.partition(":")
    lower, upper = finite_number(low), finite_number(high)
    if not column or lower is None or upper is None or lower > upper:
        problem = f"must be a column and two numbers, the lower first, got {shown(value)}"
        raise refusal([Fault((), problem, "such as 'push.force.x=-1:1'")])
    return value


Range = Annotated[str, AfterValidator(_ascending)]

Nodes = Annotated[Whole, Field(ge=2, le=MOST_NODES)]
Sections = Annotated[Whole, Field(ge=1, le=MOST_SECTIONS)]
Fibres = Annotated[Whole, Field(ge=1, le=MOST_FIBRES)]
Rotation = Literal["magnus4", "magnus6", "magnus8", "permuted"]


class RodDiscretisation(Record):
    """Modes, nodes and rotation of one rod, where they differ from the others'."""

    example: ClassVar[str] = """\
[accuracy]
modes = 4
nodes = 10
rotation = "magnus6"
of_rods = [{ rod = "finger", modes = [6, 6, 2], nodes = 14, rotation = "magnus6" }]
"""

    rod: str = Field(description="name of the rod")
    modes: ModesChoice = Field(
        description="polynomial modes per strain component, a whole number or a list of one per admitted strain"
    )
    nodes: Nodes = Field(description="intervals of the Chebyshev grid, a whole number")
    rotation: Rotation = Field(description="how the rotation is integrated, as of all rods")
    sections: Sections | None = Field(
        None, description="sections of an element at which layers are summed, a whole number"
    )
    fibres: Fibres | None = Field(None, description="points across half of its section at which a law is summed")


class Accuracy(Record):
    """Accuracy of the result, or modes, nodes and rotation to compute it with."""

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
    nodes: Nodes | None = Field(None, description="intervals of the Chebyshev grid, a whole number")
    rotation: Rotation | None = Field(
        None,
        description="how the rotation is integrated: products of exponentials of order 4, 6 or 8, or the literal "
        "'permuted' linear system",
    )
    sections: Sections | None = Field(
        None,
        description="beside obstacles with a width and without friction: sections of an element at which their push is "
        "summed, a whole number; as many as the intervals ask for when left out",
    )
    fibres: Fibres | None = Field(
        None,
        description="for rods of rubber: points across half of a section at which the law is summed, a whole number n: "
        "4 n² fibres; 3 when left out",
    )
    of_rods: tuple[RodDiscretisation, ...] = Field(
        (), description="modes, nodes and rotation of single rods, as `cosserat export` writes them where rods differ"
    )
    chosen_for: Annotated[tuple[Range, ...], NotEmpty()] | None = Field(
        None,
        description="ranges that modes and nodes were chosen for, as `cosserat tune` writes them: "
        "'column=low:high' of inputs and parameters, in their units",
    )

    def of_rod(self, name: str) -> Accuracy | RodDiscretisation:
        """The record that fixes modes, nodes and rotation of a rod: its entry in ``of_rods``, else this record."""
        own = [entry for entry in self.of_rods if entry.rod == name]
        return own[0] if own else self

    @classmethod
    def conflicts(cls, given: Table) -> Iterator[Fault]:
        """Refuse keys that have no meaning without modes, nodes or rotation for all rods."""
        if "chosen_for" in given and "modes" not in given:
            yield Fault(("chosen_for",), "stands without modes", "leave it out: it holds ranges of chosen modes")
        for key in ("sections", "fibres"):
            if key in given and "nodes" not in given:
                yield Fault((key,), "stands without nodes", "give modes and nodes, or leave it out")
        if given.get("of_rods") and not {"modes", "nodes", "rotation"} <= given.keys():
            yield Fault(("of_rods",), "stands without modes, nodes and rotation of the others", "give all three")

    @property
    def chosen_ranges(self) -> dict[str, tuple[float, float]]:
        """Lower and upper ends of the ranges that modes and nodes were chosen for, by column; empty without any."""
        ranges = {}
        for text in self.chosen_for or ():
            column, _, ends = text.rpartition("=")
            low, _, high = ends.partition(":")
            ranges[column] = (float(low), float(high))
        return ranges

    @property
    def fixed_by_hand(self) -> bool:
        """Whether the scene fixes modes, nodes or rotation other than by a choice for ranges."""
        return self.fixed and self.chosen_for is None

    @property
    def fixed(self) -> bool:
        """Whether the scene itself chooses modes, nodes or rotation."""
        if self.modes is not None or self.nodes is not None:
            return True
        return self.rotation is not None

    @property
    def binds(self) -> bool:
        """Whether the tolerance applies: a default tolerance does not apply to fixed modes."""
        return not self.fixed or "tolerance" in self.model_fields_set
