"""Numbers of a record that are expressions of parameters, as values by name.

A kernel of a section is written in scalar symbols. Where a number of its load is an expression, the kernel has a symbol
for it beside the symbols of the inputs.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from cosserat_casadi.maths.numbers import is_symbolic
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.scene.records import Entry, Record


def expressions_in(record: Any) -> dict[str, Matrix]:
    """Expressions in a record by their paths, but for those of its inputs."""
    found: dict[str, Matrix] = {}
    # What stands for a record in another program has none.
    if not isinstance(record, Entry):
        return found
    for key in type(record).model_fields:
        if key not in record.inputs:
            _collect(getattr(record, key), key, found)
    return found


def _collect(value: Any, path: str, found: dict[str, Matrix]) -> None:
    if is_symbolic(value):
        found[path] = value
    elif isinstance(value, tuple):
        for i, entry in enumerate(value):
            _collect(entry, f"{path}[{i}]", found)
    elif isinstance(value, Record):
        for key in type(value).model_fields:
            _collect(getattr(value, key), f"{path}.{key}", found)


def with_expressions(record: Entry, values: Mapping[str, Matrix]) -> Entry:
    """The record with these values at their paths; names that are no paths of its expressions are not read."""
    changes = {}
    for key in type(record).model_fields:
        if key not in record.inputs:
            changes[key] = _replaced(getattr(record, key), key, values)
    return record.model_copy(update=changes)


def _replaced(value: Any, path: str, values: Mapping[str, Matrix]) -> Any:
    if is_symbolic(value):
        return values[path]
    if isinstance(value, tuple):
        return tuple(_replaced(entry, f"{path}[{i}]", values) for i, entry in enumerate(value))
    if isinstance(value, Record):
        keys = type(value).model_fields
        return value.model_copy(update={key: _replaced(getattr(value, key), f"{path}.{key}", values) for key in keys})
    return value
