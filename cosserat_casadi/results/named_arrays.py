"""Arrays with named axes, as xarray holds them."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from cosserat_casadi.maths.typing import FloatArray


@dataclass(frozen=True)
class NamedArrays:
    """Arrays whose axes have names.

    Attributes:
        variables: by name the axes, the array, and its attributes such as ``units``.
        coordinates: values along axes, by the name of the axis.
        attributes: of the whole.
    """

    variables: dict[str, tuple[tuple[str, ...], Any, dict[str, str]]] = field(default_factory=dict)
    coordinates: dict[str, Any] = field(default_factory=dict)
    attributes: dict[str, Any] = field(default_factory=dict)

    def add(self, name: str, axes: tuple[str, ...], array: FloatArray, units: str = "") -> None:
        """Add an array, shaped as its axes, under a name that is new; units are left out where they are not known."""
        self.variables.setdefault(name, (axes, array, {"units": units} if units else {}))
