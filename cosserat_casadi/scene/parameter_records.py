"""Parameters: numbers of a scene that become arguments of the model's functions, by their names.

A name is the dotted path of a key from the entry that has it, ``finger.material.youngs_modulus``; a part of its value
follows after it: ``finger.section.radius.tip``, ``finger.intrinsic.curvature.y[1]``.
"""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from enum import Enum
from typing import Any

import numpy as np

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.scene.faults import Fault, Path, shown
from cosserat_casadi.scene.fields import unit_of, varies_by_component, varying_mark
from cosserat_casadi.scene.input_fields import AXES
from cosserat_casadi.scene.profiles import ENDS
from cosserat_casadi.scene.records import Entry, Record, keys_of
from cosserat_casadi.spelling import closest

PARAMETER_LISTS = (
    "loads",
    "actuators",
    "rods",
    "bodies",
    "joints",
    "disks",
    "supports",
    "obstacles",
    "measurements",
    "tubes",
)
"""Lists with numbers that may be parameters; among entries of one name the one with the key counts."""

SPAN = ("start", "end")
"""Names of the two abscissae of a span."""

Cell = tuple[int, int]
"""Index of a number of a key: its component, and its place along the rod."""


class Form(Enum):
    """Form of a key's numbers: a number, numbers at base and tip, or the components of a vector."""

    NUMBER = "number"
    ENDS = "base and tip"
    VECTOR = "components"
    PROFILES = "components along the rod"
    MATRIX = "rows of a matrix"


class RefusedParameter(Exception):  # noqa: N818 - it never leaves the reading of scenes
    """A name that no parameter can have: problem and remedy."""


@dataclass(frozen=True)
class Holder:
    """An entry of a scene that may have parameters.

    Attributes:
        table: key of its list.
        index: its index in the list.
        record: the entry; None if it is faulty.
        name: name of the entry; any value if it is faulty.
    """

    table: str
    index: int
    record: Entry | None
    name: Any


Holders = Mapping[str, Sequence[Holder]]
"""Entries by the words with which a name may begin: their names, and ``joints[0]``."""


@dataclass(frozen=True)
class NamedNumbers:
    """Numbers of a scene that one parameter names.

    Attributes:
        name: as the scene writes it.
        holder: the entry of the scene that has them.
        keys: path of the key in the entry: keys of tables, and indices in lists of tables.
        unit: SI unit of each, "1" without unit.
        form: form of the key's numbers.
        cells: indices of the numbers among those of the key, column after column.
        default: their values in the scene, shape (components, places along the rod).
        tied: other numbers that follow these, with their ratios to these, one for each cell.
    """

    name: str
    holder: Holder
    keys: tuple[str, ...]
    unit: str
    form: Form
    cells: tuple[Cell, ...]
    default: FloatArray
    tied: tuple[tuple[NamedNumbers, tuple[float, ...]], ...] = ()

    @property
    def size(self) -> int:
        """Number of entries."""
        return self.default.size

    @property
    def shape(self) -> tuple[int, int]:
        """Components, and values along the rod: of base and tip, or coefficients."""
        components, places = self.default.shape
        return components, places

    @property
    def all_numbers(self) -> tuple[NamedNumbers, ...]:
        """These numbers, then the numbers that follow them."""
        return (self, *(numbers for numbers, _ in self.tied))

    @property
    def field(self) -> str:
        """``owner.key`` with the keys of inner tables: the name of the key as an input."""
        owner = self.holder.name or f"{self.holder.table}[{self.holder.index}]"
        return ".".join((owner, *self.keys))

    @property
    def cell_names(self) -> tuple[str, ...]:
        """A name for each cell alone."""
        rows = dict.fromkeys(row for row, _ in self.cells)
        columns = dict.fromkeys(column for _, column in self.cells)
        words = _component_words(self.keys[-1], self.form, len(rows))
        names = []
        for row, column in self.cells:
            component = f".{words[row]}" if len(rows) > 1 else ""
            place = ""
            if len(columns) > 1:
                place = f".{ENDS[column]}" if self.form is Form.ENDS else f"[{column}]"
            names.append(self.name + component + place)
        return tuple(names)

    def written(self, record: Entry, values: Sequence[Any]) -> Entry:
        """The entry with other numbers, or expressions, one for each cell."""
        changed: Entry = self._changed(record, self.keys, values)
        return changed

    def _changed(self, record: Any, keys: Sequence[str], values: Sequence[Any]) -> Any:
        key = keys[0]
        if isinstance(record, tuple):
            entries = list(record)
            entries[int(key)] = self._changed(entries[int(key)], keys[1:], values)
            return tuple(entries)
        old = getattr(record, key)
        if len(keys) > 1:
            new = self._changed(old, keys[1:], values)
        else:
            new = _stored(self.form, _grid(self.form, old, self.cells), dict(zip(self.cells, values, strict=True)))
        return record.model_copy(update={key: new})


