"""Inputs and parameters of an exported folder, as its manifest lists them, and their values as arguments in C."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt

from cosserat_casadi.codegen.plain import pointer, vector
from cosserat_casadi.errors import SceneError
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.parameters import ParameterLayout, parameter_layout
from cosserat_casadi.model.stacked import StackedLayout
from cosserat_casadi.scene import Scene, parse_scene

ArgumentValues = Mapping[str, npt.ArrayLike] | npt.ArrayLike | None
"""Values by name, where values not named keep the scene's; or all values stacked; None for the scene's values."""


@dataclass(frozen=True)
class ListedValue:
    """An input or a parameter of an exported folder.

    Attributes:
        name: name in the scene.
        unit: SI unit, "1" if dimensionless.
        default: the scene's value, shape (components, places along the rod or degrees).
        lower: least value of each entry, stacked, shape (size,); -inf without a bound.
        upper: largest value of each entry, stacked, shape (size,); inf without a bound.
    """

    name: str
    unit: str
    default: FloatArray
    lower: FloatArray
    upper: FloatArray


class ListedValues(StackedLayout[ListedValue]):
    """Inputs or parameters of an exported folder, stacked into one vector."""

    @cached_property
    def _scene_values(self) -> FloatArray:
        """Values of the scene, shape (size,)."""
        values = self.pack()
        # Solutions keep their inputs: no caller may change them.
        values.setflags(write=False)
        return values


@dataclass(frozen=True)
class ListedInputs(ListedValues):
    """The inputs of an exported folder, stacked into one vector."""

    what = "an input"
    several = "inputs"

    @cached_property
    def lower(self) -> FloatArray:
        """Least values by the kinds of inputs and the bounds of the scene, shape (size,); -inf without a bound."""
        return np.concatenate([np.zeros(0), *(entry.lower for entry in self.entries)])

    @cached_property
    def upper(self) -> FloatArray:
        """Largest values, shape (size,); inf without a bound."""
        return np.concatenate([np.zeros(0), *(entry.upper for entry in self.entries)])

    def stacked(self, values: ArgumentValues = None, name: str = "inputs") -> FloatArray:
        """All inputs as one vector, shape (size,).

        Args:
            values: values by name or stacked.
            name: word for the values in messages.

        Raises:
            SceneError: a name is unknown, or its value has another size or is not finite.
            ValueError: there are too few or too many numbers; the solver judges numbers that are not finite.
        """
        if values is None:
            return self._scene_values
        if isinstance(values, Mapping):
            return self.pack(values)
        return vector(values, self.size, name)


@dataclass(frozen=True)
class ListedParameters(ListedValues):
    """The parameters of an exported folder, stacked into one vector p.

    Attributes:
        scene: text of the exported scene, by which values that are given by name are checked.
    """

    scene: str = ""

    what = "a parameter"
    several = "parameters"

    def pack(self, values: Mapping[str, npt.ArrayLike] | None = None) -> FloatArray:
        """Stack the parameters, with the scene's values for parameters that are not named.

        Raises:
            SceneError: a name is unknown, a value has another shape, or the scene refuses it.
        """
        p = super().pack(values)
        if values:
            self._judge(p)
        return p

    def _judge(self, p: FloatArray) -> None:
        """Check values by the scene, unless the last check was of these values."""
        last = p.tobytes()
        if self._layout is None or self.__dict__.get("_accepted") == last:
            return
        scene, layout = self._layout
        layout.set_in(scene, layout.unpack(p))
        self.__dict__["_accepted"] = last

    @cached_property
    def _layout(self) -> tuple[Scene, ParameterLayout] | None:
        """The scene and its parameters; None if the folder has no readable scene."""
        try:
            scene = parse_scene(self.scene)
        except SceneError:
            return None
        return scene, parameter_layout(scene)

    def stacked(self, values: ArgumentValues = None) -> FloatArray:
        """All parameters as one vector, shape (size,).

        Raises:
            SceneError: a name is unknown, or there are too few or too many numbers.
        """
        if values is None:
            return self._scene_values
        if isinstance(values, Mapping):
            return self.pack(values)
        # The solver judges numbers that are not finite, also in inputs.
        p = np.ascontiguousarray(values, dtype=np.float64).ravel()
        if p.size != self.size:
            self.split(p)
        return p

    def passed(self, values: ArgumentValues = None) -> list[Any]:
        """Return the argument of functions in C as a list, which is empty for a scene without parameters.

        Raises:
            SceneError: the values are refused, as by :meth:`stacked`.
        """
        p = self.stacked(values)
        return [pointer(p)] if self.size else []

    def rows(self, values: ArgumentValues = None) -> FloatArray:
        """Parameters of one row or of several, shape (rows, size).

        Raises:
            ValueError: rows have another length.
            SceneError: a name is unknown, or its value has another size.
        """
        if values is None or isinstance(values, Mapping):
            return self.pack(values)[np.newaxis]
        rows = np.atleast_2d(np.asarray(values, dtype=np.float64))
        if rows.ndim != 2 or rows.shape[1] != self.size:
            raise ValueError(f"parameters must have shape (count, {self.size}), got {rows.shape}")
        return rows


def listed_values(entries: Sequence[Mapping[str, Any]]) -> tuple[ListedValue, ...]:
    """Read the inputs or parameters of a manifest.

    Raises:
        KeyError: an entry is missing.
        OverflowError: a value is too large for a number.
        TypeError: a name, a unit or a shape has the wrong type.
        ValueError: values are not numbers, or their count does not match the shape.
    """
    values = []
    for entry in entries:
        if not isinstance(entry["name"], str) or not isinstance(entry["unit"], str):
            raise TypeError("names and units are texts")
        default = np.array(entry["value"], dtype=float).reshape(entry["shape"], order="F")
        lower = _ends(entry.get("lower"), -np.inf, default.size)
        upper = _ends(entry.get("upper"), np.inf, default.size)
        values.append(ListedValue(entry["name"], entry["unit"], default, lower, upper))
    return tuple(values)


def listed_parameters(entries: Sequence[Mapping[str, Any]], scene: str = "") -> ListedParameters:
    """Read the parameters of a manifest, with the text of the scene that checks their values."""
    return ListedParameters(listed_values(entries), scene)


def _ends(listed: Sequence[float | None] | None, none: float, size: int) -> FloatArray:
    """Bounds of all entries, shape (size,), with the value ``none`` where the manifest has no bound."""
    if listed is None:
        return np.full(size, none)
    return np.array([none if value is None else value for value in listed], dtype=float)
