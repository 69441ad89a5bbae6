"""A cable of given length, whose tension is unknown: docs/theory.md, section 8.

An elastic cable exceeds its given length by (T − T₁)(length/EA + 1/k), with T₁ the tension at which it has that length.

If the cable may go slack, the smooth complementarity a τ + s − √((a τ)² + s² + ε²) = 0 of tension τ and sag s keeps
both above zero and one of them at zero, up to a τ s = ε²/2: A. Fischer, *Optimization* 24 (1992) 269–284, with C.
Kanzow's smoothing. The softness a of the rod converts the tension to a length, comparable with the sag.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import casadi as ca

from cosserat_casadi.maths.numbers import Scalar, is_zero
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.rod.cable import Cable

SMOOTHING = 1e-10
"""ε, relative to the rod's length: size of a τ and of the sag at the corner, where both would vanish."""


@dataclass(frozen=True)
class Elasticity:
    """Elasticity of a cable of given length and of its winch: extension c = length/EA + 1/k by a unit of tension.

    Attributes:
        by_length: 1/EA, 1/N; zero for an inextensible cable.
        at_base: 1/k of the winch, m/N; zero for a rigid winch.
        resting: tension at which the cable has the given length, N.
    """

    by_length: Scalar
    at_base: Scalar
    resting: Scalar

    @property
    def rigid(self) -> bool:
        """Whether cable and winch are rigid."""
        return is_zero(self.by_length) and is_zero(self.at_base)


@dataclass(frozen=True)
class CableLength:
    """The equation of one cable of given length.

    Attributes:
        cable: the cable on its routing.
        elasticity: elasticity of the cable and its winch.
        wanted: the given length, 1×1, m.
        tension: the unknown, 1×1, in units of EI/ℓ².
        slack: whether the cable may go slack.
        softness: a, shortening of the cable by a unit of tension in the unloaded rod, relative to the rod's length.
        smoothing: ε, 1×1; larger along the load path, where a corner would stop the continuation.
    """

    cable: Cable
    elasticity: Elasticity
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
        """Derivative of the rod's residual with respect to the tension, n×1: its generalised force over ℓ."""
        return self.cable.pull / self._rod_length

    @cached_property
    def sag(self) -> Matrix:
        """Excess of the given length over the present length of the cable, relative to the rod's length, 1×1."""
        length = self.wanted
        if not self.elasticity.rigid:
            length = length + self._compliance * self._stretching
        return (length - self.cable.value) / self._rod_length

    @cached_property
    def residual(self) -> Matrix:
        """Residual, 1×1: zero if the cable has its length, or is slack."""
        return self._results[0]

    @cached_property
    def strain_columns(self) -> Matrix:
        """Derivative of the residual by the strain coordinates, 1×n."""
        by_strain = self.cable.gradient / self._rod_length
        if self.cable.mean_share_gradient is not None and not is_zero(self.elasticity.by_length):
            stretched = self.elasticity.by_length * self.wanted * self._stretching
            by_strain = by_strain - stretched / self._rod_length * self.cable.mean_share_gradient
        return -(self._results[1] * by_strain).T

    @cached_property
    def tension_column(self) -> Matrix:
        """Derivative of the residual by the tension, 1×1."""
        _, by_sag, by_tension = self._results
        if self.elasticity.rigid:
            return by_tension
        return by_tension + by_sag * (self._compliance * self._tension_unit / self._rod_length)

    @property
    def _stretching(self) -> Matrix:
        """Tension above the one at which the cable has the given length, 1×1, N."""
        return self._tension_unit * self.tension - self.elasticity.resting

    @property
    def _compliance(self) -> Matrix:
        """Extension by a unit of tension at the base, 1×1, m/N; with friction the mean tension stretches the cable."""
        share = self.cable.mean_share
        stretched = self.wanted if share is None else self.wanted * share
        return self.elasticity.by_length * stretched + self.elasticity.at_base

    @property
    def _tension_unit(self) -> float:
        """EI/ℓ², N."""
        return self.cable.shape.rod.energy_unit / self._rod_length

    @cached_property
    def _results(self) -> tuple[Matrix, Matrix, Matrix]:
        """The residual and its derivatives by sag and tension, 1×1 each."""
        kernel = pair_kernel(self.slack, self.softness)
        residual, by_sag, by_tension = kernel(self.sag, self.tension, self.smoothing)
        return residual, by_sag, by_tension

    @property
    def _rod_length(self) -> float:
        return self.cable.shape.rod.properties.length


def pair_kernel(slack: bool, softness: float) -> ca.Function:
    """Sag, tension and smoothing ↦ residual and its derivatives by sag and tension.

    For a stop of a joint the sag is the distance to the stop, and the tension its push.
    """
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
