"""Types of values in a scene: numbers, vectors, orientations, names, and choices of one or several."""

from __future__ import annotations

import logging
import math
from collections.abc import Iterator, Mapping
from typing import Annotated, Any

from pydantic import (
    AfterValidator,
    BeforeValidator,
    Discriminator,
    Field,
    GetCoreSchemaHandler,
    GetJsonSchemaHandler,
    Tag,
    ValidationError,
    ValidatorFunctionWrapHandler,
)
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema, core_schema

from cosserat_casadi.scene.faults import Fault, Path, shown
from cosserat_casadi.scene.profiles import ENDS, SERIES, Notation, Profile, RefusedProfile, read_profile
from cosserat_casadi.scene.records import refusal

ROUNDING = 1e-15
"""Distance of a norm from 1 below which it is not changed, so that writing and reading a value does not change it."""

NORM_SLACK = 1e-6
"""Distance of a quaternion's norm from 1 that may be rounding in the file."""

ROUNDED = 1e-3
"""Distance up to which a quaternion counts as one with few digits: it is scaled to norm 1, with a note."""

LOG = logging.getLogger(__name__)

Quadruple = tuple[float, float, float, float]
Triple = tuple[float, float, float]


# Lists


def listed(count: int, what: str) -> BeforeValidator:
    """Refuse lists of any other length in one sentence, instead of one for each missing entry."""

    def check(value: Any) -> Any:
        got: object = len(value) if isinstance(value, list | tuple) else shown(value)
        if got != count:
            raise refusal([Fault((), f"must be a list of {what}, got {got}")])
        return value

    return BeforeValidator(check)