def named_numbers(name: str, holders: Holders) -> NamedNumbers | None:
    """The numbers of a name; None if their entry is faulty.

    Raises:
        RefusedParameter: the name is not that of numbers that may be parameters.
    """
    # Both joints[0].position and joints.0.position are read.
    segments = re.sub(r"\[(\d+)\]", r".\1", name).split(".")
    first = segments.pop(0)
    if first in PARAMETER_LISTS and segments and segments[0].isdigit():
        first = f"{first}[{int(segments.pop(0)[:9])}]"
    if first not in holders:
        problem = f"no rod, load, actuator, body, joint, support or obstacle is named {shown(first)}"
        names = [word for word in holders if "[" not in word]
        raise RefusedParameter(problem, closest(first, names))
    if not segments:
        raise RefusedParameter("must name a number of an entry", "such as 'finger.material.youngs_modulus'")
    holder = _with_key(holders[first], segments[0])
    if holder.record is None:
        return None
    return _numbers_in(name, holder, segments)


def tied_numbers(names: Sequence[str], holders: Holders) -> NamedNumbers | None:
    """The numbers of the first of several names, with the numbers of the other names, which follow them.

    All keep their ratios in the scene; equal numbers stay equal. None if some entry is faulty.

    Raises:
        RefusedParameter: a name stands for no number that may be a parameter, or some cannot follow the first.
    """
    first, *others = [named_numbers(name, holders) for name in names]
    if first is None or None in others:
        return None
    tied = tuple((other, _ratios(first, other)) for other in others if other is not None)
    return replace(first, tied=tied)


def _ratios(first: NamedNumbers, other: NamedNumbers) -> tuple[float, ...]:
    """Ratios of numbers to the numbers that they follow."""
    if other.unit != first.unit:
        problem = f"{shown(other.name)} is in {other.unit} and cannot follow {shown(first.name)}, in {first.unit}"
        raise RefusedParameter(problem, "tie numbers of one kind together")
    leading = first.default.ravel(order="F")
    following = other.default.ravel(order="F")
    if len(leading) != len(following):
        problem = f"{shown(other.name)} has {len(following)} numbers and {shown(first.name)} {len(leading)}"
        raise RefusedParameter(problem, "name parts of them that have as many")
    if np.array_equal(leading, following):
        return (1.0,) * len(leading)
    if np.any(leading == 0.0):
        problem = f"{shown(first.name)} is zero in the scene, so that {shown(other.name)} has no ratio to it"
        raise RefusedParameter(problem, "begin the list with numbers that are not zero, or give both the same values")
    return tuple((following / leading).tolist())


def _with_key(holders: Sequence[Holder], key: str) -> Holder:
    """The entry with a key, among entries of one name; the first entry if none has the key."""
    for holder in holders:
        if holder.record is None or key in keys_of(type(holder.record)):
            return holder
    return holders[0]


