"""Relaxing stress of a rod, generalised Maxwell: Λ = Σ c_i H e_i in addition to elastic and viscous stress.

A branch is a spring of stiffness c_i H in series with a dashpot of relaxation time τ_i. Its spring is stretched by
e_i = τ_i ẇ_i, w_i the strain of the dashpot, so that ė_i = ξ̇ − ẇ_i is τ_i ẅ_i + ẇ_i = ξ̇: an equation of motion like
those of the rod, in which w_i itself does not appear. With the shares s_i of the instantaneous stiffness H/(1 − Σ s),
by strain, c_i = s_i / (1 − Σ s). N. W. Tschoegl, *The Phenomenological Theory of Linear Viscoelastic
Behavior*, Springer 1989, section 3.5; docs/theory.md, section 11.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import casadi as ca

from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.rod.strain import per_reference_length
from cosserat_casadi.rod.viscosity import Viscosity


@dataclass(frozen=True)
class RelaxationMatrices:
    """Derivatives of a rod's relaxing force and of the equations of its branches, by strains q and flows w.

    Attributes:
        force_by_rate: of the force by ẇ, n×nB, s.
        by_strain: of the equations by q, nB×n, 1/s; zero unless the rod's length changes.
        by_strain_rate: of the equations by q̇, nB×n.
        by_rate: of the equations by ẇ, nB×nB.
        by_acceleration: of the equations by ẅ, nB×nB, s.
    """

    force_by_rate: Matrix
    by_strain: Matrix
    by_strain_rate: Matrix
    by_rate: Matrix
    by_acceleration: Matrix


@dataclass(frozen=True)
class Relaxation:
    """The B Maxwell branches of a rod in motion.

    Attributes:
        rates: shape of the rod with the rates of its strains.
        velocity: ẇ, strain rates of the dashpots in strain coordinates, one column for each branch, n×B, 1/s.
        acceleration: ẅ, n×B, 1/s².
    """

    rates: Viscosity
    velocity: Matrix
    acceleration: Matrix

    @cached_property
    def force(self) -> Matrix:
        """ℓ ∫ Φᵀ Σ c_i H e_i dX / (EI/ℓ), n×1, without unit: a part of the residual."""
        return self._stiffness @ ca.sum2(self._strain * self._factors)

    @cached_property
    def equations(self) -> Matrix:
        """τ_i ẅ_i + ẇ_i − ξ̇ of all branches one after the other, nB×1, 1/s."""
        relaxed = self.acceleration @ ca.diag(self._times) + self.velocity
        return ca.vec(relaxed - ca.repmat(self.rates.strain_rate, 1, self.velocity.shape[1]))

    @cached_property
    def matrices(self) -> RelaxationMatrices:
        """Derivatives of force and equations."""
        size, branches = self.velocity.shape
        one = ca.DM.eye(size)
        by_strain_rate = -one
        by_strain: Matrix = ca.DM(size, size)
        if self.rates.shape.ratio is not None:
            by_strain_rate = by_strain_rate / self.rates.shape.ratio
            by_strain = one * (self.rates.shrinking / self.rates.shape.ratio)
        return RelaxationMatrices(
            force_by_rate=ca.horzcat(*[self._stiffness @ ca.diag(column) for column in ca.horzsplit(self._viscous)]),
            by_strain=ca.repmat(by_strain, branches, 1),
            by_strain_rate=ca.repmat(by_strain_rate, branches, 1),
            by_rate=ca.DM.eye(size * branches),
            by_acceleration=ca.kron(ca.diag(self._times), one),
        )

    @cached_property
    def energy(self) -> Matrix:
        """Energy of the springs, ℓ ∫ Σ ½ e_iᵀ c_i H e_i dX, 1×1, J."""
        return self._sum_of_squares(self._strain, self._factors / 2)

    @cached_property
    def dissipated_power(self) -> Matrix:
        """Power that the dashpots turn into heat, ℓ ∫ Σ ẇ_iᵀ c_i τ_i H ẇ_i dX, 1×1, W; never negative."""
        return self._sum_of_squares(self.velocity, self._viscous)

    @cached_property
    def lengthening_power(self) -> Matrix:
        """Power on the change of the length alone, 1×1, W: material that joins brings its springs in their state."""
        shrinking = self.rates.shrinking
        return shrinking * (self.energy - self.rates.shape.rod.energy_unit * ca.dot(self.force, self.rates.shape.q))

    @cached_property
    def _strain(self) -> Matrix:
        """e_i = τ_i ẇ_i, n×B."""
        return self.velocity @ ca.diag(self._times)

    def _sum_of_squares(self, columns: Matrix, factors: Matrix) -> Matrix:
        """Σ column_iᵀ diag(factor_i) K column_i of the whole rod, in joules over the unit of the columns, 1×1."""
        squares = ca.sum1(ca.sum2(columns * (self._stiffness @ columns) * factors))
        return per_reference_length(self.rates.shape.rod.energy_unit * squares, self.rates.shape.ratio)

    @property
    def _stiffness(self) -> Matrix:
        return self.rates.shape.rod.stiffness_matrix

    @property
    def _factors(self) -> Matrix:
        """c_i of each coordinate, n×B; it is equal for all coordinates of a strain, so that it commutes with K."""
        rod = self.rates.shape.rod
        rows = []
        for component, columns in rod.columns.items():
            shares = [branch.shares[component] for branch in rod.properties.branches]
            row = ca.horzcat(*shares) / (1 - sum(shares))
            rows.append(ca.repmat(row, columns.stop - columns.start, 1))
        return ca.vertcat(*rows)

    @property
    def _viscous(self) -> Matrix:
        """c_i τ_i of each coordinate, n×B, s."""
        return self._factors @ ca.diag(self._times)

    @property
    def _times(self) -> Matrix:
        """τ_i, B×1, s."""
        return ca.vertcat(*[branch.time for branch in self.rates.shape.rod.properties.branches])
