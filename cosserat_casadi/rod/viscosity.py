"""Viscous stress of a rod, Kelvin–Voigt: Λ = H (ξ − ξ⁰) + Υ ξ̇. It acts on rates of strain, never on velocities.

A rod of length ratio ρ = ℓ/ℓ₀ has ξ − ξ⁰ = Φ q / ρ, so that ξ̇ = Φ (q̇ − q ρ̇/ρ) / ρ. See docs/theory.md, section 11.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import casadi as ca

from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.rod.kinematics import Shape
from cosserat_casadi.rod.rod_motion import StrainRates
from cosserat_casadi.rod.strain import per_reference_length


@dataclass(frozen=True)
class Viscosity:
    """Viscous stress of a rod in motion.

    Attributes:
        shape: the rod's shape.
        rates: rates of its strain coordinates.
    """

    shape: Shape
    rates: StrainRates

    @cached_property
    def strain_rate(self) -> Matrix:
        """(q̇ − q ρ̇/ρ) / ρ, n×1, 1/s: coordinates of ξ̇."""
        ratio = self.shape.ratio
        if ratio is None:
            return self.rates.velocity
        return (self.rates.velocity - self.shape.q * self.shrinking) / ratio

    @cached_property
    def force(self) -> Matrix:
        """ℓ ∫ Φᵀ Υ ξ̇ dX / (EI/ℓ), n×1, without unit: a part of the residual."""
        return self._matrix @ self.strain_rate

    @cached_property
    def damping(self) -> Matrix:
        """Derivative of the force by q̇, n×n, s."""
        if self.shape.ratio is None:
            return self._matrix
        return self._matrix / self.shape.ratio

    @cached_property
    def stiffness(self) -> Matrix:
        """Derivative of the force by q, n×n: zero unless the rod's length changes."""
        if self.shape.ratio is None:
            return ca.DM(*self._matrix.shape)
        return -self.damping * self.shrinking

    @cached_property
    def dissipated_power(self) -> Matrix:
        """Power that turns into heat, ℓ ∫ ξ̇ᵀ Υ ξ̇ dX, 1×1, W; never negative."""
        power = self.shape.rod.energy_unit * ca.bilin(self._matrix, self.strain_rate, self.strain_rate)
        return per_reference_length(power, self.shape.ratio)

    @cached_property
    def shrinking_power(self) -> Matrix:
        """Power of the viscous stress on the change of the length alone, 1×1, W."""
        stress = self.shape.rod.energy_unit * self.force
        return -ca.dot(stress, self.shape.q) * self.shrinking

    @property
    def _matrix(self) -> Matrix:
        return self.shape.rod.viscosity_matrix

    @property
    def shrinking(self) -> Matrix:
        """ρ̇/ρ, 1×1, 1/s."""
        assert self.rates.ratio_rate is not None
        assert self.shape.ratio is not None
        return self.rates.ratio_rate / self.shape.ratio