def _numbers_in(name: str, holder: Holder, segments: Sequence[str]) -> NamedNumbers:
    record: Any = holder.record
    remaining = list(segments)
    keys: list[str] = []
    while isinstance(record, Record):
        words = ", ".join(sorted(keys_of(type(record))))
        if not remaining:
            raise RefusedParameter("is a table, not a number", f"go on with one of its keys: {words}")
        key = remaining.pop(0)
        known = keys_of(type(record))
        if key not in known:
            where = ".".join([name.split(".")[0], *keys])
            raise RefusedParameter(f"{where} has no {shown(key)}", closest(key, known))
        reason = record.parameter_refusal(key)
        if reason is not None:
            raise RefusedParameter(*reason)
        field = known[key]
        keys.append(key)
        record = getattr(record, key)
        if _holds_tables(record):
            place = _part(remaining.pop(0) if remaining else "", (), len(record), "entry")
            keys.append(str(place))
            record = record[place]
    value = record
    mark = varying_mark(field)
    form = _form(value, along=mark is not None, by_component=mark is not None and varies_by_component(field))
    unit = unit_of(field)
    cells = _chosen(keys[-1], form, _lengths(form, value), remaining)
    grid = _grid(form, value, cells)
    default = np.array([grid[cell] for cell in cells], dtype=float)
    chosen_rows = len({row for row, _ in cells})
    default = default.reshape(chosen_rows, -1, order="F")
    return NamedNumbers(name, holder, tuple(keys), "1" if unit == "–" else unit, form, cells, default)


def _holds_tables(value: Any) -> bool:
    """Whether a key holds a list of tables, such as the terms of a polynomial."""
    return isinstance(value, tuple) and bool(value) and isinstance(value[0], Record)


def _form(value: Any, *, along: bool, by_component: bool) -> Form:
    """Form of a key's numbers.

    Raises:
        RefusedParameter: the value has no number, or one that selects the structure of the model.
    """
    if value is None:
        raise RefusedParameter("is not given in the scene", "give it a value: the parameter's default")
    if isinstance(value, float):
        return Form.NUMBER
    if isinstance(value, int) and not isinstance(value, bool):
        raise RefusedParameter("is a whole number, which selects the structure of the model", "set it in the scene")
    if isinstance(value, tuple) and value:
        if by_component:
            return Form.PROFILES
        if all(isinstance(number, float) for number in value):
            return Form.ENDS if along else Form.VECTOR
        if all(isinstance(row, tuple) and all(isinstance(number, float) for number in row) for row in value):
            return Form.MATRIX
    raise RefusedParameter("is not a number", "parameters are numbers of the scene")


def _lengths(form: Form, value: Any) -> list[int]:
    """Numbers of each component of a key."""
    if form is Form.NUMBER:
        return [1]
    if form is Form.ENDS:
        return [len(value)]
    return [len(component) if isinstance(component, tuple) else 1 for component in value]


def _chosen(key: str, form: Form, lengths: Sequence[int], parts: Sequence[str]) -> tuple[Cell, ...]:
    """The cells that the parts of a name after its key choose; without parts all, equally many in each component.

    Raises:
        RefusedParameter: there is no such part.
    """
    remaining = list(parts)
    rows = len(lengths)
    columns = max(lengths)
    chosen_rows: Iterable[int] = range(rows)
    # A matrix with one row may get further coefficients.
    if remaining and (rows > 1 or form is Form.MATRIX):
        row = _part(remaining.pop(0), _component_words(key, form, rows), rows, "component")
        chosen_rows = [row]
        columns = lengths[row]
    chosen_columns: Iterable[int] = range(columns)
    if remaining and columns > 1:
        ends = ENDS if form is Form.ENDS else ()
        what = "value" if form is Form.ENDS else "coefficient"
        chosen_columns = [_part(remaining.pop(0), ends, columns, what)]
    if remaining == ["0"]:
        # A constant has one coefficient.
        remaining.clear()
    if remaining:
        problem = f"has no part {shown('.'.join(remaining))}"
        raise RefusedParameter(problem, "to make a coefficient a parameter, give it in the scene: it may be zero")
    return tuple((row, column) for column, row in itertools.product(chosen_columns, chosen_rows))


def _component_words(key: str, form: Form, rows: int) -> Sequence[str]:
    """Names of the components of a key: axes, ends of a span, or numbers of coefficients."""
    if key == "span":
        return SPAN
    if form is Form.VECTOR and rows == 2:
        return ("0", "1")
    return AXES.get(rows, AXES[3][:rows] if rows < 3 else tuple(map(str, range(rows))))


def _part(word: str, words: Sequence[str], count: int, what: str) -> int:
    """The index that a word, or a number, means."""
    if word in words:
        return words.index(word)
    if word.isdigit() and int(word[:9]) < count:
        return int(word)
    known = ", ".join(words) or f"0 to {count - 1}"
    raise RefusedParameter(f"has no {what} {shown(word)}", f"{what}s: {known}")


