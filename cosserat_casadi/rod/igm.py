"""Inverse Geometric Model: strain coordinates and loads ↦ generalised force and base wrench, report (2.18)–(2.20).

The residual K_εε q + Q_ad is divided by EI/ℓ, so it is dimensionless and of the order of F ℓ²/EI. See docs/theory.md
section 6.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import casadi as ca

from cosserat_casadi.maths.block_operators import stack, summed
from cosserat_casadi.maths.rotation import dot
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.rod.actuation import Actuation, Conjugate
from cosserat_casadi.rod.kinematics import Shape
from cosserat_casadi.rod.statics import Statics
from cosserat_casadi.rod.strain import DiscreteRod
from cosserat_casadi.rod.strain_density import energy_beyond_hooke
from cosserat_casadi.rod.transport import interval_kernels
from cosserat_casadi.rod.wrenches import LineWrench


@dataclass(frozen=True)
class InverseGeometricModel:
    """Balance of one rod.

    Attributes:
        statics: the rod's shape and internal wrench.
        actuation: the efforts on it.
    """

    statics: Statics
    actuation: tuple[Actuation, ...] = ()

    @property
    def shape(self) -> Shape:
        """The rod's shape."""
        return self.statics.shape

    @property
    def rod(self) -> DiscreteRod:
        """The rod."""
        return self.statics.shape.rod

    @cached_property
    def pulled(self) -> Statics:
        """Statics of the rod under its loads and the efforts that act as wrenches on sections; these need no clamp.

        The internal wrench of :attr:`statics` belongs to the rod and its tendons together.
        """
        parts = [(effort, conjugate.wrench) for effort, conjugate in self.efforts if conjugate.wrench is not None]
        if not parts:
            return self.statics
        force: Matrix = ca.DM(3, self.rod.grid.size)
        moment: Matrix = ca.DM(3, self.rod.grid.size)
        for effort, wrench in parts:
            assert wrench.force is not None, "cables pull"
            assert wrench.moment is not None, "cables pull off the centreline"
            force = force + effort * wrench.force
            moment = moment + effort * wrench.moment
        total = LineWrench(force, moment, None, follower=False)
        # Loads that depend on poses are already evaluated.
        return Statics(self.shape, [*self.statics.fixed_wrenches, total], self.statics.pose_loads)

    @cached_property
    def generalised_force(self) -> Matrix:
        """Q_ad / (EI/ℓ), n×1, of loads and wrenches of efforts: report (2.18), Q_ad = −ℓ ∫ Φᵀ Bᵀ Λ dX."""
        if self.rod.discretisation.transport == "permuted":
            return self._weighted_force()
        # Minus the derivative of the loads' virtual work, by the transpose of the forward sweep.
        covector = self.pulled.force_covector
        moment = self.pulled.interval_moment
        force: Matrix = ca.DM.zeros(self.rod.size, 1)
        if moment is not None and self.rod.properties.turning_axes:
            # (∂Ω/∂q)ᵀ Tᵀ Rᵀ m of every interval.
            pull = interval_kernels(self.rod).pull.map(moment.shape[1])
            pulled = pull(*self.shape.interval_arguments, moment)
            angular = self.rod.turn_axes.transposed_times(stack(pulled)) * (-1.0 / self.rod.energy_unit)
            force = ca.vertcat(angular, ca.DM(self.rod.size - angular.shape[0], 1))
        return force + self._linear_force(covector)

    @cached_property
    def efforts(self) -> tuple[tuple[Matrix, Conjugate], ...]:
        """Every effort of an actuator with the quantity that it works on, at this shape."""
        return tuple([(actuation.effort, actuation.quantity.on(self.shape)) for actuation in self.actuation])

    @cached_property
    def energy_beyond_hooke(self) -> Conjugate | None:
        """Elastic energy beyond the Hooke tensor's, J, at this shape; None for a linear rod."""
        return energy_beyond_hooke(self.shape)

    @cached_property
    def strain_functions(self) -> tuple[tuple[Matrix, Conjugate], ...]:
        """Functions of the strains with factors; the sum of products is the energy, J, of strains alone."""
        if self.energy_beyond_hooke is None:
            return self.efforts
        return (*self.efforts, (ca.DM(1.0), self.energy_beyond_hooke))

    @cached_property
    def further_force(self) -> Matrix | None:
        """ℓ ∫ Φᵀ Bᵀ Λ_ad dX / (EI/ℓ), n×1, of all stress beside the linear elastic one, report (2.16); None if none.

        Λ_ad is the stress of actuators, and the stress of the material beyond Hooke's law.
        """
        pulls = [(effort, conjugate.pull) for effort, conjugate in self.strain_functions if conjugate.wrench is None]
        return summed([effort / self.rod.energy_unit * pull for effort, pull in pulls])

    @cached_property
    def residual(self) -> Matrix:
        """(K_εε q + Q_ad) / (EI/ℓ), n×1: zero in equilibrium, report (2.20)."""
        elastic = self._elastic(self.rod.stiffness_matrix @ self.shape.q)
        passive = elastic + self.generalised_force
        if self.further_force is None:
            return passive
        return passive + self.further_force

    @cached_property
    def energy(self) -> Matrix:
        """Elastic energy, 1×1, J: ½ qᵀ K_εε q, and the energy beyond Hooke's law."""
        q = self.shape.q
        stored = ca.bilin(self.rod.stiffness_matrix, q, q)
        linear = self.rod.energy_unit / 2 * self._elastic(stored)
        if self.energy_beyond_hooke is None:
            return linear
        return linear + self.energy_beyond_hooke.value

    @cached_property
    def potential(self) -> Matrix | None:
        """Elastic energy less the work of loads and actuators, 1×1, J.

        None unless every load is a dead force or has an energy, and the pull of every effort is a gradient. With
        r = S t and n̂ = Sᵀ f the work of the dead forces is Σ n̂_k·t_k, so the residual is its exact gradient.
        """
        # A dead moment may have a potential, but it is not written here.
        if any(w.follower or w.moment is not None for w in self.statics.fixed_wrenches):
            return None
        if any(load.energy is None for load in self.statics.pose_loads):
            return None
        covector = self.statics.fixed_force_covector
        if not all(conjugate.conservative for _, conjugate in self.efforts):
            return None
        total = self.energy
        if covector is not None:
            total = total - ca.dot(covector, self.shape.tangent)
        for load in self.statics.pose_loads:
            assert load.energy is not None
            total = total + load.energy
        for effort, conjugate in self.efforts:
            total = total + effort * conjugate.value
        return total

    def _elastic(self, value: Matrix) -> Matrix:
        """A value in proportion to the stiffness: a longer rod is softer."""
        return value if self.shape.ratio is None else value / self.shape.ratio

    def _linear_force(self, covector: Matrix | None) -> Matrix:
        """Generalised forces of shear and extension: −ℓ Φᵀ (d·n̂)."""
        rod = self.rod
        # Curvature and torsion come first in q; forces work on them through moments alone.
        angular_size = sum(rod.size_of(c) for c in rod.angular)
        parts: list[Matrix] = [ca.DM.zeros(angular_size, 1)]
        for c in rod.linear:
            if covector is None:
                parts.append(ca.DM.zeros(rod.size_of(c), 1))
                continue
            along_director = dot(self.shape.directors[c - 3], covector)
            per_coordinate = rod.node_matrices[c] * (-rod.length / rod.energy_unit)
            parts.append(per_coordinate.T @ along_director.T)
        return ca.vertcat(*parts)

    def _weighted_force(self) -> Matrix:
        """Literal quadrature of report (2.16), −ℓ ∫ Φᵀ Bᵀ Λ dX / (EI/ℓ), from the internal wrench at the nodes, n×1."""
        wrench = self.statics.internal_wrench()
        rod = self.rod
        factor = rod.length / rod.energy_unit * rod.grid.weights
        parts = [ca.DM(rod.at_nodes[c] * factor[:, None]).T @ wrench[c, :].T for c in rod.admitted]
        return -ca.vertcat(*parts)
