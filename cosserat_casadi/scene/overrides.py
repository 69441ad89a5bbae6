"""Assignments such as ``push.force=[0.2, 0, 0]``, applied to the tables of a scene before they are read."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from cosserat_casadi.errors import Problem
from cosserat_casadi.scene.faults import SINGULAR, Path, printable, shown
from cosserat_casadi.scene.toml import keys_are_too_deep
from cosserat_casadi.spelling import likely_meant

NAMED_LISTS = tuple(SINGULAR)
"""Lists with entries whose names may begin a key; for a name in several lists the last list counts."""

MOST_NAMES = 12
"""Names that a remedy lists."""

_NOTHING = "there is no {} to set"
"""Problem of a key that does not exist."""


@dataclass(frozen=True)
class Assignment:
    """An override that was applied.

    Attributes:
        key: its left side, as written.
        leaf: path of the set value.
        created: path of the outermost table that the override has created; the leaf if it has created none.
    """

    key: str
    leaf: Path
    created: Path


class RefusedOverride(Exception):  # noqa: N818 - it never leaves the reading of scenes
    """An override that cannot be applied: problem and remedy."""


def apply_overrides(
    tables: dict[str, Any], overrides: Sequence[str], known: Sequence[str]
) -> tuple[list[Assignment], list[Problem]]:
    """Apply assignments to the tables in their order, so that later ones replace earlier ones.

    Args:
        tables: the tables of the scene, which are changed.
        overrides: texts ``key=value``.
        known: keys of a scene.

    Returns:
        the applied assignments, the last one first, and the problems of the refused ones.
    """
    applied: list[Assignment] = []
    refused: list[Problem] = []
    for text in overrides:
        left, equals, right = text.partition("=")
        key = left.strip()
        try:
            if not equals or not key:
                raise RefusedOverride("must read name.field=value", "such as push.force=[0.2,0,0]")
            assignment = assign(tables, key, _value(right.strip()), known)
            _refuse_missing_list(tables, assignment)
        except RefusedOverride as error:
            refused.append(Problem(f"--set {printable(key or text)}", *error.args))
        else:
            applied.insert(0, assignment)
    return applied, refused


def _value(text: str) -> Any:
    parsed: dict[str, Any] = {}
    if not keys_are_too_deep(text):
        try:
            parsed = tomllib.loads(f"value = {text}")
        except (ValueError, RecursionError):
            parsed = {}
    # A text with a line break could contain several assignments.
    if list(parsed) != ["value"]:
        raise RefusedOverride(f"{shown(text)} is not a TOML value", 'text stands in quotes: "body"; a list in brackets')
    return parsed["value"]


def assign(tables: dict[str, Any], key: str, value: Any, known: Sequence[str]) -> Assignment:
    """Set the value of a key, and create missing tables on its path.

    Raises:
        RefusedOverride: the key does not exist.
    """
    container: Any = tables
    path: list[str | int] = []
    created: Path | None = None
    segments = _from_root(tables, key, known)
    for depth in range(len(segments) - 1):
        index = _index(container, segments, depth)
        path.append(index)
        # Tables that a scene leaves out, such as accuracy, are created.
        if isinstance(container, dict) and index not in container:
            container[index] = {}
            created = created or tuple(path)
        container = container[index]
    last = _index(container, segments, len(segments) - 1)
    container[last] = value
    leaf = (*path, last)
    if created is None:
        created = leaf
    return Assignment(key, leaf, created)


def _from_root(tables: Mapping[str, Any], key: str, known: Sequence[str]) -> list[str]:
    """The segments of a key from the root; a key may begin with the name of a load, actuator, rod or support.

    Raises:
        RefusedOverride: nothing has the name that the key begins with, or the key ends there.
    """
    segments = _segments(key)
    lists = _lists_by_name(tables)
    first = segments[0]
    if first in lists:
        if len(segments) == 1:
            entry = _entry(tables[lists[first]], first)
            raise RefusedOverride("is a whole table, not one of its values", _fields_in_words(first, entry))
        return [lists[first], *segments]
    if first not in known:
        problem = f"no load, actuator, rod, support or table is named {shown(first)}"
        raise RefusedOverride(problem, _known_names(first, lists, known))
    return segments


def _segments(key: str) -> list[str]:
    """Names and numbers of a key: both loads[0].force and loads.0.force are read."""
    return re.sub(r"\[(\d+)\]", r".\1", key).split(".")


def _known_names(word: str, lists: Mapping[str, str], known: Sequence[str]) -> str:
    """A remedy for an unknown first word of a key: a similar name, or the names of the scene's entries."""
    names = f"the scene has {', '.join([*lists][:MOST_NAMES])}, and tables such as accuracy.tolerance"
    return likely_meant(word, [*lists, *known]) or names


