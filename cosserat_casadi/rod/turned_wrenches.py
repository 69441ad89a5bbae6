"""How wrenches vary that follow their sections, as these turn: docs/theory.md section 7.

Fields of M nodes are stacked component by component as in maths/block_operators.py, one column for each variation.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import casadi as ca

from cosserat_casadi.maths.block_operators import hat_operator, summed
from cosserat_casadi.maths.numbers import is_symbolic, known
from cosserat_casadi.maths.rotation import hat
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.rod.statics import Statics
from cosserat_casadi.rod.wrenches import LineWrench, Wrench, WrenchAt


@dataclass(frozen=True)
class TurnedWrenches:
    """Wrenches that follow their sections, δf = δθ × f and δc = δθ × c, on a rod of known shape.

    Attributes:
        statics: all wrenches on the rod.
        rotation: δθ of the nodes, base frame, 3M×k, rad.
        about_one_axis: whether the rod turns about one axis, where a couple turns into itself.
    """

    statics: Statics
    rotation: Matrix
    about_one_axis: bool

    @cached_property
    def force(self) -> Matrix | None:
        """δn̂ = Sᵀ δf of all forces that follow, base frame, 3M×k, N; None without any."""
        wrenches = [wrench for wrench in self.statics.wrenches if wrench.follower]
        return summed([self._force_of(wrench, wrench.force) for wrench in wrenches if wrench.force is not None])

    @property
    def moments(self) -> list[Matrix]:
        """Derivatives of the moments t × n̂ + ĉ at the nodes with the turns, base frame, 3M×k each, N m."""
        moments = []
        if self.force is not None:
            moments.append(hat_operator(self.statics.shape.tangent) @ self.force)
        couple = self.statics.couple_covector(follower=True)
        if couple is not None and not self.about_one_axis:
            moments.append(-(hat_operator(couple) @ self.rotation))
        return moments

    def _force_of(self, wrench: Wrench, force: Matrix) -> Matrix:
        """δn̂ of one wrench."""
        if isinstance(wrench, LineWrench):
            return self._force_per_length(wrench, force)
        return self._force_at_point(wrench, force)

    def _force_at_point(self, wrench: WrenchAt, force: Matrix) -> Matrix:
        shape = self.statics.shape
        grid = shape.rod.grid
        node = grid.node_at(wrench.at)
        components = ca.vertsplit(self.rotation, grid.size)
        turning = ca.vertcat(*[component[node, :] for component in components])
        in_base = shape.rotation_at(node) @ force
        # δθ × f = −f^ δθ.
        turned = -(hat(in_base) @ turning)
        to_covector = ca.DM(grid.integration_matrix[node])
        return ca.vertcat(*[to_covector @ component for component in ca.vertsplit(turned)])

    def _force_per_length(self, wrench: LineWrench, force: Matrix) -> Matrix:
        rod = self.statics.shape.rod
        grid = rod.grid
        per_length = self.statics.line(wrench, force)
        turned = -(hat_operator(per_length) @ self.rotation)
        lengths = rod.node_lengths
        if is_symbolic(lengths):
            to_covector = ca.DM(grid.integration_matrix).T
            turned = ca.diag(ca.repmat(lengths, 3, 1)) @ turned
        else:
            to_covector = ca.DM(known(lengths)[:, None] * grid.integration_matrix).T
        components = [to_covector @ component for component in ca.vertsplit(turned, grid.size)]
        return ca.vertcat(*components)
