"""The coordinate that a joint leaves free: the angle of a hinge, the displacement of a slide.

If a spring, a damper, friction, a motor or a drive acts along it, the joint holds its section in all directions at a
pose that the coordinate moves. A drive prescribes the coordinate. Otherwise it is an unknown q with the equation λ +
V'(q) = 0, λ the multiplier along the free direction, V the energy of spring and motor. As an unknown it counts turns:
poses alone do not distinguish an angle from this angle plus a full turn.

A stop is the pair 0 ≤ ρ ⟂ g ≥ 0 of its push ρ, an unknown that adds to that equation, and the distance g to it.
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np

from cosserat_casadi.constraints.held_directions import ALL, FLAT, across
from cosserat_casadi.constraints.section_constraint import Coordinate, HeldDirections
from cosserat_casadi.maths.numbers import Scalar, is_zero
from cosserat_casadi.maths.typing import FloatArray, Matrix


def held_along(coordinate: Coordinate, normal: FloatArray | None) -> HeldDirections:
    """All directions in which a section can move, the coordinate's last among displacements or rotations.

    Args:
        coordinate: coordinate in the axes of the section.
        normal: normal, in section axes, of the plane in which the section moves, shape (3,); None in space.
    """
    axis = coordinate.axis
    if normal is None:
        around = np.column_stack([across(axis.tolist(), ALL), axis])
        return HeldDirections(around, around, turn_with_pose=True)
    if coordinate.turns:
        return HeldDirections(across(axis.tolist(), ALL), axis[:, None], turn_with_pose=True)
    in_plane = np.column_stack([np.cross(normal, axis), axis])
    return HeldDirections(in_plane, normal[:, None], turn_with_pose=True)


def moves_in_plane(coordinate: Coordinate, normal: FloatArray) -> bool:
    """Whether a coordinate leaves its section in a plane: a turn about the normal, or a slide across it."""
    if coordinate.turns:
        return bool(np.linalg.norm(np.cross(coordinate.axis, normal)) <= FLAT)
    return abs(float(coordinate.axis @ normal)) <= FLAT


@dataclass(frozen=True)
class JointEffort:
    """Spring, damper, friction and motor of a joint, in N m and rad or in N and m.

    Coulomb's friction F opposes the rate u by F u / √(u² + s²), which is F to the share ½ (s/u)² above the slip rate s.
    A joint that sticks creeps, slower than s until it is close to slipping.

    Attributes:
        stiffness: effort per unit of the coordinate.
        rest: coordinate at which the spring is unloaded.
        damping: effort per unit of its rate.
        friction: effort of a joint that slips.
        slip_rate: rate below which a joint that sticks creeps.
        motor: effort of the motor, 1×1.
    """

    stiffness: Scalar
    rest: Scalar
    damping: Scalar
    friction: Scalar
    slip_rate: Scalar
    motor: Matrix

    @property
    def resists(self) -> bool:
        """Whether a damper or friction opposes the rate."""
        return not (is_zero(self.damping) and is_zero(self.friction))

    def resistance(self, rate: Matrix) -> Matrix:
        """Effort of damper and friction against a rate, 1×1."""
        effort = self.damping * rate
        if not is_zero(self.friction):
            effort = effort + self.friction * rate / ca.sqrt(rate**2 + self.slip_rate**2)
        return effort

    def resistance_slope(self, rate: Matrix) -> Matrix:
        """Derivative of the resistance by the rate, 1×1."""
        slope = ca.DM(1, 1) + self.damping
        if not is_zero(self.friction):
            slope = slope + self.friction * self.slip_rate**2 / (rate**2 + self.slip_rate**2) ** 1.5
        return slope

    def slope(self, value: Matrix) -> Matrix:
        """V'(q), 1×1."""
        spring: Matrix = ca.DM(1, 1)
        if not is_zero(self.stiffness):
            spring = self.stiffness * (value - self.rest)
        return spring - self.motor

    def spring_energy(self, value: Matrix) -> Matrix:
        """Energy of the spring, 1×1, J."""
        return self.stiffness / 2 * (value - self.rest) ** 2


def unit_vector(axis: FloatArray) -> FloatArray:
    """A vector over its norm."""
    return np.asarray(axis / np.linalg.norm(axis))
