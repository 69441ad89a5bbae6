"""What a rod is made of, as numbers: the one record that the mechanics reads."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from numpy.polynomial import legendre

Array = npt.NDArray[np.float64]

STRAINS = ("bending_x", "bending_y", "torsion", "shear_x", "shear_y", "extension")
"""Names of the six strain components, in the order K_x, K_y, K_z, Γ_x, Γ_y, Γ_z."""


@dataclass(frozen=True)
class RodProperties:
    """A rod in its unloaded state.

    Attributes:
        name: the rod's name.
        length: undeformed length ℓ, m.
        admitted: indices of the admitted strains, ascending: the columns of B in report (2.1).
        basis: "legendre" or "chebyshev", the polynomials of report (2.4).
        hooke: abscissae (k,) ↦ diagonal of the Hooke tensor (k, 6), N m² and N; rows of strains that are not
            admitted are not read.
        intrinsic: ξ⁰ as six tuples of Legendre coefficients in 2X − 1: three of 1/m, three without unit.
        linear_density: abscissae (k,) ↦ mass per length (k,), kg/m; None where the rod has no mass.
        rotary_inertia: abscissae (k,) ↦ moments of inertia per length about section x, y and tangent (k, 3), kg m;
            None where the rod has none.
        damping: abscissae (k,) ↦ diagonal of the Kelvin–Voigt tensor Υ (k, 6), N m² s and N s, whose stress is Υ ξ̇;
            None where the rod has none. Rows of strains that are not admitted are not read.
        area: abscissae (k,) ↦ area of the sections (k,), m²; None where the rod is given by its stiffness.
        diameter: abscissae (k,) ↦ outer diameter of round sections (k,), m; None where they are not round or not known.
    """

    name: str
    length: float
    admitted: tuple[int, ...]
    basis: str
    hooke: Callable[[Array], Array]
    intrinsic: tuple[tuple[float, ...], ...]
    linear_density: Callable[[Array], Array] | None = None
    rotary_inertia: Callable[[Array], Array] | None = None
    damping: Callable[[Array], Array] | None = None
    area: Callable[[Array], Array] | None = None
    diameter: Callable[[Array], Array] | None = None

    def intrinsic_strain(self, X: Array) -> Array:
        """ξ⁰ at abscissae X, shape (len(X), 6)."""
        columns = []
        for coefficients in self.intrinsic:
            values = legendre.legval(2 * X - 1, np.asarray(coefficients))
            # A constant gives one number for all abscissae.
            columns.append(np.broadcast_to(values, X.shape))
        return np.stack(columns, axis=-1)

    @property
    def bending_stiffness(self) -> float:
        """EI that makes the model dimensionless, N m²: mean of the smallest bending or torsion stiffness.

        A rod that admits neither takes H ℓ² of its softest linear strain.
        """
        points, weights = legendre.leggauss(8)
        X = (points + 1) / 2
        mean = (weights / 2) @ self.hooke(X)
        angular = [mean[i] for i in self.admitted if i < 3]
        if angular:
            return float(min(angular))
        linear = [mean[i] * self.length**2 for i in self.admitted]
        return float(min(linear))

    @property
    def turning_axes(self) -> tuple[int, ...]:
        """Local axes about which the rod can turn along its length, unloaded or not."""
        axes = {i for i in self.admitted if i < 3}
        for i, coefficients in enumerate(self.intrinsic[:3]):
            if any(coefficients):
                axes.add(i)
        return tuple(sorted(axes))
