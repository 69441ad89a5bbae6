"""Jacobian of a rod's residual from its structure, exact for the discrete model: docs/theory.md section 7.

Column i of every matrix below is the variation of a field with the i-th strain coordinate, stacked component by
component. Rotations vary by δθ = Σ R T ∂Ω/∂q over the intervals from the base, tangents by δt = δθ × t + ℓ Σ d_c δΓ_c.

**Frozen wrenches.** The moments that intervals transmit vary as the rod beyond them turns. Forces of fixed direction
have a potential, so the upper triangle of their part is enough and the lower one is its mirror. Couples have none,
unless the rod turns about one axis. Write θ_i for column i of the δθ of the section that a couple c acts on, θ_i^ =
∂_iR Rᵀ. Since ∂_i∂_jR = ∂_j∂_iR,

    ∂_iθ_j − ∂_jθ_i = θ_i × θ_j .

A frozen couple has the residual g_j = −c·θ_j and the Jacobian J_ji = −c·∂_iθ_j, so that with the skew matrix
C_ji = θ_j·(c × θ_i) the triangles differ by J_ji − J_ij = −c·(θ_i × θ_j) = −C_ji. A couple that follows its section
varies by δc = θ_i × c and adds −(θ_i × c)·θ_j = C_ji everywhere: its triangles differ by C_ji. docs/theory.md writes C
as δθᵀ ĉ δθ. For wrenches at points such a difference is cheaper than the other triangle; for wrenches along the rod, or
columns that are formed one by one, all entries are formed.

**Followers.** They turn with their sections, δf = δθ × f and δc = δθ × c. These changes are transmitted down the rod as
the wrenches are, and are added to the variation of the moments before the intervals do work on it: a column of the
Jacobian is formed from the tip to the base, and no two columns meet in a product.

**Other variations.** Loads that depend on poses vary by the derivative of their kernel, efforts by the curvature of
their conjugate. Only the terms that a scene's loads need are formed.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import casadi as ca
import numpy as np

from cosserat_casadi.maths.block_operators import (
    block_diagonal,
    cumulative_sum,
    hat_blocks,
    hat_operator,
    reversed_places,
    sparse,
    stack,
    summed,
    unstack,
    with_product,
)
from cosserat_casadi.maths.rotation import cross, hat
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.rod.actuation_stiffness import actuation_stiffness
from cosserat_casadi.rod.folded_matrix import FoldedMatrix
from cosserat_casadi.rod.igm import InverseGeometricModel
from cosserat_casadi.rod.kinematics import Shape
from cosserat_casadi.rod.pose_load import LoadedSections, StiffSections, by_sections
from cosserat_casadi.rod.statics import Statics
from cosserat_casadi.rod.strain import DiscreteRod
from cosserat_casadi.rod.transport import IntervalKernels, interval_kernels
from cosserat_casadi.rod.turned_wrenches import TurnedWrenches
from cosserat_casadi.rod.wrenches import Wrench, WrenchAt


@dataclass(frozen=True)
class Columns:
    """Columns of the Jacobian for the angular coordinates, each computed from the turns by its coordinate alone.

    Attributes:
        section_rotation: :attr:`Tangent.section_rotation`.
        angular: angular rows before they are made symmetric, n_a rows.
        linear: rows of each linear strain against the angular columns under frozen forces, by component.
        following: terms of follower forces in these rows, by component; empty without follower forces.
    """

    section_rotation: Matrix
    angular: Matrix
    linear: dict[int, Matrix]
    following: dict[int, Matrix]


@dataclass(frozen=True)
class Tangent:
    """Variations of a rod's fields with its strain coordinates.

    Attributes:
        igm: the rod's balance.
        in_loops: whether it is written for loops, in which sums and differences of mirrored rows do not pay.
        turns: turns of the intervals by k coordinates, (size·intervals)×k, instead of the turns by the angular
            coordinates; :attr:`columns` then has one column for each of them.
        given: columns of all angular coordinates, if they are already computed.
    """

    igm: InverseGeometricModel
    in_loops: bool = False
    turns: Matrix | None = None
    given: Columns | None = None

    @property
    def shape(self) -> Shape:
        """The rod's shape."""
        return self.igm.shape

    @property
    def rod(self) -> DiscreteRod:
        """The rod."""
        return self.igm.shape.rod

    @cached_property
    def kernels(self) -> IntervalKernels:
        """Functions of one interval."""
        return interval_kernels(self.rod)

    @cached_property
    def intervals(self) -> int:
        """Number of intervals between sections."""
        return len(self.rod.grid.left_ends)

    @cached_property
    def angular_size(self) -> int:
        """Number n_a of coordinates of curvature and torsion, which come first in q."""
        return sum(self.rod.size_of(c) for c in self.rod.angular)

    @cached_property
    def turn_matrix(self) -> FoldedMatrix:
        """Derivative of the stacked turns with respect to the angular coordinates, (size·intervals)×n_a."""
        return self.rod.turn_matrix.first_columns(self.angular_size)

    @cached_property
    def columns(self) -> Columns:
        """Columns of the turns, or of all angular coordinates, for intervals that transmit moments."""
        if self.given is not None:
            return self.given
        section_rotation = self.section_rotation
        linear = {component: self._linear_rows(component) for component in self.rod.linear}
        following = {}
        force = self._turned.force
        if force is not None:
            following = {component: self._following_rows(component, force) for component in self.rod.linear}
        return Columns(section_rotation, self._angular_product, linear, following)

    def under(self, load: LoadedSections) -> Tangent:
        """The tangent at this shape under one pose-dependent load alone."""
        model = InverseGeometricModel(Statics(self.shape, (), (load,)))
        if not self.kernels.axes:
            return Tangent(model, self.in_loops)
        # The turns are the same as under all loads; the terms of moments are not needed.
        turns = Columns(self.section_rotation, ca.DM(self.angular_size, self.angular_size), {}, {})
        return Tangent(model, self.in_loops, given=turns)

    @cached_property
    def _turns(self) -> Matrix:
        """Derivative of the stacked turns with respect to the coordinates of the columns."""
        return self.turns if self.turns is not None else self.turn_matrix.unfolded

    @cached_property
    def _variations(self) -> tuple[Matrix, Matrix, Matrix]:
        """A, V, H of :attr:`IntervalKernels.variation` of every interval, side by side."""
        moment = self.igm.pulled.interval_moment
        assert moment is not None, "asked for where moments pass"
        a, v, h = self.kernels.variation.map(self.intervals)(*self.shape.interval_arguments, moment)
        return a, v, h

    @cached_property
    def interval_operators(self) -> tuple[Matrix, Matrix, Matrix]:
        """A, V, H of every interval as operators on stacked fields."""
        patterns = [self.kernels.variation.sparsity_out(i) for i in range(3)]
        a, v, h = map(block_diagonal, self._variations, patterns)
        return a, v, h

    @cached_property
    def _turnings(self) -> Matrix:
        """A of every interval, side by side."""
        if self.igm.pulled.interval_moment is not None:
            return self._variations[0]
        turnings: Matrix = self.kernels.turning.map(self.intervals)(*self.shape.interval_arguments)
        return turnings

    @cached_property
    def interval_variation(self) -> Matrix:
        """δθ that each interval adds, base frame, (3·intervals)×n_a, rad."""
        if self.turns is not None:
            turned = self.kernels.turned.map(self.intervals)(self._turnings, self._in_intervals(self.turns))
            variation: Matrix = stack(turned)
            return variation
        if self.igm.pulled.interval_moment is not None:
            return self.interval_operators[0] @ self._turns
        return block_diagonal(self._turnings, self.kernels.turning.sparsity_out(0)) @ self._turns

    def _in_intervals(self, stacked: Matrix) -> Matrix:
        """A stacked column as a field on the intervals."""
        return unstack(stacked, stacked.shape[0] // self.intervals)

    @cached_property
    def section_rotation(self) -> Matrix:
        """δθ of the distinct sections beyond the base, (3·intervals)×n_a, rad."""
        if self.given is not None:
            return self.given.section_rotation
        return cumulative_sum(self.interval_variation, self.intervals)

    @cached_property
    def rotation(self) -> Matrix:
        """δθ of the nodes, 3M×n_a, rad."""
        if not self.kernels.axes:
            return ca.DM(3 * self.rod.grid.size, self.angular_size)
        return self.at_nodes(self.section_rotation)

    def at_nodes(self, sections: Matrix) -> Matrix:
        """Stacked variations at the nodes, 3M×k, from variations of the sections beyond the base, which has none."""
        # Both nodes at a break turn with their section; the base does not turn.
        section_of_node = np.asarray(self.rod.grid.section_of_node).tolist()
        parts = ca.vertsplit(sections, self.intervals)
        return ca.vertcat(*[_with_base(part)[section_of_node, :] for part in parts])

    @cached_property
    def tangent(self) -> Matrix:
        """δt of the nodes, 3M×n, m."""
        columns = [-(hat_operator(self.shape.tangent) @ self.rotation)]
        for c in self.rod.linear:
            director = self.shape.directors[c - 3]
            # ℓ d δΓ, one component of the director after the other.
            stretch = self._stretch(c)
            rows = [ca.diag(row) @ stretch for row in ca.vertsplit(director)]
            columns.append(ca.vertcat(*rows))
        return ca.horzcat(*columns)

    @cached_property
    def displacement_of_nodes(self) -> Matrix:
        """δr of the nodes, 3M×n, m."""
        grid = self.rod.grid
        integrated = [grid.integrated(part.T).T for part in ca.vertsplit(self.tangent, grid.size)]
        return ca.vertcat(*integrated)

    def position(self, node: int) -> Matrix:
        """δr of one node, 3×n, m."""
        return self._displacement(ca.DM(self.rod.grid.integration_matrix[[node]]))

    def displacement(self, weights: Matrix) -> Matrix:
        """δr of k sections, one below the other, 3k×n, m.

        Args:
            weights: weights of the values at the nodes, M×k.
        """
        integrals = weights.T @ ca.DM(self.rod.grid.integration_matrix)
        return ca.vertcat(*[self._displacement(row) for row in ca.vertsplit(integrals)])

    def quaternion_change(self, weights: Matrix) -> Matrix:
        """Changes Σ w δQ of the weighted means of the quaternions at the nodes, one below the other, 4k×n.

        Args:
            weights: weights of the values at the nodes, M×k.
        """
        changes = []
        for column in ca.horzsplit(weights):
            # δQ = ½ (0, δθ) ⊗ Q at every node.
            weighted = ca.densify(self.shape.quaternion * ca.repmat(column.T / 2, 4, 1))
            w, x, y, z = ca.vertsplit(weighted)
            spins = [
                [-x, -y, -z],
                [w, z, -y],
                [-z, w, x],
                [y, -x, w],
            ]
            changes.append(self._with_linear_columns(ca.blockcat(spins) @ self.rotation))
        return ca.vertcat(*changes)

    def _displacement(self, weights: Matrix) -> Matrix:
        """Weighted sum of the δt of the nodes, 3×n, m; weights are 1×M."""
        weighted = self.shape.tangent * ca.repmat(weights, 3, 1)
        # Σ w δθ × t, the sum over the nodes.
        columns = [hat_blocks(*ca.vertsplit(-weighted)) @ self.rotation]
        for c in self.rod.linear:
            stretch = self._stretch(c)
            weighted_stretch = ca.repmat(weights.T, 1, stretch.shape[1]) * stretch
            columns.append(self.shape.directors[c - 3] @ weighted_stretch)
        return ca.horzcat(*columns)

    def rotation_of(self, node: int) -> Matrix:
        """δθ of one node, 3×n, rad."""
        components = ca.vertsplit(self.rotation, self.rod.grid.size)
        rows = [component[node, :] for component in components]
        return self._with_linear_columns(ca.vertcat(*rows))

    def motion(self, load: LoadedSections) -> Matrix:
        """[δr; δθ] of the sections of a load, stacked component by component, 6k×n, m and rad."""
        if load.load.at is not None:
            # One section: no product with all of S.
            node = load.nodes[0]
            return ca.vertcat(self.position(node), self.rotation_of(node))
        if load.load.sections is not None:
            # Its force does not depend on rotations.
            return ca.vertcat(load.moved(self.tangent), ca.DM(3 * load.count, self.rod.size))
        return self.motion_of(load.nodes)

    def motion_of(self, nodes: list[int]) -> Matrix:
        """[δr; δθ] of the sections of k nodes, stacked component by component, 6k×n, m and rad."""
        grid = self.rod.grid
        integrate = ca.DM(grid.integration_matrix[nodes])
        moved = [integrate @ component for component in ca.vertsplit(self.tangent, grid.size)]
        turned = self.rotation
        if len(nodes) < grid.size:
            turned = ca.vertcat(*[component[nodes, :] for component in ca.vertsplit(turned, grid.size)])
        return ca.vertcat(*moved, self._with_linear_columns(turned))

    @cached_property
    def stiff_sections(self) -> list[StiffSections]:
        """Sections of the rod with their pose-dependent loads."""
        return by_sections(self.igm.statics.pose_loads)

    def change(self, stiff: StiffSections) -> tuple[Matrix, Matrix]:
        """Motion [δr; δθ] of sections, and weighted change [δf; δc] of their loads, 6k×n each."""
        motion = self.motion(stiff.sections)
        return motion, stiff.sections.weighted(stiff.stiffness @ motion)

    def turned(self, wrench: Wrench, vector: Matrix) -> Matrix:
        """δ of a vector that turns with its section, 3×n, or with the sections at all nodes, 3M×n, base frame."""
        return self._with_linear_columns(self._turned.turned(wrench, vector))

    @cached_property
    def jacobian(self) -> Matrix:
        """∂ residual / ∂q, n×n, without unit."""
        elastic = self.rod.stiffness_matrix
        if self.shape.ratio is not None:
            elastic = elastic / self.shape.ratio
        matrix = elastic + self._wrenches()
        for part in (self._pose_stiffness(), actuation_stiffness(self.igm, self)):
            if part is not None:
                matrix = matrix + part
        return matrix

    @property
    def _linear_size(self) -> int:
        """Number of coordinates of shear and extension."""
        return self.rod.size - self.angular_size

    def _with_linear_columns(self, angular: Matrix) -> Matrix:
        """Columns of the angular coordinates, and zeros for the linear ones."""
        linear = ca.DM(angular.shape[0], self._linear_size)
        return ca.horzcat(angular, linear)

    def _wrenches(self) -> Matrix:
        """Stiffness of the wrenches as dead wrenches or followers, n×n; zero between two linear strains."""
        if not self.moments_pass:
            return ca.DM(self.rod.size, self.rod.size)
        # Sections do not turn with linear strains, and neither do the forces that follow them.
        dead = self._of_linear_strains(self.columns.linear)
        rows = dead
        if self.columns.following:
            rows = dead + self._of_linear_strains(self.columns.following)
        none = ca.DM(self._linear_size, self._linear_size)
        blocks = [
            [self._angular_rows(), dead.T],
            [rows, none],
        ]
        return ca.blockcat(blocks)

    def _of_linear_strains(self, rows: dict[int, Matrix]) -> Matrix:
        """Rows of all linear strains; a rod without any has none."""
        return ca.vertcat(*rows.values(), ca.DM(0, self.angular_size))

    def _angular_rows(self) -> Matrix:
        """Angular rows and columns, n_a×n_a."""
        matrix = self.columns.angular
        if self._have_potential:
            return _mirrored(matrix)
        # Given columns have all entries; for loads per length the difference is as costly as the entries.
        if self.given is not None or not self._potential_lacks_at_points:
            return matrix
        return _mirrored(matrix) + ca.tril(self._difference_of_triangles() / self.rod.energy_unit, False)

    @property
    def _have_potential(self) -> bool:
        """Whether all wrenches have a potential, with pose-dependent ones taken as dead wrenches."""
        wrenches = self.igm.pulled.wrenches
        follows = any(wrench.follower and wrench.force is not None for wrench in wrenches)
        turns = any(wrench.moment is not None for wrench in wrenches)
        return not follows and (self._about_one_axis or not turns)

    @property
    def _potential_lacks_at_points(self) -> bool:
        """Whether all wrenches without a potential act at points."""
        for wrench in self.igm.pulled.wrenches:
            follows = wrench.follower and wrench.force is not None
            if (follows or wrench.moment is not None) and not isinstance(wrench, WrenchAt):
                return False
        return True

    def _difference_of_triangles(self) -> Matrix:
        """Angular rows less their transpose, times EI/ℓ, n_a×n_a, N m, by wrenches at points: products of few rows."""
        statics = self.igm.pulled
        difference = ca.DM(self.angular_size, self.angular_size)
        for follower in (False, True):
            couple = statics.couple_covector(follower)
            if couple is not None:
                commutator = self.rotation.T @ (hat_operator(couple) @ self.rotation)
                difference = difference + (commutator if follower else -commutator)
        for wrench in statics.wrenches:
            if isinstance(wrench, WrenchAt) and wrench.follower and wrench.force is not None:
                node = self.rod.grid.node_at(wrench.at)
                moved = self.position(node)[:, : self.angular_size]
                turned = self.rotation_of(node)[:, : self.angular_size]
                in_base = self.shape.rotation_at(node) @ wrench.force
                # −δrᵀ (δθ × f) = δrᵀ f^ δθ.
                work = moved.T @ (hat(in_base) @ turned)
                difference = difference + work - work.T
        return difference

    @property
    def moments_pass(self) -> bool:
        """Whether there are intervals that turn and moments for them to transmit."""
        return self.igm.pulled.interval_moment is not None and bool(self.kernels.axes)

    @property
    def _angular_product(self) -> Matrix:
        """Angular rows, n_a×n_a."""
        # Aᵀ (δm − δθ × m + V A) + H, the bracket of docs/theory.md section 7.
        moment = self._moment_variation()
        if self.turns is not None:
            fields = map(self._in_intervals, (self.turns, self.interval_variation, moment))
            pulled = stack(self.kernels.pulled.map(self.intervals)(*self._variations, *fields))
            # A product takes a processor far less time than a quotient.
            return self.rod.turn_axes.transposed_times(pulled) * (-1.0 / self.rod.energy_unit)
        turning, stiffness, second = self.interval_operators
        passing = with_product(moment, stiffness, self.interval_variation)
        pulled = with_product(turning.T @ passing, second, self._turns)
        unit = self.rod.energy_unit
        if self.in_loops:
            # Rods of any stiffness have these constants, so that they can share code.
            return (self.turn_matrix.unfolded.T @ pulled) / -unit
        return (self.turn_matrix / -unit).T @ pulled

    def _moment_variation(self) -> Matrix:
        """δm − δθ × m of every interval, base frame, (3·intervals)×n_a."""
        statics = self.igm.pulled
        count = self.intervals
        rotations = [_with_base(part) for part in ca.vertsplit(self.section_rotation, count)]
        begins = ca.vertcat(*[part[:-1, :] for part in rotations])
        moment = statics.interval_moment
        assert moment is not None, "asked for where moments pass"
        variation = hat_operator(moment) @ begins
        parts = []
        gather = self._gather
        if statics.force_covector is not None:
            # (δθ × t) × n̂ = n̂^ t^ δθ, summed over the nodes that share a section.
            force_hat = hat_operator(statics.force_covector)
            tangent_hat = hat_operator(self.shape.tangent)
            lever = gather @ (force_hat @ tangent_hat) @ gather.T
            parts.append(lever @ self.section_rotation)
        parts += [gather @ part for part in self._turned.moments]
        beyond = summed(parts)
        if beyond is None:
            return variation
        # An interval transmits all loads beyond it: sums from the tip.
        return variation + reversed_places(cumulative_sum(reversed_places(beyond, count), count), count)

    @cached_property
    def _turned(self) -> TurnedWrenches:
        """Variations of the wrenches that follow their sections."""
        return TurnedWrenches(self.igm.pulled, self.rotation, self._about_one_axis)

    @property
    def _about_one_axis(self) -> bool:
        """Whether the rod turns about one axis: rotations commute, and a couple has the potential −c θ."""
        return len(self.kernels.axes) == 1

    def _linear_rows(self, component: int) -> Matrix:
        """Rows of a linear strain against the angular columns under frozen forces: −ℓ Φᵀ (d × n̂)·δθ."""
        covector = self.igm.pulled.force_covector
        if covector is None:
            return ca.DM(self.rod.size_of(component), self._turns.shape[1])
        return self._work_on(component, cross(self.shape.directors[component - 3], covector), self.rotation)

    def _following_rows(self, component: int, force: Matrix) -> Matrix:
        """Rows of follower forces, which vary by δn̂: −ℓ Φᵀ d·δn̂."""
        return self._work_on(component, self.shape.directors[component - 3], force)

    def _work_on(self, component: int, vectors: Matrix, variation: Matrix) -> Matrix:
        """−ℓ Φᵀ of the products of vectors at the nodes, 3×M, with each column of a variation of the nodes, 3M×k."""
        rows = [ca.diag(row) for row in ca.vertsplit(vectors)]
        work = ca.horzcat(*rows) @ variation
        per_coordinate = self.rod.node_matrices[component] * (-self.rod.length / self.rod.energy_unit)
        return per_coordinate.T @ work

    def _pose_stiffness(self) -> Matrix | None:
        """Stiffness of loads that depend on poses: −Σ [δr; δθ]ᵀ [δf; δc] / (EI/ℓ), n×n."""
        parts = []
        for stiff in self.stiff_sections:
            if stiff.is_cheaper_at_nodes:
                moved = self.displacement_of_nodes
                parts.append(moved.T @ (stiff.stiffness_of_nodes @ moved))
            else:
                motion, change = self.change(stiff)
                parts.append(motion.T @ change)
        total = summed(parts)
        return None if total is None else total / -self.rod.energy_unit

    def _stretch(self, component: int) -> ca.DM:
        """Stretch ℓ Φ_c at the nodes of a unit of each coordinate of a linear strain, M×n_c, m."""
        phi = self.rod.at_nodes[component]
        return ca.DM(self.rod.length * phi)

    @cached_property
    def _gather(self) -> ca.DM:
        """Sums of stacked vectors at the nodes over each distinct section beyond the base, (3·intervals)×3M."""
        section_of_node = self.rod.grid.section_of_node
        sections = np.eye(self.intervals + 1)[1:, section_of_node]
        return ca.kron(ca.DM.eye(3), sparse(sections))


def _mirrored(matrix: Matrix) -> Matrix:
    """The symmetric matrix with the upper triangle of a matrix."""
    return ca.triu2symm(ca.triu(matrix))


def _with_base(part: Matrix) -> Matrix:
    """Variations of all distinct sections; the base, which does not vary, comes first."""
    base = ca.DM(1, part.shape[1])
    return ca.vertcat(base, part)