def _lists_by_name(tables: Mapping[str, Any]) -> dict[str, str]:
    """The list of each named entry, by name.

    A body that stands for a joint is left out: its name belongs to the joint alone.
    """
    lists = {}
    for key in NAMED_LISTS:
        entries = tables.get(key)
        if not isinstance(entries, list):
            continue
        for entry in entries:
            if isinstance(entry, dict) and isinstance(entry.get("name"), str) and entry.get("listed", True):
                lists[entry["name"]] = key
    return lists


def _entry(entries: list[Any], name: str) -> dict[str, Any]:
    """The entry of a list that has a name."""
    return next(entry for entry in entries if isinstance(entry, dict) and entry.get("name") == name)


def _fields(entry: Mapping[str, Any]) -> list[str]:
    """Keys of the values that an entry of a list has."""
    return [field for field in entry if field not in ("name", "kind")]


def _fields_in_words(name: str, entry: Mapping[str, Any]) -> str:
    """A remedy for a key that stops at the name of an entry: the keys of the entry."""
    return f"name one of {', '.join(f'{name}.{field}' for field in _fields(entry))}"


def _index(container: Any, segments: Sequence[str], depth: int) -> Any:
    """The key or index for a segment of a key; entries of lists are given by name or number.

    Raises:
        RefusedOverride: the container has no such entry.
    """
    segment = segments[depth]
    is_number = re.fullmatch(r"[0-9]+", segment) is not None
    if isinstance(container, dict) and segment and (segment in container or not container or not is_number):
        return segment
    if isinstance(container, list):
        for i, entry in enumerate(container):
            if isinstance(entry, dict) and entry.get("name") == segment:
                return i
        # At most nine digits: Python refuses to read integers of thousands.
        if re.fullmatch(r"[0-9]{1,9}", segment) and int(segment) < len(container):
            return int(segment)
    raise RefusedOverride(_NOTHING.format(shown(segment)), _what_to_write(container, segments, depth))


def _what_to_write(container: Any, segments: Sequence[str], depth: int) -> str:
    """A remedy for an override with a segment, at this depth, that does not exist."""
    after = segments[depth + 1 :]
    there = _written(segments[:depth])
    if isinstance(container, dict):
        written = _written([*segments[:depth], *after]) if after else f"{there}.{next(iter(_fields(container)), 'key')}"
        return f"{there} is one table, without entries of numbers: write {written}"
    if not isinstance(container, list):
        return f"{there} is one value: write {there}=…"
    names = [entry["name"] for entry in container if isinstance(entry, dict) and isinstance(entry.get("name"), str)]
    if names:
        # A segment that is a key of the entries means that the name of the entry was left out.
        rest = (
            after
            if re.fullmatch(r"[0-9]*", segments[depth]) or segments[depth] not in container[0]
            else [segments[depth], *after]
        )
        return f"write {' or '.join(_written([name, *rest]) for name in names[:MOST_NAMES])}"
    if not container:
        return f"{there} has no entries"
    if len(container) == 1:
        return f"it has one entry, {there}[0]"
    return f"its entries are {there}[0] to {there}[{len(container) - 1}]"


def _refuse_missing_list(tables: dict[str, Any], assignment: Assignment) -> None:
    """Undo an override of an entry in a missing list, which was created as a table.

    Raises:
        RefusedOverride: the override was of this kind.
    """
    leaf = assignment.leaf
    for depth in range(len(assignment.created), len(leaf)):
        entry = leaf[depth]
        if not isinstance(entry, str) or not entry.isdigit():
            continue
        holder: Any = tables
        for part in assignment.created[:-1]:
            holder = holder[part]
        del holder[assignment.created[-1]]
        there = _written(_segments(assignment.key)[: depth - len(leaf)])
        remedy = f"the scene has no {there}: set all of it, {there}=[…], or write it into the scene"
        raise RefusedOverride(_NOTHING.format(shown(entry)), remedy)


def _written(segments: Sequence[str]) -> str:
    """The key of segments: names with dots between, numbers in brackets."""
    named = segments[1:] if segments[0] in NAMED_LISTS and len(segments) > 1 else segments
    shortest = segments if re.fullmatch(r"[0-9]+", named[0]) else named
    return re.sub(r"\.([0-9]+)(?=\.|$)", r"[\1]", ".".join(shortest))
