"""Values of a scene: numbers, vectors, orientations, names, and one-or-list choices, each with its refusals."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from typing import Annotated, Any

from pydantic import (
    AfterValidator,
    BeforeValidator,
    Discriminator,
    Field,
    GetCoreSchemaHandler,
    GetJsonSchemaHandler,
    Tag,
)
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema, core_schema

from cosserat_casadi.scene.faults import Fault, Path, shown
from cosserat_casadi.scene.records import refusal

ROUNDING = 1e-15
"""Norms as near to 1 as this are left as they are: what is read, written and read again stays the same."""

NORM_SLACK = 1e-6
"""Distance of a quaternion's norm from 1 that is put down to rounding in the file."""

Quadruple = tuple[float, float, float, float]
Triple = tuple[float, float, float]


# Lists


def listed(count: int, what: str) -> BeforeValidator:
    """Refuse lists of any other length in one sentence, instead of one for each missing entry."""

    def check(value: Any) -> Any:
        got: object = shown(value)
        if isinstance(value, list | tuple):
            got = len(value)
        if got != count:
            raise refusal([Fault((), f"must be a list of {what}, got {got}")])
        return value

    return BeforeValidator(check)


class NotEmpty:
    """Refuse lists without entry: pydantic's own bound does not count entries that are faulty."""

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_before_validator_function(self._check, handler(source))

    def __get_pydantic_json_schema__(self, core: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        return {**handler(core), "minItems": 1}

    def _check(self, value: Any) -> Any:
        if isinstance(value, list | tuple) and not value:
            fault = Fault((), "must have at least one entry")
            raise refusal([fault])
        return value


# Marks tell pydantic's locations which choice was taken; ⟨ ⟩ cannot begin a key that the format knows.
SINGLE = Tag("⟨one⟩")
SEVERAL = Tag("⟨list⟩")


def _single_or_several(value: Any) -> str:
    if isinstance(value, list | tuple):
        return SEVERAL.tag
    return SINGLE.tag


BY_LENGTH = Discriminator(_single_or_several)
"""Takes the choice marked `SEVERAL` for a list, the one marked `SINGLE` for anything else."""


# Checks


def _unit_quaternion(value: Quadruple) -> Quadruple:
    norm = math.hypot(*value)
    # Far from 1 it is a mistake, such as another order of the four numbers; near 1 it is rounding, and is mended.
    if abs(norm - 1.0) > NORM_SLACK:
        problem = f"must have norm 1, got norm {norm:.9g}"
        raise refusal([Fault((), problem, "divide it by its norm; order w, x, y, z")])
    if abs(norm - 1.0) <= ROUNDING:
        return value
    w, x, y, z = value
    return (w / norm, x / norm, y / norm, z / norm)


def _direction(value: Triple) -> Triple:
    if abs(math.hypot(*value) - 1.0) <= ROUNDING:
        return value
    largest = max(map(abs, value))
    if largest == 0.0:
        raise refusal([Fault((), "must not be zero", "a direction, such as [1, 0, 0]")])
    # Divided by the largest component first: the norm of the given numbers may overflow or vanish.
    x, y, z = (component / largest for component in value)
    norm = math.hypot(x, y, z)
    return (x / norm, y / norm, z / norm)


def without_repetition(value: tuple[str, ...]) -> tuple[str, ...]:
    """Refuse names that are listed twice."""
    faults = list(_repetitions(value))
    if faults:
        raise refusal(faults)
    return value


def _repetitions(names: Sequence[str]) -> Iterator[Fault]:
    seen: set[str] = set()
    for i, name in enumerate(names):
        if name in seen:
            problem = f"{shown(name)} is listed twice"
            yield Fault((i,), problem)
        seen.add(name)


def numbers_of(value: Any) -> list[float]:
    """The numbers of a value that is one or a list of them; none where it is faulty or left out."""
    numbers = [value]
    if isinstance(value, list | tuple):
        numbers = list(value)
    # Truth values are integers in Python.
    for number in numbers:
        if isinstance(number, bool) or not isinstance(number, int | float):
            return []
    return numbers


def not_increasing(times: Sequence[float], path: Path) -> Iterator[Fault]:
    """The first of several times that is not later than the one before it."""
    for i, (before, time) in enumerate(itertools.pairwise(times), 1):
        if not time > before:
            yield Fault((*path, i), f"must be > {shown(before)}, the time before it, got {shown(time)}")
            return


def above_base(remedy_at_base: str) -> AfterValidator:
    """Refuse abscissae X that are not above 0 and at most 1.

    Args:
        remedy_at_base: what to do instead of naming the base.
    """

    def check(value: float) -> float:
        if 0.0 < value <= 1.0:
            return value
        problem = f"must be > 0 and <= 1, got {shown(value)}"
        if value == 0.0:
            raise refusal([Fault((), problem, remedy_at_base)])
        raise refusal([Fault((), problem)])

    return AfterValidator(check)


ABOVE_BASE: Any = Field(json_schema_extra={"exclusiveMinimum": 0, "maximum": 1})
"""The range that `above_base` holds, for the JSON schema."""


# Types

Name = Annotated[str, Field(pattern=r"^[A-Za-z][A-Za-z0-9_]*$")]
Names = Annotated[tuple[str, ...], NotEmpty(), AfterValidator(without_repetition)]

Number = Annotated[float, Field(strict=True, allow_inf_nan=False)]
Positive = Annotated[Number, Field(gt=0)]
NotNegative = Annotated[Number, Field(ge=0)]
Share = Annotated[Number, Field(ge=0, le=1)]
Whole = Annotated[int, Field(strict=True)]

Vector = Annotated[tuple[Number, Number, Number], listed(3, "3 numbers")]
Direction = Annotated[Vector, AfterValidator(_direction)]
Quaternion = Annotated[tuple[Number, Number, Number, Number], listed(4, "4 numbers"), AfterValidator(_unit_quaternion)]

Size = Annotated[
    Annotated[Positive, SINGLE] | Annotated[tuple[Positive, Positive], listed(2, "2 numbers, base and tip"), SEVERAL],
    BY_LENGTH,
]
"""A number > 0, or two that it changes between, linearly from base to tip."""

SizeOrZero = Annotated[
    Annotated[NotNegative, SINGLE]
    | Annotated[tuple[NotNegative, NotNegative], listed(2, "2 numbers, base and tip"), SEVERAL],
    BY_LENGTH,
]

Component = Annotated[
    Annotated[Number, SINGLE] | Annotated[tuple[Number, ...], NotEmpty(), SEVERAL],
    BY_LENGTH,
]
"""A number, or the coefficients of a polynomial along the rod."""

Polynomials = Annotated[tuple[Component, Component, Component], listed(3, "3 components")]
