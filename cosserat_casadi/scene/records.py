"""What every table of a scene is made of: frozen records, faults as pydantic passes them on, numbers and vectors."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import Annotated, Any, Self

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Discriminator,
    Field,
    GetCoreSchemaHandler,
    GetJsonSchemaHandler,
    ModelWrapValidatorHandler,
    Tag,
    ValidationError,
    model_validator,
)
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema, InitErrorDetails, PydanticCustomError, core_schema

from cosserat_casadi.scene.faults import Fault, shown

ROUNDING = 1e-15
"""Norms as near to 1 as this are left as they are: what is read, written and read again stays the same."""

Quadruple = tuple[float, float, float, float]
Triple = tuple[float, float, float]


# Faults


def refusal(faults: Iterable[Fault], others: ValidationError | None = None) -> ValidationError:
    """The faults, together with those that pydantic found, as the exception that pydantic passes on."""
    lines = [] if others is None else [_line(error) for error in others.errors(include_url=False)]
    for path, problem, remedy in faults:
        told = PydanticCustomError("refused", "{problem}", {"problem": problem, "remedy": remedy})
        lines.append(InitErrorDetails(type=told, loc=path, input=None))
    return ValidationError.from_exception_data("scene", lines)


def _line(error: Any) -> InitErrorDetails:
    told, context = error["type"], error.get("ctx", {})
    if told == "refused":
        told = PydanticCustomError("refused", "{problem}", context)
    return InitErrorDetails(type=told, loc=error["loc"], input=error["input"], ctx=context)


def _plain(value: Any) -> Any:
    """Records as the tables they were read from, and without what is not given."""
    if isinstance(value, BaseModel):
        value = value.model_dump(by_alias=True, exclude_unset=True)
    if isinstance(value, Mapping):
        return {key: _plain(entry) for key, entry in value.items() if entry is not None}
    if isinstance(value, list | tuple):
        return [_plain(entry) for entry in value]
    return value


class Record(BaseModel):
    """A table of the scene: frozen, without unknown keys, every number finite."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    @classmethod
    def conflicts(cls, given: Mapping[str, Any]) -> Iterator[Fault]:
        """Faults of keys against each other, in a table whose values may be faulty too."""
        yield from ()

    @model_validator(mode="wrap")
    @classmethod
    def _every_fault_at_once(cls, given: Any, handler: ModelWrapValidatorHandler[Self]) -> Self:
        faults = list(cls.conflicts(_plain(given))) if isinstance(given, Mapping) else []
        try:
            record = handler(given)
        except ValidationError as refused:
            raise refusal(faults, refused) from None
        if faults:
            raise refusal(faults)
        return record


# Numbers, vectors and choices


def listed(count: int, what: str) -> BeforeValidator:
    """Lists of one length only, said in one sentence instead of one for each missing entry."""

    def check(value: Any) -> Any:
        if not isinstance(value, list | tuple):
            raise refusal([Fault((), f"must be a list of {what}, got {shown(value)}")])
        if len(value) != count:
            raise refusal([Fault((), f"must be a list of {what}, got {len(value)}")])
        return value

    return BeforeValidator(check)


class NotEmpty:
    """Lists with an entry: pydantic's own bound does not count entries that are faulty."""

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_before_validator_function(self._check, handler(source))

    def __get_pydantic_json_schema__(self, core: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        return {**handler(core), "minItems": 1}

    def _check(self, value: Any) -> Any:
        if isinstance(value, list | tuple) and not value:
            raise refusal([Fault((), "must have at least one entry")])
        return value


def one_or_list(value: Any) -> str:
    """Mark of a value that is one entry or a list of them."""
    return "⟨list⟩" if isinstance(value, list | tuple) else "⟨one⟩"


def kind_word(key: str, known: Sequence[str]) -> BeforeValidator:
    """The key that says which kind of table this is, checked before the table itself."""
    choices = ", ".join(repr(word) for word in known)

    def check(value: Any) -> Any:
        if isinstance(value, BaseModel):
            return value
        if not isinstance(value, Mapping):
            raise refusal([Fault((), f"must be a table, got {shown(value)}")])
        word = value.get(key)
        if word is None:
            raise refusal([Fault((key,), "missing", f"one of {choices}")])
        if word not in known:
            raise refusal([Fault((key,), f"must be one of {choices}, got {shown(word)}")])
        return value

    return BeforeValidator(check)


def by(key: str) -> Callable[[Any], str]:
    """Mark of a table by its word under a key."""

    def tag(value: Any) -> str:
        return f"⟨{value[key] if isinstance(value, Mapping) else getattr(value, key, None)}⟩"

    return tag


def _unit_quaternion(value: Quadruple) -> Quadruple:
    norm = math.hypot(*value)
    if abs(norm - 1.0) > 1e-6:
        raise refusal([Fault((), f"must have norm 1, got norm {norm:.9g}", "divide it by its norm; order w, x, y, z")])
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
    x, y, z = (component / largest for component in value)
    norm = math.hypot(x, y, z)
    return (x / norm, y / norm, z / norm)


def without_repetition(value: tuple[str, ...]) -> tuple[str, ...]:
    """Refuse a name that is listed twice."""
    if faults := list(_repeated(value)):
        raise refusal(faults)
    return value


def _repeated(entries: Sequence[Any]) -> Iterator[Fault]:
    seen: set[str] = set()
    for i, entry in enumerate(entries):
        if isinstance(entry, str) and entry in seen:
            yield Fault((i,), f"{shown(entry)} is listed twice")
        elif isinstance(entry, str):
            seen.add(entry)


Name = Annotated[str, Field(pattern=r"^[A-Za-z][A-Za-z0-9_]*$")]
Number = Annotated[float, Field(strict=True, allow_inf_nan=False)]
Positive = Annotated[Number, Field(gt=0)]
Whole = Annotated[int, Field(strict=True)]
Vector = Annotated[tuple[Number, Number, Number], listed(3, "3 numbers")]
Quaternion = Annotated[tuple[Number, Number, Number, Number], listed(4, "4 numbers"), AfterValidator(_unit_quaternion)]
Direction = Annotated[Vector, AfterValidator(_direction)]
Size = Annotated[
    Annotated[Positive, Tag("⟨one⟩")]
    | Annotated[tuple[Positive, Positive], listed(2, "2 numbers, base and tip"), Tag("⟨list⟩")],
    Discriminator(one_or_list),
]
SizeOrZero = Annotated[
    Annotated[Number, Field(ge=0), Tag("⟨one⟩")]
    | Annotated[
        tuple[Annotated[Number, Field(ge=0)], Annotated[Number, Field(ge=0)]],
        listed(2, "2 numbers, base and tip"),
        Tag("⟨list⟩"),
    ],
    Discriminator(one_or_list),
]
Component = Annotated[
    Annotated[Number, Tag("⟨one⟩")] | Annotated[tuple[Number, ...], NotEmpty(), Tag("⟨list⟩")],
    Discriminator(one_or_list),
]
Polynomials = Annotated[tuple[Component, Component, Component], listed(3, "3 components")]
