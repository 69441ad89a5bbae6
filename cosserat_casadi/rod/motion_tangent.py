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

from cosserat_casadi.maths.blocks import block_diagonal, cumulative_sum, hat_operator, sum_of_products
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

    Columns: the n strain coordinates; with a floating base then three turns and three shifts of the base. Those that
    turn sections, curvatures, torsion and turns of the base, stand apart from the others here, linear strains and
    shifts, of which δθ has none. Sections that nothing turns, the base of a rod that does not float, have no rows
    in δθ.

    Attributes:
        tangent: variations of the rod's fields at rest.
        inertia: the rod in motion.
        floating: whether the base floats.
        unit: energy that the forces are divided by, J.
    """

    tangent: Tangent
    inertia: RodInertia
    floating: bool
    unit: float = 1.0

    @property
    def motion(self) -> RodMotion:
        """The rod's motion."""
        return self.inertia.motion

    @cached_property
    def matrices(self) -> MotionMatrices:
        """What inertia adds to ∂/∂z, ∂/∂ż and ∂/∂z̈ of the forces on z beside frozen wrenches, in units of ``unit``.

        The forces are minus the virtual work of the inertia: the rows of the residual, and minus the moment about the
        base and the force on it.
        """
        return MotionMatrices(
            stiffness=self._ordered(self._blocks("stiffness")),
            damping=self._ordered(self._blocks("damping")),
            mass=self._ordered(self._mass_blocks),
        )

    @cached_property
    def rotation(self) -> Jet:
        """δθ at the nodes that turn with its rates, 3m×turning columns, rad."""
        orders = [self._at_turning_nodes(order) for order in self._section_rotations]
        if not self.floating:
            return Jet(*orders)
        # The base turns all sections alike, and a turn about fixed axes of the world has no rate.
        rows = orders[0].shape[0]
        alike = ca.sparsify(ca.DM(np.kron(np.eye(3), np.ones((len(self._nodes), 1)))))
        turns = [alike, ca.DM(rows, 3), ca.DM(rows, 3)]
        return Jet(*(ca.horzcat(columns, turn) for columns, turn in zip(orders, turns, strict=True)))

    @cached_property
    def _nodes(self) -> list[int]:
        """Nodes whose sections turn."""
        section_of_node = self.tangent.rod.grid.section_of_node
        if self.floating:
            return list(range(len(section_of_node)))
        return np.flatnonzero(section_of_node > 0).tolist()

    def _at_turning_nodes(self, sections: Matrix) -> Matrix:
        """Variations at the nodes that turn, 3m×k, from those of the sections beyond the base; stacked."""
        nodes = self.tangent.rod.grid.size
        components = ca.vertsplit(self.tangent.at_nodes(sections), nodes)
        if len(self._nodes) == nodes:
            return ca.vertcat(*components)
        return ca.vertcat(*[component[self._nodes, :] for component in components])

    # Positions, r = p + S t: with δt = δθ × t on the turning columns, and the stretch on the others.

    @cached_property
    def _acceleration(self) -> MotionMatrices:
        """What ẗ at the nodes that turn has of δθ by its turning columns: with Θ = δθ, −(t^ Θ) for z̈ and so on."""
        theta = self.rotation
        # The transpose of a hat is its negative.
        t, t_rate, t_acceleration = (hat_operator(field[:, self._nodes]).T for field in self._tangents)
        twice_t, twice_t_rate = 2 * t, 2 * t_rate
        return MotionMatrices(
            mass=t @ theta.value,
            damping=sum_of_products((twice_t, theta.rate), (twice_t_rate, theta.value)),
            stiffness=sum_of_products(
                (t, theta.acceleration), (twice_t_rate, theta.rate), (t_acceleration, theta.value)
            ),
        )

    @property
    def _tangents(self) -> tuple[Matrix, Matrix, Matrix]:
        """Tangents at the nodes with their rates, 3×M, m."""
        motion = self.motion
        return motion.shape.tangent, motion.tangent_rate, motion.tangent_acceleration

    @cached_property
    def _stretch(self) -> MotionMatrices | None:
        """The same of the other columns, at all nodes: ℓ d δΓ along directors that turn; None without any.

        With a floating base there is one more row for each component: its shift.
        """
        rod = self.tangent.rod
        fields: dict[str, list[Matrix]] = {"mass": [], "damping": [], "stiffness": []}
        for component in rod.linear:
            axis = component - 3
            stretch = ca.DM(rod.length * rod.at_nodes[component])
            orders = {
                "mass": self.motion.shape.directors[axis],
                "damping": 2 * self.motion.director_rate(axis),
                "stiffness": self.motion.director_acceleration(axis),
            }
            for word, director in orders.items():
                rows = [self._with_shift_row(ca.diag(row) @ stretch) for row in ca.vertsplit(director)]
                fields[word].append(ca.vertcat(*rows))
        if self.floating:
            nodes = rod.grid.size
            shift_rows = [(nodes + 1) * component + nodes for component in range(3)]
            by_shift = ca.DM(ca.Sparsity.triplet(3 * (nodes + 1), 3, shift_rows, [0, 1, 2]), 1.0)
            fields["mass"].append(by_shift)
            fields["damping"].append(ca.DM(*by_shift.shape))
            fields["stiffness"].append(ca.DM(*by_shift.shape))
        if not fields["mass"]:
            return None
        return MotionMatrices(**{word: ca.horzcat(*columns) for word, columns in fields.items()})

    def _with_shift_row(self, rows: Matrix) -> Matrix:
        """One component at the nodes, with a row for the shift of a floating base, that it does not have."""
        if not self.floating:
            return rows
        return ca.vertcat(rows, ca.DM(1, rows.shape[1]))

    @cached_property
    def _gram(self) -> FloatArray:
        """Sᵀ μ S of one component, where S integrates tangents, and with a floating base adds its shift."""
        rod = self.tangent.rod
        integrate = rod.grid.integration_matrix
        if self.floating:
            integrate = np.hstack([integrate, np.ones((rod.grid.size, 1))])
        weighted = (rod.node_lengths * self.inertia.masses.mass)[:, None] * integrate
        return np.asarray(integrate.T @ weighted) / self.unit

    def _gram_of(self, rows: FloatArray) -> ca.DM:
        """Some rows and columns of the Gram matrix for all components."""
        return ca.sparsify(ca.DM(np.kron(np.eye(3), rows)))

    # The parts of the matrices by rows and columns: turning ones, then the others.

    def _pulled(self, word: str) -> Matrix:
        """Wrenches on the sections that turn, of which Θᵀ makes forces, by the turning columns."""
        turning = self._gram_of(self._gram[np.ix_(self._nodes, self._nodes)])
        forces = turning @ getattr(self._acceleration, word)
        return sum_of_products((self._levers, forces), *self._rotary_products(word))

    def _pulled_of_others(self, word: str) -> Matrix:
        """The same by the other columns."""
        forces: Matrix = self._gram_of(self._gram[self._nodes]) @ getattr(self._stretch, word)
        return self._levers @ forces

    @cached_property
    def _levers(self) -> Matrix:
        """Moments of forces on the tangents of the sections that turn."""
        return hat_operator(self.motion.shape.tangent[:, self._nodes])

    def _blocks(self, word: str) -> list[list[Matrix]]:
        """Blocks of stiffness or damping."""
        turned = self._left_of_turning.T
        blocks = [[turned @ self._pulled(word)]]
        if self._stretch is not None:
            of_others = getattr(self._stretch, word)
            blocks[0].append(turned @ self._pulled_of_others(word))
            blocks.append(
                [self._others_on_turning @ getattr(self._acceleration, word), self._others_on_others @ of_others]
            )
        return blocks

    @cached_property
    def _mass_blocks(self) -> list[list[Matrix]]:
        """Blocks of the mass matrix, which is symmetric."""
        turned = self._left_of_turning.T
        product = turned @ self._pulled("mass")
        blocks = [[ca.triu2symm(ca.triu(product))]]
        if self._stretch is not None:
            coupling = self._others_on_turning @ self._acceleration.mass
            blocks[0].append(coupling.T)
            blocks.append([coupling, self._others_on_others @ self._stretch.mass])
        return blocks

    @cached_property
    def _left_of_turning(self) -> Matrix:
        """Θ, times the ratio of the lengths: a longer rod has more mass."""
        if self.motion.shape.ratio is None:
            return self.rotation.value
        return self.motion.shape.ratio * self.rotation.value

    @cached_property
    def _others_on_turning(self) -> Matrix:
        """Rows of the other columns, as they pull at accelerations of the nodes that turn."""
        assert self._stretch is not None, "asked for with other columns"
        pulled = self._gram_of(self._gram[self._nodes]) @ self._stretch.mass
        return self.inertia.ratio * pulled.T

    @cached_property
    def _others_on_others(self) -> Matrix:
        """The same, at accelerations of all nodes."""
        assert self._stretch is not None, "asked for with other columns"
        pulled = self._gram_of(self._gram) @ self._stretch.mass
        return self.inertia.ratio * pulled.T

    def _ordered(self, blocks: list[list[Matrix]]) -> Matrix:
        """A matrix of its blocks, in the order of the coordinates: turns of the base follow all strains."""
        matrix = ca.blockcat(blocks)
        if not self.floating:
            return matrix
        turning = self.tangent.angular_size
        linear = self.tangent.rod.size - turning
        strains = [*range(turning), *range(turning + 3, turning + 3 + linear)]
        turns = list(range(turning, turning + 3))
        shifts = list(range(matrix.shape[0] - 3, matrix.shape[0]))
        order = [*strains, *turns, *shifts]
        return matrix[order, order]

    # Rotations

    def _rotary_products(self, word: str) -> list[tuple[Matrix, Matrix]]:
        """P₂ Θ̈ + P₁ Θ̇ + P₀ Θ for the stiffness and so on, of the module's docstring; nothing without rotary inertia."""
        if not self.inertia.masses.second_moments:
            return []
        p2, twice_p2, p1, p0 = self._rotary_operators
        theta = self.rotation
        products = {
            "mass": [(p2, theta.value)],
            "damping": [(twice_p2, theta.rate), (p1, theta.value)],
            "stiffness": [(p2, theta.acceleration), (p1, theta.rate), (p0, theta.value)],
        }
        return products[word]

    @cached_property
    def _section_rotations(self) -> tuple[Matrix, Matrix, Matrix]:
        """δθ of the sections beyond the base and its rates with the angular coordinates, (3·intervals)×n_a each."""
        rod = self.tangent.rod
        if not self.tangent.kernels.axes:
            none = ca.DM(3 * self.tangent.intervals, self.tangent.angular_size)
            return none, none, none
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
            rates.append(cumulative_sum(operator @ turns, count))
        first, second = rates
        return self.tangent.section_rotation, first, second

    @cached_property
    def _rotary_operators(self) -> tuple[Matrix, Matrix, Matrix, Matrix]:
        """P₂, 2 P₂, P₁ and P₀ of the module's docstring on stacked fields, 3m×3m, times the lengths of the nodes."""
        nodes = self._nodes
        totals: list[Matrix] = [ca.DM(3 * len(nodes), 3 * len(nodes))] * 3
        lengths = self.tangent.rod.node_lengths / self.unit
        for axis, second_moment in self.inertia.masses.second_moments.items():
            weights = (lengths * second_moment)[nodes]
            director = self.motion.shape.directors[axis][:, nodes]
            rate = self.motion.director_rate(axis)[:, nodes]
            acceleration = self.motion.director_acceleration(axis)[:, nodes]
            hat = hat_operator(director)
            inertia = -(_weighted(hat, weights) @ hat)
            transport = -2 * _outer(rate, director, weights)
            skew = _outer(director, acceleration, weights) - _outer(acceleration, director, weights)
            totals = [total + part for total, part in zip(totals, (inertia, transport, skew), strict=True)]
        p2, p1, p0 = totals
        return p2, 2 * p2, p1, p0


def _weighted(operator: Matrix, weights: FloatArray) -> Matrix:
    """Rows of an operator on stacked 3-vectors, each times the weight of its point."""
    return ca.diag(ca.DM(np.tile(weights, 3))) @ operator


def _outer(left: Matrix, right: Matrix, weights: FloatArray) -> Matrix:
    """Operator v ↦ weight · left (right·v) at every point, 3k×3k, from 3×k fields."""
    columns = ca.DM(weights)
    rows: list[Sequence[Matrix]] = []
    for left_row in ca.vertsplit(left):
        weighted = left_row.T * columns
        blocks = [ca.diag(weighted * right_row.T) for right_row in ca.vertsplit(right)]
        rows.append(blocks)
    return ca.blockcat(rows)
