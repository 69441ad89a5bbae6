"""Wrenches on a rod that depend on the pose of their sections: force, moment and their derivatives at a known shape.

At a known shape such a wrench is a dead one, and the sweeps of statics.py and tangent.py take it as that. What it adds
to the Jacobian is how it changes with its section: with δr and δθ of the section, f and c vary by the 6×6 derivative of
the kernel, and the residual −Σ (δrᵀ f + δθᵀ c) by −Σ [δr; δθ]ᵀ [δf; δc], docs/theory.md section 7.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import casadi as ca
import numpy as np

from cosserat_casadi.maths.blocks import block_diagonal
from cosserat_casadi.maths.typing import FloatArray, Matrix
from cosserat_casadi.rod.kinematics import Shape
from cosserat_casadi.rod.wrenches import LineWrench, PointWrench, PoseWrench, Wrench


@dataclass(frozen=True)
class LoadedSections:
    """A pose-dependent wrench on the sections of a rod of known shape.

    Fields of k sections are stacked component by component, as in maths/blocks.py.

    Attributes:
        load: the wrench.
        shape: the rod's shape.
    """

    load: PoseWrench
    shape: Shape

    @cached_property
    def nodes(self) -> list[int]:
        """Nodes of the loaded sections: one, or all."""
        grid = self.shape.rod.grid
        if self.load.at is None:
            return list(range(grid.size))
        return [grid.node_at(self.load.at)]

    @cached_property
    def weights(self) -> FloatArray:
        """Weights of the sections in sums, shape (k,): metres of rod, or one."""
        if self.load.at is not None:
            return np.ones(1)
        rod = self.shape.rod
        return np.asarray(rod.properties.length * rod.grid.weights)

    @cached_property
    def position(self) -> Matrix:
        """Positions of the sections, 3×k, m."""
        if self.load.at is None:
            return self.shape.position
        return self.shape.position_at(self.nodes[0])

    @cached_property
    def force(self) -> Matrix | None:
        """Forces on the sections, 3×k, N or N/m; None where the load has none."""
        return self._scaled(self._wrench[0])

    @cached_property
    def moment(self) -> Matrix | None:
        """Moments on the sections, 3×k, N m or N; None where the load has none."""
        return self._scaled(self._wrench[1])

    @cached_property
    def frozen(self) -> Wrench:
        """The wrench at this shape as one of fixed direction."""
        if self.load.at is None:
            return LineWrench(self.force, self.moment, None, follower=False)
        return PointWrench(self.load.at, self.force, self.moment, follower=False)

    @cached_property
    def energy(self) -> Matrix | None:
        """Energy of the load, 1×1, J; None where it has none."""
        if self.load.kernel.energy is None:
            return None
        densities = self._mapped(self.load.kernel.energy)
        return self.load.scale * (densities @ ca.DM(self.weights))

    @cached_property
    def stiffness(self) -> Matrix:
        """Operator from [δr; δθ] to [δf; δc] of all sections, 6k×6k."""
        kernel = self.load.kernel.stiffness
        return self.load.scale * block_diagonal(self._mapped(kernel), kernel.sparsity_out(0))

    def weighted(self, variation: Matrix) -> Matrix:
        """Rows of stacked fields, 3k×n or 6k×n, each times the weight of its section."""
        components = variation.shape[0] // len(self.nodes)
        return ca.diag(ca.DM(np.tile(self.weights, components))) @ variation

    @cached_property
    def with_base(self) -> tuple[Matrix, Matrix]:
        """[δf; δc] with a shift (m) and with a turn (rad) of the base, base axes, 6k×3 each.

        Moving the base moves every section, δr = δp + δφ × r and δθ = δφ. That f and c, fixed in the world, turn
        back in the axes of the base is left to the frozen wrench.
        """
        count = len(self.nodes)
        ones, none = ca.DM.ones(count, 1), ca.DM(count, 1)
        shift = [[ones, none, none], [none, ones, none], [none, none, ones]]
        x, y, z = (row.T for row in ca.vertsplit(self.position))
        lever = ca.blockcat([[none, z, -y], [-z, none, x], [y, -x, none]])
        unit = ca.blockcat(shift)
        shifted = self.stiffness @ ca.vertcat(unit, ca.DM(3 * count, 3))
        turned = self.stiffness @ ca.vertcat(lever, unit)
        return shifted, turned

    def changed(self, variation: Matrix) -> Wrench:
        """A wrench on the same sections whose forces and moments are a variation of this load's, 6k×1."""
        count = len(self.nodes)
        force, moment = (ca.reshape(part, count, 3).T for part in ca.vertsplit(variation, 3 * count))
        kept_force = force if force.nnz() else None
        kept_moment = moment if moment.nnz() else None
        if self.load.at is None:
            return LineWrench(kept_force, kept_moment, None, follower=False)
        return PointWrench(self.load.at, kept_force, kept_moment, follower=False)

    @cached_property
    def _wrench(self) -> Sequence[Matrix]:
        return self._mapped_all(self.load.kernel.wrench)

    def _scaled(self, part: Matrix) -> Matrix | None:
        return self.load.scale * part if part.nnz() else None

    def _mapped(self, function: ca.Function) -> Matrix:
        return self._mapped_all(function)[0]

    def _mapped_all(self, function: ca.Function) -> list[Matrix]:
        """Results of a function of the kernel at all sections, side by side."""
        count = len(self.nodes)
        columns = [director[:, self.nodes] for director in self.shape.directors]
        rotations = ca.reshape(ca.vertcat(*columns), 3, 3 * count)
        fixed = [self.load.base_position, self.load.base_rotation, self.load.parameters]
        repeated = [ca.repmat(value, 1, count) for value in fixed]
        results = function.map(count).call([self.position, rotations, *repeated, ca.DM(self.load.data)])
        return list(results)
