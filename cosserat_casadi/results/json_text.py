"""Numbers and arrays as plain data, and plain data and tables as the texts of files."""

from __future__ import annotations

import csv
import io
import json
import math
from collections.abc import Iterable
from typing import Any

import numpy as np

SCHEMA = 1
"""Version of the result files."""


def plain(value: Any) -> Any:
    """A value for JSON: arrays as lists, plain Python numbers, None for a number that is not finite."""
    if isinstance(value, dict):
        return {key: plain(entry) for key, entry in value.items()}
    if isinstance(value, np.ndarray):
        return plain(value.tolist())
    if isinstance(value, list | tuple):
        return [plain(entry) for entry in value]
    # JSON has no infinity and no NaN.
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value


def json_text(data: dict[str, Any]) -> str:
    """Plain data as the text of a file."""
    return json.dumps(data, indent=1, allow_nan=False, ensure_ascii=False) + "\n"


def csv_text(header: Iterable[str], rows: Iterable[Iterable[Any]]) -> str:
    """A table as the text of a CSV file."""
    lines = io.StringIO()
    writer = csv.writer(lines, lineterminator="\n")
    writer.writerow(header)
    writer.writerows(map(_cell, row) for row in rows)
    return lines.getvalue()


def _cell(value: Any) -> Any:
    """Text of a cell: booleans in lower case, numbers in shortest round-trip form, else empty."""
    if isinstance(value, bool | np.bool_):
        return str(value).lower()
    if isinstance(value, float):
        return repr(float(value)) if math.isfinite(value) else ""
    return value
