"""World poses of several sections of a rod, and their derivatives with the unknowns.

A section between nodes lies on the polynomials through the values at the nodes; a quaternion is made one of unit length
there. Derivatives follow from the variations of the rod's fields, as the Jacobian of the residual does: automatic
differentiation would carry every section through the rod again.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import casadi as ca

from cosserat_casadi.maths.rotation import quaternion_product, quaternion_to_matrix
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.model.system import System


@dataclass(frozen=True)
class SectionPoses:
    """Poses of sections of a rod.

    Attributes:
        system: rods and frames in symbols or numbers.
        rod: name of the rod.
        weights: of the values at its nodes, nodes×k.
    """

    system: System
    rod: str
    weights: Matrix

    @cached_property
    def stacked(self) -> Matrix:
        """Position and quaternion of each section, 7×k."""
        return ca.densify(ca.vertcat(self.positions, self.quaternions))

    @property
    def count(self) -> int:
        """Number k of sections."""
        return int(self.weights.shape[1])

    @cached_property
    def positions(self) -> Matrix:
        """World positions, 3×k, m."""
        base = self.system.base(self.rod)
        base_positions = ca.repmat(base.position, 1, self.count)
        own_positions = self.system.shapes[self.rod].position @ self.weights
        return base_positions + quaternion_to_matrix(base.quaternion) @ own_positions

    @cached_property
    def quaternions(self) -> Matrix:
        """Unit quaternions world_Q_section, 4×k."""
        # Between nodes an interpolated quaternion is of unit length to the accuracy of the grid only.
        unit = self._interpolated / ca.repmat(self._lengths, 4, 1)
        return quaternion_product(self._base_quaternions, unit)

    @cached_property
    def by_unknowns(self) -> Matrix:
        """∂[position; quaternion]/∂x of one section after the other, 7k×size, where they are written in symbols x."""
        discrete = self.system.discrete
        floats = discrete.unloaded.floating_base(self.rod) is not None
        literal = discrete.rods[self.rod].discretisation.transport == "permuted"
        # A floating base moves with unknowns of its own, and the literal system has no variations.
        if floats or literal:
            return ca.densify(ca.jacobian(ca.vec(self.stacked), self.system.arguments.x))
        strains = discrete.unknowns.strain(self.rod)
        before = ca.DM(7 * self.count, strains.start)
        after = ca.DM(7 * self.count, discrete.size - strains.stop)
        return ca.densify(ca.horzcat(before, self._by_strains(), after))

    @property
    def _base_quaternions(self) -> Matrix:
        return ca.densify(ca.repmat(self.system.base(self.rod).quaternion, 1, self.count))

    @cached_property
    def _interpolated(self) -> Matrix:
        """Weighted means of the quaternions at the nodes in the frame of the base, 4×k."""
        return ca.densify(self.system.shapes[self.rod].quaternion @ self.weights)

    @cached_property
    def _lengths(self) -> Matrix:
        return ca.sqrt(ca.sum1(self._interpolated * self._interpolated))

    def _by_strains(self) -> Matrix:
        """Derivatives with the strain coordinates of the rod, 7k×n."""
        tangent = self.system.tangents[self.rod]
        rotation = quaternion_to_matrix(self.system.base(self.rod).quaternion)
        moved = ca.vertsplit(tangent.displacement(self.weights), 3)
        turned = ca.vertsplit(tangent.quaternion_change(self.weights), 4)
        base_quaternions = ca.MX(ca.repmat(self.system.base(self.rod).quaternion, 1, moved[0].shape[1]))
        rows = []
        for k, (displacement, change) in enumerate(zip(moved, turned, strict=True)):
            unit = self._interpolated[:, k] / self._lengths[k]
            # δ(Q̃ / |Q̃|) = (1 − Q Qᵀ) δQ̃ / |Q̃|.
            across = change - unit @ (unit.T @ change)
            rows.append(rotation @ displacement)
            rows.append(quaternion_product(base_quaternions, ca.densify(across / self._lengths[k])))
        return ca.vertcat(*rows)
