"""Strain reduction: ξ = B (ξ_a⁰ + Φ q) + B̄ ξ_c, report (2.1)–(2.8), as constant matrices on the grid.

A rod whose length ℓ is drawn out of a reference length ℓ₀ by a ratio ℓ/ℓ₀ is written in the strain per reference length
(ℓ/ℓ₀) ξ: coordinates and constant matrices stay those of ℓ₀, the intrinsic strain takes the ratio, and the stiffness
its inverse.

The coordinates q are without unit. Φ carries a strain scale of its own for every component, √(EI/(ℓ² H)), so that
the stiffness matrix divided by EI/ℓ has entries of order one whatever the slenderness: a rod with EA ℓ²/EI = 1e8
is as well conditioned as one with 1e2.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TypeAlias

import casadi as ca
import numpy as np
import numpy.typing as npt
from numpy.polynomial import legendre

from cosserat_casadi.maths import chebyshev, magnus
from cosserat_casadi.maths.blocks import mirror_factors
from cosserat_casadi.maths.grid import Grid
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.rod.discretisation import Discretisation
from cosserat_casadi.rod.properties import RodProperties

Array = npt.NDArray[np.float64]

_POLYNOMIALS: dict[str, Callable[[int, Array], Array]] = {
    "legendre": chebyshev.legendre_polynomials,
    "chebyshev": chebyshev.chebyshev_polynomials,
}


Ratio: TypeAlias = Matrix | None
"""Length of a rod relative to the reference length, 1×1; None where it is 1 for good."""


def drawn(value: Matrix, ratio: Ratio) -> Matrix:
    """A value times the ratio of lengths; nothing is added where the length is fixed."""
    return value if ratio is None else value * ratio


@dataclass(frozen=True)
class DiscreteRod:
    """The constant matrices that turn strain coordinates into strains.

    Attributes:
        properties: what the rod is made of.
        discretisation: polynomials and grid.
    """

    properties: RodProperties
    discretisation: Discretisation

    @cached_property
    def grid(self) -> Grid:
        """The nodes of the rod."""
        return self.discretisation.grid

    @property
    def size(self) -> int:
        """Number of strain coordinates n."""
        return self.discretisation.unknowns

    @cached_property
    def energy_unit(self) -> float:
        """EI/ℓ in joules: residuals and energies are divided by it."""
        return self.properties.bending_stiffness / self.properties.length

    @cached_property
    def scales(self) -> tuple[float, ...]:
        """Strain that one unit of a coordinate stands for, per admitted component (1/m or none)."""
        x, weights = legendre.leggauss(8)
        mean = (weights / 2) @ self.properties.hooke((x + 1) / 2)
        unit = self.properties.bending_stiffness / self.properties.length**2
        return tuple(float(np.sqrt(unit / mean[i])) for i in self.properties.admitted)

    @cached_property
    def columns(self) -> dict[int, slice]:
        """Coordinates of each admitted component in q: stacked component by component, then by element."""
        counts = [modes * self.discretisation.elements for modes in self.discretisation.modes]
        ends = np.cumsum([0, *counts])
        return {c: slice(int(a), int(b)) for c, a, b in zip(self.properties.admitted, ends, ends[1:], strict=False)}

    def shape_functions(self, component: int, X: Array, element: npt.NDArray[np.int64]) -> Array:
        """Φ_c at abscissae X seen from the given elements, report (2.4): shape (len(X), n_c)."""
        place = self.properties.admitted.index(component)
        modes = self.discretisation.modes[place]
        polynomials = _POLYNOMIALS[self.properties.basis]
        breaks = np.asarray(self.discretisation.breaks)
        local = (X - breaks[element]) / (breaks[element + 1] - breaks[element])
        values = self.scales[place] * polynomials(modes, local)
        result = np.zeros((len(X), modes * self.discretisation.elements))
        for row, e in enumerate(element):
            result[row, e * modes : (e + 1) * modes] = values[row]
        return result

    def degrees(self, component: int) -> npt.NDArray[np.int64]:
        """Degree of the polynomial of each coordinate of a component, shape (n_c,)."""
        modes = self.discretisation.modes[self.properties.admitted.index(component)]
        return np.tile(np.arange(modes), self.discretisation.elements)

    def parities(self, component: int) -> Array:
        """1 for a polynomial that is even about the middle of its element, −1 for an odd one, shape (n_c,)."""
        return np.where(self.degrees(component) % 2 == 0, 1.0, -1.0)

    @cached_property
    def turn_factors(self) -> tuple[ca.DM, ca.DM]:
        """Factors (fold, half) of the matrix foldᵀ half from q to the turns of all intervals, stacked by components.

        Polynomials are even or odd about the middle of an element, and so are the intervals of its grid: every mode
        enters the sum or the difference of two mirrored intervals alone.
        """
        count, axes = len(self.grid.left_ends), self.properties.turning_axes
        rows, mirror, signs = [np.zeros((0, self.size))], [], []
        for order, matrices in enumerate(self.taylor_matrices):
            for axis in axes:
                row = np.zeros((count, self.size))
                if axis in matrices:
                    row[:, self.columns[axis]] = matrices[axis]
                mirror.append(count * len(rows[1:]) + self.grid.mirrored_intervals)
                signs.append(np.full(count, (-1.0) ** order))
                rows.append(row)
        if not mirror:
            return ca.DM(0, 0), ca.DM(0, self.size)
        parities = np.concatenate([self.parities(c) for c in self.columns])
        return mirror_factors(np.vstack(rows), np.concatenate(mirror), np.concatenate(signs), parities)

    @cached_property
    def at_nodes(self) -> dict[int, Array]:
        """Φ_c at the nodes, shape (M, n_c) for each admitted component c."""
        element = np.repeat(np.arange(self.grid.elements), self.grid.intervals + 1)
        return {c: self.shape_functions(c, self.grid.nodes, element) for c in self.properties.admitted}

    def node_factors(self, component: int) -> tuple[ca.DM, ca.DM]:
        """Factors (fold, half) of Φ_c at the nodes, foldᵀ half: modes meet sums or differences of mirrored nodes."""
        signs = np.ones(self.grid.size)
        return mirror_factors(self.at_nodes[component], self.grid.mirrored_nodes, signs, self.parities(component))

    @cached_property
    def stiffness(self) -> Array:
        """K_εε = ℓ ∫ Φᵀ H_a Φ dX of report (2.14) divided by EI/ℓ, shape (n, n), without unit.

        Gauss points enough for the product of two polynomials with a section stiffness of degree four.
        """
        x, weights = legendre.leggauss(max(self.discretisation.modes) + 8)
        matrix = np.zeros((self.size, self.size))
        for e in range(self.grid.elements):
            a, b = self.grid.breaks[e : e + 2]
            X = a + (b - a) * (x + 1) / 2
            hooke = (
                self.properties.hooke(X) * (weights * (b - a) / 2 * self.properties.length / self.energy_unit)[:, None]
            )
            for c, columns in self.columns.items():
                phi = self.shape_functions(c, X, np.full(len(X), e))
                matrix[columns, columns] += phi.T @ (hooke[:, [c]] * phi)
        matrix[np.abs(matrix) < 1e-15 * np.abs(matrix).max()] = 0.0
        return matrix

    def at(self, q: Matrix, X: Array, ratio: Matrix | float = 1.0) -> Matrix:
        """Strain ξ at any abscissae, 6×k, report (2.1); a break is seen from the element it ends."""
        element = self.grid.element_of(X)
        intrinsic = self.properties.intrinsic_strain(X)
        rows = []
        for c in range(6):
            row = ca.DM(intrinsic[:, c]).T
            if c in self.columns:
                row = row + (ca.DM(self.shape_functions(c, X, element)) @ q[self.columns[c]]).T / ratio
            rows.append(row)
        return ca.vertcat(*rows)

    def strain_rows(self, q: Matrix, components: Sequence[int], ratio: Ratio = None) -> list[Matrix | None]:
        """Components of (ℓ/ℓ₀) ξ at the nodes as 1×M rows; None for a row that is zero whatever the load."""
        intrinsic = self.properties.intrinsic_strain(self.grid.nodes)
        rows: list[Matrix | None] = []
        for c in components:
            row = drawn(ca.DM(intrinsic[:, c]).T, ratio) if np.any(intrinsic[:, c]) else None
            if c in self.columns:
                fold, half = self.node_factors(c)
                moving = (fold.T @ (half @ q[self.columns[c]])).T
                row = moving if row is None else row + moving
            rows.append(row)
        return rows

    @cached_property
    def magnus_order(self) -> int:
        """Order of the rotation integrator; a rod that turns about one axis needs no commutator."""
        return int(self.discretisation.transport.removeprefix("magnus"))

    @cached_property
    def taylor_matrices(self) -> list[dict[int, Array]]:
        """Matrices from q_c to the l-th Taylor coefficient of the turn of every interval, (intervals, n_c)."""
        return [
            {c: per_interval[:, self.columns[c]] * (self.degrees(c) >= order) for c in self.columns if c < 3}
            for order, per_interval in enumerate(self._taylor(self._sampled_modes))
        ]

    @cached_property
    def intrinsic_taylor(self) -> list[Array]:
        """Taylor coefficients of the unloaded turn of every interval: one (intervals, 3) array for each l."""
        return self._taylor(lambda X, element: self.properties.intrinsic_strain(X)[:, :3])

    @cached_property
    def taylor_count(self) -> int:
        """Taylor coefficients read per interval: one where all turns share an axis."""
        return 1 if len(self.properties.turning_axes) < 2 else magnus.coefficient_count(self.magnus_order)

    def _sampled_modes(self, X: Array, element: npt.NDArray[np.int64]) -> Array:
        samples = np.zeros((len(X), self.size))
        for c in self.columns:
            if c < 3:
                samples[:, self.columns[c]] = self.shape_functions(c, X, element)
        return samples

    def _taylor(self, field: Callable[[Array, npt.NDArray[np.int64]], Array]) -> list[Array]:
        """Taylor coefficients over every interval of ℓ h times a field sampled at Gauss points."""
        degree = max([*self.discretisation.modes, *map(len, self.properties.intrinsic)])
        points = max(self.taylor_count, degree // 2 + 1)
        tau, to_taylor = magnus.taylor_from_samples(self.taylor_count, points)
        width = self.grid.right_ends - self.grid.left_ends
        X = (self.grid.left_ends + self.grid.right_ends)[:, None] / 2 + width[:, None] * tau
        element = np.repeat(np.arange(self.grid.elements), self.grid.intervals * points)
        samples = field(X.ravel(), element).reshape(len(width), points, -1)
        scaled = samples * (self.properties.length * width)[:, None, None]
        return [np.einsum("p,ipn->in", row, scaled) for row in to_taylor]
