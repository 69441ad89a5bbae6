"""Backward sweep: from the wrenches on a rod to its internal wrench, report (1.17), (1.18), (1.29), (2.18).

The sweep is the exact transpose of the forward sweep. With the position r = S t of the tangents t at the nodes, the
virtual work of the loads is Σ n̂_k·δt_k + Σ ĉ_k·δθ_k, where n̂ = Sᵀ f collects the forces: n̂_k is the internal force
at node k times its quadrature weight, and Σ_{j>k} (t_j × n̂_j + ĉ_j) is the internal moment, m' = −r' × n − l̄ summed
from the tip. So the residual is the gradient of the discrete energy wherever an energy exists, the Jacobian is
symmetric then, and a dead load needs no product with S at all.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import casadi as ca
import numpy as np

from cosserat_casadi.maths.rotation import cross
from cosserat_casadi.maths.typing import FloatArray, Matrix
from cosserat_casadi.rod.kinematics import Shape
from cosserat_casadi.rod.wrenches import LineWrench, PointWrench, Wrench


@dataclass(frozen=True)
class Statics:
    """Internal wrench of a rod of known shape under known wrenches, base frame.

    Attributes:
        shape: the rod's shape.
        wrenches: what acts on it.
    """

    shape: Shape
    wrenches: Sequence[Wrench]

    @cached_property
    def force_covector(self) -> Matrix | None:
        """n̂, 3×M, conjugate to the variations of the tangents, N; None without forces."""
        return _total([self._force_covector(w, w.force) for w in self.wrenches if w.force is not None])

    @cached_property
    def moment_covector(self) -> Matrix | None:
        """T × n̂ + ĉ, 3×M, conjugate to the variations of the rotations of the nodes, N m; None without loads."""
        force = self.force_covector
        lever = None if force is None else cross(self.shape.tangent, force)
        parts = [lever, self.couple_covector(follower=False), self.couple_covector(follower=True)]
        return _total([part for part in parts if part is not None])

    def couple_covector(self, follower: bool) -> Matrix | None:
        """ĉ of the dead or of the follower moments, 3×M, N m; None without any."""
        wrenches = [w for w in self.wrenches if w.follower == follower]
        return _total([self._couple_covector(w, w.moment) for w in wrenches if w.moment is not None])

    @cached_property
    def interval_moment(self) -> Matrix | None:
        """Internal moment that passes each interval between nodes, 3×(intervals), N m."""
        covector = self.moment_covector
        if covector is None:
            return None
        sections = self._at_sections(covector)
        rows = [ca.cumsum(ca.densify(row[:, ::-1]), 1)[:, ::-1] for row in ca.vertsplit(sections)]
        return ca.vertcat(*rows)[:, 1:]

    @cached_property
    def base_force(self) -> Matrix:
        """Force of the clamp on the rod, base frame, 3×1, N: minus the sum of the loads."""
        grid = self.shape.rod.grid
        total = ca.DM.zeros(3, 1)
        for wrench in self.wrenches:
            if wrench.force is not None:
                total = total - self._resultant(wrench, wrench.force, grid.weights)
        return total

    @cached_property
    def base_moment(self) -> Matrix:
        """Moment of the clamp on the rod about the base, base frame, 3×1, N m."""
        covector = self.moment_covector
        return ca.DM.zeros(3, 1) if covector is None else -ca.sum2(covector)

    @cached_property
    def internal_force(self) -> Matrix:
        """N at the nodes, 3×M, N, report (1.17) integrated from the tip."""
        return self._carried(lambda wrench: wrench.force)

    @cached_property
    def internal_moment(self) -> Matrix:
        """M at the nodes, 3×M, N m, report (1.18) integrated from the tip.

        Integrated over each element from the internal force, so that it jumps where a couple acts.
        """
        grid = self.shape.rod.grid
        lever = cross(self.shape.tangent, self.internal_force)
        return lever @ ca.DM(_from_tip(grid.integration_matrix, grid.weights)).T + self._carried(
            lambda wrench: wrench.moment
        )

    def internal_wrench(self) -> Matrix:
        """Λ = [M; N] at the nodes in the sections' frames, 6×M: report (1.23) inverted."""
        moment, force = self.shape.to_body(self.internal_moment), self.shape.to_body(self.internal_force)
        return ca.vertcat(moment, force)

    def _force_covector(self, wrench: Wrench, force: Matrix) -> Matrix:
        grid, length = self.shape.rod.grid, self.shape.rod.properties.length
        if isinstance(wrench, PointWrench):
            node = grid.node_at(wrench.at)
            return self._resultant(wrench, force, grid.weights) @ ca.DM(grid.integration_matrix[node]).T
        to_covector = length * grid.weights[:, None] * grid.integration_matrix
        if wrench.follower:
            return self.line(wrench, force) @ ca.DM(to_covector)
        return force @ ca.DM(wrench.profiles @ to_covector)

    def _couple_covector(self, wrench: Wrench, moment: Matrix) -> Matrix:
        grid, length = self.shape.rod.grid, self.shape.rod.properties.length
        if isinstance(wrench, PointWrench):
            node = grid.node_at(wrench.at)
            place = ca.DM(ca.Sparsity.triplet(1, grid.size, [0], [node]), 1.0)
            return self._resultant(wrench, moment, grid.weights) @ place
        return self.line(wrench, moment) @ ca.diag(ca.DM(length * grid.weights))

    def line(self, wrench: LineWrench, coefficients: Matrix) -> Matrix:
        """Force or moment per length at the nodes from the coefficients of a line wrench, 3×M, base frame."""
        values = coefficients @ ca.DM(wrench.profiles)
        return self.shape.to_base(values) if wrench.follower else values

    def _resultant(self, wrench: Wrench, vector: Matrix, weights: FloatArray) -> Matrix:
        if isinstance(wrench, PointWrench):
            node = self.shape.rod.grid.node_at(wrench.at)
            return self.shape.rotation_at(node) @ vector if wrench.follower else vector
        return self.line(wrench, vector) @ ca.DM(self.shape.rod.properties.length * weights)

    def _carried(self, part: Callable[[Wrench], Matrix | None]) -> Matrix:
        """Sum over the wrenches of what acts between each node and the tip, 3×M."""
        grid = self.shape.rod.grid
        total: Matrix = ca.DM.zeros(3, grid.size)
        for wrench in self.wrenches:
            vector = part(wrench)
            if vector is None:
                continue
            if isinstance(wrench, PointWrench):
                before = (np.arange(grid.size) <= grid.node_at(wrench.at)).astype(float)
                total = total + self._resultant(wrench, vector, grid.weights) @ ca.DM(before).T
            else:
                rest = self.shape.rod.properties.length * _from_tip(grid.integration_matrix, grid.weights)
                total = total + self.line(wrench, vector) @ ca.DM(rest).T
        return total

    def _at_sections(self, covector: Matrix) -> Matrix:
        """Covectors of the distinct sections: the two sides of a break act on one section."""
        grid = self.shape.rod.grid
        if grid.elements == 1:
            return covector
        gather = np.zeros((grid.size, grid.section_of_node[-1] + 1))
        gather[np.arange(grid.size), grid.section_of_node] = 1.0
        return covector @ ca.DM(ca.sparsify(ca.DM(gather)))


def _from_tip(integration: FloatArray, weights: FloatArray) -> FloatArray:
    """Matrix of the integral from each node to the tip."""
    return weights[None, :] - integration


def _total(terms: Sequence[Matrix]) -> Matrix | None:
    if not terms:
        return None
    total = terms[0]
    for term in terms[1:]:
        total = total + term
    return total
