"""The files of a sweep: results as CSV, Parquet or a dataset, and a record of the computation as JSON.

A dataset is a folder of Parquet files, which many readers take as one table.

pyarrow is an extra and is imported inside functions only.
"""

from __future__ import annotations

import csv
import json
import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from cosserat_casadi.errors import CosseratError, Problem, SceneError
from cosserat_casadi.files import atomic_file, atomic_folder, check_writable, write_atomically
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.sweeps.outcome_table import LABELS, WITHIN, Sweep

DATASET = ".dataset"
"""Suffix of a folder of Parquet files."""

FORMATS = (".csv", ".parquet", DATASET)
"""Suffixes of the results."""

STABLE = "stable"
"""The column of stability; empty if stability is not judged."""

TRUTHS = (WITHIN, STABLE)
"""Columns with true and false."""

WORDS = {"true": 1.0, "false": 0.0, "": np.nan}
"""Numbers for cells of a CSV file with words, or for empty cells."""

BLOCK = 4096
"""Number of rows that are written at once."""

ROW_GROUP = 65_536
"""Rows that are written to Parquet at once: its readers skip or share out such groups of rows."""

PART_ROWS = 16 * ROW_GROUP
"""Rows of each file of a dataset: some 100 MB."""


_Read = tuple[list[str], npt.NDArray[np.int64], FloatArray]
"""Columns of a file of results, its outcomes as indices in LABELS, and the numbers of all other columns."""


class ParquetUnavailableError(CosseratError):
    """Parquet files need pyarrow."""

    page = "sweeps"

    def __init__(self) -> None:
        super().__init__("Parquet needs pyarrow: install it with  pip install 'cosserat-casadi[sweep]', or write .csv")


def check_output(path: Path) -> None:
    """Refuse results that could not be written.

    Raises:
        SceneError: the suffix is not in FORMATS, or the path cannot be written.
        ParquetUnavailableError: it is Parquet, and pyarrow is not installed.
    """
    check_writable(path, "--output", folder=_is_dataset(path))
    if path.suffix.lower() not in FORMATS:
        problem = f"{path} is neither CSV nor Parquet"
        raise SceneError(Problem("--output", problem, f"use {', '.join(FORMATS)}"))
    if _is_parquet(path):
        arrow_module()


def record_file(path: Path) -> Path:
    """The file of the record: ``results.csv.json`` beside ``results.csv``."""
    return path.with_name(f"{path.name}.json")


def read_record(path: Path) -> dict[str, Any] | None:
    """The record of a file of results; None without a record."""
    try:
        text = record_file(path).read_text(encoding="utf-8")
        record = json.loads(text)
    except (OSError, ValueError):
        return None
    if isinstance(record, dict) and "sweep" in record:
        return record
    return None


def write_sweep(sweep: Sweep, path: Path) -> None:
    """Write record and results, each atomically; equal sweeps give equal bytes."""
    # The record is written first: results without one belong to others, and are never overwritten.
    text = json.dumps(sweep.record, indent=1, ensure_ascii=False, allow_nan=False) + "\n"
    record = record_file(path)
    recorded_before = record.exists()
    write_atomically(record, text.encode())
    try:
        if _is_dataset(path):
            with atomic_folder(path) as folder:
                # Names of the parts sort as their rows do.
                for number, rows in enumerate(_blocks(range(len(sweep.values)), PART_ROWS)):
                    _write_parquet(sweep, rows, folder / f"part-{number:05}.parquet")
        else:
            with atomic_file(path) as temporary:
                if _is_parquet(path):
                    _write_parquet(sweep, range(len(sweep.values)), temporary)
                else:
                    _write_csv(sweep, temporary)
    except BaseException:
        # A record without its results would be useless.
        if not recorded_before:
            record.unlink(missing_ok=True)
        raise


def read_sweep(path: str | Path) -> Sweep:
    """Read a file of results, with its record if there is one.

    Raises:
        SceneError: the file cannot be read, or does not belong to a sweep.
    """
    file = Path(path)
    record = read_record(file)
    read = _read_parquet if _is_parquet(file) else _read_csv
    try:
        names, outcomes, values = read(file)
    except (OSError, ValueError, IndexError, NotImplementedError) as error:
        problem = f"cannot be read as the results of a sweep: {error}"
        raise SceneError(Problem(str(file), problem)) from None
    split = names.index("outcome")
    return Sweep(
        swept=tuple(names[:split]),
        found=tuple(names[split + 1 :]),
        values=values,
        outcomes=outcomes,
        record=record or {},
    )


def _is_parquet(path: Path) -> bool:
    return path.suffix.lower() in (".parquet", DATASET)


def _is_dataset(path: Path) -> bool:
    return path.suffix.lower() == DATASET


