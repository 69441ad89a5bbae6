"""The unloaded rod as numbers or expressions of parameters: the one record that the mechanics reads."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.polynomial import legendre

from cosserat_casadi.maths.grid import gauss_legendre
from cosserat_casadi.maths.numbers import (
    Numbers,
    Scalar,
    any_symbolic,
    as_matrix,
    as_vector,
    is_symbolic,
    is_zero,
    known,
    legendre_table,
    side_by_side,
)
from cosserat_casadi.maths.typing import FloatArray, Matrix

STRAINS = ("bending_x", "bending_y", "torsion", "shear_x", "shear_y", "extension")
"""Names of the six strain components, in the order K_x, K_y, K_z, Γ_x, Γ_y, Γ_z."""


Field = Callable[[Numbers], Numbers]
"""A field along the rod: abscissae (k,) ↦ its values there."""


@dataclass(frozen=True)
class EnergyBeyondHooke:
    """Elastic energy of a section beyond its Hooke tensor's: the law of a nonlinear material.

    Attributes:
        density: change of the strains ξ − ξ⁰, 6×1, and data, d×1 ↦ energy per length, 1×1, J/m; energy and gradient are
            zero at zero change.
        data: abscissae (k,) ↦ numbers that the density depends on (k, d), a row for each abscissa.
        margin: these arguments ↦ 1×1, negative outside of the law; None for a law without limits.
    """

    density: Callable[[Matrix, Matrix], Matrix]
    data: Field
    margin: Callable[[Matrix, Matrix], Matrix] | None = None


@dataclass(frozen=True)
class FixedMass:
    """A mass that is fixed to a section, centred on it and rotationally symmetric about the tangent.

    Attributes:
        at: abscissa X of the section, an element end of the rod's grid.
        mass: kg.
        across: second moment ∫ρ x² dV along every axis in the section, kg m².
        along: second moment along the tangent, kg m².
    """

    at: Scalar
    mass: Scalar
    across: Scalar
    along: Scalar


@dataclass(frozen=True)
class MaxwellBranch:
    """A spring and a dashpot in series, in parallel with the elasticity of a rod.

    Attributes:
        shares: stiffness of the spring over the instantaneous stiffness of the rod, for each of the six strains.
        time: relaxation time, s.
    """

    shares: tuple[Scalar, ...]
    time: Scalar


@dataclass(frozen=True)
class RodProperties:
    """A rod in its unloaded state.

    The fields along the rod are functions of abscissae, which are numbers, or expressions if elements move. They
    are arrays, or expressions of parameters with one row for each abscissa; a field that is the same all along the rod
    may give one row for all.

    Attributes:
        name: the rod's name.
        length: undeformed length ℓ that scales the equations, m.
        admitted: indices of the admitted strains, ascending: the columns of B in report (2.1).
        basis: "legendre" or "chebyshev", the polynomials of report (2.4).
        hooke: abscissae (k,) ↦ diagonal of the Hooke tensor (k, 6), N m² and N; rows of strains that are not
            admitted are not read.
        beyond_hooke: elastic energy beyond the Hooke tensor's; None for a linear rod.
        intrinsic: ξ⁰ as six tuples of Legendre coefficients in 2X − 1: three of 1/m, three without unit.
        linear_density: abscissae (k,) ↦ mass per length (k,), kg/m; None for a rod without mass.
        rotary_inertia: abscissae (k,) ↦ moments of inertia per length about section x, y and tangent (k, 3), kg m;
            None where the rod has none.
        damping: abscissae (k,) ↦ diagonal of the Kelvin–Voigt tensor Υ (k, 6), N m² s and N s, whose stress is Υ ξ̇;
            None where the rod has none. Rows of strains that are not admitted are not read.
        branches: Maxwell branches, by which its stress relaxes.
        mass_damping: α of forces −α times the momentum of the sections, 1/s; None without such damping.
        area: abscissae (k,) ↦ area of the sections (k,), m²; None for a rod that is given by its stiffness.
        diameter: abscissae (k,) ↦ outer diameter of round sections (k,), m; None for other or unknown sections.
        plane_sections: whether rotary inertia belongs to plane sections: the polar moment is the sum of the other two.
        ratio: length of the rod relative to ``length``, 1×1; None if it is always 1.
        nominal: the rod with the numbers that scale the equations; None if it is this record.
        fixed_masses: masses that are fixed to sections.
        largest_unit: upper bound on the EI that scales the equations, N m²; finite for a rod far stiffer than others.
    """

    name: str
    length: float
    admitted: tuple[int, ...]
    basis: str
    hooke: Field
    intrinsic: tuple[tuple[Scalar, ...], ...]
    beyond_hooke: EnergyBeyondHooke | None = None
    linear_density: Field | None = None
    rotary_inertia: Field | None = None
    damping: Field | None = None
    branches: tuple[MaxwellBranch, ...] = ()
    mass_damping: Scalar | None = None
    area: Field | None = None
    diameter: Field | None = None
    plane_sections: bool = False
    ratio: Matrix | None = None
    nominal: RodProperties | None = None
    fixed_masses: tuple[FixedMass, ...] = ()
    largest_unit: float = np.inf

    def intrinsic_strain(self, X: Numbers) -> Numbers:
        """ξ⁰ at abscissae X, shape (len(X), 6)."""
        return self._along(self.intrinsic, X)

    def intrinsic_curvature(self, X: Numbers) -> Numbers:
        """The three angular components of ξ⁰ at abscissae X, shape (len(X), 3), 1/m."""
        return self._along(self.intrinsic[:3], X)

    @staticmethod
    def _along(components: tuple[tuple[Scalar, ...], ...], X: Numbers) -> Numbers:
        """Values of Legendre series at abscissae, one column for each component."""
        count = X.shape[0]
        columns: list[Numbers] = []
        for coefficients in components:
            if len(coefficients) == 1 and not any_symbolic(coefficients):
                # A constant series gives one number for all abscissae.
                columns.append(np.full(count, coefficients[0]))
            elif any_symbolic(coefficients) or is_symbolic(X):
                columns.append(as_matrix(legendre_table(len(coefficients), X)) @ as_matrix(as_vector(coefficients)))
            else:
                columns.append(np.asarray(legendre.legval(2 * known(X) - 1, np.asarray(coefficients))))
        return side_by_side(columns)

    @cached_property
    def mean_hooke(self) -> FloatArray:
        """Mean of the Hooke tensor's diagonal along the rod that scales the equations, shape (6,)."""
        if self.nominal is not None:
            return self.nominal.mean_hooke
        points, weights = gauss_legendre(8)
        X = (points + 1) / 2
        return np.asarray((weights / 2) @ known(self.hooke(X)))

    @cached_property
    def bending_stiffness(self) -> float:
        """EI that makes the model dimensionless, N m²: mean of the smallest bending or torsion stiffness.

        A rod that admits neither takes H ℓ² of its softest linear strain. A rod that is far stiffer than another one of
        its scene takes at most :attr:`largest_unit`.
        """
        mean = self.mean_hooke
        angular = [mean[i] for i in self.admitted if i < 3]
        linear = [mean[i] * self.length**2 for i in self.admitted]
        scaling = self.nominal or self
        return float(min(*(angular or linear), scaling.largest_unit))

    @cached_property
    def turning_axes(self) -> tuple[int, ...]:
        """Local axes about which the rod turns along its length, by admitted or intrinsic curvature."""
        axes = {i for i in self.admitted if i < 3}
        for i, coefficients in enumerate(self.intrinsic[:3]):
            if not is_zero(coefficients):
                axes.add(i)
        return tuple(sorted(axes))
