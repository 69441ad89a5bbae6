"""Derivatives of the inertia of a rod with its coordinates, their rates and their accelerations: K, C and M.

A vector y of the section, its position or one of its directors, has δy = Y δq with Y the known field of tangent.py.
Along a motion ÿ = Y q̈ + Ẏ q̇, and so

    ∂ÿ/∂q̈ = Y        ∂ÿ/∂q̇ = 2 Ẏ        ∂ÿ/∂q = Ÿ,

the last because differentiating in time and with q commute. The sweeps of Y carry their first and second rates along:
with A of an interval, δθ has the rates Σ Ȧ and Σ Ä. The inertia force −μ ÿ does the work Σ Yᵀ μ ÿ on δq, whose
derivative at fixed ÿ is that of a dead load, and in tangent.py; here stands what is left. For directors it is collected
in three 3×3 matrices a node: with δd = δθ × d

    −δm = Σ μ δ(d × d̈) = P₂ δθ̈ + P₁ δθ̇ + P₀ δθ,

P₂ = −Σ μ d^d^ the inertia about the section's centre, P₁ = −2 Σ μ ḋ dᵀ and P₀ = Σ μ (d d̈ᵀ − d̈ dᵀ), where δθ̇ and δθ̈
are the rates of the vector δθ. See docs/theory.md, section 11.

A base that floats adds six columns: a turn δφ and a shift δp of it, in its own axes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import casadi as ca
import numpy as np

from cosserat_casadi.maths.blocks import block_diagonal, cumulative_sum, hat_operator
from cosserat_casadi.maths.numbers import Numbers, as_matrix, is_symbolic, known, product, row_times
from cosserat_casadi.maths.typing import FloatArray, Matrix
from cosserat_casadi.rod.inertia import RodInertia
from cosserat_casadi.rod.motion import RodMotion, motion_kernels
from cosserat_casadi.rod.tangent import Tangent


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

    def along(self, jet: Jet) -> MotionMatrices:
        """The same in other coordinates u with δz = P δu: the jet of P, n×k. Forces at fixed z̈ are left out.

        The second derivative of y is Y(P ü + 2 Ṗ u̇ + P̈ u): each order of the jet meets the one above.
        """
        to_z, to_z_rate, to_z_acceleration = jet.orders
        mass = self.mass @ to_z
        damping = self.damping @ to_z + 2 * (self.mass @ to_z_rate)
        stiffness = self.stiffness @ to_z + self.damping @ to_z_rate + self.mass @ to_z_acceleration
        pulled = to_z.T
        return MotionMatrices(pulled @ stiffness, pulled @ damping, pulled @ mass)


@dataclass(frozen=True)
class MotionTangent:
    """Variations of a rod's fields and of their rates.

    Columns: the n strain coordinates; with a floating base then three turns and three shifts of the base.

    Attributes:
        tangent: variations of the rod's fields at rest.
        inertia: the rod in motion.
        floating: whether the base floats.
    """

    tangent: Tangent
    inertia: RodInertia
    floating: bool

    @property
    def motion(self) -> RodMotion:
        """The rod's motion."""
        return self.inertia.motion

    @cached_property
    def matrices(self) -> MotionMatrices:
        """What inertia adds to ∂/∂z, ∂/∂ż and ∂/∂z̈ of the forces on z beside frozen wrenches, in J.

        The forces are minus the virtual work of the inertia: the rows of the residual, before they are divided by a
        unit, and minus the moment about the base and the force on it.
        """
        by_position = self._of_positions()
        by_rotation = self._of_rotations()
        if by_rotation is None:
            return by_position
        return MotionMatrices(
            stiffness=by_position.stiffness + by_rotation.stiffness,
            damping=by_position.damping + by_rotation.damping,
            mass=by_position.mass + by_rotation.mass,
        )

    @cached_property
    def rotation(self) -> Jet:
        """δθ at the nodes with its rates, 3M×columns, rad."""
        turning = self.tangent.rotation
        jets = Jet(turning, *self._turning_rates)
        return self._with_other_columns(jets)

    @cached_property
    def tangent_jet(self) -> Jet:
        """δt at the nodes with its rates, 3M×columns, m."""
        theta = self.rotation
        t, t_rate, t_acceleration = self._hats(
            self.motion.shape.tangent, self.motion.tangent_rate, self.motion.tangent_acceleration
        )
        # δt = δθ × t + ℓ d δΓ, and its time derivatives.
        value = -(t @ theta.value)
        rate = -(t @ theta.rate + t_rate @ theta.value)
        acceleration = -(t @ theta.acceleration + 2 * (t_rate @ theta.rate) + t_acceleration @ theta.value)
        stretch = self._stretch_columns
        return Jet(value + stretch.value, rate + stretch.rate, acceleration + stretch.acceleration)

    def _of_positions(self) -> MotionMatrices:
        """Σ Yᵀ μ (Y, 2 Ẏ, Ÿ) of the positions r = p + S t: three products with the constant Sᵀ μ S."""
        value, rate, acceleration = self._position_columns(self.tangent_jet)
        gram = self._gram
        mass = gram @ value
        damping = 2 * (gram @ rate)
        stiffness = gram @ acceleration
        pulled = self.inertia.ratio * value.T
        return MotionMatrices(pulled @ stiffness, pulled @ damping, pulled @ mass)

    def _of_rotations(self) -> MotionMatrices | None:
        """Σ Θᵀ (P₂ Θ̈ + P₁ Θ̇ + P₀ Θ) and so on of the module's docstring; None without rotary inertia."""
        if not self.inertia.masses.second_moments:
            return None
        p2, p1, p0 = self._rotary_operators
        theta = self.rotation
        mass = p2 @ theta.value
        damping = 2 * (p2 @ theta.rate) + p1 @ theta.value
        stiffness = p2 @ theta.acceleration + p1 @ theta.rate + p0 @ theta.value
        pulled = self.inertia.ratio * theta.value.T
        return MotionMatrices(pulled @ stiffness, pulled @ damping, pulled @ mass)

    @cached_property
    def _turning_rates(self) -> tuple[Matrix, Matrix]:
        """Rates of δθ at the nodes with the angular coordinates, 3M×n_a each."""
        rod = self.tangent.rod
        if not self.tangent.kernels.axes:
            none = ca.DM(3 * rod.grid.size, self.tangent.angular_size)
            return none, none
        count = self.tangent.intervals
        kernel = motion_kernels(rod).variation
        turn = self.motion.shape.interval_arguments[0]
        blocks = kernel.map(count)(
            turn,
            *self.motion.turn_rates,
            self.motion.shape.interval_begins,
            self.motion.section_angular_velocity[:, :-1],
            self.motion.section_angular_acceleration[:, :-1],
        )
        turns = self.tangent.turn_matrix.unfolded
        rates = []
        for number, block in enumerate(blocks):
            operator = block_diagonal(block, kernel.sparsity_out(number))
            at_sections = cumulative_sum(operator @ turns, count)
            rates.append(self.tangent.at_nodes(at_sections))
        first, second = rates
        return first, second

    @cached_property
    def _stretch_columns(self) -> Jet:
        """ℓ d δΓ at the nodes with its rates, 3M×columns: linear strains move along directors that turn."""
        orders: list[list[Matrix]] = [[], [], []]
        rod = self.tangent.rod
        for component in rod.linear:
            axis = component - 3
            director = self.motion.shape.directors[axis]
            fields = (director, self.motion.director_rate(axis), self.motion.director_acceleration(axis))
            stretch = ca.DM(rod.length * rod.at_nodes[component])
            for columns, field in zip(orders, fields, strict=True):
                rows = [ca.diag(row) @ stretch for row in ca.vertsplit(field)]
                columns.append(ca.vertcat(*rows))
        before = ca.DM(3 * rod.grid.size, self.tangent.angular_size)
        after = ca.DM(3 * rod.grid.size, self._base_columns)
        value, rate, acceleration = (ca.horzcat(before, *columns, after) for columns in orders)
        return Jet(value, rate, acceleration)

    def _with_other_columns(self, angular: Jet) -> Jet:
        """δθ with all coordinates: none with linear strains, all of a turn of the base, none of its shift."""
        rows = angular.value.shape[0]
        linear = ca.DM(rows, self.tangent.rod.size - self.tangent.angular_size)
        if not self.floating:
            return Jet(*(ca.horzcat(columns, linear) for columns in angular.orders))
        points = self.tangent.rod.grid.size
        # The base turns all sections alike, and a turn about fixed axes of the world has no rate.
        alike = ca.kron(ca.DM.eye(3), ca.DM.ones(points, 1))
        turn = [ca.DM(alike), ca.DM(rows, 3), ca.DM(rows, 3)]
        shift = ca.DM(rows, 3)
        orders = zip(angular.orders, turn, strict=True)
        return Jet(*(ca.horzcat(columns, linear, by_turn, shift) for columns, by_turn in orders))

    def _position_columns(self, jet: Jet) -> tuple[Matrix, Matrix, Matrix]:
        """δt with its rates, and beneath each component the shift of a floating base, that the rates do not have."""
        if not self.floating:
            return jet.orders
        points = self.tangent.rod.grid.size
        columns = jet.value.shape[1]
        results = []
        for order, matrix in enumerate(jet.orders):
            parts: list[Matrix] = []
            for component, rows in enumerate(ca.vertsplit(matrix, points)):
                shift = ca.DM(1, columns)
                if order == 0:
                    shift[0, columns - 3 + component] = 1.0
                parts += [rows, shift]
            results.append(ca.vertcat(*parts))
        value, rate, acceleration = results
        return value, rate, acceleration

    @property
    def _base_columns(self) -> int:
        return 6 if self.floating else 0

    @cached_property
    def _gram(self) -> Matrix:
        """Sᵀ μ S for each component, where S integrates tangents, and with a floating base adds its shift."""
        rod = self.tangent.rod
        integrate = rod.grid.integration_matrix
        if self.floating:
            integrate = np.hstack([integrate, np.ones((rod.grid.size, 1))])
        mass = self.inertia.masses.mass
        if is_symbolic(mass):
            return ca.kron(ca.DM.eye(3), self._symbolic_gram(integrate, mass))
        weighted = (rod.node_lengths * known(mass))[:, None] * integrate
        gram = integrate.T @ weighted
        return ca.sparsify(ca.DM(np.kron(np.eye(3), gram)))

    def _symbolic_gram(self, integrate: FloatArray, mass: Matrix) -> Matrix:
        """Sᵀ μ S where the masses are expressions: linear in the mass of each node."""
        weighted = self.tangent.rod.node_lengths[:, None, None] * integrate[:, :, None] * integrate[:, None, :]
        columns = integrate.shape[1]
        return ca.reshape(product(weighted.reshape(len(weighted), -1).T, mass), columns, columns)

    @cached_property
    def _rotary_operators(self) -> tuple[Matrix, Matrix, Matrix]:
        """P₂, P₁ and P₀ of the module's docstring on stacked fields, 3M×3M, times the lengths of the nodes."""
        totals: list[Matrix] = [ca.DM(3 * self.tangent.rod.grid.size, 3 * self.tangent.rod.grid.size)] * 3
        lengths = self.tangent.rod.node_lengths
        for axis, second_moment in self.inertia.masses.second_moments.items():
            weights = row_times(lengths, second_moment)
            director = self.motion.shape.directors[axis]
            rate = self.motion.director_rate(axis)
            acceleration = self.motion.director_acceleration(axis)
            hat = hat_operator(director)
            inertia = -(_weighted(hat, weights) @ hat)
            transport = -2 * _outer(rate, director, weights)
            skew = _outer(director, acceleration, weights) - _outer(acceleration, director, weights)
            totals = [total + part for total, part in zip(totals, (inertia, transport, skew), strict=True)]
        p2, p1, p0 = totals
        return p2, p1, p0

    @staticmethod
    def _hats(*fields: Matrix) -> list[Matrix]:
        return [hat_operator(field) for field in fields]


def _weighted(operator: Matrix, weights: Numbers) -> Matrix:
    """Rows of an operator on stacked 3-vectors, each times the weight of its point."""
    return ca.diag(ca.repmat(as_matrix(weights), 3, 1)) @ operator


def _outer(left: Matrix, right: Matrix, weights: Numbers) -> Matrix:
    """Operator v ↦ weight · left (right·v) at every point, 3k×3k, from 3×k fields."""
    columns = as_matrix(weights)
    rows: list[Sequence[Matrix]] = []
    for left_row in ca.vertsplit(left):
        weighted = left_row.T * columns
        blocks = [ca.diag(weighted * right_row.T) for right_row in ca.vertsplit(right)]
        rows.append(blocks)
    return ca.blockcat(rows)
