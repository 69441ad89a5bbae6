"""Grids and random samples written as TOML.

A column is a number, a list of numbers, ``{ from, to, count }``, ``{ uniform = [low, high] }`` or
``{ normal = [mean, deviation] }``. The rows are all combinations of the first three kinds; the last column runs
fastest. Random columns are drawn ``samples`` times with ``seed``; every draw is combined with all these rows, so that
each drawn rod is solved under all loads.
"""

from __future__ import annotations

import math
import sys
import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from cosserat_casadi.errors import Problem, SceneError, refuse
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.scene.faults import shown
from cosserat_casadi.sweeps.scratch import MEMORY, Scratch

MOST_ROWS = 20_000_000
"""Most rows of a grid."""

RANGE = ("from", "to", "count")
RANDOM = {"uniform": "low and high", "normal": "mean and deviation"}
BEYOND = "leads beyond the largest number"
REMEDY = "write { from = -1, to = 1, count = 21 }, a list of numbers, { uniform = [0, 1] } or { normal = [0, 1] }"


@dataclass(frozen=True)
class _Random:
    """A random column: its kind and two numbers."""

    kind: str
    numbers: tuple[float, float]

    def draw(self, rng: np.random.Generator, count: int) -> FloatArray:
        first, second = self.numbers
        if self.kind == "uniform":
            return rng.uniform(first, second, count)
        return rng.normal(first, second, count)


def read_tables(path: Path) -> dict[str, Any]:
    """The tables of a grid file.

    Raises:
        SceneError: it cannot be read, or is not TOML.
    """
    try:
        tables: dict[str, Any] = tomllib.loads(path.read_text(encoding="utf-8-sig"))
    except (OSError, UnicodeDecodeError) as error:
        raise SceneError(Problem(str(path), f"cannot be read: {error}")) from None
    except (ValueError, RecursionError) as error:
        raise SceneError(Problem(str(path), f"is not TOML: {error}")) from None
    return tables


def grid(tables: Mapping[str, Any], where: str, scratch: Scratch = MEMORY) -> tuple[tuple[str, ...], FloatArray]:
    """Columns and rows of a grid given as tables.

    Args:
        tables: of the file.
        where: name of the table in refusals.
        scratch: storage for the rows.

    Raises:
        SceneError: with every fault.
    """
    problems: list[Problem] = []
    axes, samples = _axes(tables, where, problems)
    # Counted before the rows are made, since a grid that is too large would not fit into memory.
    combinations = math.prod(len(axis) for axis in axes.values() if not isinstance(axis, _Random))
    problems += too_many_rows(combinations * samples, where)
    refuse(problems)
    seed = int(tables.get("seed", 0))
    return tuple(axes), _product(axes, samples, seed, scratch)


def paired_draws(tables: Mapping[str, Any], where: str) -> tuple[tuple[str, ...], FloatArray, tuple[str, ...]]:
    """Columns and rows of the design for the estimate of Sobol indices, and its random columns.

    Two independent draws A and B of ``samples`` rows each, then for each random column A with that column of B. See
    :mod:`cosserat_casadi.sweeps.sobol`.

    Raises:
        SceneError: with every fault: no column is random, or another one has several values.
    """
    problems: list[Problem] = []
    axes, samples = _axes(tables, where, problems)
    factors = tuple(name for name, axis in axes.items() if isinstance(axis, _Random))
    for name, axis in axes.items():
        if not isinstance(axis, _Random) and len(axis) > 1:
            problem = "has several values; Sobol indices are of random columns beside fixed numbers"
            problems.append(Problem(f"{where}, {name}", problem, "write { uniform = [0, 1] } or one number"))
    if axes and not factors:
        problems.append(Problem(where, "names no random column to find Sobol indices of", REMEDY))
    if samples < 2 and factors:
        problems.append(Problem(f"{where}, samples", "must be at least 2 for Sobol indices", "give some thousands"))
    problems += too_many_rows(samples * (len(factors) + 2), where)
    refuse(problems)
    seed = int(tables.get("seed", 0))
    return tuple(axes), _pairs(axes, factors, samples, seed), factors


