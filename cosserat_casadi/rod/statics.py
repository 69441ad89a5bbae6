"""Backward sweep: from the wrenches on a rod to its internal wrench, report (1.17), (1.18), (1.29), (2.18).

The sweep is the exact transpose of the forward sweep. With the position r = S t of the tangents t at the nodes, the
virtual work of the loads is Σ n̂_k·δt_k + Σ ĉ_k·δθ_k, where n̂ = Sᵀ f collects the forces: n̂_k is the internal force
at node k times its quadrature weight, and Σ_{j>k} (t_j × n̂_j + ĉ_j) is the internal moment, m' = −r' × n − l̄ summed
from the tip. So the residual is the gradient of the discrete energy if there is an energy, the Jacobian is symmetric
then, and a dead load needs no product with S at all.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import casadi as ca
import numpy as np

from cosserat_casadi.maths.block_operators import sparse, summed
from cosserat_casadi.maths.numbers import (
    Numbers,
    any_symbolic,
    as_matrix,
    is_symbolic,
    is_zero,
    known,
    product,
    repeated,
    row_times,
    rows_of,
    without_rounding,
)
from cosserat_casadi.maths.rotation import cross
from cosserat_casadi.maths.typing import FloatArray, Matrix
from cosserat_casadi.rod.kinematics import Shape
from cosserat_casadi.rod.pose_load import LoadedSections
from cosserat_casadi.rod.wrenches import LineWrench, PoseWrench, RodLoad, Wrench, WrenchAt


@dataclass(frozen=True)
class Statics:
    """Internal wrench of a rod of known shape under known loads, base frame.

    Attributes:
        shape: the rod's shape.
        loads: loads on the rod.
        evaluated: further pose-dependent loads, which are already evaluated at this shape.
    """

    shape: Shape
    loads: Sequence[RodLoad]
    evaluated: Sequence[LoadedSections] = ()

    @cached_property
    def pose_loads(self) -> list[LoadedSections]:
        """Loads that depend on the poses of their sections."""
        dependent = [load for load in self.loads if isinstance(load, PoseWrench)]
        return [*self.evaluated, *(LoadedSections(load, self.shape) for load in dependent)]

    @cached_property
    def fixed_wrenches(self) -> list[Wrench]:
        """Dead and follower wrenches."""
        return [load for load in self.loads if not isinstance(load, PoseWrench)]

    @cached_property
    def wrenches(self) -> list[Wrench]:
        """All wrenches; a pose-dependent one is a dead wrench with its value at this shape."""
        frozen = [load.frozen for load in self.pose_loads]
        return self.fixed_wrenches + frozen

    @cached_property
    def force_covector(self) -> Matrix | None:
        """n̂, 3×M, conjugate to the variations of the tangents, N; None without forces."""
        return self._force_covector_of(self.wrenches)

    @cached_property
    def fixed_force_covector(self) -> Matrix | None:
        """The part of n̂ by dead and follower forces, 3×M, N; None without such forces."""
        return self._force_covector_of(self.fixed_wrenches)

    @cached_property
    def moment_covector(self) -> Matrix | None:
        """T × n̂ + ĉ, 3×M, conjugate to the variations of the rotations of the nodes, N m; None without loads."""
        # Turning the sections by δθ moves the tangents by δθ × t.
        force = self.force_covector
        turned = None if force is None else cross(self.shape.tangent, force)
        parts = (turned, self.couple_covector(follower=False), self.couple_covector(follower=True))
        return summed([part for part in parts if part is not None])

    def couple_covector(self, follower: bool) -> Matrix | None:
        """ĉ of the dead or of the follower moments, 3×M, N m; None without any."""
        turning = [wrench for wrench in self.wrenches if wrench.follower == follower]
        return summed([self._couple_covector(w, w.moment) for w in turning if w.moment is not None])

    @cached_property
    def interval_moment(self) -> Matrix | None:
        """Internal moment transmitted by each interval between nodes, 3×(intervals), N m: m_i of docs/theory.md 6."""
        covector = self.moment_covector
        if covector is None:
            return None
        rows = [_sums_to_the_tip(row) for row in ca.vertsplit(self._at_sections(covector))]
        # No interval transmits a load on the base section.
        return ca.vertcat(*rows)[:, 1:]

    @cached_property
    def base_force(self) -> Matrix:
        """Force of the clamp on the rod, base frame, 3×1, N: minus the sum of the loads."""
        # It sums the loads, not n̂, and so is exact for every integration matrix.
        total = ca.DM.zeros(3, 1)
        for wrench in self.wrenches:
            if wrench.force is not None:
                total = total - self._resultant(wrench, wrench.force)
        return total

    @cached_property
    def base_moment(self) -> Matrix:
        """Moment of the clamp on the rod about the base, base frame, 3×1, N m."""
        covector = self.moment_covector
        if covector is None:
            return ca.DM.zeros(3, 1)
        return -ca.sum2(covector)

    @property
    def held_force(self) -> Matrix:
        """Force on the rod of all that holds its base, base frame, 3×1, N: the clamp's and that of a joint there."""
        joints = [wrench.force for wrench in self._at_base if wrench.force is not None]
        return sum(joints, self.base_force)

    @property
    def held_moment(self) -> Matrix:
        """Moment on the rod of all that holds its base, base frame, 3×1, N m: the clamp's and that of a joint there."""
        joints = [wrench.moment for wrench in self._at_base if wrench.moment is not None]
        return sum(joints, self.base_moment)

    @property
    def _at_base(self) -> list[WrenchAt]:
        """Wrenches on the base section, which no other section transmits: from a joint that holds the base."""
        return [wrench for wrench in self.fixed_wrenches if isinstance(wrench, WrenchAt) and is_zero(wrench.at)]

    @cached_property
    def internal_force(self) -> Matrix:
        """N at the nodes, 3×M, N, report (1.17) integrated from the tip."""
        return self._beyond_each_node(lambda wrench: wrench.force)

    @cached_property
    def internal_moment(self) -> Matrix:
        """M at the nodes, 3×M, N m, report (1.18) integrated from the tip.

        It is integrated over each element from the internal force, so that it jumps at couples.
        """
        lever = cross(self.shape.tangent, self.internal_force)
        of_forces = lever @ ca.DM(self._from_tip).T
        of_couples = self._beyond_each_node(lambda wrench: wrench.moment)
        return of_forces + of_couples

    def internal_wrench(self) -> Matrix:
        """Λ = [M; N] at the nodes in the sections' frames, 6×M: report (1.23) inverted."""
        moment = self.shape.to_body(self.internal_moment)
        force = self.shape.to_body(self.internal_force)
        return ca.vertcat(moment, force)

    def line(self, wrench: LineWrench, coefficients: Matrix) -> Matrix:
        """Force or moment per length at the nodes from the coefficients of a line wrench, 3×M, base frame."""
        values = coefficients
        if wrench.profiles is not None:
            values = coefficients @ self._at_every_node(wrench.profiles)
        if wrench.follower:
            return self.shape.to_base(values)
        return values

    def _at_every_node(self, profiles: Numbers) -> Matrix:
        """Values of profiles at the nodes, k×M."""
        if is_symbolic(profiles):
            return as_matrix(repeated(profiles.T, self.shape.rod.grid.size).T)
        return as_matrix(profiles)

    @property
    def _from_tip(self) -> FloatArray:
        """Matrix of the integral over X from each node to the tip, shape (M, M)."""
        grid = self.shape.rod.grid
        whole = grid.weights[None, :]
        return without_rounding(whole - grid.integration_matrix)

    def _force_covector_of(self, wrenches: Sequence[Wrench]) -> Matrix | None:
        return summed([self._force_covector(w, w.force) for w in wrenches if w.force is not None])

    def _force_covector(self, wrench: Wrench, force: Matrix) -> Matrix:
        rod = self.shape.rod
        grid = rod.grid
        if isinstance(wrench, WrenchAt):
            # δr of the node is this row of S times the variations of the tangents.
            row = grid.integration_matrix[grid.node_at(wrench.at)]
            return self._resultant(wrench, force) @ ca.DM(row).T
        if wrench.follower or wrench.profiles is None:
            per_length = self.line(wrench, force)
            if is_symbolic(rod.node_lengths):
                return grid.summed_by_integrals(per_length @ ca.diag(rod.node_lengths))
            return grid.summed_by_integrals(per_length @ ca.diag(ca.DM(known(rod.node_lengths))))
        # With constant profiles a dead force per length needs no product with S at run time.
        profiles = wrench.profiles
        if not any_symbolic([profiles, rod.node_lengths]):
            to_covector = known(rod.node_lengths)[:, None] * grid.integration_matrix
            return force @ ca.sparsify(ca.DM(without_rounding(known(profiles) @ to_covector)))
        return force @ ca.vertcat(*[self._profile_covector(profile) for profile in rows_of(profiles)])

    def _profile_covector(self, profile: Numbers) -> Matrix:
        """n̂ of a unit of a profile, 1×M, m: linear in the profile, and in the rates of moved elements."""
        rod = self.shape.rod
        grid = rod.grid
        rates = grid.rates
        if not is_symbolic(rates):
            to_covector = known(rod.node_lengths)[:, None] * grid.integration_matrix
            return product(to_covector.T, profile).T
        if is_symbolic(profile):
            return product(grid.integration_matrix.T, row_times(rod.node_lengths, profile)).T
        per_reference = rod.reference_lengths * known(profile)
        of_element = grid.element_of_node[:, None] == np.arange(grid.elements)
        by_rate = grid.integration_matrix.T @ (per_reference[:, None] * of_element)
        return product(by_rate, rates).T

    def _couple_covector(self, wrench: Wrench, moment: Matrix) -> Matrix:
        grid = self.shape.rod.grid
        if isinstance(wrench, WrenchAt):
            node = grid.node_at(wrench.at)
            # A couple acts at one node alone.
            to_node = ca.DM(ca.Sparsity.triplet(1, grid.size, [0], [node]), 1.0)
            return self._resultant(wrench, moment) @ to_node
        lengths = as_matrix(self.shape.rod.node_lengths)
        return self.line(wrench, moment) @ ca.diag(lengths)

    def _resultant(self, wrench: Wrench, vector: Matrix) -> Matrix:
        """Sum of the forces or moments of a wrench, 3×1, base frame."""
        if isinstance(wrench, LineWrench):
            lengths = as_matrix(self.shape.rod.node_lengths)
            return self.line(wrench, vector) @ lengths
        if not wrench.follower:
            return vector
        node = self.shape.rod.grid.node_at(wrench.at)
        return self.shape.rotation_at(node) @ vector

    def _beyond_each_node(self, part: Callable[[Wrench], Matrix | None]) -> Matrix:
        """Sum of a part of the wrenches that act between each node and the tip, 3×M."""
        grid = self.shape.rod.grid
        total: Matrix = ca.DM.zeros(3, grid.size)
        for wrench in self.wrenches:
            vector = part(wrench)
            if vector is None:
                continue
            if isinstance(wrench, WrenchAt):
                # The internal wrench at the node on the tip side of a break excludes a load on the break.
                loaded = grid.node_at(wrench.at)
                before = (np.arange(grid.size) <= loaded).astype(float) * (loaded > 0)
                total = total + self._resultant(wrench, vector) @ ca.DM(before).T
            else:
                to_tip = self.shape.rod.length * self._from_tip
                per_length = self.line(wrench, vector)
                rates = self.shape.rod.node_rates
                if rates is not None:
                    per_length = per_length @ ca.diag(as_matrix(rates))
                total = total + per_length @ ca.DM(to_tip).T
        return total

    def _at_sections(self, covector: Matrix) -> Matrix:
        """Covectors of the distinct sections: the two nodes at a break are one section, their covectors are summed."""
        grid = self.shape.rod.grid
        if grid.elements == 1:
            return covector
        section_of_node = grid.section_of_node
        gather = np.zeros((grid.size, section_of_node[-1] + 1))
        gather[np.arange(grid.size), section_of_node] = 1.0
        return covector @ sparse(gather)


def _sums_to_the_tip(row: Matrix) -> Matrix:
    """Sum of each entry of a row and all entries after it."""
    # Made dense first: CasADi 3.8.2 sums a sparse MX wrongly.
    reversed_row = ca.densify(row[:, ::-1])
    return ca.cumsum(reversed_row, 1)[:, ::-1]