def _write_csv(sweep: Sweep, path: Path) -> None:
    with path.open("w", encoding="utf-8", newline="") as stream:
        header = [*sweep.swept, "outcome", *sweep.found]
        csv.writer(stream, lineterminator="\n").writerow(header)
        # Numbers and words without commas: the csv module would take half as long again.
        stream.writelines(f"{','.join(cells)}\n" for cells in _cells(sweep))


def _cells(sweep: Sweep) -> Iterator[list[str]]:
    """Rows of the CSV file; a missing result is an empty cell."""
    swept_count = len(sweep.swept)
    iterations = swept_count + sweep.found.index("iterations")
    truths = [swept_count + sweep.found.index(name) for name in TRUTHS if name in sweep.found]
    # Lists of a block of rows: Python's own numbers print faster, and all at once would take too much memory.
    for first in range(0, len(sweep.values), BLOCK):
        block = sweep.values[first : first + BLOCK]
        complete = np.isfinite(block.sum(axis=1)).tolist()
        outcomes = sweep.outcomes[first : first + BLOCK].tolist()
        for row, is_complete, number in zip(block.tolist(), complete, outcomes, strict=True):
            if is_complete:
                cells = list(map(repr, row))
            else:
                cells = ["" if math.isnan(cell) else repr(cell) for cell in row]
            cells[iterations] = str(int(row[iterations]))
            for truth in truths:
                if cells[truth]:
                    cells[truth] = "true" if row[truth] else "false"
            cells.insert(swept_count, LABELS[number])
            yield cells
        sweep.scratch.let_go()


def _write_parquet(sweep: Sweep, rows: range, path: Path) -> None:
    arrow_module()
    import pyarrow.parquet

    # A block at once: a copy of all columns would take as much memory again as the results.
    first, *others = _blocks(rows, ROW_GROUP)
    table = _arrow_table(sweep, first)
    with pyarrow.parquet.ParquetWriter(path, table.schema) as writer:
        writer.write_table(table)
        for block in others:
            sweep.scratch.let_go()
            writer.write_table(_arrow_table(sweep, block))


def _blocks(rows: range, size: int) -> list[range]:
    """Rows cut into blocks of a size; the last one may be smaller."""
    return [rows[start : start + size] for start in range(0, len(rows), size)]


def _arrow_table(sweep: Sweep, block: range) -> Any:
    """Some rows as a table of pyarrow."""
    arrow = arrow_module()
    rows = slice(block.start, block.stop)
    columns: dict[str, Any] = {}
    for name in sweep.swept:
        columns[name] = arrow.array(sweep[name][rows])
    numbers_of_outcomes = arrow.array(sweep.outcomes[rows], arrow.int8())
    columns["outcome"] = arrow.DictionaryArray.from_arrays(numbers_of_outcomes, list(LABELS))
    for name in sweep.found:
        numbers = sweep[name][rows]
        # Taken before the cast: whole numbers have no NaN.
        missing = ~np.isfinite(numbers)
        if name == "iterations":
            numbers = numbers.astype(np.int32)
        if name in TRUTHS:
            numbers = numbers == 1.0
        columns[name] = arrow.array(numbers, mask=missing)
    return arrow.table(columns)


def _read_parquet(path: Path) -> _Read:
    arrow = arrow_module()
    import pyarrow.compute
    import pyarrow.parquet

    table = pyarrow.parquet.read_table(path)
    names = table.column_names
    split = names.index("outcome")
    # Arrays of arrow are cast as they are: Python's own numbers would take several times their memory.
    words = table.column(split).cast(arrow.string())
    places = pyarrow.compute.index_in(words, arrow.array(LABELS))
    if places.null_count:
        raise ValueError("an outcome is not one that a row can have")
    columns = [*table.columns[:split], *table.columns[split + 1 :]]
    values = np.empty((table.num_rows, len(columns)))
    for index, column in enumerate(columns):
        values[:, index] = column.cast(arrow.float64()).to_numpy()
    return names, places.to_numpy().astype(np.int64), values


def _read_csv(path: Path) -> _Read:
    with path.open(encoding="utf-8", newline="") as stream:
        names, *rows = csv.reader(stream)
    columns = list(zip(*rows, strict=True))
    split = names.index("outcome")
    outcomes = np.array([LABELS.index(word) for word in columns[split]])
    numbers = [
        [WORDS[cell] if cell in WORDS else float(cell) for cell in column]
        for column in (*columns[:split], *columns[split + 1 :])
    ]
    return names, outcomes, np.column_stack(numbers)


def arrow_module() -> Any:
    """The module pyarrow.

    Raises:
        ParquetUnavailableError: it is not installed.
    """
    try:
        import pyarrow
    except ImportError:
        raise ParquetUnavailableError from None
    return pyarrow
