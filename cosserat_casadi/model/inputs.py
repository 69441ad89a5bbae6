"""What stays free at run time: the model's inputs, their order and their values in the scene."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from cosserat_casadi import scene as scenes
from cosserat_casadi.errors import Problem, SceneError
from cosserat_casadi.loads.load import coefficients
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.registry import EFFECTS
from cosserat_casadi.model.rods import base_pose


@dataclass(frozen=True)
class InputLayout:
    """The inputs of a model, stacked into one vector.

    Attributes:
        names: ``load.field`` or ``actuator.field`` in the order of the vector.
        defaults: the scene's value of each, shape (1, 1) of a tension, a length or a pressure, (3, k) of a vector:
            column k holds the k-th Legendre coefficient.
        rods: names of the rods, those apart that a load or an actuator has too.
    """

    names: tuple[str, ...]
    defaults: tuple[FloatArray, ...]
    rods: frozenset[str] = frozenset()

    @property
    def size(self) -> int:
        """Entries of the stacked vector."""
        return sum(value.size for value in self.defaults)

    @property
    def slices(self) -> dict[str, slice]:
        """Where each input stands in the stacked vector, column after column."""
        ends = np.cumsum([0, *[value.size for value in self.defaults]])
        return {n: slice(int(a), int(b)) for n, a, b in zip(self.names, ends, ends[1:], strict=False)}

    def pack(self, values: Mapping[str, npt.ArrayLike] | None = None) -> FloatArray:
        """The stacked vector, from the scene's values and those given here.

        Args:
            values: new values by name; a number, (3,) for a vector, (3, k) for Legendre coefficients.

        Returns:
            shape (size,), SI units.

        Raises:
            SceneError: a name is unknown, or a value has another shape or is not finite.
        """
        given = dict(values or {})
        problems = [
            Problem(name, "is not an input of this model", f"its inputs are {', '.join(self.names) or 'none'}")
            for name in given
            if name not in self.names
        ]
        parts = []
        for name, default in zip(self.names, self.defaults, strict=True):
            value = np.asarray(given.get(name, default), dtype=float)
            if value.size != default.size:
                problems.append(Problem(name, f"must have {default.size} numbers, got {value.size}"))
            elif not np.all(np.isfinite(value)):
                problems.append(Problem(name, f"must be finite, got {value.tolist()}"))
            elif name.endswith(".length") and not value.item() > 0.0:
                problems.append(Problem(name, f"must be > 0, got {value.item()}"))
            elif name.endswith(".base.quaternion") and not np.any(value):
                problems.append(Problem(name, "must not be zero", "w, x, y, z; its norm does not matter"))
            parts.append(value.ravel(order="F"))
        if problems:
            raise SceneError(*problems)
        return np.concatenate([np.zeros(0), *parts])

    @property
    def geometry(self) -> list[int]:
        """Places of what the equations are not linear in and must not be zero: lengths and poses of rods."""
        names = [name for name in self.names if name.split(".", 1)[1] in ROD_UNITS and name.split(".")[0] in self.rods]
        return [i for name in names for i in range(*self.slices[name].indices(self.size))]

    def unpack(self, stacked: FloatArray) -> dict[str, FloatArray]:
        """Values by name from the stacked vector, each shaped as its default."""
        return {
            name: stacked[place].reshape(default.shape, order="F")
            for (name, place), default in zip(self.slices.items(), self.defaults, strict=True)
        }


ROD_UNITS: dict[str, str] = {"length": "m", "base.position": "m", "base.quaternion": "1"}
"""What may be free of a rod itself, each with its unit."""


def rod_field(rod: scenes.Rod, field: str) -> FloatArray:
    """What may be free of a rod itself, as the scene has it: shape (1, 1), (3, 1) or (4, 1)."""
    if field == "length":
        return np.array([[rod.length]])
    return base_pose(rod)[("base.position", "base.quaternion").index(field)][:, None]


def magnitude(cause: scenes.Load | scenes.Actuator, field: str) -> FloatArray:
    """A magnitude as the scene has it, shape (1, 1) or (3, k); zero where it is left out."""
    value = getattr(cause, field, None)
    if isinstance(value, int | float):
        return np.array([[float(value)]])
    return np.zeros((3, 1)) if value is None else coefficients(value)


def input_layout(scene: scenes.Scene) -> InputLayout:
    """The inputs a scene asks for, by default every magnitude of loads and actuators."""
    names = scene.input_names()
    causes = {cause.name for cause in scene.causes}
    rods = frozenset(rod.name for rod in scene.rods) - causes
    return InputLayout(names, tuple(_default(scene, *name.split(".", 1)) for name in names), rods)


def _default(scene: scenes.Scene, name: str, field: str) -> FloatArray:
    cause = next((cause for cause in scene.causes if cause.name == name), None)
    if cause is not None:
        return magnitude(cause, field)
    return rod_field(next(rod for rod in scene.rods if rod.name == name), field)


def load_values(scene: scenes.Scene, layout: InputLayout, inputs: FloatArray) -> dict[str, dict[str, FloatArray]]:
    """Numeric magnitudes of every load and actuator for given inputs, by name and field."""
    free = layout.unpack(inputs)
    return {
        cause.name: {f: free.get(f"{cause.name}.{f}", magnitude(cause, f)) for f in EFFECTS[cause.kind].magnitudes}
        for cause in scene.causes
    }
