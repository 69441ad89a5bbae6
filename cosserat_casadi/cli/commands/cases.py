"""Load cases of a command: a file, or ranges."""

from __future__ import annotations

from pathlib import Path

from cosserat_casadi.errors import Problem, SceneError
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.load_cases import CaseLayout, read_load_cases, spread


def load_cases(over: Path | None, ranges: list[str], samples: int, layout: CaseLayout) -> FloatArray:
    """Load cases of a file, or spread over ranges, shape (count, size of a case).

    Raises:
        SceneError: both or none stand in the command, or one of them is refused.
    """
    if over is not None and not ranges:
        return read_load_cases(over, layout)
    if over is None and ranges:
        return spread(ranges, samples, layout)
    raise SceneError(Problem("--over", "stands beside --range, or both are missing", "give one of them"))
