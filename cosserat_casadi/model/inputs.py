"""Numbers that stay free at run time: the model's inputs as records, their order and their values in the scene.

Names, units, bounds and shapes of an input are declared once, by the record of the scene that it belongs to
(``InputField``). Other modules ask the :class:`Input` for them and do not parse its name. Loads and actuators take
their values out of the stacked inputs with :func:`input_values`.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np
import numpy.typing as npt

from cosserat_casadi import scene as scenes
from cosserat_casadi.errors import Problem
from cosserat_casadi.loads.load import coefficients, constant
from cosserat_casadi.loads.load_trace import expressions_in
from cosserat_casadi.maths.numbers import Numbers, is_symbolic, known
from cosserat_casadi.maths.typing import FloatArray, Matrix
from cosserat_casadi.model.scene_rods import base_pose
from cosserat_casadi.model.stacked import StackedLayout
from cosserat_casadi.scene.input_fields import InputField
from cosserat_casadi.scene.records import Entry

HISTORY = "history"
"""Name of the field with a load's memory of its sections from the last point of a path."""

SHORTEST = 1e-3
"""Least value of a length as an input, relative to the scene's value."""

PASSED = 1e-7
"""Amount, SI units, by which a value may pass a bound of its physics: ipopt relaxes bounds by 1e-8."""


@dataclass(frozen=True)
class Input:
    """One input of a model.

    Attributes:
        owner: name of the rod, the load or the actuator that it belongs to.
        field: its name in the table of the owner.
        declared: declaration by the record of the owner: unit, components, bounds.
        default: the scene's value, shape (components, k): column k holds the k-th Legendre coefficient.
        axes: "none" for a number, else "world" or "section".
        of_rod: whether the owner is a rod.
        upper: largest value that physics allows each entry; inf where there is none.
    """

    owner: str
    field: str
    declared: InputField
    default: FloatArray
    axes: str
    of_rod: bool
    upper: float

    @property
    def name(self) -> str:
        """``owner.field``, as the scene and the command line spell it."""
        return f"{self.owner}.{self.field}"

    @property
    def unit(self) -> str:
        """SI unit of each number."""
        return self.declared.unit

    @property
    def size(self) -> int:
        """Number of entries."""
        return self.default.size

    @property
    def shape(self) -> tuple[int, int]:
        """Components and Legendre coefficients."""
        components, degrees = self.default.shape
        return components, degrees

    @property
    def lower(self) -> float:
        """Least value that each entry may have; -inf where there is none."""
        if self.declared.positive:
            # A rod cannot have length zero: the range ends at a small share of the scene's value.
            least_default = float(self.default.min())
            return SHORTEST * least_default
        if self.declared.lower is None:
            return -np.inf
        return self.declared.lower


@dataclass(frozen=True)
class InputLayout(StackedLayout[Input]):
    """The inputs of a model, stacked into one vector."""

    what = "an input"
    several = "inputs"

    def _faults(self, entry: Input, value: FloatArray) -> Iterator[Problem]:
        """Problems of a value."""
        faults = list(super()._faults(entry, value))
        yield from faults
        if faults:
            return
        declared = entry.declared
        if declared.positive and not np.all(value > 0.0):
            yield Problem(entry.name, f"must be > 0, got {value.item()}")
        elif declared.nonzero and not np.any(value):
            yield Problem(entry.name, "must not be zero", "w, x, y, z; its norm does not matter")
        elif declared.lower is not None and np.any(value < declared.lower - PASSED):
            yield Problem(entry.name, f"must be >= {declared.lower:g}, got {value.min():g}")
        elif np.any(value > entry.upper + PASSED):
            yield Problem(entry.name, f"must be <= {entry.upper:g}, got {value.max():g}")

    def of_load(self, name: str, field: str) -> slice | None:
        """Slice of a field of a load or an actuator in the stacked vector; None where the scene fixes it."""
        return self._slice_of(name, field, of_rod=False)

    def of_rod(self, name: str, field: str) -> slice | None:
        """Slice of a field of a rod in the stacked vector; None where the scene fixes it."""
        return self._slice_of(name, field, of_rod=True)

    def _slice_of(self, owner: str, field: str, *, of_rod: bool) -> slice | None:
        # A rod and a load may share a name, so that the name of the owner alone does not identify an input.
        wanted = (owner, field, of_rod)
        return next((span for entry, span in self if (entry.owner, entry.field, entry.of_rod) == wanted), None)

    def indices(self, *flags: str) -> list[int]:
        """Indices of the inputs with a declared property: ``geometry``, ``nodal`` or ``nonlinear``."""
        spans = [span for entry, span in self if any(getattr(entry.declared, flag) for flag in flags)]
        return [index for span in spans for index in range(span.start, span.stop)]

    @cached_property
    def memory(self) -> slice | None:
        """Entries of the histories of all loads; None without memory."""
        spans = [span for entry, span in self if entry.field == HISTORY]
        return slice(spans[0].start, spans[-1].stop) if spans else None

    @cached_property
    def of_memory(self) -> npt.NDArray[np.bool_]:
        """Whether each input belongs to the history of a load, shape (size,)."""
        flags = np.zeros(self.size, dtype=bool)
        if self.memory is not None:
            flags[self.memory] = True
        return flags

    @cached_property
    def nodal(self) -> frozenset[int]:
        """Indices of the inputs that hold values at nodes."""
        return frozenset(self.indices("nodal"))

    @cached_property
    def geometry(self) -> list[int]:
        """Indices of lengths and poses of rods, in which the equations are not linear and which must not be zero."""
        return self.indices("geometry")

    @property
    def quaternions(self) -> list[int]:
        """Indices of the first entries of quaternions."""
        return [span.start for entry, span in self if entry.field == "base.quaternion"]


