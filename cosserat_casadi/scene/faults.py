"""Faults of a scene as data, and access to its tables before they are records."""

from __future__ import annotations

import itertools
import math
import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any, NamedTuple

from pydantic import BaseModel

Path = tuple[str | int, ...]
Table = Mapping[str, Any]

PLAIN = (str, int, float)
"""Classes of values without values inside; this test is faster than the test for a mapping."""

LISTS = (list, tuple)
"""Classes of arrays; this test is faster than the test for a sequence."""

LONGEST_TEXT = 60
"""Characters of a text or a key of the file that a message quotes."""

LONGEST_LIST = 12
"""Names that a remedy lists."""

LARGEST_LENGTH = 1e60
"""Largest length, m, and largest curvature, 1/m: their fourth powers are numbers of double precision."""

SMALLEST_SIZE = 1e-60
"""Smallest size, m: the fourth powers of its inverse are numbers of double precision."""

SIZES = frozenset({"length", "radius", "outer_radius", "inner_radius", "width", "height", "diameter"})
"""Keys of sizes, in every table."""

LENGTHS = SIZES | {
    *("position", "point", "points", "centre", "from", "to", "offset", "centre_of_mass"),
    *("straight", "curved", "translation", "curvature"),
}
"""Keys of sizes, of other lengths, of positions, and of curvatures."""

PROFILE_KEYS = ("base", "tip", "legendre", "powers")
"""Keys of a table of values that vary along the rod, below the key of the quantity."""

SINGULAR = {
    "obstacles": "obstacle",
    "rod_contacts": "contact of rods",
    "supports": "support",
    "joints": "joint",
    "disks": "row of disks",
    "bodies": "body",
    "rods": "rod",
    "actuators": "actuator",
    "loads": "load",
    "tubes": "tube",
}
"""Lists with named entries, and the word for one entry of each in an error message."""


class Fault(NamedTuple):
    """One fault at a path of the scene.

    Attributes:
        path: keys and indices from the record that is checked.
        problem: the fault in words.
        remedy: advice; empty if the problem implies it.
    """

    path: Path
    problem: str
    remedy: str = ""


class SceneTables:
    """The tables of a scene as the file gives them: any value may be missing or faulty."""

    def __init__(self, given: Table) -> None:
        self._given = given
        # A rule asks for the same list once for each entry of another.
        self._tables: dict[str, list[tuple[int, Table]]] = {}
        self._named: dict[str, dict[str, tuple[int, Table]]] = {}

    @property
    def keys(self) -> tuple[str, ...]:
        """All keys of the scene, known or not."""
        return tuple(self._given)

    def get(self, key: str) -> Any:
        """The value of a key; None if it is left out."""
        return self._given.get(key)

    def tables(self, key: str) -> list[tuple[int, Table]]:
        """The tables of a list with their indices; entries that are no tables are left out."""
        if key not in self._tables:
            entries = enumerate(list_of(self._given.get(key)))
            self._tables[key] = [(i, entry) for i, entry in entries if isinstance(entry, Mapping)]
        return self._tables[key]

    def named(self, key: str) -> dict[str, tuple[int, Table]]:
        """The first table of every name in a list, with its index."""
        if key not in self._named:
            first = self._named[key] = {}
            for i, table in self.tables(key):
                name = table.get("name")
                if isinstance(name, str):
                    first.setdefault(name, (i, table))
        return self._named[key]

    def table_named(self, key: str, name: Any) -> Table:
        """The first table of a name in a list; empty if there is none."""
        _, table = self.named(key).get(name, (0, {})) if isinstance(name, str) else (0, {})
        return table


def faults_of_range(value: Any, path: Path = ()) -> Iterator[Fault]:
    """Faults of numbers, anywhere in a value, that cannot be computed with.

    These are integers beyond the range of double precision, and lengths with powers that overflow. The types refuse
    infinity and NaN.
    """
    if isinstance(value, PLAIN):
        # These values have no fault under any key.
        if isinstance(value, str) or not value or SMALLEST_SIZE <= abs(value) <= LARGEST_LENGTH:
            return
        if isinstance(value, int) and abs(value) > sys.float_info.max:
            yield Fault(path, f"must be finite, got {shown(value)}")
        else:
            yield from _length_faults(float(value), path)
    elif isinstance(value, LISTS):
        for i, entry in enumerate(value):
            yield from faults_of_range(entry, (*path, i))
    elif isinstance(value, Mapping):
        for key, entry in value.items():
            yield from faults_of_range(entry, (*path, key))


