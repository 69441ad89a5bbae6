"""Error messages: pydantic's errors ↦ `Fault` ↦ `Problem`, in the words of the format and the order of the file."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping, Sequence
from typing import Any

from pydantic import ValidationError
from pydantic_core import ErrorDetails

from cosserat_casadi.errors import Problem
from cosserat_casadi.scene.families import Family, contents_of
from cosserat_casadi.scene.faults import Fault, Path, printable, shortened, shown
from cosserat_casadi.scene.overrides import Assignment
from cosserat_casadi.scene.records import REFUSED, Record, keys_of
from cosserat_casadi.scene.scene import Scene
from cosserat_casadi.spelling import closest, likely_meant

WANTED = {
    "finite_number": "finite",
    "float_type": "a number",
    "int_type": "a whole number",
    "bool_type": "true or false",
    "string_type": "text",
    "string_unicode": "text",
    "tuple_type": "a list",
    "model_type": "a table",
    "string_pattern_mismatch": "a letter, then letters, digits and underscores",
}
"""Kind of value that a key must have, by pydantic's type of error."""

BOUNDS = {
    "greater_than": (">", "gt"),
    "greater_than_equal": (">=", "ge"),
    "less_than": ("<", "lt"),
    "less_than_equal": ("<=", "le"),
}
"""Sign of a bound, and the key of its value in pydantic's error."""


def problems_of(error: ValidationError, tables: Mapping[str, Any], applied: Sequence[Assignment]) -> list[Problem]:
    """Word the errors of a scene.

    Args:
        error: pydantic's exception.
        tables: the scene, in whose order problems are listed.
        applied: overrides, the last one first: a fault of a value from an override is reported at the override.
    """
    faults = [_fault(details) for details in error.errors(include_url=False)]
    order = _FileOrder(tables)
    faults.sort(key=order.position)
    return [problem_of(fault, applied) for fault in faults]


# From pydantic's errors to faults


def _fault(details: ErrorDetails) -> Fault:
    location = details["loc"]
    kind = details["type"]
    path = _path_of(location, kind)
    if kind == REFUSED:
        context = details["ctx"]
        return Fault(path, context["problem"], context["remedy"])
    # The last part is the key with the fault, in the record that the others lead to.
    record = record_at(location[:-1])
    if kind in ("extra_forbidden", "invalid_key"):
        key = str(location[-1])
        return Fault(path, "unknown key", closest(record.namesakes.get(key, key), keys_of(record)))
    return Fault(path, _problem_text(kind, details), _remedy(kind, path, record, details))


def _path_of(location: Path, kind: str) -> Path:
    """A location of pydantic without marks; an unknown key that looks like a mark is kept."""
    *leading, last = location
    path = [part for part in leading if not _is_mark(part)]
    if kind == "extra_forbidden" or not _is_mark(last):
        path.append(last)
    return tuple(path)


def _is_mark(part: str | int) -> bool:
    if isinstance(part, int):
        return False
    return part.startswith("⟨") and part.endswith("⟩")


def record_at(location: Path) -> type[Record]:
    """The record that a location of pydantic leads into, followed from the scene."""
    record: type[Record] = Scene
    family: Family[Any] | None = None
    for part in location:
        # An index leads to an entry of this list.
        if isinstance(part, int):
            continue
        # The mark of the kind follows the key of a family, or the index in its list.
        if family is not None:
            record = family.records.get(part.strip("⟨⟩"), record)
            family = None
        keys = keys_of(record)
        if part not in keys:
            continue
        contents = contents_of(keys[part])
        if isinstance(contents, Family):
            family = contents
        elif contents is not None:
            record = contents
    return record


def _problem_text(kind: str, details: ErrorDetails) -> str:
    context = details.get("ctx", {})
    got = shown(details["input"])
    if kind == "missing":
        return "missing"
    # Pydantic lists the words as "'a', 'b' or 'c'"; our families list theirs with commas.
    if kind == "literal_error":
        words = context["expected"].replace(" or ", ", ")
        return f"must be one of {words}, got {got}"
    if kind in BOUNDS:
        sign, key = BOUNDS[kind]
        return f"must be {sign} {context[key]:g}, got {got}"
    return f"must be {WANTED.get(kind, 'something else')}, got {got}"


def _remedy(kind: str, path: Path, record: type[Record], details: ErrorDetails) -> str:
    """The closest word, or the description of the field, if the problem alone does not imply it."""
    # The problem of a number out of its range names the range.
    if kind in BOUNDS or kind == "finite_number":
        return ""
    word = details["input"]
    if kind == "literal_error" and isinstance(word, str):
        known = re.findall(r"'([^']*)'", details["ctx"]["expected"])
        remedy = likely_meant(word, known)
        if remedy:
            return remedy
    return _description(path, record)


def _description(path: Path, record: type[Record]) -> str:
    """Description of a key in the schema; empty if the record does not have the key."""
    keys = keys_of(record)
    names = [part for part in path if isinstance(part, str)]
    if not names or names[-1] not in keys:
        return ""
    return keys[names[-1]].description or ""


# From faults to problems


class _FileOrder:
    """Positions of faults in a file."""

    def __init__(self, tables: Mapping[str, Any]) -> None:
        self.tables = tables
        # By identity: tables cannot be keys of a dictionary.
        self._orders: dict[int, dict[Any, int]] = {}

    def position(self, fault: Fault) -> tuple[int, ...]:
        """Indices of the keys of a fault, level by level; a missing key stands at the end of its table."""
        indices: list[int] = []
        container: Any = self.tables
        for part in fault.path:
            if isinstance(container, dict):
                order = self._order(container)
                indices.append(order.get(part, len(container)))
                container = container.get(part)
            elif isinstance(container, list) and isinstance(part, int) and part < len(container):
                indices.append(part)
                container = container[part]
            else:
                # Faults below a value that is not a table or list are in the order of the entries that it could have.
                index = part if isinstance(part, int) else 0
                indices.append(index)
                container = None
        return tuple(indices)

    def _order(self, table: dict[str, Any]) -> dict[Any, int]:
        """Index of each key of a table, kept: a table may have many faults."""
        order = self._orders.get(id(table))
        if order is None:
            order = {key: i for i, key in enumerate(table)}
            self._orders[id(table)] = order
        return order


def problem_of(fault: Fault, applied: Sequence[Assignment]) -> Problem:
    """A fault as a problem; a fault from an override is reported at the override."""
    where = _dotted(fault.path).removeprefix(".")
    # The last override of a key, which is first in the list, counts.
    for assignment in applied:
        depth = len(assignment.leaf)
        option = f"--set {printable(assignment.key)}"
        if fault.path[:depth] == assignment.leaf or assignment.created == fault.path:
            where = f"{option}{_dotted(fault.path[depth:])}"
            break
        if fault.path[: len(assignment.created)] == assignment.created:
            # Another key of a table that the override has created.
            remedy = f"{option} begins this table"
            return Problem(where, fault.problem, f"{fault.remedy}; {remedy}" if fault.remedy else remedy)
    return Problem(where, fault.problem, fault.remedy)


def _dotted(path: Path) -> str:
    """A path in the form in which it follows another path in a key: ``[0].length``."""
    text = ""
    for part in path:
        if isinstance(part, int):
            text += f"[{part}]"
        else:
            text += f".{_quoted(part)}"
    return text


def _quoted(key: str) -> str:
    """A key as TOML writes it, shortened."""
    short = shortened(key)
    if re.fullmatch(r"[\w-]+", short):
        return short
    return json.dumps(short)
