"""Loads that depend on the motion of their sections: their terms in the derivatives K, C and M of a rod in motion.

A force f and a moment c that depend on ṙ, ω, r̈ and ω̇ of their section do the work −Σ [δr; δθ]ᵀ [f; c] in the
residual. Their derivative with the pose of the section at fixed rates is in tangent.py; the variations of the rates are
here. With δr = Y δq and δθ = Θ δq, and the rates of the fields Y and Θ as in motion_tangent.py,

    δṙ = Ẏ δq + Y δq̇                δω = (Θ̇ − ω^ Θ) δq + Θ δq̇
    δr̈ = Ÿ δq + 2 Ẏ δq̇ + Y δq̈       δω̇ = (Θ̈ − ω̇^ Θ − ω^ Θ̇) δq + (2 Θ̇ − ω^ Θ) δq̇ + Θ δq̈,

the second column since δω = d(δθ)/dt − ω × δθ, and the second row from its time derivative. See docs/theory.md,
section 11.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import casadi as ca

from cosserat_casadi.maths.block_operators import hat_operator
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.rod.motion_matrices import Jet, MotionMatrices
from cosserat_casadi.rod.motion_tangent import MotionTangent
from cosserat_casadi.rod.pose_load import LoadedSections

Variation = tuple[Matrix | None, Matrix | None, Matrix | None]
"""Derivatives of a rate by z, ż and z̈, 3k×columns each; None for a zero derivative."""


def motion_matrices(tangent: MotionTangent, loads: Sequence[LoadedSections]) -> MotionMatrices:
    """Terms of inertia and of loads that depend on rates in ∂/∂z, ∂/∂ż and ∂/∂z̈ of the forces on z.

    They are in units of ``tangent.unit``.
    """
    total = tangent.matrices
    mass_damping = tangent.motion.rod.properties.mass_damping
    if mass_damping is not None:
        # With damping by mass the rod's inertia takes r̈ + α ṙ as acceleration; loads take r̈.
        total = replace(total, damping=total.damping + mass_damping * total.mass)
    for load in loads:
        if load.load.kernel.rates:
            pairs = zip(total.orders, MotionLoad(tangent, load).matrices.orders, strict=True)
            total = MotionMatrices(*(before + added / tangent.unit for before, added in pairs))
    return total


@dataclass(frozen=True)
class MotionLoad:
    """A load that depends on rates, on a rod in motion.

    Attributes:
        tangent: variations of the rod's fields with their rates.
        load: the loaded sections.
    """

    tangent: MotionTangent
    load: LoadedSections

    @cached_property
    def matrices(self) -> MotionMatrices:
        """−Σ [Y; Θ]ᵀ (∂[f; c]/∂rates) (variations of the rates), in J."""
        pulled = -ca.vertcat(self.position.value, self.rotation.value).T
        columns = self.position.value.shape[1]
        changed: list[Matrix] = [ca.DM(pulled.shape[1], columns)] * 3
        for rate, operator in self.load.with_rates.items():
            for order, variation in enumerate(self._variation_of(rate)):
                if variation is not None:
                    changed[order] = changed[order] + self.load.weighted(operator @ variation)
        stiffness, damping, mass = (pulled @ total for total in changed)
        return MotionMatrices(stiffness, damping, mass)

    @cached_property
    def position(self) -> Jet:
        """δr of the loaded sections with its rates, 3k×columns, m."""
        orders = [self.load.moved(matrix) for matrix in self.tangent.section_tangent.orders]
        if self.tangent.floating:
            # A shift of the base moves all sections equally.
            alike = ca.kron(ca.DM.eye(3), ca.DM.ones(self.load.count, 1))
            before = ca.DM(alike.shape[0], orders[0].shape[1] - 3)
            orders[0] = orders[0] + ca.horzcat(before, alike)
        return Jet(*orders)

    @cached_property
    def rotation(self) -> Jet:
        """δθ of the loaded sections with its rates, 3k×columns, rad."""
        return Jet(*[self.load.varied_at_sections(matrix) for matrix in self.tangent.section_rotation.orders])

    def _variation_of(self, rate: str) -> Variation:
        r = self.position
        theta = self.rotation
        if rate == "velocity":
            return r.rate, r.value, None
        if rate == "acceleration":
            return self._undamped(r.acceleration, r.rate), 2 * r.rate, r.value
        spin = hat_operator(self.load.at_sections(self.tangent.motion.angular_velocity))
        if rate == "angular_velocity":
            return theta.rate - spin @ theta.value, theta.value, None
        spin_rate = hat_operator(self.load.at_sections(self.tangent.motion.angular_acceleration))
        by_position = theta.acceleration - spin_rate @ theta.value - spin @ theta.rate
        by_position = self._undamped(by_position, theta.rate - spin @ theta.value)
        return by_position, 2 * theta.rate - spin @ theta.value, theta.value

    def _undamped(self, acceleration: Matrix, velocity: Matrix) -> Matrix:
        """Variation of the acceleration r̈, from the variations of r̈ + α ṙ and of the velocity ṙ."""
        mass_damping = self.tangent.motion.rod.properties.mass_damping
        return acceleration if mass_damping is None else acceleration - mass_damping * velocity
