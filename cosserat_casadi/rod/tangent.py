"""Jacobian of a rod's residual from its structure, exact for the discrete model.

Column j of every matrix below is the variation of a field with the j-th strain coordinate, stacked component by
component. Rotations vary by δθ = Σ R T ∂Ω/∂q over the intervals passed, tangents by δt = δθ × t + ℓ Σ d_c δΓ_c,
moments by the transpose. Only what a scene's loads need is formed.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import casadi as ca
import numpy as np

from cosserat_casadi.maths.blocks import (
    block_diagonal,
    cumulative_sum,
    hat_operator,
    reversed_places,
)
from cosserat_casadi.maths.rotation import cross
from cosserat_casadi.maths.typing import FloatArray, Matrix
from cosserat_casadi.rod.igm import InverseGeometricModel
from cosserat_casadi.rod.transport import IntervalKernels, interval_kernels, interval_turns, turn_matrix
from cosserat_casadi.rod.wrenches import PointWrench, Wrench


@dataclass(frozen=True)
class Tangent:
    """Variations of a rod's fields with its strain coordinates.

    Attributes:
        igm: the rod's balance.
    """

    igm: InverseGeometricModel

    @cached_property
    def kernels(self) -> IntervalKernels:
        """Functions of one interval."""
        return interval_kernels(self.igm.shape.basis)

    @cached_property
    def turns(self) -> Matrix:
        """Taylor coefficients of the turn of every interval."""
        return interval_turns(self.igm.shape.basis, self.igm.shape.q)

    @cached_property
    def turn_matrix(self) -> ca.DM:
        """Derivative of the stacked turns with respect to q."""
        return ca.sparsify(ca.DM(turn_matrix(self.igm.shape.basis)))

    @cached_property
    def interval_operators(self) -> tuple[Matrix, Matrix, Matrix, Matrix]:
        """E, T, W, H of every interval as operators on stacked fields."""
        count = self.turns.shape[1]
        moment = self.igm.body_moment
        kernel = self.kernels.variation
        blocks = kernel.map(count)(self.turns, ca.DM.zeros(3, count) if moment is None else moment)
        e, t, w, h = (block_diagonal(block, kernel.sparsity_out(i)) for i, block in enumerate(blocks))
        return e, t, w, h

    @cached_property
    def increment(self) -> Matrix:
        """δΩ of the intervals, (3·intervals)×n, rad."""
        return self.interval_operators[0] @ self.turn_matrix

    @cached_property
    def to_base(self) -> Matrix:
        """Operator of the rotations of the sections at which the intervals begin."""
        d1, d2, d3 = (d[:, :-1] for d in self.igm.shape.section_directors)
        blocks = [[ca.diag(row) for row in ca.vertsplit(d)] for d in (d1, d2, d3)]
        return ca.horzcat(*[ca.vertcat(*column) for column in blocks])

    @cached_property
    def section_rotation(self) -> Matrix:
        """δθ of the distinct sections beyond the base, (3·intervals)×n, rad."""
        steps = self.to_base @ (self.interval_operators[1] @ self.increment)
        return cumulative_sum(steps, self.turns.shape[1])

    @cached_property
    def rotation(self) -> Matrix:
        """δθ of the nodes, 3M×n, rad."""
        grid, n = self.igm.shape.basis.grid, self.igm.shape.basis.size
        if not self.kernels.axes:
            return ca.DM(3 * grid.size, n)
        parts = ca.vertsplit(self.section_rotation, self.turns.shape[1])
        index = np.asarray(grid.section_of_node).tolist()
        return ca.vertcat(*[self._with_base(part)[index, :] for part in parts])

    @cached_property
    def tangent(self) -> Matrix:
        """δt of the nodes, 3M×n, m."""
        shape = self.igm.shape
        variation = -(hat_operator(shape.tangent) @ self.rotation)
        linear = [self._stretch(c) for c in shape.basis.rod.admitted if c >= 3]
        if linear:
            rest = shape.basis.size - sum(block.shape[1] for block in linear)
            variation = variation + ca.horzcat(ca.DM(variation.shape[0], rest), *linear)
        return variation

    def position(self, node: int) -> Matrix:
        """δr of one node, 3×n, m."""
        row = ca.DM(self.igm.shape.basis.grid.integration_matrix[[node]])
        return ca.vertcat(*[row @ part for part in self._components(self.tangent)])

    def rotation_of(self, node: int) -> Matrix:
        """δθ of one node, 3×n, rad."""
        return ca.vertcat(*[part[node, :] for part in self._components(self.rotation)])

    @cached_property
    def force_covector(self) -> Matrix | None:
        """δn̂, 3M×n: only followers turn with the rod."""
        followers = [w for w in self.igm.statics.wrenches if w.follower]
        parts = [self._follower_force(w, w.force) for w in followers if w.force is not None]
        return sum(parts[1:], parts[0]) if parts else None

    @cached_property
    def moment_covector(self) -> Matrix:
        """δ(t × n̂ + ĉ), 3M×n, N m."""
        statics, shape = self.igm.statics, self.igm.shape
        variation: Matrix = ca.DM(3 * shape.basis.grid.size, shape.basis.size)
        if statics.force_covector is not None:
            variation = variation - hat_operator(statics.force_covector) @ self.tangent
        if self.force_covector is not None:
            variation = variation + hat_operator(shape.tangent) @ self.force_covector
        for wrench in statics.wrenches:
            if wrench.follower and wrench.moment is not None:
                variation = variation + self._follower_couple(wrench, wrench.moment)
        return variation

    @cached_property
    def jacobian(self) -> Matrix:
        """∂ residual / ∂q, n×n, without unit."""
        basis = self.igm.shape.basis
        stiffness = ca.DM(basis.stiffness)
        angular = self._angular_rows()
        linear = [self._linear_rows(c) for c in basis.rod.admitted if c >= 3]
        if linear:
            rest = basis.size - sum(block.shape[0] for block in linear)
            return stiffness + angular + ca.vertcat(ca.DM(rest, basis.size), *linear)
        return stiffness + angular

    def _angular_rows(self) -> Matrix:
        basis, moment = self.igm.shape.basis, self.igm.body_moment
        if moment is None or not self.kernels.axes:
            return ca.DM(basis.size, basis.size)
        _, frame, turning, second = self.interval_operators
        moved = turning @ self.increment + frame.T @ (self.to_base.T @ self._moment_variation())
        curved = ca.triu2symm(ca.triu(self.turn_matrix.T @ (second @ self.turn_matrix)))
        return (self.increment.T @ moved + curved) / -basis.energy_unit

    def _moment_variation(self) -> Matrix:
        """δm − δθ × m of every interval in the base frame, (3·intervals)×n."""
        count = self.turns.shape[1]
        ends = self._at_sections(self.moment_covector)
        passed = reversed_places(cumulative_sum(reversed_places(ends, count), count), count)
        parts = ca.vertsplit(self.section_rotation, count)
        begins = ca.vertcat(*[self._with_base(part)[:-1, :] for part in parts])
        return passed + hat_operator(self.igm.statics.interval_moment) @ begins

    def _linear_rows(self, component: int) -> Matrix:
        basis, covector = self.igm.shape.basis, self.igm.statics.force_covector
        if covector is None:
            return ca.DM(basis.at_nodes[component].shape[1], basis.size)
        director = self.igm.shape.directors[component - 3]
        lever = cross(director, covector)
        share = self._contract(lever, self.rotation)
        if self.force_covector is not None:
            share = share + self._contract(director, self.force_covector)
        return ca.DM(basis.at_nodes[component] * (-basis.rod.length / basis.energy_unit)).T @ share

    def _stretch(self, component: int) -> Matrix:
        """δt of a unit of each coordinate of a linear strain: ℓ d_c Φ_c."""
        basis = self.igm.shape.basis
        phi = ca.DM(basis.rod.length * basis.at_nodes[component])
        director = self.igm.shape.directors[component - 3]
        return ca.vertcat(*[ca.diag(row) @ phi for row in ca.vertsplit(director)])

    def _follower_force(self, wrench: Wrench, force: Matrix) -> Matrix:
        statics, grid = self.igm.statics, self.igm.shape.basis.grid
        if isinstance(wrench, PointWrench):
            node = grid.node_at(wrench.at)
            turned = self._turned(self.igm.shape.rotation_at(node) @ force, node)
            spread = ca.DM(grid.integration_matrix[[node]]).T
            return ca.vertcat(*[spread @ row for row in ca.vertsplit(turned)])
        variation = -(hat_operator(statics.line(wrench, force)) @ self.rotation)
        to_covector = ca.DM(self._line_matrix()).T
        return ca.vertcat(*[to_covector @ part for part in self._components(variation)])

    def _follower_couple(self, wrench: Wrench, moment: Matrix) -> Matrix:
        grid = self.igm.shape.basis.grid
        if isinstance(wrench, PointWrench):
            node = grid.node_at(wrench.at)
            turned = self._turned(self.igm.shape.rotation_at(node) @ moment, node)
            place = ca.DM(ca.Sparsity.triplet(grid.size, 1, [node], [0]), 1.0)
            return ca.vertcat(*[place @ row for row in ca.vertsplit(turned)])
        weights = ca.DM(self.igm.shape.basis.rod.length * grid.weights)
        couple = self.igm.statics.line(wrench, moment) @ ca.diag(weights)
        return -(hat_operator(couple) @ self.rotation)

    def _turned(self, vector: Matrix, node: int) -> Matrix:
        """δθ × vector at one node, 3×n."""
        return -ca.skew(vector) @ self.rotation_of(node)

    def _line_matrix(self) -> FloatArray:
        grid, length = self.igm.shape.basis.grid, self.igm.shape.basis.rod.length
        matrix: FloatArray = length * grid.weights[:, None] * grid.integration_matrix
        return matrix

    def _at_sections(self, stacked: Matrix) -> Matrix:
        """Sums over the nodes of each distinct section beyond the base."""
        grid = self.igm.shape.basis.grid
        parts = self._components(stacked)
        if grid.elements == 1:
            return ca.vertcat(*[part[1:, :] for part in parts])
        gather = np.zeros((grid.section_of_node[-1] + 1, grid.size))
        gather[grid.section_of_node, np.arange(grid.size)] = 1.0
        matrix = ca.sparsify(ca.DM(gather[1:]))
        return ca.vertcat(*[matrix @ part for part in parts])

    def _components(self, stacked: Matrix) -> list[Matrix]:
        return list(ca.vertsplit(stacked, self.igm.shape.basis.grid.size))

    def _contract(self, field: Matrix, stacked: Matrix) -> Matrix:
        """Scalar product at each node of a 3×M field with stacked variations, M×n."""
        rows = zip(ca.vertsplit(field), self._components(stacked), strict=True)
        terms = [ca.diag(row) @ part for row, part in rows]
        return terms[0] + terms[1] + terms[2]

    @staticmethod
    def _with_base(part: Matrix) -> Matrix:
        return ca.vertcat(ca.DM(1, part.shape[1]), part)
