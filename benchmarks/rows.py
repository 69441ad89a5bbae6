"""Rows of measurements in CSV files that grow row by row, so that a stopped run loses nothing."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from dataclasses import asdict, fields
from pathlib import Path
from typing import Any


def read(file: Path) -> list[dict[str, str]]:
    """The rows of a file; none where there is no file."""
    if not file.exists():
        return []
    with file.open(newline="") as lines:
        return list(csv.DictReader(lines))


def append(file: Path, rows: Sequence[Any]) -> None:
    """Dataclass instances as rows of a file, all of them at once; the head first where the file is new."""
    new = not file.exists()
    file.parent.mkdir(parents=True, exist_ok=True)
    with file.open("a", newline="") as lines:
        writer = csv.DictWriter(lines, [f.name for f in fields(rows[0])])
        if new:
            writer.writeheader()
        writer.writerows(map(asdict, rows))
