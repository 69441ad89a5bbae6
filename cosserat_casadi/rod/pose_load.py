"""Wrenches on a rod that depend on the pose of their sections: force, moment and their derivatives at a known shape.

At a known shape such a wrench is a dead wrench for the sweeps of statics.py and tangent.py. Its change with its section
is a further term of the Jacobian: with δr and δθ of the section, f and c vary by the 6×6 derivative of the kernel, and
the residual −Σ (δrᵀ f + δθᵀ c) by −Σ [δr; δθ]ᵀ [δf; δc], docs/theory.md section 7.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Hashable, Sequence
from dataclasses import dataclass
from functools import cached_property

import casadi as ca
import numpy as np

from cosserat_casadi.maths.block_operators import block_diagonal, hat_blocks, unstack
from cosserat_casadi.maths.numbers import Numbers, as_matrix
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.rod.kinematics import Shape
from cosserat_casadi.rod.wrenches import LineWrench, PoseWrench, Wrench, WrenchAt

FAR_FEWER = 0.4
"""Ratio of products below which a formula with fewer products is taken, although its C has no loops over columns."""


@dataclass(frozen=True)
class LoadedSections:
    """A pose-dependent wrench on the sections of a rod of known shape.

    Fields of k sections are stacked component by component, as in maths/block_operators.py.

    Attributes:
        load: the wrench.
        shape: the rod's shape.
    """

    load: PoseWrench
    shape: Shape

    @cached_property
    def count(self) -> int:
        """Number of loaded sections k."""
        return len(self.nodes) if self.load.sections is None else self.load.sections.size

    @cached_property
    def nodes(self) -> list[int]:
        """Indices of the nodes of the loaded sections: one node, or all nodes of the span."""
        assert self.load.sections is None, "they lie between nodes"
        grid = self.shape.rod.grid
        at = self.load.at
        if at is None:
            return list(map(int, grid.nodes_in(*self.load.span)))
        return [grid.node_at(at)]

    @property
    def everywhere(self) -> bool:
        """Whether the sections are all nodes of the rod."""
        return self.load.sections is None and len(self.nodes) == self.shape.rod.grid.size

    def at_sections(self, field: Matrix) -> Matrix:
        """Values at the loaded sections, m×k, of a field at the nodes, m×M."""
        if self.load.sections is not None:
            return self.load.sections.at_sections(field)
        return field if self.everywhere else field[:, self.nodes]

    def varied_at_sections(self, variation: Matrix) -> Matrix:
        """Variations at the loaded sections, mk×n, from variations at the nodes, mM×n, stacked by component."""
        parts = ca.vertsplit(variation, self.shape.rod.grid.size)
        if self.load.sections is not None:
            return ca.vertcat(*[self.load.sections.placed.interpolation @ part for part in parts])
        return variation if self.everywhere else ca.vertcat(*[part[self.nodes, :] for part in parts])

    def moved(self, tangents: Matrix) -> Matrix:
        """Variations of positions at the loaded sections, 3k×n, from variations of tangents at the nodes, 3M×n."""
        grid = self.shape.rod.grid
        parts = ca.vertsplit(tangents, grid.size)
        if self.load.sections is not None:
            return self.varied_at_sections(ca.vertcat(*[grid.integrated(part.T).T for part in parts]))
        integrate = ca.DM(grid.integration_matrix[self.nodes])
        return ca.vertcat(*[integrate @ part for part in parts])

    @cached_property
    def weights(self) -> Numbers:
        """Weights of the sections in sums, shape (k,): lengths of rod in m, or one."""
        if self.load.at is not None:
            return np.ones(1)
        if self.load.sections is not None:
            return self.load.sections.lengths
        return self.shape.rod.node_lengths[self.nodes]

    @cached_property
    def position(self) -> Matrix:
        """Positions of the sections, 3×k, m."""
        if self.load.at is not None:
            return self.shape.position_at(self.nodes[0])
        return self.at_sections(self.shape.position)

    @cached_property
    def force(self) -> Matrix | None:
        """Forces on the sections, 3×k, N or N/m; None for a load without force."""
        force, _ = self._wrench
        return self._scaled(force)

    @cached_property
    def moment(self) -> Matrix | None:
        """Moments on the sections, 3×k, N m or N; None for a load without moment."""
        _, moment = self._wrench
        return self._scaled(moment)

    @cached_property
    def frozen(self) -> Wrench:
        """The wrench at this shape as a dead wrench."""
        return self.dead(self.force, self.moment)

    @cached_property
    def energy(self) -> Matrix | None:
        """Energy of the load, 1×1, J; None for a load without energy."""
        function = self.load.kernel.energy
        if function is None:
            return None
        (densities,) = self._mapped(function)
        return self.load.scale * (densities @ as_matrix(self.weights))

    @cached_property
    def stiffness(self) -> Matrix:
        """Operator from [δr; δθ] to [δf; δc] of all sections, 6k×6k."""
        function = self.load.kernel.stiffness
        (blocks,) = self._mapped(function)
        operator = block_diagonal(blocks, function.sparsity_out(0))
        return self.load.scale * operator

    @cached_property
    def with_rates(self) -> dict[str, Matrix]:
        """Operators from the variation of each rate of the sections, 3k×1, to [δf; δc], 6k×3k."""
        function = self.load.kernel.with_rates
        operators = {}
        for number, (rate, blocks) in enumerate(zip(self.load.kernel.rates, self._mapped(function), strict=True)):
            operators[rate] = self.load.scale * block_diagonal(blocks, function.sparsity_out(number))
        return operators

    def weighted(self, variation: Matrix) -> Matrix:
        """Rows of stacked fields, 3k×n or 6k×n, each times the weight of its section."""
        if self.load.at is not None:
            return variation
        components = variation.shape[0] // self.count
        weights = ca.repmat(as_matrix(self.weights), components, 1)
        return ca.diag(weights) @ variation

    def changed(self, variation: Matrix) -> Wrench:
        """A dead wrench on these sections with a variation of forces and moments, 6k×1, as its values."""
        count = self.count
        forces, moments = ca.vertsplit(variation, 3 * count)
        force = unstack(forces, 3)
        moment = unstack(moments, 3)
        return self.dead(force if force.nnz() else None, moment if moment.nnz() else None)

    def dead(self, force: Matrix | None, moment: Matrix | None) -> Wrench:
        """A dead wrench on the loaded sections from its values there, 3×k each."""
        at = self.load.at
        if at is not None:
            return WrenchAt(at, force, moment, follower=False)
        return LineWrench(self._at_all_nodes(force), self._at_all_nodes(moment), None, follower=False)

    def _at_all_nodes(self, part: Matrix | None) -> Matrix | None:
        """Load at all nodes from a load per length at the loaded sections; unloaded nodes store no entry."""
        if part is None or self.everywhere:
            return part
        if self.load.sections is not None:
            return self.load.sections.at_nodes(part)
        size = self.shape.rod.grid.size
        places = ca.Sparsity.triplet(len(self.nodes), size, list(range(len(self.nodes))), self.nodes)
        return part @ ca.DM(places, 1.0)

    @cached_property
    def drag(self) -> tuple[Matrix, Matrix]:
        """Forces and moments on the sections minus the values at rest, 3×k each."""
        force, moment = (self.load.scale * part for part in self._mapped(self.load.kernel.drag))
        return force, moment

    @cached_property
    def _wrench(self) -> Sequence[Matrix]:
        return self._mapped(self.load.kernel.wrench)

    @property
    def _rates(self) -> list[Matrix]:
        """The rates that the kernel depends on at the loaded sections, 3×k each, axes of the base."""
        if self.load.motion is None:
            return []
        return [self.at_sections(self.load.motion.undamped(rate)) for rate in self.load.kernel.rates]

    def _scaled(self, part: Matrix) -> Matrix | None:
        return self.load.scale * part if part.nnz() else None

    def _mapped(self, function: ca.Function) -> list[Matrix]:
        """Results of a function of the kernel at all sections, side by side."""
        # Base, parameters and scale are equal for all sections; CasADi's map needs them side by side.
        count = self.count
        rotations = ca.DM(3, 3 * count) if self.load.sections is not None else self.shape.rotations_at(self.nodes)
        alike = [self.load.base_position, self.load.base_rotation, self.load.parameters]
        repeated = [ca.repmat(value, 1, count) for value in alike]
        given = [self.position, rotations, *repeated, as_matrix(self.load.data), *self._rates]
        results = function.map(count).call(given)
        return list(results)


@dataclass(frozen=True)
class StiffSections:
    """Sections of a rod with all pose-dependent loads on them.

    Attributes:
        loads: the loads, on the same sections.
    """

    loads: Sequence[LoadedSections]

    @property
    def sections(self) -> LoadedSections:
        """The sections with one of their loads."""
        return self.loads[0]

    @cached_property
    def stiffness(self) -> Matrix:
        """Operator from [δr; δθ] to [δf; δc] of all sections and loads, 6k×6k."""
        return sum((load.stiffness for load in self.loads[1:]), self.loads[0].stiffness)

    @property
    def is_cheaper_at_nodes(self) -> bool:
        """Whether the stiffness of sections between nodes takes far fewer products if written for the nodes."""
        sections = self.sections
        if sections.load.sections is None:
            return False
        rod, count = sections.shape.rod, sections.count
        of_element = rod.grid.size // rod.grid.elements
        at_sections = 3 * count * rod.size * (of_element + rod.size)
        at_nodes = 9 * count * of_element**2 + 3 * rod.grid.size * rod.size * (3 * of_element + rod.size)
        return at_nodes < FAR_FEWER * at_sections

    @cached_property
    def stiffness_of_nodes(self) -> Matrix:
        """Operator from δr of the nodes to weighted δf at the nodes, for sections between nodes, 3M×3M."""
        sections = self.sections
        assert sections.load.sections is not None, "they lie between nodes"
        of_positions = self.stiffness[: 3 * sections.count, : 3 * sections.count]
        to_sections = ca.kron(ca.DM.eye(3), sections.load.sections.placed.interpolation)
        return to_sections.T @ (sections.weighted(of_positions) @ to_sections)

    @cached_property
    def with_base(self) -> tuple[Matrix, Matrix]:
        """[δf; δc] by a shift (m) and by a turn (rad) of the base, base axes, 6k×3 each.

        Moving the base moves every section, δr = δp + δφ × r and δθ = δφ. The frozen wrench has the other part: f and
        c, fixed in the world, turn back in the axes of the base.
        """
        count = self.sections.count
        # δφ × r at every section.
        levers = hat_blocks(*(row.T for row in ca.vertsplit(-self.sections.position)))
        alike = ca.kron(ca.DM.eye(3), ca.DM.ones(count, 1))
        shift = ca.vertcat(alike, ca.DM(3 * count, 3))
        turn = ca.vertcat(levers, alike)
        return self.stiffness @ shift, self.stiffness @ turn

    def changed_by_base(self, motion: int, axis: int) -> Wrench:
        """Change of all loads by a shift of the base along one of its axes (motion 0), or a turn about it (1)."""
        return self.sections.changed(self.with_base[motion][:, axis])


def by_sections(loads: Sequence[LoadedSections]) -> list[StiffSections]:
    """Pose-dependent loads, grouped by their sections; loads at one section come last."""
    groups: dict[Hashable, list[LoadedSections]] = defaultdict(list)
    for load in sorted(loads, key=lambda load: load.load.at is not None):
        places = tuple(load.nodes) if load.load.sections is None else id(load.load.sections)
        groups[load.load.at is not None, places].append(load)
    return [StiffSections(group) for group in groups.values()]
