"""Sets of load cases: rows of a CSV file, or points spread evenly over ranges of the inputs.

A column is ``load.field.axis`` with axis x, y or z, ``load.field.axis.degree`` for a Legendre coefficient beyond the
constant one, or ``actuator.field`` for a number. Inputs without a column keep the scene's values.
"""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from cosserat_casadi.errors import Problem, SceneError
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.inputs import InputLayout

AXES = {1: ("",), 3: ("x", "y", "z"), 4: ("w", "x", "y", "z")}
"""Names of the entries of a number, a vector and a quaternion."""


def column_places(layout: InputLayout) -> dict[str, int]:
    """Where each column stands in the stacked inputs."""
    places = {}
    for name, place, default in zip(layout.names, layout.slices.values(), layout.defaults, strict=True):
        for k in range(default.size):
            axes = AXES[len(default)]
            axis = f".{axes[k % len(axes)]}" if len(axes) > 1 else ""
            degree = f".{k // len(axes)}" if k >= len(axes) else ""
            places[f"{name}{axis}{degree}"] = place.start + k
    return places


def read_load_cases(path: Path, layout: InputLayout) -> FloatArray:
    """Load cases of a CSV file with a header, shape (count, size of the inputs), SI units.

    Raises:
        SceneError: with every fault: a column that is no input, a row of another length, what is not a finite number.
    """
    header, numbers, _, problems = read_numbers(path)
    places = column_places(layout)
    problems = [_no_column(str(path), column, places) for column in header if column not in places] + problems
    if problems:
        raise SceneError(*problems)
    cases = np.tile(layout.pack(), (len(numbers), 1))
    cases[:, [places[column] for column in header]] = numbers
    return cases


def read_numbers(path: Path) -> tuple[list[str], FloatArray, list[int], list[Problem]]:
    """Header of a CSV file, its numbers, shape (count, columns), the line of each row, and every fault of its cells.

    Raises:
        SceneError: the file cannot be read, or holds no row.
    """
    try:
        rows = list(csv.reader(io.StringIO(path.read_text(encoding="utf-8-sig"))))
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise SceneError(Problem(str(path), f"cannot be read as CSV: {error}")) from None
    filled = [(number, row) for number, row in enumerate(rows, 1) if any(cell.strip() for cell in row)]
    if len(filled) < 2:
        raise SceneError(Problem(str(path), "holds no load case", "give a header and one row for each case"))
    header = [cell.strip() for cell in filled[0][1]]
    repeated = sorted({column for column in header if header.count(column) > 1})
    problems = [Problem(str(path), f"has the column {column} twice") for column in repeated]
    numbers = np.full((len(filled) - 1, len(header)), np.nan)
    for found, (number, row) in zip(numbers, filled[1:], strict=True):
        problems += _fill(found, f"{path}, line {number}", header, row)
    return header, numbers, [number for number, _ in filled[1:]], problems


def spread(ranges: Sequence[str], count: int, layout: InputLayout) -> FloatArray:
    """Load cases spread evenly over a box, shape (count, size of the inputs).

    The points are the multiples of an irrational direction, modulo one (the additive recurrence with the generalised
    golden ratio), so that any number of them covers the box; the corner of all upper ends comes first.

    Args:
        ranges: ``column=low:high``, such as ``push.force.x=-1:1``.
        count: number of points, at least 1.
        layout: the inputs.

    Raises:
        SceneError: with every fault.
    """
    places, problems = column_places(layout), list[Problem]()
    bounds: dict[int, tuple[float, float]] = {}
    for text in ranges:
        column, _, ends = text.partition("=")
        low, high = (_number(end) for end in (ends.partition(":")[0], ends.partition(":")[2]))
        if column.strip() not in places:
            problems.append(_no_column("--range", column.strip(), places))
        elif low is None or high is None:
            problems.append(Problem("--range", f"{text!r} has no two finite numbers", "such as push.force.x=-1:1"))
        else:
            bounds[places[column.strip()]] = low, high
    if problems:
        raise SceneError(*problems)
    cases = np.tile(layout.pack(), (count, 1))
    shares = _additive_recurrence(count, len(bounds))
    for (place, (low_end, high_end)), share in zip(bounds.items(), shares.T, strict=True):
        cases[:, place] = low_end + share * (high_end - low_end)
    return cases


def _additive_recurrence(count: int, dimension: int) -> FloatArray:
    root = 2.0
    for _ in range(60):
        root = (1 + root) ** (1 / (dimension + 1))
    steps = root ** -np.arange(1.0, dimension + 1)
    return np.vstack([np.ones((1, dimension)), (0.5 + np.arange(1, count)[:, None] * steps) % 1.0])


def _no_column(where: str, column: str, places: dict[str, int]) -> Problem:
    return Problem(where, f"{column!r} is not an input of this scene", f"its inputs are {', '.join(places) or 'none'}")


def _fill(found: FloatArray, where: str, header: list[str], row: list[str]) -> list[Problem]:
    if len(row) != len(header):
        return [Problem(where, f"has {len(row)} values for {len(header)} columns")]
    problems = []
    for k, (column, cell) in enumerate(zip(header, row, strict=True)):
        number = _number(cell)
        if number is None:
            problems.append(Problem(where, f"{column} must be a finite number, got {cell!r}"))
        else:
            found[k] = number
    return problems


def _number(text: str) -> float | None:
    try:
        value = float(text)
    except ValueError:
        return None
    return value if math.isfinite(value) else None