def _grid(form: Form, value: Any, cells: Iterable[Cell]) -> dict[Cell, Any]:
    """The numbers of a key by cell; numbers that a name adds to a shorter component are zero."""
    grid: dict[Cell, Any] = dict.fromkeys(cells, 0.0)
    if form is Form.NUMBER:
        grid[0, 0] = value
    elif form is Form.ENDS:
        grid.update({(0, column): number for column, number in enumerate(value)})
    else:
        for row, component in enumerate(value):
            numbers = component if isinstance(component, tuple) else (component,)
            grid.update({(row, column): number for column, number in enumerate(numbers)})
    return grid


def _stored(form: Form, grid: Mapping[Cell, Any], values: Mapping[Cell, Any]) -> Any:
    """Value of a key with some of its numbers changed."""
    numbers = {**grid, **values}
    rows = 1 + max(row for row, _ in numbers)
    components = []
    for row in range(rows):
        columns = sorted(column for own, column in numbers if own == row)
        components.append(tuple(numbers[row, column] for column in columns))
    if form is Form.NUMBER:
        return components[0][0]
    if form is Form.ENDS:
        return components[0]
    if form is Form.MATRIX:
        return tuple(components)
    return tuple(component[0] if len(component) == 1 else component for component in components)


def parameter_faults(
    names: Sequence[Any],
    paths: Sequence[Path],
    holders: Holders,
    inputs: Iterable[str],
    requests: Mapping[str, str],
) -> Iterator[Fault]:
    """Faults of the names of the parameters of a scene.

    Args:
        names: values that the scene gives as names, which may be faulty.
        paths: path of each name.
        holders: entries that may have parameters.
        inputs: names of the free inputs.
        requests: names of the inputs of an identification, with the table that asks for each.
    """
    free = set(inputs)
    first: dict[tuple[str, int, tuple[str, ...], Cell], str] = {}
    seen: set[str] = set()
    for name, path in zip(names, paths, strict=True):
        # A name that is listed twice has a fault already.
        if not isinstance(name, str) or name in seen:
            continue
        seen.add(name)
        try:
            numbers = named_numbers(name, holders)
        except RefusedParameter as refused:
            problem, remedy = refused.args
            yield Fault(path, f"{shown(name)}: {problem}", remedy)
            continue
        if numbers is None:
            continue
        if numbers.field in free:
            problem = f"{shown(name)} is an input already"
            yield Fault(path, problem, "leave it out here, or list inputs without it")
        elif numbers.field in requests:
            problem = f"{shown(name)} would be an input as well: {requests[numbers.field]}"
            yield Fault(
                path, problem, f"{shown(numbers.field)} is an input or a parameter: leave it out there, or here"
            )
        places = [(numbers.holder.table, numbers.holder.index, numbers.keys, cell) for cell in numbers.cells]
        again = next((first[place] for place in places if place in first), None)
        if again is not None:
            problem = f"{shown(name)} names what {shown(again)} names already"
            yield Fault(path, problem, "name each number once")
        for place in places:
            first.setdefault(place, name)


def tie_faults(groups: Iterable[tuple[Sequence[Any], Path]], holders: Holders) -> Iterator[Fault]:
    """Faults of names that are listed together but cannot be one parameter; single names are tested elsewhere.

    Args:
        groups: names that are listed together, with the path of their list.
        holders: entries that may have parameters.
    """
    for names, path in groups:
        if not all(isinstance(name, str) for name in names):
            continue
        try:
            for name in names:
                named_numbers(name, holders)
        except RefusedParameter:
            continue
        try:
            tied_numbers(names, holders)
        except RefusedParameter as refused:
            problem, remedy = refused.args
            yield Fault(path, problem, remedy)


def holders_of(entries: Iterable[Holder]) -> dict[str, list[Holder]]:
    """Entries that may have parameters, in the order of their lists, by the words with which a name may begin."""
    known: dict[str, list[Holder]] = {}
    for holder in sorted(entries, key=lambda holder: PARAMETER_LISTS.index(holder.table)):
        if isinstance(holder.name, str):
            known.setdefault(holder.name, []).append(holder)
        known.setdefault(f"{holder.table}[{holder.index}]", []).append(holder)
    return known
