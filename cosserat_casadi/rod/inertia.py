"""Inertia of a rod: the wrench of inertia on its sections, its kinetic energy and its momentum.

The discrete kinetic energy is T = ½ Σ ℓ w (ρA ṙ·ṙ + Σ c_k ḋ_k·ḋ_k) over the nodes: the mass of each section in its
centre, and its second moments c_k = ∫ρ x_k² dA along the directors d_k. Rotary inertia about the axes of the section is
J_1 = c_2 + c_3 and so on; a plane section has c_3 = 0. So inertia is the force −ρA r̈ and the moment −Σ c_k d_k × d̈_k,
which enter the backward sweep as any load does, and accelerations alone are needed: no Coriolis term is written.
See docs/theory.md, section 11.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import casadi as ca
import numpy as np

from cosserat_casadi.maths.numbers import (
    Numbers,
    Scalar,
    any_symbolic,
    as_matrix,
    column,
    is_symbolic,
    is_zero,
    known,
    repeated,
    row_times,
)
from cosserat_casadi.maths.rotation import cross
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.rod.properties import FixedMass, RodProperties
from cosserat_casadi.rod.rod_motion import RodMotion
from cosserat_casadi.rod.strain import DiscreteRod, Ratio
from cosserat_casadi.rod.wrenches import LineWrench


def second_moments(rotary_inertia: Numbers) -> Numbers:
    """Second moments c_k along the section's axes from the inertia about them, shape (k, 3) each, kg m.

    c_1 = (J_2 + J_3 − J_1)/2, and cyclically.
    """
    if is_symbolic(rotary_inertia):
        half_sum = ca.sum2(rotary_inertia) / 2
        return ca.repmat(half_sum, 1, 3) - rotary_inertia
    about_axes = known(rotary_inertia)
    half_sum = about_axes.sum(axis=1, keepdims=True) / 2
    return np.asarray(half_sum - about_axes)


@dataclass(frozen=True)
class SectionMasses:
    """Masses and second moments of the nodes, for one reference length of rod.

    Attributes:
        mass: ρA at the nodes, shape (M,), kg/m.
        second_moments: c_k at the nodes for those directors k that have any, shape (M,) each, kg m.
    """

    mass: Numbers
    second_moments: dict[int, Numbers]


def rod_mass(rod: DiscreteRod) -> float:
    """Mass of a rod, kg; 0 for a rod without mass."""
    masses = section_masses(rod)
    return 0.0 if masses is None else float(known(rod.node_lengths) @ known(masses.mass))


def section_masses(rod: DiscreteRod, ratio: Ratio = None) -> SectionMasses | None:
    """Mass and second moments of a rod's sections and of masses fixed to them; None without any mass.

    In sums over the nodes, a mass that is fixed to a node is a mass per length over the length of the node.

    Args:
        rod: the rod.
        ratio: length of the rod relative to the reference length; None if it is fixed.
    """
    masses = masses_along(rod)
    for fixed in rod.properties.fixed_masses:
        mass = np.zeros(rod.grid.size) if masses is None else masses.mass
        moments = {} if masses is None else dict(masses.second_moments)
        masses = SectionMasses(_with_fixed(mass, fixed.mass, fixed, rod, ratio), moments)
        for axis, moment in ((0, fixed.across), (1, fixed.across), (2, fixed.along)):
            if not is_zero(moment):
                before = moments.get(axis, np.zeros(rod.grid.size))
                moments[axis] = _with_fixed(before, moment, fixed, rod, ratio)
    return masses


def _with_fixed(masses: Numbers, added: Scalar, fixed: FixedMass, rod: DiscreteRod, ratio: Ratio) -> Numbers:
    """Masses per length of the nodes plus a mass that is fixed to a section."""
    node = rod.grid.node_at(fixed.at)
    length = rod.node_lengths[node] if ratio is None else rod.node_lengths[node] * ratio
    density = added / length
    if not any_symbolic([masses, density]):
        return np.asarray(known(masses) + np.asarray(density) * np.eye(rod.grid.size)[node])
    at_node = ca.DM(ca.Sparsity.triplet(rod.grid.size, 1, [node], [0]), 1.0)
    return as_matrix(masses) + at_node * density


def masses_along(rod: DiscreteRod) -> SectionMasses | None:
    """Mass and second moments of a rod's sections alone; None where the rod has no mass."""
    properties = rod.properties
    if properties.linear_density is None:
        return None
    X = rod.grid.nodes
    mass = repeated(properties.linear_density(X), X.shape[0])
    if properties.rotary_inertia is None:
        return SectionMasses(mass, {})
    along_axes = second_moments(properties.rotary_inertia(X))
    moments = {}
    for axis in _axes_with_moment(properties, along_axes):
        moments[axis] = repeated(column(along_axes, axis), X.shape[0])
    return SectionMasses(mass, moments)


