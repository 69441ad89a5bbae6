"""A cable of given length, whose tension is unknown: docs/theory.md, section 8.

Where the cable may go slack, the smooth complementarity a τ + s − √((a τ)² + s² + ε²) = 0 of tension τ and sag s
holds both at zero or above and one of them at zero, up to a τ s = ε²/2: A. Fischer, *Optimization* 24 (1992) 269–284,
with C. Kanzow's smoothing. The softness a of the rod makes a length of the tension, so that the two compare.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import casadi as ca

from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.rod.cable import RoutedCable

SMOOTHING = 1e-10
"""ε, relative to the rod's length: at the corner, where both would vanish, a τ and the sag are this small."""


@dataclass(frozen=True)
class CableLength:
    """The equation of one cable of given length.

    Attributes:
        cable: the cable on its routing.
        wanted: its length, 1×1, m.
        tension: the unknown, 1×1, in units of EI/ℓ².
        slack: whether it may sag.
        softness: a, the length relative to the rod's that a unit of tension takes from the cable in the unloaded rod.
        smoothing: ε, 1×1; larger on the way to the scene, where a corner would stop the continuation.
    """

    cable: RoutedCable
    wanted: Matrix
    tension: Matrix
    slack: bool
    softness: float
    smoothing: Matrix

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
        return self._results[0]

    @cached_property
    def strain_columns(self) -> Matrix:
        """Derivative of the residual with the strain coordinates, 1×n."""
        return -(self._results[1] * self.pull).T

    @cached_property
    def tension_column(self) -> Matrix:
        """Derivative of the residual with the tension, 1×1."""
        return self._results[2]

    @cached_property
    def _results(self) -> tuple[Matrix, Matrix, Matrix]:
        """The residual and its derivatives with sag and tension, 1×1 each."""
        kernel = _kernel(self.slack, self.softness)
        residual, by_sag, by_tension = kernel(self.sag, self.tension, self.smoothing)
        return residual, by_sag, by_tension

    @property
    def _rod_length(self) -> float:
        return self.cable.shape.rod.properties.length


def _kernel(slack: bool, softness: float) -> ca.Function:
    """Sag, tension and smoothing ↦ residual and its derivatives with sag and tension."""
    sag = ca.SX.sym("sag")
    tension = ca.SX.sym("tension")
    smoothing = ca.SX.sym("smoothing")
    residual = -sag
    if slack:
        shortening = softness * tension
        larger_than_both = ca.sqrt(shortening**2 + sag**2 + smoothing**2)
        residual = shortening + sag - larger_than_both
    by_sag = ca.jacobian(residual, sag)
    by_tension = ca.jacobian(residual, tension)
    results = ca.cse([residual, by_sag, by_tension])
    return ca.Function("cable_length", [sag, tension, smoothing], results)
