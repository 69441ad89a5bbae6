"""Base class of all tables of a scene: a frozen record, with all faults reported at once.

A record exists only if all its fields are valid. Rules between keys and between tables read the tables of the file, not
validated records, so that their faults are reported together with those of single values.
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
    """Wrap faults in the exception that pydantic propagates."""
    lines = [_wrapped(fault) for fault in faults]
    return ValidationError.from_exception_data("scene", lines)


def restated(error: ValidationError, *, below: Path = (), faults: Iterable[Fault] = ()) -> ValidationError:
    """Restate an error of pydantic deeper in the scene, or with more faults.

    Args:
        error: pydantic's exception.
        below: path to put before its locations.
        faults: further faults, after those of the error.
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
    # Pydantic knows its own types of errors by name; our type needs its sentence again.
    if kind == REFUSED:
        kind = PydanticCustomError(REFUSED, "{problem}", context)
    location = (*below, *details["loc"])
    return InitErrorDetails(type=kind, loc=location, input=details["input"], ctx=context)


def _as_given(value: Any) -> Any:
    """Convert records back to the tables of which they were read; keys that were left out stay out."""
    if isinstance(value, PLAIN):
        return value
    if isinstance(value, LISTS):
        return [_as_given(entry) for entry in value]
    if isinstance(value, Mapping):
        return {key: _as_given(entry) for key, entry in value.items() if entry is not None}
    # A scene may be built from records in Python as well as from tables; rules get tables in both cases.
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
        example: an example of the table in TOML, for the reference page. The page uses these names: the rods "finger"
            and "arm", the body "platform", the load "push" and the actuator "cable".
        namesakes: keys of other records, each with the key of this record that has its meaning.
    """

    example: ClassVar[str] = ""
    namesakes: ClassVar[Mapping[str, str]] = {}

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False, defer_build=True)

    @classmethod
    def conflicts(cls, given: Table) -> Iterator[Fault]:
        """Faults of combinations of keys, in a table whose values may be faulty too."""
        yield from ()

    @classmethod
    def settled(cls, given: Table) -> Table:
        """A table in the form of the fields: values with several notations are converted to one."""
        return given

    def parameter_refusal(self, key: str) -> tuple[str, str] | None:
        """Problem and remedy for a key whose numbers cannot be a parameter; None if they can."""
        return None

    @model_validator(mode="wrap")
    @classmethod
    def _every_fault_at_once(cls, given: Any, handler: ModelWrapValidatorHandler[Self]) -> Self:
        faults: list[Fault] = []
        if isinstance(given, Mapping):
            faults = list(cls.conflicts(_as_given(given)))
        # The rules are applied first but do not stop pydantic: the faults of both are reported together.
        try:
            record = handler(cls.settled(given) if isinstance(given, Mapping) else given)
        except ValidationError as error:
            raise restated(error, faults=faults) from None
        if faults:
            raise refusal(faults)
        return record


def sound(record: type[RecordType], table: Table) -> RecordType | None:
    """The record of a table; None if the table has faults."""
    try:
        return record.model_validate(table)
    except ValidationError:
        return None


class Entry(Record):
    """An entry of one of the scene's lists: a rod, a load, a support.

    Attributes:
        inputs: fields that may stay free at run time, by name; the name of a field in an inner table has dots.
        references: fields that name entries of other lists, each with the key of the list; a field may have one name or
            several.
    """

    inputs: ClassVar[Mapping[str, InputField]] = {}
    references: ClassVar[Mapping[str, str]] = {}

    @classmethod
    def scene_conflicts(cls, given: Table, scene: SceneTables) -> Iterator[Fault]:
        """Faults of a table in combination with the rest of the scene.

        Args:
            given: the table, whose values may be faulty.
            scene: all tables of the scene.

        Yields:
            faults, with paths that begin at this table.
        """
        yield from ()

    @classmethod
    def free_fields(cls, given: Table) -> tuple[str, ...]:
        """Fields of a table that may stay free at run time; by default all inputs of the record."""
        return tuple(cls.inputs)

    @classmethod
    def input_conflicts(cls, field: str, given: Table, scene: SceneTables) -> Iterator[Fault]:
        """Faults, without path, of a free field that cannot stay free in this scene."""
        yield from ()

    def input_upper(self, field: str) -> float:
        """Largest value that physics allows each number of a free field; inf where there is none."""
        upper = self.inputs[field].upper
        return math.inf if upper is None else upper


class HashedTable(dict[str, Any]):
    """A table with keys by the user, frozen and hashable like its record."""

    def __hash__(self) -> int:  # type: ignore[override]
        return hash(tuple(self.items()))
