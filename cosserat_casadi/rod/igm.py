"""Inverse Geometric Model: strain coordinates and loads ↦ generalised force and base wrench, report (2.18)–(2.20).

The residual K_εε q + Q_ad is divided by EI/ℓ, so it is without unit and of the size of F ℓ²/EI.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import casadi as ca

from cosserat_casadi.maths.blocks import stack
from cosserat_casadi.maths.rotation import dot
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.rod.actuation import Actuation, Conjugate
from cosserat_casadi.rod.kinematics import Shape
from cosserat_casadi.rod.statics import Statics
from cosserat_casadi.rod.transport import interval_kernels


@dataclass(frozen=True)
class InverseGeometricModel:
    """Balance of one rod.

    Attributes:
        statics: the rod's shape and internal wrench.
        actuation: what actuators put against the elastic stress.
    """

    statics: Statics
    actuation: tuple[Actuation, ...] = ()

    @property
    def shape(self) -> Shape:
        """The rod's shape."""
        return self.statics.shape

    @cached_property
    def generalised_force(self) -> Matrix:
        """Q_ad / (EI/ℓ), n×1: report (2.18), Q_ad = −ℓ ∫ Φᵀ Bᵀ Λ dX."""
        if self.shape.rod.discretisation.transport == "permuted":
            return self._weighted_force()
        return self._transposed_force()

    @cached_property
    def efforts(self) -> tuple[tuple[Matrix, Conjugate], ...]:
        """Every effort of an actuator with the quantity that it works on, at this shape."""
        return tuple((a.effort, a.quantity.on(self.shape)) for a in self.actuation)

    @cached_property
    def actuation_force(self) -> Matrix | None:
        """ℓ ∫ Φᵀ Bᵀ Λ_ad dX / (EI/ℓ), n×1: what actuators put against the elastic stress, report (2.16)."""
        unit = self.shape.rod.energy_unit
        forces = [effort / unit * conjugate.gradient for effort, conjugate in self.efforts]
        return sum(forces[1:], forces[0]) if forces else None

    @cached_property
    def residual(self) -> Matrix:
        """(K_εε q + Q_ad) / (EI/ℓ), n×1: zero in equilibrium, report (2.20)."""
        passive = self._elastic(ca.sparsify(ca.DM(self.shape.rod.stiffness)) @ self.shape.q) + self.generalised_force
        return passive if self.actuation_force is None else passive + self.actuation_force

    @cached_property
    def energy(self) -> Matrix:
        """Elastic energy ½ qᵀ K_εε q, 1×1, J."""
        rod = self.shape.rod
        stored = ca.bilin(ca.sparsify(ca.DM(rod.stiffness)), self.shape.q, self.shape.q)
        return rod.energy_unit / 2 * self._elastic(stored)

    def _elastic(self, value: Matrix) -> Matrix:
        """A value in proportion to the stiffness: a longer rod is softer."""
        return value if self.shape.ratio is None else value / self.shape.ratio

    @cached_property
    def potential(self) -> Matrix | None:
        """Elastic energy less the work of loads and actuators, 1×1, J.

        None unless every load is a dead force or has an energy. With r = S t and n̂ = Sᵀ f the work of the dead forces
        is Σ n̂_k·t_k, so the residual is its exact gradient.
        """
        if any(w.follower or w.moment is not None for w in self.statics.fixed_wrenches):
            return None
        if any(load.energy is None for load in self.statics.pose_loads):
            return None
        covector = self.statics.fixed_force_covector
        total = self.energy
        if covector is not None:
            total = total - ca.dot(covector, self.shape.tangent)
        for load in self.statics.pose_loads:
            assert load.energy is not None
            total = total + load.energy
        for effort, conjugate in self.efforts:
            total = total + effort * conjugate.value
        return total

    def _transposed_force(self) -> Matrix:
        """Minus the derivative of the loads' virtual work, by the transpose of the forward sweep."""
        rod, moment = self.shape.rod, self.statics.interval_moment
        force: Matrix = ca.DM.zeros(rod.size, 1)
        if moment is not None and rod.properties.turning_axes:
            pulled = interval_kernels(rod).pull.map(moment.shape[1])(*self.shape.interval_arguments, moment)
            fold, half = rod.turn_factors
            force = force + (half / -rod.energy_unit).T @ (fold @ stack(pulled))
        return force + self._linear_force(self.statics.force_covector)

    def _linear_force(self, covector: Matrix | None) -> Matrix:
        """Generalised forces of shear and extension: −ℓ Φᵀ (d·n̂)."""
        rod = self.shape.rod
        parts: list[Matrix] = [ca.DM.zeros(rod.size - self._linear_size(), 1)]
        for c in rod.properties.admitted:
            if c < 3:
                continue
            if covector is None:
                parts.append(ca.DM.zeros(rod.at_nodes[c].shape[1], 1))
                continue
            share = dot(self.shape.directors[c - 3], covector).T
            fold, half = rod.node_factors(c)
            parts.append((half * (-rod.properties.length / rod.energy_unit)).T @ (fold @ share))
        return ca.vertcat(*parts)

    def _linear_size(self) -> int:
        rod = self.shape.rod
        return sum(rod.at_nodes[c].shape[1] for c in rod.properties.admitted if c >= 3)

    def _weighted_force(self) -> Matrix:
        """Literal quadrature of report (2.16), from the internal wrench at the nodes."""
        return -self._project(self.statics.internal_wrench())

    def _project(self, wrench: Matrix) -> Matrix:
        """ℓ ∫ Φᵀ Bᵀ Λ dX / (EI/ℓ) of a 6×M stress in the sections' frames, n×1."""
        rod = self.shape.rod
        factor = rod.properties.length / rod.energy_unit * rod.grid.weights
        return ca.vertcat(
            *[ca.DM(rod.at_nodes[c] * factor[:, None]).T @ wrench[c, :].T for c in rod.properties.admitted]
        )
