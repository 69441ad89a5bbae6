"""A cable of given length, whose tension is unknown: docs/theory.md, section 8.

Where the cable may go slack, the smooth complementarity τ + s − √(τ² + s² + ε²) = 0 of the tension τ and the sag s
holds both at zero or above and one of them at zero, up to τ s = ε²/2: A. Fischer, *Optimization* 24 (1992) 269–284,
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
class CableLength:
    """The equation of one cable of given length.

    Attributes:
        cable: the cable on its routing.
        wanted: its length, 1×1, m.
        tension: the unknown, 1×1, in units of EI/ℓ².
        slack: whether it may sag.
    """

    cable: RoutedCable
    wanted: Matrix
    tension: Matrix
    slack: bool

    @property
    def rod(self) -> str:
        """Name of the rod that the cable runs through."""
        return self.cable.shape.rod.properties.name

    @cached_property
    def pull(self) -> Matrix:
        """Derivative of the rod's residual with respect to the tension, n×1: ∂L/∂q / ℓ."""
        return self.cable.gradient / self._rod_length

    @cached_property
    def sag(self) -> Matrix:
        """What the wanted length exceeds that of the cable by, relative to the rod's length, 1×1."""
        return (self.wanted - self.cable.value) / self._rod_length

    @cached_property
    def residual(self) -> Matrix:
        """Zero where the cable has its length, or is slack, 1×1."""
        residual: Matrix = _kernel(self.slack)(self.sag, self.tension)[0]
        return residual

    @cached_property
    def strain_columns(self) -> Matrix:
        """Derivative of the residual with the strain coordinates, 1×n."""
        by_sag: Matrix = _kernel(self.slack)(self.sag, self.tension)[1]
        return -(by_sag * self.pull).T

    @cached_property
    def tension_column(self) -> Matrix:
        """Derivative of the residual with the tension, 1×1."""
        by_tension: Matrix = _kernel(self.slack)(self.sag, self.tension)[2]
        return by_tension

    @property
    def _rod_length(self) -> float:
        return self.cable.shape.rod.properties.length


def _kernel(slack: bool) -> ca.Function:
    """Sag and tension ↦ residual and its derivatives with both."""
    sag = ca.SX.sym("sag")
    tension = ca.SX.sym("tension")
    residual = -sag
    if slack:
        larger_than_both = ca.sqrt(tension**2 + sag**2 + SMOOTHING**2)
        residual = tension + sag - larger_than_both
    by_sag = ca.jacobian(residual, sag)
    by_tension = ca.jacobian(residual, tension)
    results = ca.cse([residual, by_sag, by_tension])
    return ca.Function("cable_length", [sag, tension], results)
