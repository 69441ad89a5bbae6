"""Derivatives of the inertia of a rod by its coordinates, their rates and their accelerations: K, C and M.

A vector y of the section, its position or one of its directors, has δy = Y δq with Y the known field of tangent.py.
Along a motion ÿ = Y q̈ + Ẏ q̇, and so

    ∂ÿ/∂q̈ = Y        ∂ÿ/∂q̇ = 2 Ẏ        ∂ÿ/∂q = Ÿ,

the last because differentiating in time and with q commute. The sweeps of Y carry its first and second rates along:
with A for an interval, δθ has the rates Σ Ȧ and Σ Ä. The inertia force −μ ÿ does the work Σ Yᵀ μ ÿ on δq, whose
derivative at fixed ÿ is as for a dead load and is computed in tangent.py; this module adds the other derivatives. For
directors they are collected in three 3×3 matrices a node: with δd = δθ × d

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

from cosserat_casadi.maths.block_operators import block_diagonal, cumulative_sum, hat_operator, sum_of_products
from cosserat_casadi.maths.numbers import Numbers, as_matrix, each_times, is_symbolic, known, product, row_times
from cosserat_casadi.maths.typing import FloatArray, Matrix
from cosserat_casadi.rod.inertia import RodInertia
from cosserat_casadi.rod.motion_matrices import Jet, MotionMatrices
from cosserat_casadi.rod.rod_motion import RodMotion, motion_kernels
from cosserat_casadi.rod.tangent import Tangent

ORDERS = 3
"""Derivatives by z, by ż and by z̈."""


@dataclass(frozen=True)
class MotionTangent:
    """Variations of a rod's fields and of their rates.

    Columns: the n strain coordinates; with a floating base then three turns and three shifts of the base. Coordinates
        that turn sections (curvatures, torsion, turns of the base) stand apart from linear strains and shifts, which
        have no δθ. Sections that cannot turn, such as the base of a rod that does not float, have no rows in δθ.

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
        """Terms of inertia in ∂/∂z, ∂/∂ż and ∂/∂z̈ of the forces on z, without frozen wrenches, in units of ``unit``.

        The forces are minus the virtual work of the inertia: the rows of the residual, and minus the moment about the
        base and the force on it.
        """
        return MotionMatrices(*map(self._ordered, self._matrices.orders))

    @cached_property
    def rotation(self) -> Jet:
        """δθ at the m nodes that turn, with its rates, 3m×turning columns, rad."""
        orders = [self._at_turning_nodes(order) for order in self._section_rotations]
        if not self.floating:
            return Jet(*orders)
        # The base turns all sections alike, and a turn about fixed axes of the world has no rate.
        rows = orders[0].shape[0]
        alike = ca.sparsify(ca.DM(np.kron(np.eye(3), np.ones((len(self._nodes), 1)))))
        turns = [alike, ca.DM(rows, 3), ca.DM(rows, 3)]
        return Jet(*(ca.horzcat(columns, turn) for columns, turn in zip(orders, turns, strict=True)))

    @cached_property
    def _rotations(self) -> Matrix:
        """Stack of δθ̈, δθ̇ and δθ, 9m×turning columns."""
        theta = self.rotation
        return ca.vertcat(theta.acceleration, theta.rate, theta.value)

    @cached_property
    def _nodes(self) -> list[int]:
        """Nodes with sections that turn."""
        section_of_node = self.tangent.rod.grid.section_of_node
        if self.floating:
            return list(range(len(section_of_node)))
        return np.flatnonzero(section_of_node > 0).tolist()

    def _at_turning_nodes(self, sections: Matrix) -> Matrix:
        """Stacked variations at the nodes that turn, 3m×k, from variations of the sections beyond the base."""
        nodes = self.tangent.rod.grid.size
        components = ca.vertsplit(self.tangent.at_nodes(sections), nodes)
        if len(self._nodes) == nodes:
            return ca.vertcat(*components)
        return ca.vertcat(*[component[self._nodes, :] for component in components])

    # Positions, r = p + S t: with δt = δθ × t on the turning columns, and the stretch on the others.

    # Operators on Θ̈, Θ̇ and Θ for stiffness, damping and mass are stacked: one product with long sums gives all three.

    @cached_property
    def _accelerations(self) -> Matrix:
        """Derivatives of ẗ by z, ż and z̈ at the nodes that turn, 9m×turning columns: δt = δθ × t."""
        # A hat matrix is antisymmetric.
        t, t_rate, t_acceleration = (hat_operator(field[:, self._nodes]).T for field in self._tangents)
        return _operators(t, 2 * t_rate, t_acceleration) @ self._rotations

    @property
    def _tangents(self) -> tuple[Matrix, Matrix, Matrix]:
        """Tangents at the nodes with their rates, 3×M, m."""
        motion = self.motion
        return motion.shape.tangent, motion.tangent_rate, motion.tangent_acceleration

    @cached_property
    def _stretch(self) -> MotionMatrices | None:
        """Derivatives of ẗ at all nodes by linear strains: ℓ d δΓ along directors that turn; None without such strains.

        A floating base adds a row to each component, and columns for its shift.
        """
        rod = self.tangent.rod
        # By z, by ż and by z̈.
        fields: tuple[list[Matrix], ...] = ([], [], [])
        for component in rod.linear:
            axis = component - 3
            stretch = ca.DM(rod.length * rod.at_nodes[component])
            rate, acceleration = self.motion.director_rate(axis), self.motion.director_acceleration(axis)
            orders = (acceleration, 2 * rate, self.motion.shape.directors[axis])
            for columns, director in zip(fields, orders, strict=True):
                rows = [self._with_shift_row(ca.diag(row) @ stretch) for row in ca.vertsplit(director)]
                columns.append(ca.vertcat(*rows))
        if self.floating:
            nodes = rod.grid.size
            shift_rows = [(nodes + 1) * component + nodes for component in range(3)]
            by_shift = ca.DM(ca.Sparsity.triplet(3 * (nodes + 1), 3, shift_rows, [0, 1, 2]), 1.0)
            none = ca.DM(*by_shift.shape)
            for columns, order in zip(fields, (none, none, by_shift), strict=True):
                columns.append(order)
        if not fields[0]:
            return None
        return MotionMatrices(*(ca.horzcat(*columns) for columns in fields))

    def _with_shift_row(self, rows: Matrix) -> Matrix:
        """One component at the nodes, with a row of zeros for the shift of a floating base."""
        return ca.vertcat(rows, ca.DM(1, rows.shape[1])) if self.floating else rows

    @cached_property
    def _gram(self) -> Numbers:
        """Sᵀ μ S of one component, where S integrates tangents, and with a floating base adds its shift.

        It is in units of :attr:`_mass`, so that all uniform rods, of any length and density, have the same matrix.
        """
        rod = self.tangent.rod
        integrate = rod.grid.integration_matrix
        if self.floating:
            integrate = np.hstack([integrate, np.ones((rod.grid.size, 1))])
        mass = self._node_mass
        if is_symbolic(mass):
            return self._symbolic_gram(integrate, mass)
        relative = known(mass) / self._largest_mass
        weighted = (rod.grid.weights * relative)[:, None] * integrate
        return np.asarray(integrate.T @ weighted)

    @property
    def _node_mass(self) -> Numbers:
        """Mass at the nodes per length of the grid's coordinate, shape (M,), kg/m."""
        return each_times(self.inertia.masses.mass, self.tangent.rod.node_rates)

    @property
    def _mass(self) -> float:
        """Mass of a uniform rod with the heaviest section of this rod, over the unit of the forces, kg/J."""
        return self.tangent.rod.length * self._largest_mass / self.unit

    @property
    def _largest_mass(self) -> float:
        """Largest mass per length of a node, kg/m; 1 for a rod without mass, or with masses that are expressions."""
        mass = self._node_mass
        if is_symbolic(mass):
            return 1.0
        return float(known(mass).max()) or 1.0

    def _pulled(self, rows: list[int] | None, columns: list[int] | None, fields: Matrix) -> Matrix:
        """Some rows and columns of the Gram matrix times each component of stacked fields."""
        part = self._gram
        if rows is not None:
            part = part[rows, :]
        if columns is not None:
            part = part[:, columns]
        gram = as_matrix(part)
        # Transposed, so that sums in generated C run along the columns of the unknowns, as in the neighbouring
        # products.
        return ca.horzcat(*[component @ gram.T for component in ca.horzsplit(fields.T, gram.shape[1])]).T

    # Variations at all nodes, in the order of the coordinates, for loads that depend on rates and act anywhere.

    @cached_property
    def section_rotation(self) -> Jet:
        """δθ at all nodes with its rates, 3M×columns, rad."""
        # Coordinates that stretch turn nothing.
        none = ca.DM(3 * self.tangent.rod.grid.size, 0 if self._stretch is None else self._stretch.mass.shape[1])
        orders = [ca.horzcat(self._at_all_nodes(order), none) for order in self.rotation.orders]
        return Jet(*[self._ordered_columns(order) for order in orders])

    @cached_property
    def section_tangent(self) -> Jet:
        """δt at all nodes with its rates, 3M×columns, m."""
        rows = 3 * len(self._nodes)
        by_z, by_rate, by_acceleration = (self._at_all_nodes(part) for part in ca.vertsplit(self._accelerations, rows))
        turning = [by_acceleration, by_rate / 2, by_z]
        if self._stretch is None:
            return Jet(*[self._ordered_columns(order) for order in turning])
        others = [self._stretch.mass, self._stretch.damping / 2, self._stretch.stiffness]
        orders = [ca.horzcat(one, self._without_shift_rows(other)) for one, other in zip(turning, others, strict=True)]
        return Jet(*[self._ordered_columns(order) for order in orders])

    def _at_all_nodes(self, rows: Matrix) -> Matrix:
        """Rows of all nodes from rows of the nodes that turn, 3M×k; rows of other nodes are zero."""
        count = len(self._nodes)
        pattern = ca.Sparsity.triplet(self.tangent.rod.grid.size, count, self._nodes, list(range(count)))
        places = ca.DM(pattern, 1.0)
        return ca.kron(ca.DM.eye(3), places) @ rows

    def _without_shift_rows(self, rows: Matrix) -> Matrix:
        """Rows of the nodes, without the row of the shift that a floating base adds to each component."""
        if not self.floating:
            return rows
        nodes = self.tangent.rod.grid.size
        return ca.vertcat(*[component[:nodes, :] for component in ca.vertsplit(rows, nodes + 1)])

    # Parts of the matrices by rows and columns: turning coordinates first, then the others.

    @cached_property
    def _wrenches(self) -> Matrix:
        """Wrenches on the sections that turn by the turning columns, 9m×turning columns; Θᵀ turns them into forces."""
        forces = self._pulled(self._nodes, self._nodes, self._accelerations)
        levers = ca.diagcat(*[self._levers] * ORDERS)
        if not self.inertia.masses.second_moments:
            return levers @ forces
        return sum_of_products((levers, forces), (_operators(*self._rotary_operators), self._rotations))

    @cached_property
    def _levers(self) -> Matrix:
        """Operator from forces on the tangents, in units of :attr:`_mass`, to moments on the sections that turn."""
        return hat_operator(self._mass * self.motion.shape.tangent[:, self._nodes])

    @cached_property
    def _matrices(self) -> MotionMatrices:
        """The matrices, turning rows and columns first."""
        rows = 3 * len(self._nodes)
        ratio = self.motion.shape.ratio
        # The mass grows with the length.
        turned = (self.rotation.value if ratio is None else ratio * self.rotation.value).T
        every = ca.diagcat(*[turned] * ORDERS) @ self._wrenches
        count = turned.shape[0]
        stiffness, damping, mass = (every[k * count : (k + 1) * count, :] for k in range(ORDERS))
        mass = ca.triu2symm(ca.triu(mass))
        others = self._stretch
        if others is None:
            return MotionMatrices(stiffness, damping, mass)
        on_turning, on_others = self._rows_of(others, self._nodes), self._rows_of(others, None)
        of_turning = [on_turning @ moved for moved in ca.vertsplit(self._accelerations, rows)]
        columns = [others.stiffness, others.damping, others.mass]
        by_others = [turned @ (self._levers @ self._pulled(self._nodes, None, field)) for field in columns[:2]]
        by_others.append(of_turning[2].T)
        of_others = [on_others @ field for field in columns]
        blocks = zip((stiffness, damping, mass), by_others, of_turning, of_others, strict=True)
        return MotionMatrices(*(ca.blockcat([[one, two], [three, four]]) for one, two, three, four in blocks))

    def _rows_of(self, others: MotionMatrices, nodes: list[int] | None) -> Matrix:
        """Rows of the linear strains and the shift, from accelerations of some nodes, or of all."""
        return (self._mass * self.inertia.ratio) * self._pulled(nodes, None, others.mass).T

    def _ordered(self, matrix: Matrix) -> Matrix:
        """A matrix in the order of the coordinates: turns of the base follow all strains."""
        return matrix[self._order, self._order] if self.floating else matrix

    def _ordered_columns(self, matrix: Matrix) -> Matrix:
        """A matrix with columns in the order of the coordinates."""
        return matrix[:, self._order] if self.floating else matrix

    @cached_property
    def _order(self) -> list[int]:
        """Columns of a floating rod in the order of the coordinates."""
        turning = self.tangent.angular_size
        linear = self.tangent.rod.size - turning
        strains = [*range(turning), *range(turning + 3, turning + 3 + linear)]
        turns = list(range(turning, turning + 3))
        first_shift = turning + 3 + linear
        shifts = list(range(first_shift, first_shift + 3))
        return [*strains, *turns, *shifts]

    @cached_property
    def _section_rotations(self) -> tuple[Matrix, Matrix, Matrix]:
        """δθ of the sections beyond the base by the angular coordinates, with its rates, (3·intervals)×n_a each."""
        rod = self.tangent.rod
        if not self.tangent.kernels.axes:
            none = ca.DM(3 * self.tangent.intervals, self.tangent.angular_size)
            return none, none, none
        count = self.tangent.intervals
        kernel = motion_kernels(rod).variation
        blocks = kernel.map(count)(
            *self.motion.shape.interval_arguments,
            *self.motion.turn_rates,
            self.motion.section_angular_velocity[:, :-1],
            self.motion.section_angular_acceleration[:, :-1],
        )
        operators = [block_diagonal(block, kernel.sparsity_out(number)) for number, block in enumerate(blocks)]
        added = ca.vertcat(*operators) @ self.tangent.turn_matrix.unfolded
        first, second = ca.vertsplit(cumulative_sum(added, count), 3 * count)
        return self.tangent.section_rotation, first, second

    def _symbolic_gram(self, integrate: FloatArray, mass: Matrix) -> Matrix:
        """Sᵀ μ S for masses that are expressions; it is linear in the mass of each node."""
        weights = self.tangent.rod.grid.weights
        weighted = weights[:, None, None] * integrate[:, :, None] * integrate[:, None, :]
        columns = integrate.shape[1]
        return ca.reshape(product(weighted.reshape(len(weighted), -1).T, mass), columns, columns)

    @cached_property
    def _rotary_operators(self) -> tuple[Matrix, Matrix, Matrix]:
        """P₂, P₁ and P₀ of the module's docstring on stacked fields, 3m×3m, times the lengths of the nodes."""
        nodes = self._nodes
        totals: list[Matrix] = [ca.DM(3 * len(nodes), 3 * len(nodes))] * 3
        lengths: Numbers = self.tangent.rod.node_lengths / self.unit
        for axis, second_moment in self.inertia.masses.second_moments.items():
            weights = row_times(lengths, second_moment)[nodes]
            director = self.motion.shape.directors[axis][:, nodes]
            rate = self.motion.director_rate(axis)[:, nodes]
            acceleration = self.motion.director_acceleration(axis)[:, nodes]
            hat = hat_operator(director)
            inertia = -(_weighted(hat, weights) @ hat)
            transport = -2 * _outer(rate, director, weights)
            skew = _outer(director, acceleration, weights) - _outer(acceleration, director, weights)
            totals = [total + part for total, part in zip(totals, (inertia, transport, skew), strict=True)]
        p2, p1, p0 = totals
        return p2, p1, p0


