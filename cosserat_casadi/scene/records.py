"""Base class of all tables of a scene: a frozen record, all of whose faults come at once.

A record either holds what its fields promise or does not exist. The rules between keys and between tables look at what
the file says, not at validated records, so that their faults come together with those of single values.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from typing import Any, ClassVar, Self, TypeVar

from pydantic import BaseModel, ConfigDict, ModelWrapValidatorHandler, ValidationError, model_validator
from pydantic.fields import FieldInfo
from pydantic_core import ErrorDetails, InitErrorDetails, PydanticCustomError

from cosserat_casadi.scene.faults import LISTS, PLAIN, Fault, Path, SceneTables, Table
from cosserat_casadi.scene.input_fields import InputField

RecordType = TypeVar("RecordType", bound="Record")

REFUSED = "refused"
"""Type of the errors that carry a `Fault` through pydantic."""


def refusal(faults: Iterable[Fault]) -> ValidationError:
    """Wrap faults in the exception that pydantic passes on."""
    lines = [_wrapped(fault) for fault in faults]
    return ValidationError.from_exception_data("scene", lines)


def restated(error: ValidationError, *, below: Path = (), faults: Iterable[Fault] = ()) -> ValidationError:
    """Restate an error of pydantic deeper in the scene, or with more faults.

    Args:
        error: what pydantic raised.
        below: path that its locations are put behind.
        faults: faults that follow the error's.
    """
    errors = error.errors(include_url=False)
    lines = [_line(details, below) for details in errors]
    lines += [_wrapped(fault) for fault in faults]
    return ValidationError.from_exception_data("scene", lines)


def _wrapped(fault: Fault) -> InitErrorDetails:
    context = {"problem": fault.problem, "remedy": fault.remedy}
    kind = PydanticCustomError(REFUSED, "{problem}", context)
    return InitErrorDetails(type=kind, loc=fault.path, input=None)


def _line(details: ErrorDetails, below: Path) -> InitErrorDetails:
    kind: str | PydanticCustomError = details["type"]
    context = details.get("ctx", {})
    # Pydantic knows its own types of errors by name; ours has to bring its sentence along again.
    if kind == REFUSED:
        kind = PydanticCustomError(REFUSED, "{problem}", context)
    location = (*below, *details["loc"])
    return InitErrorDetails(type=kind, loc=location, input=details["input"], ctx=context)


def _as_given(value: Any) -> Any:
    """Turn records back into the tables that they were read from; keys that were left out stay out."""
    if isinstance(value, PLAIN):
        return value
    if isinstance(value, LISTS):
        return [_as_given(entry) for entry in value]
    if isinstance(value, Mapping):
        return {key: _as_given(entry) for key, entry in value.items() if entry is not None}
    # A scene may be built from records in Python as well as from tables; the rules see tables in both cases.
    if isinstance(value, BaseModel):
        return _as_given(value.model_dump(by_alias=True, exclude_unset=True))
    return value


def keys_of(record: type[Record]) -> dict[str, FieldInfo]:
    """The keys of a record's table, as the file writes them."""
    keys = {}
    for name, field in record.model_fields.items():
        keys[field.alias or name] = field
    return keys


class Record(BaseModel):
    """A table of the scene: frozen, without unknown keys, every number finite.

    Attributes:
        example: the table as a scene has it, TOML, for the reference page. The page uses these names: the rods
            "finger" and "arm", the body "platform", the load "push" and the actuator "cable".
        namesakes: keys of other records, each with the key that has its part here.
    """

    example: ClassVar[str] = ""
    namesakes: ClassVar[Mapping[str, str]] = {}

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False, defer_build=True)

    @classmethod
    def conflicts(cls, given: Table) -> Iterator[Fault]:
        """Faults of keys against each other, in a table whose values may be faulty too."""
        yield from ()

    @classmethod
    def settled(cls, given: Table) -> Table:
        """A table as its fields take it; what can be written in several ways is written in one."""
        return given

    def parameter_refusal(self, key: str) -> tuple[str, str] | None:
        """Why the numbers of a key cannot be a parameter, and what to do instead; None where they can."""
        return None

    @model_validator(mode="wrap")
    @classmethod
    def _every_fault_at_once(cls, given: Any, handler: ModelWrapValidatorHandler[Self]) -> Self:
        faults: list[Fault] = []
        if isinstance(given, Mapping):
            faults = list(cls.conflicts(_as_given(given)))
        # The rules go first but do not stop pydantic: its faults and theirs are reported together.
        try:
            record = handler(cls.settled(given) if isinstance(given, Mapping) else given)
        except ValidationError as error:
            raise restated(error, faults=faults) from None
        if faults:
            raise refusal(faults)
        return record


def sound(record: type[RecordType], table: Table) -> RecordType | None:
    """The record of a table; None where the table has faults."""
    try:
        return record.model_validate(table)
    except ValidationError:
        return None


class Entry(Record):
    """An entry of one of the scene's lists: a rod, a load, a support.

    Attributes:
        inputs: fields that may stay free at run time, by name; the name of a field in an inner table has dots.
        references: fields that name entries of other lists, each with the key of that list; a field may hold
            one name or several.
    """

    inputs: ClassVar[Mapping[str, InputField]] = {}
    references: ClassVar[Mapping[str, str]] = {}

    @classmethod
    def scene_conflicts(cls, given: Table, scene: SceneTables) -> Iterator[Fault]:
        """Faults of a table against the rest of the scene.

        Args:
            given: the table, whose values may be faulty.
            scene: all tables of the scene.

        Yields:
            faults, their paths counted from this table.
        """
        yield from ()

    @classmethod
    def free_fields(cls, given: Table) -> tuple[str, ...]:
        """Fields of a table that may stay free at run time, where the table decides which."""
        return tuple(cls.inputs)

    @classmethod
    def input_conflicts(cls, field: str, given: Table, scene: SceneTables) -> Iterator[Fault]:
        """Reasons why one of the free fields cannot stay free in this scene, without path."""
        yield from ()

    def input_upper(self, field: str) -> float:
        """Largest value that physics allows each number of a free field; inf where there is none."""
        upper = self.inputs[field].upper
        return math.inf if upper is None else upper


class HashedTable(dict[str, Any]):
    """A table whose keys are the user's: frozen with its record, and so it has a hash."""

    def __hash__(self) -> int:  # type: ignore[override]
        return hash(tuple(self.items()))
