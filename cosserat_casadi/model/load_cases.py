"""Sets of load cases: rows of a CSV file, or points spread evenly over ranges of the inputs.

A column is ``load.field.axis`` with axis x, y or z, ``load.field.axis.degree`` for a Legendre coefficient beyond the
constant one, or ``actuator.field`` for a number. Inputs without a column keep the scene's values.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from cosserat_casadi.errors import Problem, SceneError
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.inputs import InputLayout
from cosserat_casadi.scene.inputs import column_suffixes
from cosserat_casadi.scene.number_table import finite_number, read_numbers


def column_indices(layout: InputLayout) -> dict[str, int]:
    """Index of each column in the stacked inputs."""
    indices = {}
    for name, entries, default in zip(layout.names, layout.slices.values(), layout.defaults, strict=True):
        for k, suffix in enumerate(column_suffixes(*default.shape)):
            indices[name + suffix] = entries.start + k
    return indices


def read_load_cases(path: Path, layout: InputLayout) -> FloatArray:
    """Load cases of a CSV file with a header, shape (count, size of the inputs), SI units.

    Raises:
        SceneError: with every fault: a column that is no input, a row of another length, what is not a finite number.
    """
    header, numbers, _, problems = read_numbers(path)
    indices = column_indices(layout)
    unknown = [column for column in header if column not in indices]
    problems = [_no_column(str(path), column, indices) for column in unknown] + problems
    if problems:
        raise SceneError(*problems)
    cases = np.tile(layout.pack(), (len(numbers), 1))
    cases[:, [indices[column] for column in header]] = numbers
    return cases


def spread(ranges: Sequence[str], count: int, layout: InputLayout) -> FloatArray:
    """Load cases spread evenly over a box, shape (count, size of the inputs).

    The points are the multiples of an irrational direction, modulo one (the additive recurrence with the generalised
    golden ratio), so that any number of them covers the box; the corner of all upper ends comes first.

    Args:
        ranges: ``column=low:high``, such as ``push.force.x=-1:1``.
        count: number of points, at least 1.
        layout: the inputs.

    Raises:
        SceneError: with every fault.
    """
    bounds = _bounds(ranges, column_indices(layout))
    cases = np.tile(layout.pack(), (count, 1))
    shares = _additive_recurrence(count, len(bounds))
    for (index, (low, high)), share in zip(bounds.items(), shares.T, strict=True):
        cases[:, index] = low + share * (high - low)
    return cases


def _bounds(ranges: Sequence[str], indices: dict[str, int]) -> dict[int, tuple[float, float]]:
    """Lower and upper end by the index of the input."""
    problems: list[Problem] = []
    bounds: dict[int, tuple[float, float]] = {}
    for text in ranges:
        name, _, ends = text.partition("=")
        column = name.strip()
        first, _, last = ends.partition(":")
        low = finite_number(first)
        high = finite_number(last)
        if column not in indices:
            problems.append(_no_column("--range", column, indices))
        elif low is None or high is None:
            problems.append(Problem("--range", f"{text!r} has no two finite numbers", "such as push.force.x=-1:1"))
        else:
            bounds[indices[column]] = (low, high)
    if problems:
        raise SceneError(*problems)
    return bounds


def _additive_recurrence(count: int, dimension: int) -> FloatArray:
    """Points in the unit box, shape (count, dimension), the corner of all ones first."""
    # The generalised golden ratio is the fixed point of this iteration.
    root = 2.0
    for _ in range(60):
        root = (1 + root) ** (1 / (dimension + 1))
    steps = root ** -np.arange(1.0, dimension + 1)
    multiples = np.arange(1, count)[:, None] * steps
    return np.vstack([np.ones((1, dimension)), (0.5 + multiples) % 1.0])


def _no_column(where: str, column: str, indices: dict[str, int]) -> Problem:
    names = ", ".join(indices) or "none"
    return Problem(where, f"{column!r} is not an input of this scene", f"its inputs are {names}")
