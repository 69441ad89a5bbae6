"""A wrench as a function of the pose of its section, differentiated by CasADi.

Rods are written in the axes of their base, loads in world axes: the kernel composes the pose of the base with
the pose of the section, calls the load, and turns force and moment back. With poses (p, R) of the base, (r, θ) of the
section in it, f = Rᵀ f_w(p + R r, R exp(θ^) …), so the derivatives below are in the axes of the base too.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import casadi as ca

from cosserat_casadi.maths.rotation import hat
from cosserat_casadi.maths.typing import Matrix

RATES = ("velocity", "angular_velocity", "acceleration", "angular_acceleration")
"""Rates of its section that a kernel may depend on: of the centre in m/s and m/s², angular ones in rad/s and rad/s²."""

ARGUMENTS = ["position", "rotation", "base_position", "base_rotation", "parameters", "data"]


@dataclass(frozen=True)
class SectionKernel:
    """A wrench as a small function of one section, with its derivatives, and its energy if it has one.

    All functions have the arguments :data:`ARGUMENTS`: position (3×1, m) and rotation (3×3) of the section in the axes
    of the base, position and rotation of the base in the world, the run-time parameters and the section's numbers.

    Attributes:
        world_wrench: (position, rotation, parameters, data) ↦ (force, moment), world axes, 3×1 each.
        world_energy: these arguments ↦ energy, J or J/m; None for a wrench that is not the derivative of an energy.
        rates: names among :data:`RATES` of further arguments, 3×1 each, for a wrench that depends on the motion of the
            section.
    """

    world_wrench: ca.Function
    world_energy: ca.Function | None = None
    rates: tuple[str, ...] = ()

    @property
    def arguments(self) -> list[str]:
        """Names of the arguments of all functions."""
        return [*ARGUMENTS, *self.rates]

    @cached_property
    def wrench(self) -> ca.Function:
        """Force and moment in the axes of the base, 3×1 each."""
        symbols = self._symbols()
        results = self._in_base(symbols)
        return ca.Function("wrench", symbols, results, self.arguments, ["force", "moment"])

    @cached_property
    def drag(self) -> ca.Function:
        """Force and moment minus their values at zero rates, 3×1 each, in the axes of the base."""
        symbols = self._symbols()
        still = [*symbols[: len(ARGUMENTS)], *(ca.SX(3, 1) for _ in self.rates)]
        pairs = zip(self._in_base(symbols), self._in_base(still), strict=True)
        results = ca.cse([ca.densify(moving - resting) for moving, resting in pairs])
        return ca.Function("drag", symbols, results, self.arguments, ["force", "moment"])

    @cached_property
    def stiffness(self) -> ca.Function:
        """Derivative of [force; moment] by [δr; δθ], 6×6, all in the axes of the base."""
        symbols = self._symbols()
        position, rotation = symbols[:2]
        wrench = ca.vertcat(*self._in_base(symbols))
        # The entries of R are differentiated as if they were independent, then multiplied by the rates of rotations.
        columns = [ca.vec(rate) for rate in rotation_rates(rotation)]
        with_position = ca.jacobian(wrench, position)
        with_rotation = ca.jacobian(wrench, ca.vec(rotation)) @ ca.horzcat(*columns)
        stiffness = ca.cse(ca.horzcat(with_position, with_rotation))
        return ca.Function("stiffness", symbols, [ca.sparsify(stiffness)], self.arguments, ["stiffness"])

    @cached_property
    def with_rates(self) -> ca.Function:
        """Derivatives of [force; moment] by each of the rates, in their order, 6×3 each, in the axes of the base."""
        symbols = self._symbols()
        wrench = ca.vertcat(*self._in_base(symbols))
        derivatives = [ca.jacobian(wrench, rate) for rate in symbols[len(ARGUMENTS) :]]
        results = [ca.sparsify(derivative) for derivative in ca.cse(derivatives)]
        return ca.Function("with_rates", symbols, results, self.arguments, [f"with_{rate}" for rate in self.rates])

    @cached_property
    def energy(self) -> ca.Function | None:
        """Energy, J on one section, J/m along a rod; None for a wrench without energy."""
        if self.world_energy is None:
            return None
        symbols = self._symbols()
        energy = self.world_energy(*self._in_world(symbols))
        return ca.Function("energy", symbols, [energy], self.arguments, ["energy"])

    def _symbols(self) -> list[ca.SX]:
        parameter_count = self.world_wrench.size1_in(2)
        data_count = self.world_wrench.size1_in(3)
        return [
            ca.SX.sym("position", 3),
            ca.SX.sym("rotation", 3, 3),
            ca.SX.sym("base_position", 3),
            ca.SX.sym("base_rotation", 3, 3),
            ca.SX.sym("parameters", parameter_count),
            ca.SX.sym("data", data_count),
            *(ca.SX.sym(rate, 3) for rate in self.rates),
        ]

    def _in_world(self, symbols: Sequence[ca.SX]) -> list[ca.SX]:
        position, rotation, base_position, base_rotation, parameters, data, *rates = symbols
        world_position = base_position + base_rotation @ position
        world_rotation = base_rotation @ rotation
        world_rates = [base_rotation @ rate for rate in rates]
        return [world_position, world_rotation, parameters, data, *world_rates]

    def _in_base(self, symbols: Sequence[ca.SX]) -> list[ca.SX]:
        base_rotation = symbols[3]
        return [ca.sparsify(base_rotation.T @ vector) for vector in self.world_wrench(*self._in_world(symbols))]


def rotation_rates(rotation: Matrix) -> list[Matrix]:
    """Derivative of a rotation matrix by a turn about each axis, δR = δθ^ R, 3×3 each."""
    axes = ca.horzsplit(ca.DM.eye(3))
    return [hat(axis) @ rotation for axis in axes]


def wrench_of_energy(energy: Matrix, position: Matrix, rotation: Matrix) -> tuple[Matrix, Matrix]:
    """Force −∂U/∂r and moment −∂U/∂θ of an energy in the symbols of a pose, 3×1 each, world axes.

    With δR = δθ^ R the energy varies by Σ ∂U/∂R ∘ (δθ^ R).
    """
    with_position = ca.gradient(energy, position)
    with_rotation = ca.gradient(energy, ca.vec(rotation))
    rates = [ca.vec(rate) for rate in rotation_rates(rotation)]
    with_turn = [ca.dot(with_rotation, rate) for rate in rates]
    return -with_position, -ca.vertcat(*with_turn)