def _axes_with_moment(properties: RodProperties, along_axes: Numbers) -> list[int]:
    """Axes along which sections have a second moment."""
    if is_symbolic(along_axes):
        # A plane section has a zero moment along the tangent, J_x + J_y − J_z.
        return [0, 1] if properties.plane_sections else [0, 1, 2]
    sizes = np.abs(known(along_axes))
    # In a plane section it is zero by cancellation.
    return [axis for axis in range(3) if np.any(sizes[:, axis] > 1e-12 * sizes.max())]


@dataclass(frozen=True)
class RodInertia:
    """Inertia of a rod in motion, in the axes of its base.

    Attributes:
        motion: motion of its sections.
        masses: masses and second moments at the nodes.
    """

    motion: RodMotion
    masses: SectionMasses

    @property
    def ratio(self) -> Matrix | float:
        """Length of the rod relative to the reference length: a longer rod has more mass."""
        ratio = self.motion.shape.ratio
        return 1.0 if ratio is None else ratio

    @cached_property
    def wrench(self) -> LineWrench:
        """Force −ρA r̈ and moment −Σ c_k d_k × d̈_k per reference length at the nodes."""
        force = self._scaled(self.motion.acceleration, -self.masses.mass)
        moment = None
        for axis, second_moment in self.masses.second_moments.items():
            director = self.motion.shape.directors[axis]
            turning = cross(director, self.motion.director_acceleration(axis))
            term = self._scaled(turning, -second_moment)
            moment = term if moment is None else moment + term
        return LineWrench(force, moment, None, follower=False)

    @cached_property
    def kinetic_energy(self) -> Matrix:
        """Kinetic energy in the world, 1×1, J."""
        total = self._sum(ca.sum1(self.motion.velocity**2), self.masses.mass)
        for axis, second_moment in self.masses.second_moments.items():
            squares = ca.sum1(self.motion.director_rate(axis) ** 2)
            total = total + self._sum(squares, second_moment)
        return total / 2

    @cached_property
    def linear_momentum(self) -> Matrix:
        """Momentum Σ ρA ṙ, 3×1, N s, base axes."""
        return self._sum(self.motion.velocity, self.masses.mass)

    @cached_property
    def angular_momentum(self) -> Matrix:
        """Angular momentum about the base, 3×1, N m s, base axes: Σ ρA r × ṙ + c_k d_k × ḋ_k."""
        about_base = cross(self.motion.shape.position, self.motion.velocity)
        total = self._sum(about_base, self.masses.mass)
        for axis, second_moment in self.masses.second_moments.items():
            director = self.motion.shape.directors[axis]
            spin = cross(director, self.motion.director_rate(axis))
            total = total + self._sum(spin, second_moment)
        return total

    def _scaled(self, vectors: Matrix, factors: Numbers) -> Matrix:
        """Vectors of the nodes times the factors of the nodes and the ratio of the lengths, 3×M."""
        return self.ratio * (vectors @ ca.diag(as_matrix(factors)))

    def _sum(self, values: Matrix, factors: Numbers) -> Matrix:
        """Sum over the rod of values at the nodes, m×M, times factors per length, m×1."""
        lengths = self.motion.rod.node_lengths
        return self.ratio * (values @ as_matrix(row_times(lengths, factors)))
