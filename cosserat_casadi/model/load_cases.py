"""Load cases: their columns, and points spread evenly over ranges of inputs and parameters.

A column is ``load.field.axis`` with axis x, y or z, ``load.field.axis.degree`` for a Legendre coefficient beyond the
constant one, ``actuator.field`` for a number, or a number of a parameter, spelled as in the scene's list of them. What
has no column keeps the scene's values.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from cosserat_casadi import scene as scenes
from cosserat_casadi.errors import Problem, SceneError, refuse
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.inputs import InputLayout, input_layout
from cosserat_casadi.model.parameters import NO_PARAMETERS, ParameterLayout, parameter_layout
from cosserat_casadi.model.tube_checks import refuse_tubes
from cosserat_casadi.scene.input_fields import column_suffixes
from cosserat_casadi.scene.number_table import finite_number


def column_indices(layout: InputLayout) -> dict[str, int]:
    """Index in the stacked inputs of each column, by its name."""
    indices = {}
    for name, entries, default in zip(layout.names, layout.slices.values(), layout.defaults, strict=True):
        for k, suffix in enumerate(column_suffixes(*default.shape)):
            indices[name + suffix] = entries.start + k
    return indices


@dataclass(frozen=True)
class CaseLayout:
    """Layout of a load case: the inputs of a scene, and the parameters behind them.

    Attributes:
        inputs: inputs of the scene.
        parameters: parameters of the scene; often none.
    """

    inputs: InputLayout
    parameters: ParameterLayout = NO_PARAMETERS

    @cached_property
    def columns(self) -> dict[str, int]:
        """Index of each column in a case."""
        indices = column_indices(self.inputs)
        for entry, span in self.parameters:
            for k, name in enumerate(entry.cell_names):
                indices[name] = self.inputs.size + span.start + k
        return indices

    @cached_property
    def spans(self) -> dict[str, slice]:
        """Slice of each input and each parameter in a case."""
        spans = dict(self.inputs.slices)
        for entry, span in self.parameters:
            spans[entry.name] = slice(self.inputs.size + span.start, self.inputs.size + span.stop)
        return spans

    @cached_property
    def default(self) -> FloatArray:
        """The case of the scene's own values, shape (size,)."""
        return np.concatenate([self.inputs.pack(), self.parameters.pack()])

    def unpack(self, case: FloatArray) -> dict[str, FloatArray]:
        """Inputs and parameters of a case by name."""
        inputs, parameters = np.split(case, [self.inputs.size])
        return {**self.inputs.unpack(inputs), **self.parameters.unpack(parameters)}

    def pack(self, values: Mapping[str, npt.ArrayLike]) -> FloatArray:
        """The case with values by name; other inputs and parameters keep the scene's values.

        Raises:
            SceneError: a value is refused, or a name is neither an input nor a parameter.
        """
        parameters = {name: value for name, value in values.items() if name in self.parameters.names}
        inputs = {name: value for name, value in values.items() if name not in parameters}
        return np.concatenate([self.inputs.pack(inputs), self.parameters.pack(parameters)])


def case_layout(scene: scenes.Scene) -> CaseLayout:
    """The inputs and the parameters of a scene.

    Raises:
        SceneError: the scene has tubes.
    """
    refuse_tubes(scene)
    return CaseLayout(input_layout(scene), parameter_layout(scene))


@dataclass(frozen=True)
class AskedRange:
    """A range from an option, ``column=low:high`` or ``column=low:high:count``.

    Attributes:
        column: an input or a parameter, such as ``push.force.x``.
        low: lower end, SI units.
        high: upper end.
        count: number of values, with both ends; None if the text has none.
    """

    column: str
    low: float
    high: float
    count: int | None


def read_range(text: str) -> AskedRange:
    """The range in a text.

    Raises:
        SceneError: the text is not a range.
    """
    name, _, numbers = text.partition("=")
    first, _, rest = numbers.partition(":")
    last, colon, values = rest.partition(":")
    low = finite_number(first)
    high = finite_number(last)
    if low is None or high is None:
        raise SceneError(Problem("--range", f"{text!r} has no two finite numbers", "such as push.force.x=-1:1"))
    # At most nine digits: Python refuses to read integers of thousands.
    if colon and not re.fullmatch(r"[1-9][0-9]{0,8}", values):
        problem = f"{text!r} has no whole number of values above 0 and below 10⁹"
        raise SceneError(Problem("--range", problem, "such as push.force.x=-1:1:21"))
    return AskedRange(name.strip(), low, high, int(values) if colon else None)