def scene_value(record: Entry, field: str) -> Numbers:
    """Value of an input of a load or an actuator in the scene, shape (1, k) or (3, k); zero if left out."""
    value: Any = record
    # A field in an inner table has dots in its name.
    for key in field.split("."):
        value = getattr(value, key, None)
    components = record.inputs[field].components
    if value is None:
        return np.zeros((components, 1))
    if isinstance(value, int | float):
        return np.array([[float(value)]])
    if is_symbolic(value):
        return value
    # A scalar along the rod is a list of its coefficients, or, in loads of contact, a list of one component.
    is_one_component = components == 1 and not isinstance(value[0], tuple)
    return coefficients((value,) if is_one_component else value)


def input_layout(scene: scenes.Scene) -> InputLayout:
    """The inputs a scene asks for, by default all that its loads and actuators declare."""
    return InputLayout(tuple(_input(free) for free in scene.free_inputs()))


def _input(free: scenes.FreeInput) -> Input:
    record, field = free.record, free.field
    of_rod = isinstance(record, scenes.Rod)
    default = _rod_value(record, field) if isinstance(record, scenes.Rod) else known(scene_value(record, field))
    return Input(free.owner, field, free.declared, default, _axes(free), of_rod, record.input_upper(field))


def _rod_value(rod: scenes.Rod, field: str) -> FloatArray:
    """Value of a free field of a rod itself in the scene: shape (1, 1), (3, 1) or (4, 1)."""
    position, quaternion = base_pose(rod)
    values = {
        "length": np.array([rod.length]),
        "base.position": position,
        "base.quaternion": quaternion,
    }
    return values[field][:, None]


def _axes(free: scenes.FreeInput) -> str:
    """Axes of an input: the axes of the record's ``frame`` where the field is declared to follow it."""
    if free.declared.components == 1:
        return "none"
    follows = free.declared.axes == "frame" and getattr(free.record, "frame", "world") == "body"
    return "section" if follows or free.declared.axes == "section" else "world"


def load_values(scene: scenes.Scene, layout: InputLayout, inputs: FloatArray) -> dict[str, dict[str, FloatArray]]:
    """Values of every load and actuator for given inputs, by name and field: the scene's where they are fixed."""
    values: dict[str, dict[str, FloatArray]] = {}
    for record in scene.input_owners:
        values[record.name or ""] = {field: known(scene_value(record, field)) for field in record.inputs}
    for entry, span in layout:
        if not entry.of_rod:
            values.setdefault(entry.owner, {})[entry.field] = inputs[span].reshape(entry.shape, order="F")
    return values


def input_values(layout: InputLayout, record: scenes.LoadRecord | scenes.Actuator, inputs: Matrix) -> dict[str, Matrix]:
    """Inputs of a load or an actuator, and its numbers that are expressions of parameters.

    An input that is always zero is a matrix that stores nothing.
    """
    values = expressions_in(record)
    for field in record.inputs:
        value = input_value(layout, record, field, inputs)
        if value is None:
            value = ca.DM(*scene_value(record, field).shape)
        values[field] = value
    return values


def input_value(
    layout: InputLayout, record: scenes.LoadRecord | scenes.Actuator | scenes.JointRecord, field: str, inputs: Matrix
) -> Matrix | None:
    """An input of a load, an actuator or a joint; None if it is fixed at zero."""
    entries = layout.of_load(record.name or "", field)
    default = scene_value(record, field)
    if entries is None:
        return constant(default)
    return ca.reshape(inputs[entries], *default.shape)
