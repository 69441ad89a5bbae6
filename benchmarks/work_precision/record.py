"""The measured rows as files: a CSV that grows row by row and is taken up again, and a JSON of everything."""

from __future__ import annotations

import csv
import hashlib
import io
import os
from collections.abc import Sequence
from dataclasses import asdict, fields
from importlib.metadata import version
from math import isfinite
from pathlib import Path
from typing import Any, get_type_hints

import casadi as ca

from cosserat_casadi import scene as scenes
from cosserat_casadi.errors import Problem, SceneError
from cosserat_casadi.files import write_atomically
from cosserat_casadi.results.json_text import csv_text, json_text, plain
from cosserat_casadi.scene.writing import scene_text
from work_precision.measurement import Measurement, front

CSV = "bench.csv"
"""File of the rows."""

JSON = "bench.json"
"""File of everything."""

COLUMNS = ("scene", *(field.name for field in fields(Measurement)))
"""Columns of the rows: what tells the scene, and the attributes of a measurement."""

_TYPES = get_type_hints(Measurement)


def fingerprint(scene: scenes.Scene) -> str:
    """Identity of the rows of one scene and version: the beginning of a hash."""
    # Rows do not depend on the title, nor on an accuracy that every candidate brings itself.
    plain = scene.model_copy(update={"title": "", "accuracy": scenes.Accuracy()})
    words = [
        scene_text(plain),
        version("cosserat-casadi"),
        ca.CasadiMeta.version(),
    ]
    text = "\0".join(words)
    digest = hashlib.sha256(text.encode())
    return digest.hexdigest()[:16]


def output_problems(folder: Path) -> list[Problem]:
    """Why a folder cannot take the files; it need not exist, but its parent must."""
    if folder.is_dir():
        if os.access(folder, os.W_OK | os.X_OK):
            return []
        return [_problem(f"the folder {folder} cannot be written to")]
    if folder.exists():
        return [_problem(f"{folder} is a file", "name a folder")]
    if not folder.parent.is_dir():
        return [_problem(f"the folder {folder.parent} does not exist", "make it first")]
    if os.access(folder.parent, os.W_OK):
        return []
    return [_problem(f"the folder {folder.parent} cannot be written to")]


def read_rows(folder: Path, mark: str) -> list[Measurement]:
    """Rows of an earlier bench of the same scene; none where there was none.

    Raises:
        SceneError: the CSV is of another scene or version, or is none of a bench.
    """
    path = folder / CSV
    if not path.is_file():
        return []
    remedy = "name another folder, or remove the file"
    try:
        text = path.read_text(encoding="utf-8")
        table = list(csv.reader(io.StringIO(text)))
        if not table or tuple(table[0]) != COLUMNS:
            raise SceneError(_problem(f"{path} is not the table of a bench of this version", remedy))
        rows = [dict(zip(COLUMNS, cells, strict=True)) for cells in table[1:]]
        marks = {row.pop("scene") for row in rows}
        read = [Measurement(**{name: _parsed(name, cell) for name, cell in row.items()}) for row in rows]
    except (OSError, ValueError, csv.Error):
        raise SceneError(_problem(f"{path} cannot be read as the table of a bench", remedy)) from None
    if marks - {mark}:
        raise SceneError(_problem(f"{path} holds another scene, or this one as an earlier version saw it", remedy))
    return read


def write_rows(folder: Path, mark: str, rows: Sequence[Measurement]) -> None:
    """The CSV with all rows so far, whole at any time; numbers with six digits, an empty cell for NaN."""
    cells = [[mark, *map(_rounded, asdict(row).values())] for row in rows]
    write_atomically(folder / CSV, csv_text(COLUMNS, cells).encode())


def write_json(folder: Path, scene: scenes.Scene, rows: Sequence[Measurement], facts: dict[str, Any]) -> None:
    """Everything as JSON: rows, front, and facts about reference and tools; numbers that are none are null."""
    versions = {"cosserat-casadi": version("cosserat-casadi"), "casadi": ca.CasadiMeta.version()}
    content = {
        "schema": 1,
        "title": scene.title,
        "scene": fingerprint(scene),
        "versions": versions,
        **facts,
        "front": [row.name for row in front(rows)],
        "rows": [asdict(row) for row in rows],
    }
    write_atomically(folder / JSON, json_text(plain(content)).encode())


def _problem(problem: str, remedy: str = "") -> Problem:
    return Problem("--output", problem, remedy)


def _rounded(value: Any) -> Any:
    return f"{value:.6g}" if isinstance(value, float) and isfinite(value) else value


def _parsed(name: str, cell: str) -> Any:
    """The value that a cell of a column holds."""
    kind = _TYPES[name]
    return float(cell or "nan") if kind is float else kind(cell)
