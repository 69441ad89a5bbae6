"""The rows of a sweep: named columns of numbers, from a CSV file, a grid, or arrays."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from cosserat_casadi.errors import Problem, SceneError, collect_problems, refuse
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.load_cases import AskedRange, read_ranges
from cosserat_casadi.scene.number_table import begun_rows, fill, repeated, shortened
from cosserat_casadi.sweeps.grid_file import grid, paired_draws, read_tables, too_many_rows
from cosserat_casadi.sweeps.scratch import BLOCK, MEMORY, Scratch


@dataclass(frozen=True)
class Table:
    """Values of inputs and parameters, a row for each solve.

    Attributes:
        columns: names such as ``push.force.x`` or ``wire.section.radius``.
        values: shape (rows, columns), SI units.
        where: name of the table in refusals.
        lines: the line of each row in the file, shape (rows,); without a file rows are counted from 1.
        factors: columns for whose Sobol indices the rows are drawn; see :func:`sobol_table`.
        scratch: storage of arrays with an entry for each row.
    """

    columns: tuple[str, ...]
    values: FloatArray
    where: str
    lines: FloatArray | None = None
    factors: tuple[str, ...] = ()
    scratch: Scratch = MEMORY

    def where_of(self, row: int) -> str:
        """Name of a row in a refusal."""
        if self.lines is None:
            return f"{self.where}, row {row + 1}"
        return f"{self.where}, line {int(self.lines[row])}"


def read_table(path: Path, *, sobol: bool = False, scratch: Scratch = MEMORY) -> Table:
    """The rows of a grid (``.toml``) or of a CSV file with a header.

    Args:
        path: the file.
        sobol: whether the random columns of a grid are drawn for their Sobol indices.
        scratch: storage for the rows.

    Raises:
        SceneError: with every fault.
        WriteError: the disc has no room for them.
    """
    if path.suffix.lower() == ".toml":
        tables = read_tables(path)
        if sobol:
            return _sobol_table(tables, str(path))
        columns, values = grid(tables, str(path), scratch)
        return Table(columns, values, str(path), scratch=scratch)
    if sobol:
        remedy = "give a grid in TOML with random columns"
        raise SceneError(Problem(str(path), "holds rows of its own; for Sobol indices they are drawn", remedy))
    header, rows = begun_rows(path)
    problems = [Problem(str(path), f"has the column {column} twice") for column in repeated(header)]
    # The first column has the lines.
    numbers = scratch.joined(_blocks(path, header, rows, problems), 1 + len(header))
    refuse(shortened(problems, str(path)))
    return Table(tuple(header), numbers[:, 1:], str(path), numbers[:, 0], scratch=scratch)


def range_table(ranges: Sequence[str], scratch: Scratch = MEMORY) -> Table:
    """The grid of ranges ``column=from:to:count``: every combination of their values, the last range running fastest.

    Args:
        ranges: at least one.
        scratch: storage for the rows.

    Raises:
        SceneError: with every fault.
    """

    def fault(text: str, asked: AskedRange) -> Problem | None:
        if asked.count is not None:
            return None
        return Problem("--range", f"{text!r} does not say how many values", f"write {text}:21 for 21 of them")

    asked = read_ranges(ranges, fault)
    tables = {column: {"from": one.low, "to": one.high, "count": one.count} for column, one in asked.items()}
    columns, values = grid(tables, "--range", scratch)
    return Table(columns, values, "--range", scratch=scratch)


def asked_table(over: Path | None, ranges: Sequence[str], *, sobol: bool = False, scratch: Scratch = MEMORY) -> Table:
    """The rows of a file, of ranges, or every row of the file combined with every row of the ranges.

    Args:
        over: the file; None stands for ranges alone.
        ranges: texts as for :func:`range_table`, at least one without a file.
        sobol: whether the file is a grid with random columns, whose rows are drawn for Sobol indices.
        scratch: storage for the rows.

    Raises:
        SceneError: with every fault of both.
    """
    if over is None:
        return range_table(ranges, scratch)
    problems: list[Problem] = []
    rows: Table | None = None
    grid_of_ranges: Table | None = None
    with collect_problems(problems):
        rows = read_table(over, sobol=sobol, scratch=scratch)
    with collect_problems(problems):
        grid_of_ranges = range_table(ranges) if ranges else None
    if problems or rows is None:
        raise SceneError(*problems)
    return rows if grid_of_ranges is None else crossed(rows, grid_of_ranges)


def crossed(table: Table, ranges: Table) -> Table:
    """Every row of a table combined with every row of ranges, which run fastest.

    Args:
        table: rows of a file.
        ranges: a grid of other columns, in memory.

    Raises:
        SceneError: both have a column, there are too many rows, or the rows were drawn for Sobol indices.
        WriteError: the disc has no room for the rows.
    """
    problems = [
        Problem("--range", f"{column!r} is a column of {table.where} too", "leave one of them out")
        for column in ranges.columns
        if column in table.columns
    ]
    if table.factors:
        problems.append(Problem("--range", "has several values; Sobol indices are of random columns", "leave it out"))
    rows = len(table.values) * len(ranges.values)
    problems += too_many_rows(rows, f"{table.where} and --range")
    refuse(problems)
    stays = len(ranges.values)
    own = len(table.columns)
    values = table.scratch.array((rows, own + len(ranges.columns)))
    for block in table.scratch.blocks(rows):
        numbers = np.arange(block.start, block.stop)
        values[block, :own] = table.values[numbers // stays]
        values[block, own:] = ranges.values[numbers % stays]
    lines = None if table.lines is None else np.repeat(table.lines, stays)
    return Table((*table.columns, *ranges.columns), values, table.where, lines, scratch=table.scratch)


def _blocks(
    path: Path, header: list[str], rows: Iterator[tuple[int, list[str]]], problems: list[Problem]
) -> Iterator[FloatArray]:
    """Blocks of rows, line and numbers of each; faults go to the problems."""
    while several := list(islice(rows, BLOCK)):
        numbers = np.full((len(several), 1 + len(header)), np.nan)
        for values, (line, row) in zip(numbers, several, strict=True):
            values[0] = line
            problems += fill(values[1:], f"{path}, line {line}", header, row)
        yield numbers


def table_of(columns: Mapping[str, npt.ArrayLike], scratch: Scratch = MEMORY) -> Table:
    """The rows of arrays by column; a single number counts for every row.

    Args:
        columns: the arrays.
        scratch: storage for the rows.

    Raises:
        SceneError: there is no row, lengths differ, or a value is not a finite number.
    """
    arrays = {name: _column(name, values) for name, values in columns.items()}
    lengths = {len(array) for array in arrays.values() if array.ndim == 1}
    # A table of single numbers has one row.
    lengths = lengths or {1}
    problems = []
    for name, array in arrays.items():
        if array.ndim > 1:
            problem = f"must be a number or a list of numbers, got {array.ndim} dimensions"
            problems.append(Problem(name, problem))
    if len(lengths) > 1:
        listed = ", ".join(map(str, sorted(lengths)))
        remedy = "columns stand side by side, a row each; numpy.meshgrid and ravel() make those of a grid"
        problems.append(Problem("table", f"has columns of {listed} rows", remedy))
    if not arrays or not min(lengths):
        problems.append(Problem("table", "holds no row"))
    for name, array in arrays.items():
        if not np.all(np.isfinite(array)):
            problems.append(Problem(name, "holds a value that is not a finite number"))
    refuse(problems)
    count = max(lengths)
    full_columns = [np.broadcast_to(array, count) for array in arrays.values()]
    rows = scratch.array((count, len(arrays)))
    for block in scratch.blocks(count):
        rows[block] = np.column_stack([column[block] for column in full_columns])
    return Table(tuple(arrays), rows, "table", scratch=scratch)


def sobol_table(columns: Mapping[str, Any], samples: int, seed: int = 0) -> Table:
    """Rows drawn for the Sobol indices of random columns, (columns + 2) for each sample.

    Args:
        columns: for each random column ``{"uniform": [low, high]}`` or ``{"normal": [mean, deviation]}``; a number for
            each that keeps its value.
        samples: number of draws, at least 2; the intervals narrow with its square root.
        seed: seed of the draws.

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
