"""Parameters of an exported folder, as its manifest lists them, and their values as arguments in C."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt

from cosserat_casadi.codegen.input_values import ArgumentValues, ListedValues, listed_values
from cosserat_casadi.codegen.plain import pointer
from cosserat_casadi.errors import SceneError
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.parameters import ParameterLayout, parameter_layout
from cosserat_casadi.scene import Scene, parse_scene


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
        vector = np.ascontiguousarray(values, dtype=np.float64).ravel()
        if vector.size != self.size:
            self.split(vector)
        return vector

    def passed(self, values: ArgumentValues = None) -> list[Any]:
        """The argument of functions in C; none where the scene has no parameters.

        Raises:
            SceneError: as :meth:`stacked`.
        """
        vector = self.stacked(values)
        return [pointer(vector)] if self.size else []

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


def listed_parameters(entries: Sequence[Mapping[str, Any]], scene: str = "") -> ListedParameters:
    """The parameters of a manifest, with the text of the scene that judges them."""
    return ListedParameters(listed_values(entries), scene)
