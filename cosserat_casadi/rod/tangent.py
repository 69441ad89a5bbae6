"""Jacobian of a rod's residual from its structure, exact for the discrete model.

Column j of every matrix below is the variation of a field with the j-th strain coordinate, stacked component by
component. Rotations vary by δθ = Σ R T ∂Ω/∂q over the intervals passed, tangents by δt = δθ × t + ℓ Σ d_c δΓ_c.

Two parts add to the stiffness of the rod. With the wrenches frozen, forces have a potential, so that one triangle is
enough; frozen couples have none, and what they take from the symmetry is ½ Σ δθᵀ ĉ^ δθ at the sections they act on,
because the rotations of one section commute but for their commutator. Then followers turn. Only what a scene's loads
need is formed.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import cast

import casadi as ca
import numpy as np

from cosserat_casadi.maths.blocks import (
    block_diagonal,
    cumulative_sum,
    hat_operator,
    reversed_places,
)
from cosserat_casadi.maths.rotation import cross, hat
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.rod.igm import InverseGeometricModel
from cosserat_casadi.rod.pose_load import LoadedSections
from cosserat_casadi.rod.transport import IntervalKernels, interval_kernels
from cosserat_casadi.rod.wrenches import LineWrench, PointWrench, Wrench


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
        return interval_kernels(self.igm.shape.rod)

    @cached_property
    def intervals(self) -> int:
        """Number of intervals between sections."""
        return len(self.igm.shape.rod.grid.left_ends)

    @cached_property
    def angular_size(self) -> int:
        """Number n_a of coordinates of curvature and torsion, which come first in q."""
        rod = self.igm.shape.rod
        return sum(rod.at_nodes[c].shape[1] for c in rod.properties.admitted if c < 3)

    @cached_property
    def turn_factors(self) -> tuple[ca.DM, ca.DM]:
        """Factors of the derivative of the stacked turns with respect to the angular coordinates."""
        fold, half = self.igm.shape.rod.turn_factors
        return fold, half[:, : self.angular_size]

    @cached_property
    def turn_matrix(self) -> ca.DM:
        """Derivative of the stacked turns with respect to the angular coordinates, (size·intervals)×n_a."""
        fold, half = self.turn_factors
        return fold.T @ half

    @cached_property
    def interval_operators(self) -> tuple[Matrix, Matrix, Matrix]:
        """A, V, H of every interval as operators on stacked fields."""
        shape, moment = self.igm.shape, self.igm.statics.interval_moment
        kernel = self.kernels.variation
        passing = ca.DM.zeros(3, self.intervals) if moment is None else moment
        blocks = kernel.map(self.intervals)(*shape.interval_arguments, passing)
        a, v, h = (block_diagonal(block, kernel.sparsity_out(i)) for i, block in enumerate(blocks))
        return a, v, h

    @cached_property
    def step(self) -> Matrix:
        """δθ that each interval adds, base frame, (3·intervals)×n_a, rad."""
        return self.interval_operators[0] @ self.turn_matrix

    @cached_property
    def section_rotation(self) -> Matrix:
        """δθ of the distinct sections beyond the base, (3·intervals)×n_a, rad."""
        return cumulative_sum(self.step, self.intervals)

    @cached_property
    def rotation(self) -> Matrix:
        """δθ of the nodes, 3M×n_a, rad."""
        grid = self.igm.shape.rod.grid
        if not self.kernels.axes:
            return ca.DM(3 * grid.size, self.angular_size)
        parts = ca.vertsplit(self.section_rotation, self.intervals)
        index = np.asarray(grid.section_of_node).tolist()
        return ca.vertcat(*[self._with_base(part)[index, :] for part in parts])

    @cached_property
    def tangent(self) -> Matrix:
        """δt of the nodes, 3M×n, m."""
        shape = self.igm.shape
        stretches = [
            ca.vertcat(*[ca.diag(row) @ self._stretch(c) for row in ca.vertsplit(shape.directors[c - 3])])
            for c in self._linear
        ]
        return ca.horzcat(-(hat_operator(shape.tangent) @ self.rotation), *stretches)

    def position(self, node: int) -> Matrix:
        """δr of one node, 3×n, m."""
        shape = self.igm.shape
        weights = shape.rod.grid.integration_matrix[[node]]
        x, y, z = ca.vertsplit(shape.tangent * ca.repmat(ca.DM(weights), 3, 1))
        none = type(x)(*x.shape)
        turned = ca.blockcat([[none, z, -y], [-z, none, x], [y, -x, none]]) @ self.rotation
        stretched = [shape.directors[c - 3] @ ca.DM(weights.T * np.asarray(self._stretch(c))) for c in self._linear]
        return ca.horzcat(turned, *stretched)

    def rotation_of(self, node: int) -> Matrix:
        """δθ of one node, 3×n, rad."""
        size = self.igm.shape.rod.grid.size
        turned = ca.vertcat(*[part[node, :] for part in ca.vertsplit(self.rotation, size)])
        return ca.horzcat(turned, ca.DM(3, self.igm.shape.rod.size - self.angular_size))

    @cached_property
    def jacobian(self) -> Matrix:
        """∂ residual / ∂q, n×n, without unit."""
        rod = self.igm.shape.rod
        linear = ca.vertcat(*[self._linear_rows(c) for c in self._linear], ca.DM(0, self.angular_size))
        none = ca.DM(linear.shape[0], linear.shape[0])
        elastic = ca.sparsify(ca.DM(rod.stiffness))
        elastic = elastic if self.igm.shape.ratio is None else elastic / self.igm.shape.ratio
        matrix = elastic + ca.blockcat([[self._angular_rows(), linear.T], [linear, none]])
        for part in (self._following_forces(), self._pose_stiffness(), self._actuation_stiffness()):
            if part is not None:
                matrix = matrix + part
        return matrix

    @property
    def _linear(self) -> list[int]:
        """Admitted strains that are shear or extension."""
        return [c for c in self.igm.shape.rod.properties.admitted if c >= 3]

    def _angular_rows(self) -> Matrix:
        """Angular rows and columns but for following forces, n_a×n_a."""
        statics, unit = self.igm.statics, self.igm.shape.rod.energy_unit
        if statics.interval_moment is None or not self.kernels.axes:
            return ca.DM(self.angular_size, self.angular_size)
        turning, stiffness, second = self.interval_operators
        fold, half = self.turn_factors
        pulled = turning.T @ (self._moment_variation() + stiffness @ self.step) + second @ self.turn_matrix
        matrix = ca.triu2symm(ca.triu((half / -unit).T @ (fold @ pulled)))
        # Mirrored, the upper triangle lacks the skew part of frozen couples below the diagonal; that of couples which
        # follow has the other sign, and is lacking above.
        dead, following = (statics.couple_covector(follower) for follower in (False, True))
        if dead is not None:
            matrix = matrix - ca.tril(self._commutator(dead / unit), False)
        if following is not None:
            matrix = matrix + ca.triu(self._commutator(following / unit), False)
        return matrix

    def _moment_variation(self) -> Matrix:
        """δm − δθ × m of every interval under frozen wrenches, base frame, (3·intervals)×n_a."""
        statics, count = self.igm.statics, self.intervals
        begins = ca.vertcat(*[self._with_base(part)[:-1, :] for part in ca.vertsplit(self.section_rotation, count)])
        variation = hat_operator(cast("Matrix", statics.interval_moment)) @ begins
        if statics.force_covector is None:
            return variation
        # (δθ × t) × n̂ = n̂^ t^ δθ, summed over the nodes that share a section.
        gather = self._gather
        lever = gather @ (hat_operator(statics.force_covector) @ hat_operator(self.igm.shape.tangent)) @ gather.T
        ends = reversed_places(lever @ self.section_rotation, count)
        return variation + reversed_places(cumulative_sum(ends, count), count)

    def _commutator(self, couple: Matrix) -> Matrix:
        """Sum of δθᵀ ĉ^ δθ over the nodes, skew, n_a×n_a, for couples 3×M."""
        return self.rotation.T @ (hat_operator(couple) @ self.rotation)

    def _linear_rows(self, component: int) -> Matrix:
        """Rows of a linear strain against the angular columns under frozen forces: −ℓ Φᵀ (d × n̂)·δθ."""
        rod, covector = self.igm.shape.rod, self.igm.statics.force_covector
        fold, half = rod.node_factors(component)
        if covector is None:
            return ca.DM(half.shape[1], self.angular_size)
        lever = cross(self.igm.shape.directors[component - 3], covector)
        share = ca.horzcat(*[ca.diag(row) for row in ca.vertsplit(lever)]) @ self.rotation
        return (half * (-rod.properties.length / rod.energy_unit)).T @ (fold @ share)

    def _following_forces(self) -> Matrix | None:
        """What forces add by turning with their sections: −Σ δtᵀ δn̂ / (EI/ℓ), n×n."""
        wrenches = [w for w in self.igm.statics.wrenches if w.follower]
        rod = self.igm.shape.rod
        parts = [self._following_force(w, w.force / rod.energy_unit) for w in wrenches if w.force is not None]
        if not parts:
            return None
        return ca.horzcat(-sum(parts[1:], parts[0]), ca.DM(rod.size, rod.size - self.angular_size))

    def _following_force(self, wrench: Wrench, force: Matrix) -> Matrix:
        """Sum of δtᵀ δn̂, n×n_a: δrᵀ (δθ × f) wherever the force acts."""
        shape, grid = self.igm.shape, self.igm.shape.rod.grid
        if isinstance(wrench, PointWrench):
            node = grid.node_at(wrench.at)
            turned = hat(shape.rotation_at(node) @ force) @ self.rotation_of(node)[:, : self.angular_size]
            return -self.position(node).T @ turned
        return self.tangent.T @ self._following_line(wrench, force)

    def _following_line(self, wrench: LineWrench, force: Matrix) -> Matrix:
        """δn̂ of a force per length that turns with the sections, 3M×n_a."""
        grid, length = self.igm.shape.rod.grid, self.igm.shape.rod.properties.length
        turned = -(hat_operator(self.igm.statics.line(wrench, force)) @ self.rotation)
        to_covector = ca.DM(length * grid.weights[:, None] * grid.integration_matrix).T
        return ca.vertcat(*[to_covector @ part for part in ca.vertsplit(turned, grid.size)])

    def motion(self, load: LoadedSections) -> Matrix:
        """[δr; δθ] of the sections of a load, stacked component by component, 6k×n, m and rad."""
        rod = self.igm.shape.rod
        if load.load.at is not None:
            node = load.nodes[0]
            return ca.vertcat(self.position(node), self.rotation_of(node))
        integrate = ca.DM(rod.grid.integration_matrix)
        moved = [integrate @ part for part in ca.vertsplit(self.tangent, rod.grid.size)]
        turned = ca.horzcat(self.rotation, ca.DM(3 * rod.grid.size, rod.size - self.angular_size))
        return ca.vertcat(*moved, turned)

    def wrench_variation(self, load: LoadedSections) -> Matrix:
        """[δf; δc] of a load that depends on the poses of its sections, 6k×n, times the weights of the sections."""
        return load.weighted(load.stiffness @ self.motion(load))

    def _pose_stiffness(self) -> Matrix | None:
        """What loads add by depending on poses: −Σ [δr; δθ]ᵀ [δf; δc] / (EI/ℓ), n×n."""
        parts = [self.motion(load).T @ self.wrench_variation(load) for load in self.igm.statics.pose_loads]
        if not parts:
            return None
        return sum(parts[1:], parts[0]) / -self.igm.shape.rod.energy_unit

    def _actuation_stiffness(self) -> Matrix | None:
        """Σ τ ∂²L/∂q∂qᵀ / (EI/ℓ) of all efforts, n×n: sums over the nodes of rows that they share."""
        rod = self.igm.shape.rod
        admitted = rod.properties.admitted
        blocks = {(a, b): self._curvature_block(a, b) for a in admitted for b in admitted if a <= b}
        if not any(block.nnz() for block in blocks.values()):
            return None
        return ca.blockcat([[blocks[a, b] if a <= b else blocks[b, a].T for b in admitted] for a in admitted])

    def _curvature_block(self, a: int, b: int) -> Matrix:
        rod = self.igm.shape.rod
        first, second = (ca.sparsify(ca.DM(rod.at_nodes[c])) for c in (a, b))
        curved = [(effort, conjugate.curvature(a, b)) for effort, conjugate in self.igm.efforts]
        rows = [effort / rod.energy_unit * row for effort, row in curved if row is not None]
        if not rows:
            return ca.DM(first.shape[1], second.shape[1])
        block = first.T @ (ca.diag(sum(rows[1:], rows[0])) @ second)
        return ca.triu2symm(ca.triu(block)) if a == b else block

    def _stretch(self, component: int) -> ca.DM:
        """Stretch ℓ Φ_c at the nodes of a unit of each coordinate of a linear strain, M×n_c, m."""
        rod = self.igm.shape.rod
        return ca.DM(rod.properties.length * rod.at_nodes[component])

    @cached_property
    def _gather(self) -> ca.DM:
        """Sums of stacked vectors at the nodes over each distinct section beyond the base, (3·intervals)×3M."""
        grid = self.igm.shape.rod.grid
        sections = np.eye(self.intervals + 1)[1:, grid.section_of_node]
        return ca.sparsify(ca.DM(np.kron(np.eye(3), sections)))

    @staticmethod
    def _with_base(part: Matrix) -> Matrix:
        return ca.vertcat(ca.DM(1, part.shape[1]), part)