def _operators(on_acceleration: Matrix, on_rate: Matrix, on_value: Matrix) -> Matrix:
    """Operator on the stack of Θ̈, Θ̇ and Θ with rows of derivatives by z, by ż and by z̈.

    The derivative by z is A Θ̈ + B Θ̇ + C Θ, by ż it is 2 A Θ̇ + B Θ, by z̈ it is A Θ.
    """
    none = ca.DM(*on_acceleration.shape)
    rows = [
        [on_acceleration, on_rate, on_value],
        [none, 2 * on_acceleration, on_rate],
        [none, none, on_acceleration],
    ]
    return ca.blockcat(rows)


def _weighted(operator: Matrix, weights: Numbers) -> Matrix:
    """Rows of an operator on stacked 3-vectors, each times the weight of its point."""
    return ca.diag(ca.repmat(as_matrix(weights), 3, 1)) @ operator


def _outer(left: Matrix, right: Matrix, weights: Numbers) -> Matrix:
    """Operator v ↦ weight · left (right·v) at every point, 3k×3k, from 3×k fields."""
    columns = as_matrix(weights)
    rows: list[Sequence[Matrix]] = []
    for left_row in ca.vertsplit(left):
        weighted = left_row.T * columns
        rows.append([ca.diag(weighted * right_row.T) for right_row in ca.vertsplit(right)])
    return ca.blockcat(rows)
