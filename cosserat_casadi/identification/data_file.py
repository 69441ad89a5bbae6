"""Columns of a table of measurements: text cells become numbers where they are asked for, empty ones NaN."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from cosserat_casadi.errors import Problem, SceneError, refuse
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.scene.faults import listing
from cosserat_casadi.scene.number_table import finite_number, length_faults, read_rows, repeated

NOT_MEASURED = ("", "nan", "na", "none", "null")
"""Cells, in small letters, that say that nothing was measured."""


@dataclass(frozen=True)
class DataFile:
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
        """The numbers of a column in some rows, NaN where nothing was measured, and the problems of other cells."""
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

    def holds_all(self, values: Mapping[str, str | float], row: int) -> bool:
        """Whether the cells of a row are these texts and numbers, by column."""
        for column, value in values.items():
            cell = self.columns[column][row].strip()
            if value != (cell if isinstance(value, str) else finite_number(cell)):
                return False
        return True


def read_table(path: Path) -> DataFile:
    """The rows of a CSV file with a header.

    Raises:
        SceneError: the file cannot be read, holds no row, has a column twice, or rows of another length.
    """
    header, rows = read_rows(path)
    problems = [Problem(str(path), f"has the column {column!r} twice") for column in repeated(header)]
    for line, row in rows:
        problems += length_faults(f"{path}, line {line}", header, row)
    refuse(problems)
    columns = {name: [row[k] for _, row in rows] for k, name in enumerate(header)}
    return DataFile(str(path), columns, tuple(line for line, _ in rows))


def table_of(name: str, columns: Mapping[str, npt.ArrayLike]) -> DataFile:
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
    return DataFile(name, texts, tuple(range(1, count + 1)))
