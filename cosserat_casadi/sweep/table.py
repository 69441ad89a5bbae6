"""The rows of a sweep: named columns of numbers, from a CSV file, a grid, or arrays."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from cosserat_casadi.errors import Problem, SceneError
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.scene.number_table import read_numbers, shortened
from cosserat_casadi.sweep.grid_file import grid, paired_draws, read_tables


@dataclass(frozen=True)
class Table:
    """Values of inputs and parameters, a row for each solve.

    Attributes:
        columns: names such as ``push.force.x`` or ``wire.section.radius``.
        values: shape (rows, columns), SI units.
        where: what a refusal calls it.
        lines: the line of each row in the file; without one rows are counted from 1.
        factors: columns whose Sobol indices the rows are drawn for; see :func:`sobol_table`.
    """

    columns: tuple[str, ...]
    values: FloatArray
    where: str
    lines: tuple[int, ...] | None = None
    factors: tuple[str, ...] = ()

    def where_of(self, row: int) -> str:
        """What a refusal calls a row."""
        if self.lines is None:
            return f"{self.where}, row {row + 1}"
        return f"{self.where}, line {self.lines[row]}"


def read_table(path: Path, *, sobol: bool = False) -> Table:
    """The rows of a grid (``.toml``) or of a CSV file with a header.

    Args:
        path: the file.
        sobol: whether the random columns of a grid are drawn for their Sobol indices.

    Raises:
        SceneError: with every fault.
    """
    if path.suffix.lower() == ".toml":
        tables = read_tables(path)
        return _sobol_table(tables, str(path)) if sobol else Table(*grid(tables, str(path)), str(path))
    if sobol:
        remedy = "give a grid in TOML with random columns"
        raise SceneError(Problem(str(path), "holds rows of its own; for Sobol indices they are drawn", remedy))
    header, values, lines, problems = read_numbers(path)
    if problems:
        raise SceneError(*shortened(problems, str(path)))
    return Table(tuple(header), values, str(path), tuple(lines))


def table_of(columns: Mapping[str, npt.ArrayLike]) -> Table:
    """The rows of arrays by column; a single number is that of every row.

    Raises:
        SceneError: there is no row, lengths differ, or a value is not a finite number.
    """
    arrays = {name: _column(name, values) for name, values in columns.items()}
    lengths = {len(array) for array in arrays.values() if array.ndim == 1}
    # Numbers alone are a table of one row.
    lengths = lengths or {1}
    problems = []
    for name, array in arrays.items():
        if array.ndim > 1:
            problem = f"must be a number or a list of numbers, got {array.ndim} dimensions"
            problems.append(Problem(name, problem))
    if len(lengths) > 1:
        listed = ", ".join(map(str, sorted(lengths)))
        problems.append(Problem("table", f"has columns of {listed} rows"))
    if not arrays or not min(lengths):
        problems.append(Problem("table", "holds no row"))
    for name, array in arrays.items():
        if not np.all(np.isfinite(array)):
            problems.append(Problem(name, "holds what is not a finite number"))
    if problems:
        raise SceneError(*problems)
    count = max(lengths)
    full_columns = [np.broadcast_to(array, count) for array in arrays.values()]
    return Table(tuple(arrays), np.column_stack(full_columns), "table")


def sobol_table(columns: Mapping[str, Any], samples: int, seed: int = 0) -> Table:
    """Rows drawn for the Sobol indices of random columns, (columns + 2) for each sample.

    Args:
        columns: for each random column ``{"uniform": [low, high]}`` or ``{"normal": [mean, deviation]}``; a number for
            each that keeps its value.
        samples: draws, at least 2; the intervals narrow with the root of it.
        seed: of the draws.

    Raises:
        SceneError: with every fault.
    """
    return _sobol_table({**columns, "samples": samples, "seed": seed}, "table")


def _sobol_table(tables: Mapping[str, Any], where: str) -> Table:
    columns, values, factors = paired_draws(tables, where)
    return Table(columns, values, where, factors=factors)


def _column(name: str, values: npt.ArrayLike) -> FloatArray:
    try:
        return np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError):
        raise SceneError(Problem(name, "must be a number or a list of numbers")) from None
