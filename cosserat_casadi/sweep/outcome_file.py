"""The files of a sweep: results as CSV or Parquet, and beside them what was computed, as JSON.

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

from cosserat_casadi.errors import CosseratError, Problem, SceneError
from cosserat_casadi.files import atomic_file, write_atomically
from cosserat_casadi.sweep.outcome_table import LABELS, Sweep

FORMATS = (".csv", ".parquet")
"""Suffixes of the results."""

BLOCK = 4096
"""Rows that are written at once."""


class ParquetUnavailableError(CosseratError):
    """Parquet files need pyarrow."""

    def __init__(self) -> None:
        super().__init__("Parquet needs pyarrow: install it with  pip install 'cosserat-casadi[sweep]', or write .csv")


def check_format(path: Path) -> None:
    """Refuse a file that could not be written.

    Raises:
        SceneError: the suffix is none of FORMATS.
        ParquetUnavailableError: it is Parquet, and pyarrow is not installed.
    """
    if path.suffix.lower() not in FORMATS:
        raise SceneError(Problem("--output", f"{path} is neither CSV nor Parquet", f"use {' or '.join(FORMATS)}"))
    if path.suffix.lower() == ".parquet":
        _arrow()


def record_file(path: Path) -> Path:
    """The file that says what was computed: ``results.csv.json`` beside ``results.csv``."""
    return path.with_name(f"{path.name}.json")


def read_record(path: Path) -> dict[str, Any] | None:
    """What was computed for a file of results; None where nothing says so."""
    try:
        found = json.loads(record_file(path).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
    return found if isinstance(found, dict) and "sweep" in found else None


def write_sweep(sweep: Sweep, path: Path) -> None:
    """Write record and results, each whole or not at all; the same sweep gives the same bytes."""
    # The record comes first: results without one are not ours, and are never written over.
    text = json.dumps(sweep.record, indent=1, ensure_ascii=False, allow_nan=False) + "\n"
    write_atomically(record_file(path), text.encode())
    with atomic_file(path) as temporary:
        if path.suffix.lower() == ".parquet":
            _write_parquet(sweep, temporary)
        else:
            with temporary.open("w", encoding="utf-8", newline="") as stream:
                csv.writer(stream, lineterminator="\n").writerow([*sweep.swept, "outcome", *sweep.found])
                # Numbers and words without commas: the csv module would take half as long again.
                stream.writelines(f"{','.join(cells)}\n" for cells in _cells(sweep))


def read_sweep(path: str | Path) -> Sweep:
    """Read results that were written, with their record where that lies beside them.

    Raises:
        SceneError: the file cannot be read, or is not of a sweep.
    """
    file = Path(path)
    record = read_record(file)
    try:
        names, columns = _read_parquet(file) if file.suffix.lower() == ".parquet" else _read_csv(file)
        place = names.index("outcome")
        outcomes = np.array([LABELS.index(word) for word in columns[place]])
        numbers = [
            np.array([np.nan if cell in ("", None) else float(cell) for cell in column])
            for column in columns
            if column is not columns[place]
        ]
    except (OSError, ValueError, IndexError) as error:
        raise SceneError(Problem(str(file), f"cannot be read as the results of a sweep: {error}")) from None
    return Sweep(tuple(names[:place]), tuple(names[place + 1 :]), np.column_stack(numbers), outcomes, record or {})


def _cells(sweep: Sweep) -> Iterator[list[str]]:
    """Rows of the CSV file; what was not found is an empty cell."""
    swept, steps = len(sweep.swept), sweep.found.index("iterations")
    whole = np.isfinite(sweep.values.sum(axis=1)).tolist()
    for first in range(0, len(sweep.values), BLOCK):
        for place, row in enumerate(sweep.values[first : first + BLOCK].tolist(), first):
            cells = list(map(repr, row)) if whole[place] else ["" if math.isnan(cell) else repr(cell) for cell in row]
            cells[swept + steps] = str(int(row[swept + steps]))
            cells.insert(swept, LABELS[sweep.outcomes[place]])
            yield cells


def _write_parquet(sweep: Sweep, path: Path) -> None:
    arrow = _arrow()
    columns: dict[str, Any] = {}
    for name in sweep.swept:
        columns[name] = arrow.array(sweep[name])
    columns["outcome"] = arrow.DictionaryArray.from_arrays(arrow.array(sweep.outcomes, arrow.int8()), list(LABELS))
    for name in sweep.found:
        whole = name == "iterations"
        numbers = sweep[name].astype(np.int32) if whole else sweep[name]
        columns[name] = arrow.array(numbers, mask=~np.isfinite(sweep[name]))
    import pyarrow.parquet

    pyarrow.parquet.write_table(arrow.table(columns), path)


def _read_parquet(path: Path) -> tuple[list[str], list[Any]]:
    _arrow()
    import pyarrow.parquet

    table = pyarrow.parquet.read_table(path)
    return table.column_names, [column.to_pylist() for column in table.columns]


def _read_csv(path: Path) -> tuple[list[str], list[Any]]:
    with path.open(encoding="utf-8", newline="") as stream:
        header, *rows = csv.reader(stream)
    return header, list(zip(*rows, strict=True))


def _arrow() -> Any:
    try:
        import pyarrow
    except ImportError:
        raise ParquetUnavailableError from None
    return pyarrow
