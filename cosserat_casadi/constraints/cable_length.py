"""A cable of given length, whose tension is what it takes.

Where the cable may go slack, the smooth complementarity τ + g − √(τ² + g² + ε²) = 0 of the tension τ and the sag g
holds both at zero or above and one of them at zero, up to τ g = ε²/2: A. Fischer, *Optimization* 24 (1992) 269–284,
with C. Kanzow's smoothing.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import casadi as ca

from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.rod.cable import RoutedCable

SMOOTHING = 1e-9
"""ε, without unit: at the corner, where both would vanish, tension and sag are this small."""


@dataclass(frozen=True)
class HeldLength:
    """The equation of one cable of given length.

    Attributes:
        cable: the cable on its course.
        wanted: its length, 1×1, m.
        tension: the unknown, 1×1, in units of EI/ℓ².
        slack: whether it may sag.
        factor: 1 is the scene; on the way to it a spring stands between the cable's length and the wanted one, from
            limp at 0 to rigid.
    """

    cable: RoutedCable
    wanted: Matrix
    tension: Matrix
    slack: bool
    factor: Matrix | float

    @cached_property
    def pull(self) -> Matrix:
        """Derivative of the rod's residual with respect to the tension, n×1: ∂L/∂q / ℓ."""
        return self.cable.gradient / self._unit

    @cached_property
    def sag(self) -> Matrix:
        """What the wanted length exceeds that of the course by, relative to the rod's length, 1×1."""
        sag = (self.wanted - self.cable.value) / self._unit
        return sag if self._whole else self.factor * sag + (1 - self.factor) * self.tension

    @cached_property
    def gap(self) -> Matrix:
        """Zero where the cable has its length, or is slack, 1×1."""
        return self.tension + self.sag - self._root if self.slack else -self.sag

    @cached_property
    def gap_with_length(self) -> Matrix | float:
        """Derivative of the gap with respect to L/ℓ, 1×1."""
        rate = 1.0 if self._whole else self.factor
        return rate * (self.sag / self._root - 1) if self.slack else rate

    @cached_property
    def gap_with_tension(self) -> Matrix:
        """Derivative of the gap with respect to the tension, 1×1."""
        if not self.slack:
            return type(self.tension)(1, 1) if self._whole else self.factor - 1
        own = 1 - self.tension / self._root
        return own if self._whole else own + (1 - self.factor) * (1 - self.sag / self._root)

    @cached_property
    def _root(self) -> Matrix:
        return ca.sqrt(self.tension**2 + self.sag**2 + SMOOTHING**2)

    @property
    def _unit(self) -> float:
        return self.cable.shape.rod.properties.length

    @property
    def _whole(self) -> bool:
        return isinstance(self.factor, float) and self.factor == 1.0