def _axes(
    tables: Mapping[str, Any], where: str, problems: list[Problem]
) -> tuple[dict[str, FloatArray | _Random], int]:
    """The columns of a grid and the number of draws of random ones; faults are added to the problems."""
    axes: dict[str, FloatArray | _Random] = {}
    columns = {key: entry for key, entry in tables.items() if key not in ("samples", "seed")}
    for name, entry in _leaves(columns):
        try:
            if name in axes:
                raise _Refused("is given twice", "once as a dotted key, once in quotes")
            axes[name] = _axis(entry)
        except _Refused as error:
            problems.append(Problem(f"{where}, {name}", *error.args))
    has_random = any(isinstance(axis, _Random) for axis in axes.values())
    samples = _samples(tables, where, has_random, problems)
    if not axes and not problems:
        problems.append(Problem(where, "names no column", REMEDY))
    return axes, samples


def too_many_rows(rows: int, where: str) -> list[Problem]:
    """The problem of a grid that is too large; empty for others."""
    if rows <= MOST_ROWS:
        return []
    return [Problem(where, f"asks for {rows:,} rows", f"at most {MOST_ROWS:,}")]


class _Refused(Exception):  # noqa: N818 - it never leaves this module
    """An entry that is no column: problem and remedy."""


def _leaves(tables: Mapping[str, Any], prefix: str = "") -> Iterator[tuple[str, Any]]:
    """Columns of nested tables: ``push.force.x`` may be written as a dotted key, or in quotes."""
    for key, entry in tables.items():
        name = f"{prefix}{key}"
        # An entry that is not a column contains columns.
        if isinstance(entry, dict) and entry and not set(entry) & {*RANGE, *RANDOM}:
            yield from _leaves(entry, f"{name}.")
        else:
            yield name, entry


def _axis(entry: Any) -> FloatArray | _Random:
    """The values of a column, or its distribution."""
    if isinstance(entry, dict):
        if set(entry) & set(RANDOM):
            return _random(entry)
        return _range(entry)
    entries = entry if isinstance(entry, list) else [entry]
    if not entries:
        raise _Refused("is an empty list", REMEDY)
    return np.array([_number(number) for number in entries])


def _range(entry: Mapping[str, Any]) -> FloatArray:
    """Evenly spaced values, both ends included."""
    unknown = sorted(set(entry) - set(RANGE))
    missing = [key for key in RANGE if key not in entry]
    faults = [f"does not know {', '.join(unknown)}"] if unknown else []
    faults += [f"lacks {', '.join(missing)}"] if missing else []
    if faults:
        raise _Refused(" and ".join(faults), REMEDY)
    count = _whole(entry["count"], "count", 1)
    if count > MOST_ROWS:
        raise _Refused(f"asks for {count:,} values", f"at most {MOST_ROWS:,}")
    start = _number(entry["from"])
    end = _number(entry["to"])
    if not math.isfinite(end - start):
        raise _Refused(BEYOND, REMEDY)
    if count == 1 and start != end:
        raise _Refused("has one value between two ends", "count at least 2, or a number")
    return np.linspace(start, end, count)


def _random(entry: Mapping[str, Any]) -> _Random:
    kinds = list(entry)
    if len(kinds) != 1 or kinds[0] not in RANDOM:
        raise _Refused(f"mixes {', '.join(sorted(entry))}", REMEDY)
    kind = kinds[0]
    numbers = entry[kind]
    if not isinstance(numbers, list) or len(numbers) != 2:
        raise _Refused(f"{kind} must be a list of {RANDOM[kind]}, got {shown(numbers)}", REMEDY)
    first, second = map(_number, numbers)
    if kind == "uniform":
        sound = first < second
        reach = second - first
    else:
        sound = second > 0
        # No draw lies a hundred deviations off.
        reach = abs(first) + 100 * second
    if not sound:
        raise _Refused(f"{kind} = {numbers} is no range", "low < high; a deviation is > 0")
    if not math.isfinite(reach):
        raise _Refused(BEYOND, REMEDY)
    return _Random(kind, (first, second))


