"""Derivatives of forces with coordinates, their rates and their accelerations, and how they change with coordinates."""

from __future__ import annotations

from dataclasses import dataclass

from cosserat_casadi.maths.typing import Matrix


@dataclass(frozen=True)
class Jet:
    """A matrix and its first two time derivatives."""

    value: Matrix
    rate: Matrix
    acceleration: Matrix

    @property
    def orders(self) -> tuple[Matrix, Matrix, Matrix]:
        """Value, rate and acceleration."""
        return self.value, self.rate, self.acceleration


@dataclass(frozen=True)
class MotionMatrices:
    """Derivatives of forces with coordinates z, ż and z̈.

    Attributes:
        stiffness: with z, n×n.
        damping: with ż, n×n.
        mass: with z̈, n×n.
    """

    stiffness: Matrix
    damping: Matrix
    mass: Matrix

    @property
    def orders(self) -> tuple[Matrix, Matrix, Matrix]:
        """Stiffness, damping and mass."""
        return self.stiffness, self.damping, self.mass

    def along(self, jet: Jet) -> MotionMatrices:
        """These matrices in other coordinates u with δz = P δu, given the jet of P, n×k; forces at fixed z̈ left out.

        The second derivative of y is Y(P ü + 2 Ṗ u̇ + P̈ u): each order of the jet meets the one above.
        """
        to_z, to_z_rate, to_z_acceleration = jet.orders
        mass = self.mass @ to_z
        damping = self.damping @ to_z + 2 * (self.mass @ to_z_rate)
        stiffness = self.stiffness @ to_z + self.damping @ to_z_rate + self.mass @ to_z_acceleration
        pulled = to_z.T
        return MotionMatrices(pulled @ stiffness, pulled @ damping, pulled @ mass)