def read_ranges(texts: Sequence[str], fault: Callable[[str, AskedRange], Problem | None]) -> dict[str, AskedRange]:
    """The ranges in texts, by column.

    Args:
        texts: one text for each range.
        fault: function from a text and its range to the reason to refuse the range, or None.

    Raises:
        SceneError: with every fault.
    """
    problems: list[Problem] = []
    ranges: dict[str, AskedRange] = {}
    for text in texts:
        try:
            asked = read_range(text)
        except SceneError as error:
            problems.extend(error.problems)
            continue
        problem = fault(text, asked)
        if problem is None and asked.column in ranges:
            problem = Problem("--range", f"{asked.column!r} has two ranges", "give one of them")
        if problem is not None:
            problems.append(problem)
        ranges.setdefault(asked.column, asked)
    refuse(problems)
    return ranges


def ends_by_column(ranges: Sequence[str], layout: CaseLayout, *, grids: bool = False) -> dict[str, tuple[float, float]]:
    """Lower and upper end by column of ``column=low:high``, with a count of values or without.

    Args:
        ranges: texts of the ranges.
        layout: the inputs and the parameters.
        grids: whether a range with a count is a grid, whose ends have any order.

    Raises:
        SceneError: with every fault.
    """

    def fault(text: str, asked: AskedRange) -> Problem | None:
        if asked.column not in layout.columns:
            return no_column("--range", asked.column, layout.columns)
        if grids and asked.count is not None:
            return None
        return fault_of_ends("--range", asked.column, asked.low, asked.high)

    return {column: (asked.low, asked.high) for column, asked in read_ranges(ranges, fault).items()}


def fault_of_ends(where: str, name: str, low: float, high: float) -> Problem | None:
    """Why two ends of an input or a parameter are no range; None where they are one."""
    if not (np.isfinite(low) and np.isfinite(high)):
        return Problem(where, f"the range of {name} must have two finite ends, got {low:g}:{high:g}")
    if low == high:
        return Problem(where, f"the range of {name} must have two different ends, got {low:g} twice")
    if low > high:
        return Problem(where, f"the range of {name} must have the lower end first, got {low:g}:{high:g}")
    return None


def spread(ranges: Sequence[str], count: int, layout: CaseLayout) -> FloatArray:
    """Load cases spread evenly over a box, shape (count, size of a case).

    The points are the multiples of an irrational direction, modulo one (the additive recurrence with the generalised
    golden ratio), so that any number of points covers the box; the corner of all upper ends comes first.

    Args:
        ranges: ``column=low:high``, such as ``push.force.x=-1:1``.
        count: number of points, at least 1.
        layout: the inputs and the parameters.

    Raises:
        SceneError: with every fault.
    """
    ends = ends_by_column(ranges, layout)
    cases = np.tile(layout.default, (count, 1))
    shares = additive_recurrence(count, len(ends))
    for (column, (low, high)), share in zip(ends.items(), shares.T, strict=True):
        cases[:, layout.columns[column]] = low + share * (high - low)
    return cases


def additive_recurrence(count: int, dimension: int) -> FloatArray:
    """Points in the unit box, shape (count, dimension), the corner of all ones first."""
    # The generalised golden ratio is the fixed point of this iteration.
    root = 2.0
    for _ in range(60):
        root = (1 + root) ** (1 / (dimension + 1))
    steps = root ** -np.arange(1.0, dimension + 1)
    multiples = np.arange(1, count)[:, None] * steps
    return np.vstack([np.ones((1, dimension)), (0.5 + multiples) % 1.0])


def no_column(where: str, column: str, indices: Mapping[str, int]) -> Problem:
    """The problem of a column that a scene does not have."""
    names = ", ".join(indices) or "none"
    return Problem(where, f"{column!r} is not an input or a parameter of this scene", f"its columns are {names}")