def _samples(tables: Mapping[str, Any], where: str, random: bool, problems: list[Problem]) -> int:
    """Number of draws of random columns; faults of ``samples`` and ``seed`` are added to the problems."""
    for key, least in (("samples", 1), ("seed", 0)):
        if key in tables:
            try:
                _whole(tables[key], key, least)
            except _Refused as error:
                problems.append(Problem(where, *error.args))
        if random and key not in tables:
            problem = "is missing for random columns"
            problems.append(Problem(f"{where}, {key}", problem, f"give {key} = {least + 100}"))
        if not random and key in tables:
            problems.append(Problem(f"{where}, {key}", "stands without random columns", "leave it out"))
    samples = tables.get("samples", 1)
    # If it is refused the rows are still counted, with one draw.
    return samples if isinstance(samples, int) and samples > 0 else 1


def _product(axes: Mapping[str, FloatArray | _Random], samples: int, seed: int, scratch: Scratch) -> FloatArray:
    """Every combination, shape (rows, columns); draws run slowest."""
    rng = np.random.default_rng(seed)
    sizes = [len(axis) for axis in axes.values() if not isinstance(axis, _Random)]
    combinations = math.prod(sizes)
    values = scratch.array((samples * combinations, len(axes)))
    # Number of successive rows with one value of a column; the last column runs fastest.
    stays = combinations
    for column, axis in enumerate(axes.values()):
        if isinstance(axis, _Random):
            drawn = _drawn(axis, rng, samples, scratch)
            for rows in scratch.blocks(len(values)):
                values[rows, column] = drawn[np.arange(rows.start, rows.stop) // combinations]
            continue
        stays //= len(axis)
        for rows in scratch.blocks(len(values)):
            values[rows, column] = axis[np.arange(rows.start, rows.stop) // stays % len(axis)]
    return values


def _drawn(axis: _Random, rng: np.random.Generator, samples: int, scratch: Scratch) -> FloatArray:
    """The draws of a random column, shape (samples,)."""
    drawn = scratch.array((samples,))
    for rows in scratch.blocks(samples):
        drawn[rows] = axis.draw(rng, rows.stop - rows.start)
    return drawn


def _pairs(axes: Mapping[str, FloatArray | _Random], factors: tuple[str, ...], samples: int, seed: int) -> FloatArray:
    """The rows of A, of B, and of A with one column of B after the other, shape ((factors + 2) samples, columns)."""
    rng = np.random.default_rng(seed)
    draws = []
    for _ in range(2):
        columns = [
            axis.draw(rng, samples) if isinstance(axis, _Random) else np.full(samples, axis[0])
            for axis in axes.values()
        ]
        draws.append(np.column_stack(columns))
    first, second = draws
    mixed = []
    for name in factors:
        column = list(axes).index(name)
        rows = first.copy()
        rows[:, column] = second[:, column]
        mixed.append(rows)
    return np.vstack([first, second, *mixed])


def _number(value: Any) -> float:
    # A boolean is an integer in Python, and NaN fails the comparison.
    is_number = isinstance(value, int | float)
    if isinstance(value, bool) or not is_number or not abs(value) <= sys.float_info.max:
        raise _Refused(f"must be a finite number, got {shown(value)}", REMEDY)
    return float(value)


def _whole(value: Any, name: str, least: int) -> int:
    if isinstance(value, bool) or not isinstance(value, int) or value < least:
        raise _Refused(f"{name} must be a whole number >= {least}, got {shown(value)}")
    return value