def _length_faults(value: float, path: Path) -> Iterator[Fault]:
    """Fault of a length that is too large or too small to compute with; the last key of its path tells lengths."""
    keys = [part for part in path if isinstance(part, str)]
    if keys[-1] in PROFILE_KEYS:
        keys.pop()
    key = keys[-1] if keys else ""
    if key in LENGTHS and LARGEST_LENGTH < abs(value) < math.inf:
        yield Fault(path, f"must be at most {LARGEST_LENGTH:g} in size, got {shown(value)}", "lengths are in m")
    if key in SIZES and 0.0 < abs(value) < SMALLEST_SIZE:
        yield Fault(path, f"must be at least {SMALLEST_SIZE:g}, got {shown(value)}", "lengths are in m")


def shown(value: object) -> str:
    """A value of the file for a message: short, as TOML."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        return repr(shortened(value))
    if isinstance(value, int):
        # Python refuses to print integers of thousands of digits.
        return str(value) if abs(value) < 10**30 else "a whole number beyond all range"
    if isinstance(value, float):
        return repr(float(value))
    if isinstance(value, list | tuple):
        return f"a list of {len(value)}"
    if isinstance(value, Mapping | BaseModel):
        return "a table"
    return f"a {type(value).__name__}"


def printable(text: str) -> str:
    """A text in a message, short, and without characters that move the cursor of a terminal."""
    return repr(shortened(text))[1:-1]


def shortened(text: str) -> str:
    """A text, cut off if it is too long for a message."""
    return text if len(text) <= LONGEST_TEXT else text[: LONGEST_TEXT - 3] + "..."


def listing(names: Iterable[str], what: str) -> str:
    """A remedy that lists the known names, the first few of many."""
    known = [name if name.isprintable() else repr(name) for name in names]
    if not known:
        return f"there are no {what}"
    if len(known) > LONGEST_LIST:
        known = [*known[:LONGEST_LIST], "…"]
    return f"{what}: {', '.join(known)}"


def below(path: Path, faults: Iterable[Fault]) -> Iterator[Fault]:
    """Faults with paths that begin with ``path``."""
    return (fault._replace(path=(*path, *fault.path)) for fault in faults)


def refused_keys(given: Table, keys: Iterable[str], problem: str, remedy: str) -> Iterator[Fault]:
    """A fault for each of some keys that a table has."""
    return (Fault((key,), problem, remedy) for key in keys if key in given)


def not_ascending(numbers: Sequence[float], path: Path, what: str) -> Iterator[Fault]:
    """A fault for each of several numbers that is not greater than the one before it.

    Args:
        numbers: the numbers.
        path: path of their list.
        what: word for one of them.
    """
    for i, (before, number) in enumerate(itertools.pairwise(numbers), 1):
        if not number > before:
            yield Fault((*path, i), f"must be > {shown(before)}, the {what} before it, got {shown(number)}")


def frame_faults(given: Table) -> Iterator[Fault]:
    """Faults of a table that names a section of a rod, or a body."""
    yield from one_of("rod", "body", given, "name a rod or a body")
    if "at" in given and "body" in given and "rod" not in given:
        yield Fault(("at",), "is for a rod", "leave it out: a body has one pose")


def one_of(first: str, second: str, given: Table, remedy: str = "") -> Iterator[Fault]:
    """Faults unless a table has exactly one of two keys; ``remedy`` is for a table without either."""
    if first in given and second in given:
        yield Fault((second,), f"stands beside {first}", "give one of the two")
    if first not in given and second not in given:
        yield Fault((first,), "missing", remedy or f"give {first} or {second}")


def faults_of_ends(given: Table, *, equal: bool) -> Iterator[Fault]:
    """Faults of a lower and an upper end, one number for all entries or a list; both may be missing or faulty.

    Args:
        given: the table.
        equal: whether both ends may be equal.
    """
    lower, upper = numbers_of(given.get("lower")), numbers_of(given.get("upper"))
    count = max(len(lower), len(upper))
    if min(len(lower), len(upper)) > 1 and len(lower) != len(upper):
        yield Fault(("upper",), f"must have as many entries as lower, {len(lower)}, got {len(upper)}")
        return
    # A missing or faulty end has no numbers to compare.
    lowest, highest = (side * count if len(side) == 1 else side for side in (lower, upper))
    pairs = list(zip(lowest, highest, strict=False))
    if any(low > high or (low == high and not equal) for low, high in pairs):
        yield Fault(("upper",), "must not be below lower" if equal else "must be above lower")


def table_of(value: Any) -> Table:
    """The value if it is a table; else an empty table."""
    return value if isinstance(value, Mapping) else {}


def list_of(value: Any) -> Sequence[Any]:
    """The value if it is a list; else an empty list."""
    return value if isinstance(value, list | tuple) else ()


def numbers_of(value: Any) -> list[float]:
    """The numbers of a value that is a number or a list of numbers; empty for other values."""
    numbers = list(value) if isinstance(value, list | tuple) else [value]
    # Truth values are integers in Python.
    for number in numbers:
        if isinstance(number, bool) or not isinstance(number, int | float):
            return []
    return numbers
