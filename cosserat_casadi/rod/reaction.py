"""What a rod does to whatever carries its base, and how that changes: for a rod whose base moves.

In the base frame a rod knows nothing of the motion of its base, but for loads of fixed direction in the world: they
turn the other way. The rod's equations are linear in them, so their change with a rotation of the base is the same
equations under other loads.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import casadi as ca

from cosserat_casadi.maths.blocks import hat_operator
from cosserat_casadi.maths.rotation import hat
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.rod.igm import InverseGeometricModel
from cosserat_casadi.rod.statics import Statics
from cosserat_casadi.rod.tangent import Tangent
from cosserat_casadi.rod.wrenches import PointWrench, Wrench


@dataclass(frozen=True)
class Reaction:
    """Variations of a rod's base wrench, and of its residual, when its base turns.

    Attributes:
        tangent: variations of the rod's fields.
        dead: the wrenches on it whose direction is fixed in the world.
    """

    tangent: Tangent
    dead: Sequence[Wrench]

    @cached_property
    def force_with_strain(self) -> Matrix:
        """∂ base force / ∂q, base frame, 3×n, N: only forces that follow the sections change it."""
        force = ca.DM(3, self._size)
        for wrench in self._followers:
            if wrench.force is not None:
                force = force - self._resultant(self._turned(wrench, wrench.force), wrench)
        return force

    @cached_property
    def moment_with_strain(self) -> Matrix:
        """∂ base moment / ∂q, base frame, 3×n, N m."""
        moment = ca.DM(3, self._size)
        if self._statics.force_covector is not None:
            moment = moment + _hat_row(self._statics.force_covector) @ self.tangent.tangent
        for wrench in self._followers:
            if wrench.force is not None:
                moment = moment - self._lever(wrench) @ self._turned(wrench, wrench.force)
            if wrench.moment is not None:
                moment = moment - self._resultant(self._turned(wrench, wrench.moment), wrench)
        return moment

    @cached_property
    def with_turn(self) -> tuple[Matrix, Matrix, Matrix]:
        """Derivatives of residual (n×3), base force and base moment (3×3) with a turn of the base, base axes, rad."""
        turned = [self._under([_turned_back(wrench, axis) for wrench in self.dead]) for axis in range(3)]
        residual = ca.horzcat(*[model.generalised_force for model in turned])
        force = ca.horzcat(*[model.statics.base_force for model in turned])
        moment = ca.horzcat(*[model.statics.base_moment for model in turned])
        return residual, force, moment

    @property
    def _statics(self) -> Statics:
        return self.tangent.igm.statics

    @property
    def _size(self) -> int:
        return self._statics.shape.rod.size

    @property
    def _followers(self) -> list[Wrench]:
        return [wrench for wrench in self._statics.wrenches if wrench.follower]

    def _under(self, wrenches: Sequence[Wrench]) -> InverseGeometricModel:
        return InverseGeometricModel(Statics(self._statics.shape, wrenches))

    def _turned(self, wrench: Wrench, vector: Matrix) -> Matrix:
        """δ of a vector that turns with its section, 3×n, or with the sections at all nodes, 3M×n."""
        shape = self._statics.shape
        if isinstance(wrench, PointWrench):
            node = shape.rod.grid.node_at(wrench.at)
            return -(hat(shape.rotation_at(node) @ vector) @ self.tangent.rotation_of(node))
        angular = -(hat_operator(self._statics.line(wrench, vector)) @ self.tangent.rotation)
        return ca.horzcat(angular, ca.DM(angular.shape[0], self._size - angular.shape[1]))

    def _resultant(self, variation: Matrix, wrench: Wrench) -> Matrix:
        if isinstance(wrench, PointWrench):
            return variation
        return ca.kron(ca.DM.eye(3), self._weights) @ variation

    def _lever(self, wrench: Wrench) -> Matrix:
        """Moment about the base of a force on the wrench's section, 3×3, or of forces per length at the nodes, 3×3M."""
        shape = self._statics.shape
        if isinstance(wrench, PointWrench):
            return hat(shape.position_at(shape.rod.grid.node_at(wrench.at)))
        return _hat_row(shape.position * ca.repmat(self._weights, 3, 1))

    @property
    def _weights(self) -> ca.DM:
        rod = self._statics.shape.rod
        return ca.DM(rod.properties.length * rod.grid.weights).T


def _hat_row(field: Matrix) -> Matrix:
    """Operator v ↦ Σ field × v over the places, from a 3×k field: 3×3k on stacked fields."""
    x, y, z = ca.vertsplit(field)
    zero = type(x)(*x.shape)
    return ca.blockcat([[zero, -z, y], [z, zero, -x], [-y, x, zero]])


def _turned_back(wrench: Wrench, axis: int) -> Wrench:
    """Change of a wrench of fixed direction, as the base sees it, while the base turns about one of its axes."""
    vectors = {name: getattr(wrench, name) for name in ("force", "moment")}
    changed: dict[str, Any] = {name: _cross(vector, axis) for name, vector in vectors.items() if vector is not None}
    return replace(wrench, **changed)


def _cross(vectors: Matrix, axis: int) -> Matrix:
    """Each column times the unit vector of an axis."""
    x, y, z = ca.vertsplit(vectors)
    zero = type(x)(*x.shape)
    return ca.vertcat(*((zero, z, -y), (-z, zero, x), (y, -x, zero))[axis])
