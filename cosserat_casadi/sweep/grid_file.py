"""Grids and random samples written as TOML.

A column is a number, a list of numbers, ``{ from, to, count }``, ``{ uniform = [low, high] }`` or
``{ normal = [mean, deviation] }``. The rows are every combination of the first three kinds, the last column running
fastest. Random columns are drawn ``samples`` times with ``seed``; every draw stands beside every combination, so that
one rod drawn is met under all loads.
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

from cosserat_casadi.errors import Problem, SceneError
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.scene.faults import shown

MOST_ROWS = 20_000_000
"""Rows of the largest grid that is made."""

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
        return rng.uniform(first, second, count) if self.kind == "uniform" else rng.normal(first, second, count)


def read_grid(path: Path) -> tuple[tuple[str, ...], FloatArray]:
    """Columns and rows of a grid file.

    Raises:
        SceneError: with every fault.
    """
    try:
        tables = tomllib.loads(path.read_text(encoding="utf-8-sig"))
    except (OSError, UnicodeDecodeError) as error:
        raise SceneError(Problem(str(path), f"cannot be read: {error}")) from None
    except (ValueError, RecursionError) as error:
        raise SceneError(Problem(str(path), f"is not TOML: {error}")) from None
    return grid(tables, str(path))


def grid(tables: Mapping[str, Any], where: str) -> tuple[tuple[str, ...], FloatArray]:
    """Columns and rows of a grid given as tables; those who call the file name it by ``where``.

    Raises:
        SceneError: with every fault.
    """
    problems: list[Problem] = []
    axes: dict[str, FloatArray | _Random] = {}
    for name, given in _leaves({key: entry for key, entry in tables.items() if key not in ("samples", "seed")}):
        try:
            if name in axes:
                raise _Refused("is given twice", "once as a dotted key, once in quotes")
            axes[name] = _axis(given)
        except _Refused as error:
            problems.append(Problem(f"{where}, {name}", *error.args))
    samples = _samples(tables, where, any(isinstance(axis, _Random) for axis in axes.values()), problems)
    rows = math.prod(len(axis) for axis in axes.values() if not isinstance(axis, _Random)) * samples
    if not axes and not problems:
        problems.append(Problem(where, "names no column", REMEDY))
    if rows > MOST_ROWS:
        problems.append(Problem(where, f"asks for {rows:,} rows", f"at most {MOST_ROWS:,}"))
    if problems:
        raise SceneError(*problems)
    return tuple(axes), _product(axes, samples, int(tables.get("seed", 0)))


class _Refused(Exception):  # noqa: N818 - it never leaves this module
    """An entry that is no column: problem and remedy."""


def _leaves(tables: Mapping[str, Any], prefix: str = "") -> Iterator[tuple[str, Any]]:
    """Columns of nested tables: ``push.force.x`` may be written with its dots as TOML takes them, or in quotes."""
    for key, entry in tables.items():
        name = f"{prefix}{key}"
        nested = isinstance(entry, dict) and entry and not set(entry) & {*RANGE, *RANDOM}
        yield from _leaves(entry, f"{name}.") if nested else [(name, entry)]


def _axis(given: Any) -> FloatArray | _Random:
    if isinstance(given, dict):
        return _random(given) if set(given) & set(RANDOM) else _range(given)
    entries = given if isinstance(given, list) else [given]
    if not entries:
        raise _Refused("is an empty list", REMEDY)
    return np.array([_number(entry) for entry in entries])


def _range(given: Mapping[str, Any]) -> FloatArray:
    if set(given) != set(RANGE):
        unknown, missing = sorted(set(given) - set(RANGE)), [key for key in RANGE if key not in given]
        told = [f"does not know {', '.join(unknown)}"] * bool(unknown) + [f"lacks {', '.join(missing)}"] * bool(missing)
        raise _Refused(" and ".join(told), REMEDY)
    count = _whole(given["count"], "count", 1)
    if count > MOST_ROWS:
        raise _Refused(f"asks for {count:,} values", f"at most {MOST_ROWS:,}")
    ends = _number(given["from"]), _number(given["to"])
    if not math.isfinite(ends[1] - ends[0]):
        raise _Refused(BEYOND, REMEDY)
    if count == 1 and ends[0] != ends[1]:
        raise _Refused("has one value between two ends", "count at least 2, or a number")
    return np.linspace(*ends, count)


def _random(given: Mapping[str, Any]) -> _Random:
    (kind,) = set(given) if len(given) == 1 else ("",)
    if kind not in RANDOM:
        raise _Refused(f"mixes {', '.join(sorted(given))}", REMEDY)
    numbers = given[kind]
    if not isinstance(numbers, list) or len(numbers) != 2:
        raise _Refused(f"{kind} must be a list of {RANDOM[kind]}, got {shown(numbers)}", REMEDY)
    first, second = map(_number, numbers)
    if (kind == "uniform" and not first < second) or (kind == "normal" and not second > 0):
        raise _Refused(f"{kind} = {numbers} is no range", "low < high; a deviation is > 0")
    # No draw lies a hundred deviations off.
    if not math.isfinite(second - first if kind == "uniform" else abs(first) + 100 * second):
        raise _Refused(BEYOND, REMEDY)
    return _Random(kind, (first, second))


def _samples(tables: Mapping[str, Any], where: str, random: bool, problems: list[Problem]) -> int:
    """How often random columns are drawn; faults of ``samples`` and ``seed`` go to the problems."""
    for key, least in (("samples", 1), ("seed", 0)):
        if key in tables:
            try:
                _whole(tables[key], key, least)
            except _Refused as error:
                problems.append(Problem(where, *error.args))
        if random != (key in tables):
            told = "is missing for random columns" if random else "stands without random columns"
            remedy = f"give {key} = {least + 100}" if random else "leave it out"
            problems.append(Problem(f"{where}, {key}", told, remedy))
    samples = tables.get("samples", 1)
    return samples if isinstance(samples, int) and samples > 0 else 1


def _product(axes: Mapping[str, FloatArray | _Random], samples: int, seed: int) -> FloatArray:
    """Every combination, shape (rows, columns); draws run slowest."""
    rng = np.random.default_rng(seed)
    drawn = [axis.draw(rng, samples) for axis in axes.values() if isinstance(axis, _Random)]
    fixed = [axis for axis in axes.values() if not isinstance(axis, _Random)]
    count = math.prod(map(len, fixed))
    mesh = iter([part.ravel() for part in np.meshgrid(*fixed, indexing="ij")])
    draws = iter(drawn)
    parts = [
        np.repeat(next(draws), count) if isinstance(axis, _Random) else np.tile(next(mesh), samples)
        for axis in axes.values()
    ]
    return np.column_stack(parts)


def _number(value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not abs(value) <= sys.float_info.max:
        raise _Refused(f"must be a finite number, got {shown(value)}", REMEDY)
    return float(value)


def _whole(value: Any, name: str, least: int) -> int:
    if isinstance(value, bool) or not isinstance(value, int) or value < least:
        raise _Refused(f"{name} must be a whole number >= {least}, got {shown(value)}")
    return value
