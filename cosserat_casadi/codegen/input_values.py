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
        name: as the scene spells it.
        unit: SI unit, "1" without.
        default: the scene's value, shape (components, places along the rod or degrees).
        lower: least value of each entry, stacked, shape (size,); -inf where there is none.
        upper: largest value of each entry, stacked, shape (size,); inf where there is none.
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
        # Solutions keep what they were found for: nobody may change it under them.
        values.setflags(write=False)
        return values


@dataclass(frozen=True)
class ListedInputs(ListedValues):
    """The inputs of an exported folder, stacked into one vector."""

    what = "an input"
    several = "inputs"

    @cached_property
    def lower(self) -> FloatArray:
        """Least values by what inputs are and by the bounds of the scene, shape (size,); -inf where there is none."""
        return np.concatenate([np.zeros(0), *(entry.lower for entry in self.entries)])

    @cached_property
    def upper(self) -> FloatArray:
        """Largest values, shape (size,); inf where there is none."""
        return np.concatenate([np.zeros(0), *(entry.upper for entry in self.entries)])

    def stacked(self, values: ArgumentValues = None, name: str = "inputs") -> FloatArray:
        """All inputs as one vector, shape (size,).

        Args:
            values: by name or stacked.
            name: what a message calls them.

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
        scene: text of the scene that the folder was made from, which judges values that are given by name.
    """

    scene: str = ""

    what = "a parameter"
    several = "parameters"

    def pack(self, values: Mapping[str, npt.ArrayLike] | None = None) -> FloatArray:
        """The stacked vector, from the argument and, for parameters that it does not name, the scene's values.

        Raises:
            SceneError: a name is unknown, a value has another shape, or the scene refuses it.
        """
        p = super().pack(values)
        if values:
            self._judge(p)
        return p

    def _judge(self, p: FloatArray) -> None:
        """Ask the scene about values, unless it was asked about the same values last."""
        last = p.tobytes()
        if self._layout is None or self.__dict__.get("_accepted") == last:
            return
        scene, layout = self._layout
        layout.set_in(scene, layout.unpack(p))
        self.__dict__["_accepted"] = last

    @cached_property
    def _layout(self) -> tuple[Scene, ParameterLayout] | None:
        """The scene and its parameters; None where the folder has no scene that can be read."""
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
        # Numbers that are not finite are the solver's to judge, as those of inputs are.
        p = np.ascontiguousarray(values, dtype=np.float64).ravel()
        if p.size != self.size:
            self.split(p)
        return p

    def passed(self, values: ArgumentValues = None) -> list[Any]:
        """The argument of functions in C; none where the scene has no parameters.

        Raises:
            SceneError: as :meth:`stacked`.
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
    """Inputs or parameters of a manifest.

    Raises:
        KeyError: something is missing.
        OverflowError: a value is beyond all range.
        TypeError: a name, a unit or a shape is none.
        ValueError: values are no numbers, or not so many as their shape says.
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
    """The parameters of a manifest, with the text of the scene that judges them."""
    return ListedParameters(listed_values(entries), scene)


def _ends(listed: Sequence[float | None] | None, none: float, size: int) -> FloatArray:
    """Ends of the range of each entry; where the manifest has none, this value."""
    if listed is None:
        return np.full(size, none)
    return np.array([none if value is None else value for value in listed], dtype=float)
