"""Wrench of a rod on its base and the derivatives of that wrench, for a rod whose base moves.

A rod is written in the axes of its base. Motions of the base therefore enter its equations only through loads that
depend on the world: if the base turns by δφ, a load of fixed direction turns by −δφ in the axes of the base. Loads that
depend on poses vary in addition, since all their sections move with the base. The equations of a rod are linear in the
wrenches on it, so its residual and base wrench under the variations of the wrenches are their own variations.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import casadi as ca

from cosserat_casadi.maths.block_operators import hat_blocks
from cosserat_casadi.maths.numbers import as_matrix
from cosserat_casadi.maths.rotation import hat
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.rod.igm import InverseGeometricModel
from cosserat_casadi.rod.pose_load import LoadedSections, StiffSections
from cosserat_casadi.rod.statics import Statics
from cosserat_casadi.rod.tangent import Tangent
from cosserat_casadi.rod.wrenches import Wrench, WrenchAt

Variation = tuple[Matrix, Matrix, Matrix]
"""Derivatives of residual (n×3), base force and base moment (3×3 each) by a motion of the base along three axes."""


@dataclass(frozen=True)
class Reaction:
    """Variations of a rod's base wrench and residual under motions of its base.

    Attributes:
        tangent: variations of the rod's fields.
        dead: wrenches on the rod with a direction that is fixed in the world.
    """

    tangent: Tangent
    dead: Sequence[Wrench]

    @cached_property
    def force_with_strain(self) -> Matrix:
        """∂ base force / ∂q, base frame, 3×n, N: minus the sum of δf, which dead forces do not have."""
        force = ca.DM(3, self.tangent.rod.size)
        for wrench in self._followers:
            if wrench.force is not None:
                turned = self.tangent.turned(wrench, wrench.force)
                force = force - self._resultant(turned, wrench)
        for stiff, change in self._changes:
            forces, _ = ca.vertsplit(change, 3 * stiff.sections.count)
            force = force - _summed(forces, stiff.sections)
        return force

    @cached_property
    def moment_with_strain(self) -> Matrix:
        """∂ base moment / ∂q, base frame, 3×n, N m: minus the sum of δr × f + r × δf + δc."""
        moment = ca.DM(3, self.tangent.rod.size)
        covector = self._statics.force_covector
        if covector is not None:
            # Σ n̂ × δt is −Σ δr × f: with r = S t and n̂ = Sᵀ f.
            moment = moment + _hat_row(covector) @ self.tangent.tangent
        for wrench in self._followers:
            if wrench.force is not None:
                turned = self.tangent.turned(wrench, wrench.force)
                moment = moment - self._lever(wrench) @ turned
            if wrench.moment is not None:
                turned = self.tangent.turned(wrench, wrench.moment)
                moment = moment - self._resultant(turned, wrench)
        for stiff, change in self._changes:
            # The covector already has δr × f of these, as of the other frozen forces.
            forces, moments = ca.vertsplit(change, 3 * stiff.sections.count)
            moment = moment - _hat_row(stiff.sections.position) @ forces - _summed(moments, stiff.sections)
        return moment

    @cached_property
    def with_turn(self) -> Variation:
        """Derivatives by a turn of the base, base axes, rad."""
        # Pose-dependent wrenches turn back as dead ones do, and in addition change with the motion of their sections.
        fixed = [*self.dead, *(load.frozen for load in self._statics.pose_loads)]
        variations = []
        for axis in range(3):
            turned_back = [_turned_back(wrench, axis) for wrench in fixed]
            variations.append([*turned_back, *(stiff.changed_by_base(1, axis) for stiff in self._stiff_sections)])
        return self._side_by_side(variations)

    @cached_property
    def with_shift(self) -> Variation | None:
        """Derivatives by a shift of the base, base axes, m; None if no load depends on the position of the rod."""
        if not self._stiff_sections:
            return None
        changed = [[stiff.changed_by_base(0, axis) for stiff in self._stiff_sections] for axis in range(3)]
        return self._side_by_side(changed)

    @property
    def _stiff_sections(self) -> list[StiffSections]:
        return self.tangent.stiff_sections

    @cached_property
    def _changes(self) -> list[tuple[StiffSections, Matrix]]:
        """Sections with loads that depend on their poses, and the change [δf; δc] of these loads, 6k×n each."""
        return [(stiff, self.tangent.change(stiff)[1]) for stiff in self._stiff_sections]

    @property
    def _statics(self) -> Statics:
        return self.tangent.igm.statics

    @property
    def _followers(self) -> list[Wrench]:
        return [wrench for wrench in self._statics.fixed_wrenches if wrench.follower]

    def _side_by_side(self, variations: Sequence[Sequence[Wrench]]) -> Variation:
        """Residual and base wrench under each variation of the wrenches, side by side."""
        residuals = []
        forces = []
        moments = []
        for wrenches in variations:
            model = InverseGeometricModel(Statics(self.tangent.shape, wrenches))
            residuals.append(model.generalised_force)
            forces.append(model.statics.base_force)
            moments.append(model.statics.base_moment)
        return ca.horzcat(*residuals), ca.horzcat(*forces), ca.horzcat(*moments)

    def _resultant(self, variation: Matrix, wrench: Wrench) -> Matrix:
        """Sum over the sections of variations of a vector, 3×n."""
        if isinstance(wrench, WrenchAt):
            return variation
        lengths = as_matrix(self.tangent.rod.node_lengths).T
        sums = ca.kron(ca.DM.eye(3), lengths)
        return sums @ variation

    def _lever(self, wrench: Wrench) -> Matrix:
        """Moment about the base of a force on the wrench's section, 3×3, or of forces per length at the nodes, 3×3M."""
        shape = self.tangent.shape
        if isinstance(wrench, WrenchAt):
            node = shape.rod.grid.node_at(wrench.at)
            return hat(shape.position_at(node))
        lengths = as_matrix(shape.rod.node_lengths).T
        weighted = shape.position * ca.repmat(lengths, 3, 1)
        return _hat_row(weighted)


def _summed(variation: Matrix, load: LoadedSections) -> Matrix:
    """Sum over the sections of a load, 3×n, of weighted variations, 3k×n."""
    over_sections = ca.DM.ones(1, load.count)
    sums = ca.kron(ca.DM.eye(3), over_sections)
    return sums @ variation


def _hat_row(field: Matrix) -> Matrix:
    """Operator v ↦ Σ field × v over the sections, from a 3×k field: 3×3k on stacked fields."""
    return hat_blocks(*ca.vertsplit(field))


def _turned_back(wrench: Wrench, axis: int) -> Wrench:
    """Change, in base axes, of a wrench of fixed direction as the base turns about one of its axes."""
    parts = (wrench.force, wrench.moment)
    force, moment = (None if part is None else _cross_with_axis(part, axis) for part in parts)
    return replace(wrench, force=force, moment=moment)


def _cross_with_axis(vectors: Matrix, axis: int) -> Matrix:
    """Each column times the unit vector of an axis."""
    x, y, z = ca.vertsplit(vectors)
    zero = type(x)(*x.shape)
    crossed = (
        (zero, z, -y),
        (-z, zero, x),
        (y, -x, zero),
    )
    return ca.vertcat(*crossed[axis])
