"""What a rod does to its base, and how that changes, for a rod whose base moves.

A rod is written in the axes of its base. Motions of the base therefore do not appear in its equations, but for loads
that know the world: when the base turns by δφ, a load of fixed direction turns by −δφ in the axes of the base. Loads
that depend on poses vary besides, since all their sections move with the base. The equations of a rod are linear in
the wrenches on it, so its residual and base wrench under the variations of the wrenches are their own variations.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import casadi as ca

from cosserat_casadi.maths.blocks import hat_operator
from cosserat_casadi.maths.rotation import hat
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.rod.igm import InverseGeometricModel
from cosserat_casadi.rod.pose_load import LoadedSections
from cosserat_casadi.rod.statics import Statics
from cosserat_casadi.rod.tangent import Tangent
from cosserat_casadi.rod.wrenches import PointWrench, Wrench

Variation = tuple[Matrix, Matrix, Matrix]
"""Derivatives of residual (n×3), base force and base moment (3×3 each) with a motion of the base along three axes."""


@dataclass(frozen=True)
class Reaction:
    """Variations of a rod's base wrench, and of its residual, when its base moves.

    Attributes:
        tangent: variations of the rod's fields.
        dead: the wrenches on it whose direction is fixed in the world.
    """

    tangent: Tangent
    dead: Sequence[Wrench]

    @cached_property
    def force_with_strain(self) -> Matrix:
        """∂ base force / ∂q, base frame, 3×n, N: dead forces do not change it."""
        force = ca.DM(3, self._size)
        for wrench in self._followers:
            if wrench.force is not None:
                force = force - self._resultant(self._turned(wrench, wrench.force), wrench)
        for load in self._statics.pose_loads:
            forces, _ = _halves(self.tangent.wrench_variation(load))
            force = force - _summed(forces, load)
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
        for load in self._statics.pose_loads:
            forces, moments = _halves(self.tangent.wrench_variation(load))
            moment = moment - _hat_row(load.position) @ forces - _summed(moments, load)
        return moment

    @cached_property
    def with_turn(self) -> Variation:
        """Derivatives with a turn of the base, base axes, rad."""
        turned_back = [*self.dead, *[load.frozen for load in self._statics.pose_loads]]
        return self._joined(
            [[*[_turned_back(wrench, axis) for wrench in turned_back], *self._changed(1, axis)] for axis in range(3)]
        )

    @cached_property
    def with_shift(self) -> Variation | None:
        """Derivatives with a shift of the base, base axes, m; None where no load depends on where the rod is."""
        if not self._statics.pose_loads:
            return None
        return self._joined([self._changed(0, axis) for axis in range(3)])

    @property
    def _statics(self) -> Statics:
        return self.tangent.igm.statics

    @property
    def _size(self) -> int:
        return self._statics.shape.rod.size

    @property
    def _followers(self) -> list[Wrench]:
        return [wrench for wrench in self._statics.fixed_wrenches if wrench.follower]

    def _changed(self, motion: int, axis: int) -> list[Wrench]:
        """Variations of the pose-dependent wrenches with a shift (0) or a turn (1) of the base along an axis."""
        return [load.changed(load.with_base[motion][:, axis]) for load in self._statics.pose_loads]

    def _joined(self, variations: Sequence[Sequence[Wrench]]) -> Variation:
        """Residual and base wrench under each of the variations of the wrenches, side by side."""
        models = [InverseGeometricModel(Statics(self._statics.shape, wrenches)) for wrenches in variations]
        residual = ca.horzcat(*[model.generalised_force for model in models])
        force = ca.horzcat(*[model.statics.base_force for model in models])
        moment = ca.horzcat(*[model.statics.base_moment for model in models])
        return residual, force, moment

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


def _halves(variation: Matrix) -> tuple[Matrix, Matrix]:
    """Variations of the forces and of the moments, 3k×n each, from those of both."""
    forces, moments = ca.vertsplit(variation, variation.shape[0] // 2)
    return forces, moments


def _summed(variation: Matrix, load: LoadedSections) -> Matrix:
    """Sum over the sections of a load, 3×n, of variations that hold their weights, 3k×n."""
    return ca.kron(ca.DM.eye(3), ca.DM.ones(1, len(load.nodes))) @ variation


def _hat_row(field: Matrix) -> Matrix:
    """Operator v ↦ Σ field × v over the sections, from a 3×k field: 3×3k on stacked fields."""
    x, y, z = ca.vertsplit(field)
    zero = type(x)(*x.shape)
    return ca.blockcat([[zero, -z, y], [z, zero, -x], [-y, x, zero]])


def _turned_back(wrench: Wrench, axis: int) -> Wrench:
    """Change of a wrench of fixed direction, as the base sees it, while the base turns about one of its axes."""
    force = None if wrench.force is None else _cross_with_axis(wrench.force, axis)
    moment = None if wrench.moment is None else _cross_with_axis(wrench.moment, axis)
    return replace(wrench, force=force, moment=moment)


def _cross_with_axis(vectors: Matrix, axis: int) -> Matrix:
    """Each column times the unit vector of an axis."""
    x, y, z = ca.vertsplit(vectors)
    zero = type(x)(*x.shape)
    crossed = ((zero, z, -y), (-z, zero, x), (y, -x, zero))
    return ca.vertcat(*crossed[axis])
