"""What the inverse problem is asked: targets of sections and bodies, and ranges of the inputs that it looks for.

They do not act on the rods: a scene with targets is solved like one without.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Annotated, Any, Literal

from pydantic import Discriminator, Field, Tag

from cosserat_casadi.scene.faults import Fault, listing, named, shown, tables
from cosserat_casadi.scene.records import (
    Component,
    NotEmpty,
    Number,
    Positive,
    Quaternion,
    Record,
    Vector,
    by,
    kind_word,
)

Abscissa = Annotated[Number, Field(ge=0, le=1)]


class _Target(Record):
    weight: Positive = Field(1.0, description="weight against other targets where not all can be met, without unit")


class _Placed(_Target):
    rod: str | None = Field(None, description="name of the rod; or body")
    at: Abscissa = Field(1.0, description="abscissa X of the rod's section, without unit; the tip when left out")
    body: str | None = Field(None, description="name of the body; or rod")

    @classmethod
    def conflicts(cls, given: Mapping[str, Any]) -> Iterator[Fault]:
        """A rod or a body; only rods have sections."""
        if "rod" in given and "body" in given:
            yield Fault(("body",), "stands beside rod", "give one of the two")
        elif "rod" not in given and "body" not in given:
            yield Fault(("rod",), "missing", "name a rod or a body")
        elif "at" in given and "body" in given:
            yield Fault(("at",), "is for a rod", "leave it out: a body has one pose")


class PoseTarget(_Placed):
    """Position and orientation that a section or a body is to have."""

    kind: Literal["pose"] = Field(description="position and orientation")
    position: Vector = Field(description="wanted position in world axes, m")
    quaternion: Quaternion = Field(description="wanted orientation w, x, y, z, of norm 1, without unit")


class PositionTarget(_Placed):
    """Position that a section or a body is to have, its orientation free."""

    kind: Literal["position"] = Field(description="position, the orientation is free")
    position: Vector = Field(description="wanted position in world axes, m")


class CurveTarget(_Target):
    """Points that the centreline of a rod is to pass, as nearly as it can."""

    kind: Literal["curve"] = Field(description="points along a rod")
    rod: str = Field(description="name of the rod")
    at: Annotated[tuple[Abscissa, ...], NotEmpty()] = Field(description="abscissae X of the sections, without unit")
    points: Annotated[tuple[Vector, ...], NotEmpty()] = Field(
        description="wanted positions of these sections in world axes, one for each, m"
    )

    @classmethod
    def conflicts(cls, given: Mapping[str, Any]) -> Iterator[Fault]:
        """A point for each section."""
        at, points = given.get("at"), given.get("points")
        if isinstance(at, list) and isinstance(points, list) and len(at) != len(points):
            yield Fault(("points",), f"must have one point for each of {len(at)} sections, got {len(points)}")


Target = Annotated[
    Annotated[PoseTarget, Tag("⟨pose⟩")]
    | Annotated[PositionTarget, Tag("⟨position⟩")]
    | Annotated[CurveTarget, Tag("⟨curve⟩")],
    Discriminator(by("kind")),
    kind_word("kind", ("pose", "position", "curve")),
]


class Bound(Record):
    """The range of an input; what is left out is not bounded on that side."""

    input: str = Field(description="'load.field' of the input")
    lower: Component | None = Field(
        None, description="least value in the unit of the input; a number for all entries, or a list of one for each"
    )
    upper: Component | None = Field(
        None, description="largest value in the unit of the input; a number for all entries, or a list of one for each"
    )

    @classmethod
    def conflicts(cls, given: Mapping[str, Any]) -> Iterator[Fault]:
        """The lower bound is below the upper one."""
        lower, upper = _entries(given.get("lower")), _entries(given.get("upper"))
        if "lower" not in given and "upper" not in given:
            yield Fault(("lower",), "missing", "give lower, upper or both")
        if len(lower) > 1 and len(upper) > 1 and len(lower) != len(upper):
            yield Fault(("upper",), f"must have as many entries as lower, {len(lower)}, got {len(upper)}")
            return
        count = max(len(lower), len(upper))
        pairs = zip(_spread(lower, count), _spread(upper, count), strict=False)
        if any(low > high for low, high in pairs):
            yield Fault(("upper",), "must not be below lower")


def target_faults(given: Mapping[str, Any], inputs: Mapping[str, int]) -> Iterator[Fault]:
    """Faults of targets and bounds against rods, bodies and inputs.

    Args:
        given: the tables of the scene.
        inputs: numbers of entries of the inputs that the scene leaves free, by name.
    """
    for array, word, noun in (("rods", "rod", "rods"), ("bodies", "body", "bodies")):
        known = named(tables(given, array))
        for i, target in tables(given, "targets"):
            name = target.get(word)
            if isinstance(name, str) and name not in known and tables(given, "rods"):
                yield Fault(("targets", i, word), f"no {word} is named {shown(name)}", listing(known, noun))
    yield from _bound_faults(given, inputs)


def _bound_faults(given: Mapping[str, Any], inputs: Mapping[str, int]) -> Iterator[Fault]:
    first: dict[str, int] = {}
    for i, bound in tables(given, "bounds"):
        name = bound.get("input")
        if not isinstance(name, str):
            continue
        if name not in inputs:
            yield Fault(("bounds", i, "input"), f"{shown(name)} is not free at run time", listing(inputs, "inputs"))
            continue
        if first.setdefault(name, i) != i:
            yield Fault(("bounds", i, "input"), f"bounds[{first[name]}] bounds {shown(name)} already")
        for side in ("lower", "upper"):
            count = len(_entries(bound.get(side)))
            if count > 1 and count != inputs[name]:
                wanted = "1 number" if inputs[name] == 1 else f"1 number or {inputs[name]}"
                yield Fault(("bounds", i, side), f"must have {wanted}, got {count}")


def _entries(value: Any) -> list[float]:
    """The numbers of a bound; none where it is faulty or left out."""
    entries = value if isinstance(value, list | tuple) else [value]
    sound = all(isinstance(entry, int | float) and not isinstance(entry, bool) for entry in entries)
    return list(entries) if sound else []


def _spread(values: list[float], count: int) -> list[float]:
    """One number for all entries as a list of them."""
    return values * count if len(values) == 1 else values