class NotEmpty:
    """Refuse empty lists, with a remedy: pydantic's own bound does not count faulty entries."""

    def __init__(self, remedy: str = "") -> None:
        self._remedy = remedy

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_before_validator_function(self._check, handler(source))

    def __get_pydantic_json_schema__(self, core: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        return {**handler(core), "minItems": 1}

    def _check(self, value: Any) -> Any:
        if isinstance(value, list | tuple) and not value:
            raise refusal([Fault((), "must have at least one entry", self._remedy)])
        return value


# Marks in pydantic's locations tell which choice was taken; no key of the format begins with ⟨.
SINGLE = Tag("⟨one⟩")
SEVERAL = Tag("⟨list⟩")


def _single_or_several(value: Any) -> str:
    return SEVERAL.tag if isinstance(value, list | tuple) else SINGLE.tag


BY_LENGTH = Discriminator(_single_or_several)
"""Discriminator: the choice marked `SEVERAL` for a list, the one marked `SINGLE` for anything else."""


# What varies along X


TABLE_TITLES = ("PositiveAlongRod", "NotNegativeAlongRod", "AlongRod")
"""Titles of the tables of varying values: values > 0, values ≥ 0, any values."""


class Varying:
    """Admit a table of values that vary along X, as well as a number and a plain list; it is read as the key's list.

    Attributes:
        notation: meaning of the numbers of a plain list.
    """

    def __init__(self, notation: Notation) -> None:
        self.notation = notation

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_wrap_validator_function(self._read, handler(source))

    def __get_pydantic_json_schema__(self, core: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        schema = handler(core)
        # A number, with the range of the table's values too, and a list.
        number, plain_list = schema["oneOf"]
        return {**schema, "oneOf": [number, plain_list, self._table_schema(number)]}

    def _read(self, value: Any, read_list: ValidatorFunctionWrapHandler) -> Any:
        if not isinstance(value, Mapping):
            return read_list(value)
        try:
            written = read_profile(value)
            stored = written.converted(self.notation)
        except RefusedProfile as refused:
            raise refusal(refused.faults) from None
        try:
            return read_list(stored.numbers)
        except ValidationError as error:
            raise refusal(_range_faults(error, written, stored)) from None

    def _table_schema(self, number: JsonSchemaValue) -> JsonSchemaValue:
        """The JSON schema of a table; the range of the numbers holds at base and tip."""
        coefficients: JsonSchemaValue = {"type": "array", "items": {"type": "number"}, "minItems": 1}
        if self.notation is Notation.ENDS:
            coefficients["maxItems"] = 2
        values = {
            "base": {**number, "description": "value at X = 0"},
            "tip": {**number, "description": "value at X = 1; linear between them"},
            "legendre": {**coefficients, "description": "coefficients of Legendre polynomials in 2X − 1"},
            "powers": {**coefficients, "description": "coefficients of powers of X"},
        }
        positive, not_negative, any_values = TABLE_TITLES
        title = not_negative if "minimum" in number else any_values
        if "exclusiveMinimum" in number:
            title = positive
        return {
            "title": title,
            "type": "object",
            "properties": values,
            "additionalProperties": False,
            "dependentRequired": {"base": ["tip"], "tip": ["base"]},
            "oneOf": [{"required": list(ENDS)}, *({"required": [key]} for key in SERIES)],
        }


def _range_faults(error: ValidationError, written: Profile, stored: Profile) -> Iterator[Fault]:
    """Faults of the numbers of a table, at the keys of the file."""
    for details in error.errors(include_url=False):
        index = details["loc"][-1]
        got = shown(details["input"])
        context = details.get("ctx", {})
        wanted = "finite"
        for bound, sign in (("gt", ">"), ("ge", ">=")):
            if bound in context:
                wanted = f"{sign} {context[bound]:g}"
        # Converted coefficients have no key in the file.
        if stored.notation is not Notation.ENDS or not isinstance(index, int):
            yield Fault((), f"must be {wanted}, got {got}")
        elif written.notation is Notation.ENDS:
            yield Fault((ENDS[index],), f"must be {wanted}, got {got}")
        else:
            yield Fault((), f"must be {wanted} along X, got {got} at the {ENDS[index]}")


# Checks


def _unit_quaternion(value: Quadruple) -> Quadruple:
    norm = math.hypot(*value)
    # A norm far from 1 is a mistake, such as another order of the four numbers; near 1 it is rounding, and is
    # corrected.
    if abs(norm - 1.0) > ROUNDED:
        problem = f"must have norm 1, got norm {norm:.9g}"
        raise refusal([Fault((), problem, "divide it by its norm; order w, x, y, z")])
    if abs(norm - 1.0) > NORM_SLACK:
        LOG.warning("the quaternion %s has norm %.6g and is divided by it", list(value), norm)
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


def without_repetition(value: tuple[str | tuple[str, ...], ...]) -> tuple[str | tuple[str, ...], ...]:
    """Refuse names that are listed twice, also in lists of names for one number."""
    seen: set[str] = set()
    faults = []
    for i, entry in enumerate(value):
        for j, name in enumerate(names_in(entry)):
            path: Path = (i,) if isinstance(entry, str) else (i, j)
            if name in seen:
                faults.append(Fault(path, f"{shown(name)} is listed twice"))
            seen.add(name)
    if faults:
        raise refusal(faults)
    return value


def names_in(entry: str | tuple[str, ...]) -> tuple[str, ...]:
    """The names in an entry, which is one name or several tied ones."""
    return (entry,) if isinstance(entry, str) else entry


def _without_list_of_one(entry: str | tuple[str, ...]) -> str | tuple[str, ...]:
    """The name itself for a list of one name: both spellings are one parameter."""
    names = names_in(entry)
    return names[0] if len(names) == 1 else entry


def above_base(remedy_at_base: str) -> AfterValidator:
    """Refuse abscissae X that are not above 0 and at most 1.

    Args:
        remedy_at_base: advice for the abscissa of the base.
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
"""The range that `above_base` checks, for the JSON schema."""


# Types

Name = Annotated[str, Field(pattern=r"^[A-Za-z][A-Za-z0-9_]*$")]
BodyName = Annotated[str, Field(pattern=r"^[A-Za-z][A-Za-z0-9_]*(\[[0-9]+\])?$")]
"""Name of a body, or of an entry of a table that is written as a body: ``spacers[0]``, ``joints[2]``."""
Names = Annotated[
    tuple[str, ...],
    NotEmpty("name at least one, or leave the key out for its default"),
    AfterValidator(without_repetition),
]
"""Names of things of the scene, for a key that has a meaning when it is left out."""

Number = Annotated[float, Field(strict=True, allow_inf_nan=False)]
Positive = Annotated[Number, Field(gt=0)]
NotNegative = Annotated[Number, Field(ge=0)]
Share = Annotated[Number, Field(ge=0, le=1)]
PoissonRatio = Annotated[Number, Field(gt=-1, le=0.5)]
Whole = Annotated[int, Field(strict=True)]

Vector = Annotated[tuple[Number, Number, Number], listed(3, "3 numbers")]
Direction = Annotated[Vector, AfterValidator(_direction)]
Matrix3 = Annotated[tuple[Vector, Vector, Vector], listed(3, "3 rows of 3 numbers")]
Quaternion = Annotated[tuple[Number, Number, Number, Number], listed(4, "4 numbers"), AfterValidator(_unit_quaternion)]

Size = Annotated[
    Annotated[Positive, SINGLE] | Annotated[tuple[Positive, Positive], listed(2, "2 numbers, base and tip"), SEVERAL],
    BY_LENGTH,
    Varying(Notation.ENDS),
]
"""A number > 0, or what varies linearly along the rod: a plain list is of its values at base and tip."""

SizeOrZero = Annotated[
    Annotated[NotNegative, SINGLE]
    | Annotated[tuple[NotNegative, NotNegative], listed(2, "2 numbers, base and tip"), SEVERAL],
    BY_LENGTH,
    Varying(Notation.ENDS),
]

Component = Annotated[
    Annotated[Number, SINGLE] | Annotated[tuple[Number, ...], NotEmpty(), SEVERAL],
    BY_LENGTH,
]
"""A number, or several."""

PositiveComponent = Annotated[
    Annotated[Positive, SINGLE] | Annotated[tuple[Positive, ...], NotEmpty(), SEVERAL],
    BY_LENGTH,
]
"""A number > 0, or several."""

TiedNames = Annotated[
    Annotated[str, SINGLE] | Annotated[tuple[str, ...], NotEmpty(), SEVERAL],
    BY_LENGTH,
    AfterValidator(_without_list_of_one),
]
"""A name, or several whose numbers are tied together."""

LegendreComponent = Annotated[Component, Varying(Notation.LEGENDRE)]
"""A number, or what varies along the rod: a plain list is of Legendre coefficients in 2X − 1."""

PowerComponent = Annotated[Component, Varying(Notation.POWERS)]
"""A number, or what varies along the rod: a plain list is of coefficients of powers of X."""

Polynomials = Annotated[tuple[LegendreComponent, LegendreComponent, LegendreComponent], listed(3, "3 components")]
