"""What is wrong with a scene, as data, and how its tables are looked at before they are records."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any, NamedTuple

from pydantic import BaseModel

Path = tuple[str | int, ...]
Tables = list[tuple[int, Mapping[str, Any]]]


class Fault(NamedTuple):
    """One fault at a path of the scene.

    Attributes:
        path: keys and indices from the record that is checked.
        problem: what is wrong.
        remedy: what to do about it; empty when the problem says it already.
    """

    path: Path
    problem: str
    remedy: str = ""


def shown(value: object) -> str:
    """A value of the file as it is quoted in a message: short, in the words of TOML."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        return repr(value if len(value) <= 60 else value[:57] + "...")
    if isinstance(value, int):
        return str(value) if abs(value) < 10**30 else "a whole number beyond all range"
    if isinstance(value, float):
        return repr(float(value))
    if isinstance(value, list | tuple):
        return f"a list of {len(value)}"
    if isinstance(value, Mapping | BaseModel):
        return "a table"
    return f"a {type(value).__name__}"


def tables(given: Mapping[str, Any], key: str) -> Tables:
    """The tables of an array with their indices, without what is not a table."""
    entries = given.get(key)
    if not isinstance(entries, list):
        return []
    return [(i, entry) for i, entry in enumerate(entries) if isinstance(entry, Mapping)]


def named(entries: Tables) -> dict[str, tuple[int, Mapping[str, Any]]]:
    """The first table of every name."""
    found: dict[str, tuple[int, Mapping[str, Any]]] = {}
    for i, table in entries:
        if isinstance(name := table.get("name"), str):
            found.setdefault(name, (i, table))
    return found


def listing(names: Iterable[str], what: str) -> str:
    """A remedy that lists the known names, the first few of many."""
    known = [name if name.isprintable() else repr(name) for name in names]
    return f"{what}: {', '.join(known[:12])}{', …' if len(known) > 12 else ''}" if known else f"there are no {what}"
