"""Variations of the wrenches that follow their sections as these turn: docs/theory.md section 7.

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
        about_one_axis: whether the rod turns about one axis, so that a couple does not change.
    """

    statics: Statics
    rotation: Matrix
    about_one_axis: bool

    @cached_property
    def force(self) -> Matrix | None:
        """δn̂ = Sᵀ δf of all follower forces, base frame, 3M×k, N; None without any."""
        wrenches = [wrench for wrench in self.statics.wrenches if wrench.follower]
        return summed([self._force_of(wrench, wrench.force) for wrench in wrenches if wrench.force is not None])

    @property
    def moments(self) -> list[Matrix]:
        """Derivatives of the moments t × n̂ + ĉ at the nodes by the turns, base frame, 3M×k each, N m."""
        moments = []
        if self.force is not None:
            moments.append(hat_operator(self.statics.shape.tangent) @ self.force)
        couple = self.statics.couple_covector(follower=True)
        if couple is not None and not self.about_one_axis:
            moments.append(-(hat_operator(couple) @ self.rotation))
        return moments

    def turned(self, wrench: Wrench, vector: Matrix) -> Matrix:
        """δ of a vector that turns with its section, 3×k, or with the sections at all nodes, 3M×k, base frame."""
        if isinstance(wrench, LineWrench):
            return -(hat_operator(self.statics.line(wrench, vector)) @ self.rotation)
        shape = self.statics.shape
        grid = shape.rod.grid
        node = grid.node_at(wrench.at)
        turning = ca.vertcat(*[component[node, :] for component in ca.vertsplit(self.rotation, grid.size)])
        # δ(R v) = δθ × R v = −(R v)^ δθ.
        return -(hat(shape.rotation_at(node) @ vector) @ turning)

    def _force_of(self, wrench: Wrench, force: Matrix) -> Matrix:
        """δn̂ of one wrench."""
        rod = self.statics.shape.rod
        grid = rod.grid
        lengths = rod.node_lengths
        turned = self.turned(wrench, force)
        if isinstance(wrench, WrenchAt):
            to_covector = ca.DM(grid.integration_matrix[grid.node_at(wrench.at)])
        elif is_symbolic(lengths):
            to_covector = ca.DM(grid.integration_matrix).T
            turned = ca.diag(ca.repmat(lengths, 3, 1)) @ turned
        else:
            to_covector = ca.DM(known(lengths)[:, None] * grid.integration_matrix).T
        components = ca.vertsplit(turned, turned.shape[0] // 3)
        return ca.vertcat(*[to_covector @ component for component in components])
