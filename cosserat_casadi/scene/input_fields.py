"""Fields of a scene's tables that may stay free at run time: their units, axes and numbers of entries."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

from cosserat_casadi.scene.profiles import coefficient_count

AXES = {1: ("",), 3: ("x", "y", "z"), 4: ("w", "x", "y", "z")}
"""Names of the entries of a number, a vector and a quaternion."""


@dataclass(frozen=True)
class InputField:
    """A field of a scene's table that may stay free at run time.

    Attributes:
        unit: SI unit of each number, "1" for a dimensionless one.
        components: 1 for a number, 3 for a vector, 4 for a quaternion.
        polynomial: whether each component may be a list of Legendre coefficients along the rod.
        positive: whether each number must be > 0.
        nonzero: whether not all numbers may be zero.
        lower: least value that physics allows each number; None without a bound.
        upper: largest value that physics allows each number, whatever its table says; None without a bound.
        axes: axes of the components: "none" for a number, "world", "section", or "frame" for the axes that the record's
            key ``frame`` names.
        geometry: whether it moves rods or their bases, so that the equations are not linear in it; its path in a motion
            must have a velocity.
        continuous: whether its path in a motion must not jump: it prescribes a length.
        on_request: whether it stays free only if the scene lists it, since it is not a magnitude.
        nonlinear: whether the equations are not linear in it.
        nodal: whether it has values at each node of a rod.
    """

    unit: str
    components: int
    polynomial: bool = False
    positive: bool = False
    nonzero: bool = False
    lower: float | None = None
    upper: float | None = None
    axes: Literal["none", "world", "section", "frame"] = "none"
    geometry: bool = False
    continuous: bool = False
    on_request: bool = False
    nonlinear: bool = False
    nodal: bool = False

    @property
    def moves(self) -> bool:
        """Whether the input moves rods or prescribes a length: it cannot jump, and its rate and acceleration matter."""
        return self.geometry or self.continuous

    def entry_count(self, value: Any) -> int:
        """Number of entries of the input for this value in its table; faulty values have no coefficients."""
        if not self.polynomial:
            return self.components
        if self.components == 1:
            return coefficient_count(value)
        if not isinstance(value, list | tuple):
            return self.components
        # Components share the highest degree that one of them has; the others are filled up with zeros.
        coefficients = max([1, *map(coefficient_count, value)])
        return self.components * coefficients


def column_suffixes(components: int, degrees: int) -> list[str]:
    """Suffixes of the columns of an input, column after column: ".x", then ".x.1" for the first Legendre degree."""
    axes = [f".{axis}" if axis else "" for axis in AXES[components]]
    higher = [f".{degree}" for degree in range(1, degrees)]
    return [axis + degree for degree in ("", *higher) for axis in axes]
