"""Columns of numbers from a CSV file with a header."""

from __future__ import annotations

import csv
import math
from collections.abc import Iterator
from itertools import chain
from pathlib import Path

import numpy as np

from cosserat_casadi.errors import Problem, SceneError
from cosserat_casadi.maths.typing import FloatArray

MOST_TOLD = 20
"""Most reported faults of one table; a file may have one in every row."""

SEPARATORS = (";", "\t")
"""Separators of columns in tables of other programs; no name of a column has them."""


def read_numbers(path: Path) -> tuple[list[str], FloatArray, list[int], list[Problem]]:
    """Header of a CSV file, its numbers, shape (count, columns), the line of each row, and every fault of its cells.

    Raises:
        SceneError: the file cannot be read, or has no row.
    """
    header, later = begun_rows(path)
    rows = list(later)
    problems = [Problem(str(path), f"has the column {column} twice") for column in repeated(header)]
    numbers = np.full((len(rows), len(header)), np.nan)
    for values, (line, row) in zip(numbers, rows, strict=True):
        problems += fill(values, f"{path}, line {line}", header, row)
    return header, numbers, [line for line, _ in rows], problems


def begun_rows(path: Path) -> tuple[list[str], Iterator[tuple[int, list[str]]]]:
    """Header of a table, and line and cells of each filled row, read one by one: a file may be larger than memory.

    Raises:
        SceneError: the file cannot be read, which may show only at a later row, or has no row.
    """
    rows = _filled_rows(path)
    _, names = next(rows, (0, []))
    first = next(rows, None)
    if first is None:
        raise SceneError(Problem(str(path), "holds no row of numbers", "give a header and a row of numbers below it"))
    header = [cell.strip() for cell in names]
    if len(header) == 1 and any(sign in header[0] for sign in SEPARATORS):
        problem = f"has the one column {header[0]!r}"
        raise SceneError(Problem(str(path), problem, "separate columns by commas, and write decimals with a point"))
    return header, chain([first], rows)


def _filled_rows(path: Path) -> Iterator[tuple[int, list[str]]]:
    """The line and the cells of each row that is not empty."""
    try:
        with path.open(encoding="utf-8-sig") as stream:
            for line, row in enumerate(csv.reader(stream), 1):
                if any(cell.strip() for cell in row):
                    yield line, row
    except OSError as error:
        raise SceneError(Problem(str(path), f"cannot be read: {error.strerror}")) from None
    except (ValueError, csv.Error) as error:
        raise SceneError(Problem(str(path), f"cannot be read as CSV: {error}")) from None


def repeated(header: list[str]) -> list[str]:
    """Names of columns that occur twice."""
    return sorted({column for column in header if header.count(column) > 1})


def length_faults(where: str, header: list[str], row: list[str]) -> list[Problem]:
    """Problems with the number of cells of a row."""
    if len(row) == len(header):
        return []
    return [Problem(where, f"has {len(row)} values for {len(header)} columns")]


def finite_number(text: str) -> float | None:
    """The number in a text; None if it is not a number, or not finite."""
    if "_" in text:
        # Python reads 1_0 as ten; in a table it is a typing error.
        return None
    try:
        value = float(text)
    except ValueError:
        return None
    return value if math.isfinite(value) else None


def shortened(problems: list[Problem], where: str) -> list[Problem]:
    """The first faults, and the number of the others."""
    if len(problems) <= MOST_TOLD:
        return problems
    further = len(problems) - MOST_TOLD
    return [*problems[:MOST_TOLD], Problem(where, f"has {further} more faults")]


def fill(values: FloatArray, where: str, header: list[str], row: list[str]) -> list[Problem]:
    """Put the numbers of a row into an array, and return the problems of the other cells."""
    problems = length_faults(where, header, row)
    if problems:
        return problems
    for k, (column, cell) in enumerate(zip(header, row, strict=True)):
        number = finite_number(cell)
        if number is None:
            problems.append(Problem(where, f"{column} must be a finite number, got {cell!r}"))
        else:
            values[k] = number
    return problems
