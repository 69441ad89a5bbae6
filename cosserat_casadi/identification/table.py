"""Columns of a table of measurements: text cells become numbers where they are asked for, empty ones NaN."""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from cosserat_casadi.errors import Problem, SceneError
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.scene.faults import listing
from cosserat_casadi.scene.number_table import finite_number

NOT_MEASURED = ("", "nan", "na", "none", "null")
"""Cells, in small letters, that say that nothing was measured."""


@dataclass(frozen=True)
class Table:
    """Rows of named cells.

    Attributes:
        source: the file, or what else the rows are from.
        columns: the cells of each column, as text.
        lines: line of each row in the file.
    """

    source: str
    columns: Mapping[str, Sequence[str]]
    lines: tuple[int, ...]

    def __len__(self) -> int:
        return len(self.lines)

    def where(self, row: int) -> str:
        """A row as a message names it."""
        return f"{self.source}, line {self.lines[row]}"

    def missing(self, names: Sequence[str]) -> list[Problem]:
        """A problem for each column that is not there."""
        remedy = listing(self.columns, "columns")
        absent = [name for name in dict.fromkeys(names) if name not in self.columns]
        return [Problem(self.source, f"has no column {name!r}", remedy) for name in absent]

    def numbers(self, name: str, rows: Sequence[int]) -> tuple[FloatArray, list[Problem]]:
        """The numbers of a column in some rows, NaN where nothing was measured, and what is wrong with the others."""
        values = np.full(len(rows), np.nan)
        problems = []
        for i, row in enumerate(rows):
            cell = self.columns[name][row].strip()
            if cell.lower() in NOT_MEASURED:
                continue
            number = finite_number(cell)
            if number is None:
                problem = f"{name} must be a finite number, or empty where it was not measured, got {cell!r}"
                problems.append(Problem(self.where(row), problem))
            else:
                values[i] = number
        return values, problems

    def holds(self, name: str, row: int, value: str | float) -> bool:
        """Whether a cell is a text, or a number."""
        cell = self.columns[name][row].strip()
        if isinstance(value, str):
            return cell == value
        return finite_number(cell) == value


def read_table(path: Path) -> Table:
    """The rows of a CSV file with a header.

    Raises:
        SceneError: the file cannot be read, holds no row, has a column twice, or rows of another length.
    """
    try:
        rows = list(csv.reader(io.StringIO(path.read_text(encoding="utf-8-sig"))))
    except (OSError, ValueError, csv.Error) as error:
        raise SceneError(Problem(str(path), f"cannot be read as CSV: {error}")) from None
    filled = [(line, row) for line, row in enumerate(rows, 1) if any(cell.strip() for cell in row)]
    if len(filled) < 2:
        raise SceneError(Problem(str(path), "holds no row", "give a header and a row below it"))
    header = [cell.strip() for cell in filled[0][1]]
    repeated = sorted({column for column in header if header.count(column) > 1})
    problems = [Problem(str(path), f"has the column {column!r} twice") for column in repeated]
    for line, row in filled[1:]:
        if len(row) != len(header):
            problem = f"has {len(row)} values for {len(header)} columns"
            problems.append(Problem(f"{path}, line {line}", problem))
    if problems:
        raise SceneError(*problems)
    columns = {name: [row[k] for _, row in filled[1:]] for k, name in enumerate(header)}
    return Table(str(path), columns, tuple(line for line, _ in filled[1:]))


def table_of(name: str, columns: Mapping[str, npt.ArrayLike]) -> Table:
    """Columns that are given in Python, as the rows of a file.

    Args:
        name: what to call them in messages.
        columns: of one length, each of shape (rows,); NaN is not measured.

    Raises:
        SceneError: they differ in length.
    """
    arrays = {key: np.atleast_1d(np.asarray(values)) for key, values in columns.items()}
    counts = {array.shape for array in arrays.values()}
    if len(counts) != 1 or len(next(iter(counts))) != 1:
        shapes = ", ".join(f"{key} {array.shape}" for key, array in arrays.items())
        raise SceneError(Problem(name, f"must have columns of one length, got {shapes or 'none'}"))
    texts = {key: [str(value) for value in array.tolist()] for key, array in arrays.items()}
    (count,) = next(iter(counts))
    return Table(name, texts, tuple(range(1, count + 1)))
