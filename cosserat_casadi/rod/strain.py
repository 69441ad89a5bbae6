"""Strain reduction: ξ = B (ξ_a⁰ + Φ q) + B̄ ξ_c, report (2.1)–(2.8), as constant matrices on the grid.

See docs/theory.md section 2.

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
from cosserat_casadi.maths.grid import Grid
from cosserat_casadi.maths.numbers import (
    Numbers,
    any_symbolic,
    as_matrix,
    as_vector,
    column,
    is_symbolic,
    is_zero,
    known,
    product,
    without_rounding,
)
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.rod.discretisation import Discretisation
from cosserat_casadi.rod.folded_matrix import FoldedMatrix, folded
from cosserat_casadi.rod.properties import RodProperties

Array = npt.NDArray[np.float64]

_POLYNOMIALS: dict[str, Callable[[int, Array], Array]] = {
    "legendre": chebyshev.legendre_polynomials,
    "chebyshev": chebyshev.chebyshev_polynomials,
}


Ratio: TypeAlias = Matrix | None
"""Length of a rod relative to the reference length, 1×1; None where it is 1 for good."""


def per_reference_length(value: Matrix, ratio: Ratio) -> Matrix:
    """What is per length of the rod, per reference length: nothing is added where the length is fixed."""
    if ratio is None:
        return value
    return value * ratio


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

    @property
    def length(self) -> float:
        """Undeformed length ℓ, m."""
        return self.properties.length

    @property
    def admitted(self) -> tuple[int, ...]:
        """Indices of the admitted strains, ascending."""
        return self.properties.admitted

    @property
    def angular(self) -> list[int]:
        """Admitted strains that are curvature or torsion: their coordinates come first in q."""
        return [c for c in self.admitted if c < 3]

    @property
    def linear(self) -> list[int]:
        """Admitted strains that are shear or extension."""
        return [c for c in self.admitted if c >= 3]

    def size_of(self, component: int) -> int:
        """Number of coordinates n_c of an admitted strain."""
        columns = self.columns[component]
        return int(columns.stop - columns.start)

    @cached_property
    def energy_unit(self) -> float:
        """EI/ℓ in joules: residuals and energies are divided by it."""
        return self.properties.bending_stiffness / self.length

    @cached_property
    def scales(self) -> tuple[float, ...]:
        """Strain that one unit of a coordinate stands for, per admitted component (1/m or none)."""
        mean = self.properties.mean_hooke
        unit = self.properties.bending_stiffness / self.length**2
        # A constant strain of this size stores EI/(2ℓ) in the rod.
        strains = [np.sqrt(unit / mean[c]) for c in self.admitted]
        return tuple(map(float, strains))

    @cached_property
    def columns(self) -> dict[int, slice]:
        """Coordinates of each admitted component in q: stacked component by component, then by element."""
        columns = {}
        start = 0
        for component, modes in zip(self.admitted, self.discretisation.modes, strict=True):
            end = start + modes * self.discretisation.elements
            columns[component] = slice(start, end)
            start = end
        return columns

    def shape_functions(self, component: int, X: Array, element: npt.NDArray[np.int64]) -> Array:
        """Φ_c at abscissae X seen from the given elements, report (2.4): shape (len(X), n_c)."""
        number = self.admitted.index(component)
        modes = self.discretisation.modes[number]
        polynomials = _POLYNOMIALS[self.properties.basis]
        breaks = np.asarray(self.discretisation.breaks)
        # The polynomials of an element are in its own coordinate, from 0 to 1.
        start = breaks[element]
        width = breaks[element + 1] - start
        values = self.scales[number] * polynomials(modes, (X - start) / width)
        # Every element has polynomials of its own, side by side.
        result = np.zeros((len(X), modes * self.discretisation.elements))
        for row, e in enumerate(element):
            own = slice(e * modes, (e + 1) * modes)
            result[row, own] = values[row]
        return result

    def degrees(self, component: int) -> npt.NDArray[np.int64]:
        """Degree of the polynomial of each coordinate of a component, shape (n_c,)."""
        number = self.admitted.index(component)
        degrees = np.arange(self.discretisation.modes[number])
        return np.tile(degrees, self.discretisation.elements)

    def parities(self, component: int) -> Array:
        """1 for a polynomial that is even about the middle of its element, −1 for an odd one, shape (n_c,)."""
        even = self.degrees(component) % 2 == 0
        return np.where(even, 1.0, -1.0)

    @cached_property
    def turn_matrix(self) -> FoldedMatrix:
        """Matrix from q to the Taylor coefficients of the turns of all intervals, stacked by components.

        The intervals of an element mirror each other: every mode enters the sum or the difference of two of them alone.
        """
        count = len(self.grid.left_ends)
        rows = [np.zeros((0, self.size))]
        mirror = [np.zeros(0, dtype=np.int64)]
        signs = [np.zeros(0)]
        for order, matrices in enumerate(self.taylor_matrices):
            for axis in self.properties.turning_axes:
                row = np.zeros((count, self.size))
                if axis in matrices:
                    row[:, self.columns[axis]] = matrices[axis]
                first_row = count * (len(rows) - 1)
                mirror.append(first_row + self.grid.mirrored_intervals)
                # The l-th Taylor coefficient takes the sign (−1)^l when the interval is turned round.
                signs.append(np.full(count, (-1.0) ** order))
                rows.append(row)
        if len(rows) == 1:
            return FoldedMatrix(ca.DM(0, 0), ca.DM(0, self.size))
        matrix = np.vstack(rows)
        parities = [self.parities(c) for c in self.columns]
        return folded(matrix, np.concatenate(mirror), np.concatenate(signs), np.concatenate(parities))

    @cached_property
    def at_nodes(self) -> dict[int, Array]:
        """Φ_c at the nodes, shape (M, n_c) for each admitted component c."""
        grid = self.grid
        element = np.repeat(np.arange(grid.elements), grid.intervals + 1)
        values = {}
        for c in self.admitted:
            values[c] = self.shape_functions(c, grid.nodes, element)
        return values

    @cached_property
    def node_lengths(self) -> Array:
        """Length of rod that each node stands for in sums, ℓ w, shape (M,), m."""
        return np.asarray(self.length * self.grid.weights)

    def node_matrix(self, component: int) -> FoldedMatrix:
        """Φ_c at the nodes, M×n_c: modes meet sums or differences of mirrored nodes."""
        signs = np.ones(self.grid.size)
        parities = self.parities(component)
        return folded(self.at_nodes[component], self.grid.mirrored_nodes, signs, parities)

    @cached_property
    def stiffness(self) -> Numbers:
        """K_εε = ℓ ∫ Φᵀ H_a Φ dX of report (2.14) divided by EI/ℓ, shape (n, n), without unit."""
        return self._section_matrix(self.properties.hooke)

    @cached_property
    def viscosity(self) -> Numbers:
        """ℓ ∫ Φᵀ Υ Φ dX divided by EI/ℓ, Υ the coefficients of damping, shape (n, n), s; zero without damping."""
        if self.properties.damping is None:
            return np.zeros((self.size, self.size))
        return self._section_matrix(self.properties.damping)

    def _section_matrix(self, diagonal: Callable[[Array], Numbers]) -> Numbers:
        """ℓ ∫ Φᵀ D Φ dX divided by EI/ℓ for coefficients D of the six strains, shape (n, n)."""
        points = [self._gauss_points(e) for e in range(self.grid.elements)]
        coefficients = [diagonal(X) for X, _ in points]
        if any_symbolic(coefficients):
            return self._symbolic_section_matrix(diagonal)
        result = np.zeros((self.size, self.size))
        for e, (X, weight) in enumerate(points):
            weighted = known(coefficients[e]) * weight[:, None]
            element = np.full(len(X), e)
            # Strains do not couple: the tensor is diagonal, and so are its blocks.
            for c, columns in self.columns.items():
                phi = self.shape_functions(c, X, element)
                result[columns, columns] += phi.T @ (weighted[:, [c]] * phi)
        return without_rounding(result)

    def _gauss_points(self, element: int) -> tuple[Array, Array]:
        """Abscissae of an element, shape (k,), and the weights ℓ w / (EI/ℓ) of a sum over them.

        Enough for the product of two polynomials with a section stiffness of degree four.
        """
        points, weights = legendre.leggauss(max(self.discretisation.modes) + 8)
        start, end = self.grid.breaks[element : element + 2]
        width = end - start
        X = start + width * (points + 1) / 2
        lengths = weights * width / 2 * self.length
        return X, lengths / self.energy_unit

    def _symbolic_section_matrix(self, diagonal: Callable[[Array], Numbers]) -> Matrix:
        """The same where the coefficients are expressions: its entries are linear in them."""
        points = [self._gauss_points(e) for e in range(self.grid.elements)]
        element = np.repeat(np.arange(self.grid.elements), [len(X) for X, _ in points])
        X = np.concatenate([X for X, _ in points])
        weights = np.concatenate([weight for _, weight in points])
        coefficients = as_matrix(diagonal(X))
        blocks = []
        for c in self.columns:
            phi = self.shape_functions(c, X, element)
            # One column a point: the product of two modes there, for every pair of modes.
            pairs = (phi[:, :, None] * phi[:, None, :] * weights[:, None, None]).reshape(len(X), -1).T
            own = column(coefficients, c)
            size = phi.shape[1]
            blocks.append(ca.reshape(product(pairs, own), size, size))
        return ca.diagcat(*blocks)

    @cached_property
    def stiffness_matrix(self) -> Matrix:
        """K_εε / (EI/ℓ), n×n, without its zeros."""
        stiffness = self.stiffness
        return stiffness if is_symbolic(stiffness) else ca.sparsify(as_matrix(stiffness))

    @cached_property
    def viscosity_matrix(self) -> Matrix:
        """The matrix of the viscosity, n×n, s, without its zeros."""
        viscosity = self.viscosity
        return viscosity if is_symbolic(viscosity) else ca.sparsify(as_matrix(viscosity))

    def at(self, q: Matrix, X: Array, ratio: Matrix | float = 1.0) -> Matrix:
        """Strain ξ at any abscissae, 6×k, report (2.1); a break is seen from the element it ends."""
        element = self.grid.element_of(X)
        intrinsic = self.properties.intrinsic_strain(X)
        rows = []
        for c in range(6):
            row = as_matrix(column(intrinsic, c)).T
            if c in self.columns:
                phi = ca.DM(self.shape_functions(c, X, element))
                strain = phi @ q[self.columns[c]]
                row = row + strain.T / ratio
            rows.append(row)
        return ca.vertcat(*rows)

    def strain_rows(self, q: Matrix, components: Sequence[int], ratio: Ratio = None) -> list[Matrix | None]:
        """Components of (ℓ/ℓ₀) ξ at the nodes as 1×M rows; None for a row that is zero whatever the load."""
        intrinsic = self.properties.intrinsic_strain(self.grid.nodes)
        # Strains that are neither admitted nor intrinsic stay zero, and cost nothing below.
        rows: list[Matrix | None] = []
        for c in components:
            row = None
            own = column(intrinsic, c)
            if not is_zero(own):
                row = per_reference_length(as_matrix(own).T, ratio)
            if c in self.columns:
                varying = (self.node_matrix(c) @ q[self.columns[c]]).T
                row = varying if row is None else row + varying
            rows.append(row)
        return rows

    @cached_property
    def magnus_order(self) -> int:
        """Order of the rotation integrator; a rod that turns about one axis needs no commutator."""
        return int(self.discretisation.transport.removeprefix("magnus"))

    @cached_property
    def taylor_matrices(self) -> list[dict[int, Array]]:
        """Matrices from q_c to the l-th Taylor coefficient of the turn of every interval, (intervals, n_c)."""
        orders = []
        for order, per_interval in enumerate(self._taylor(self._sampled_modes)):
            matrices = {}
            for c in self.angular:
                # A polynomial has no Taylor coefficient beyond its degree: what is there is rounding.
                within_degree = self.degrees(c) >= order
                matrices[c] = per_interval[:, self.columns[c]] * within_degree
            orders.append(matrices)
        return orders

    @cached_property
    def intrinsic_turn(self) -> Numbers:
        """Taylor coefficients of the unloaded turn of every interval, shape (size, intervals), rad.

        All turning axes of the first coefficient, then all of the next.
        """
        axes = list(self.properties.turning_axes)
        curvatures = self.properties.intrinsic[:3]
        if not any_symbolic(curvatures):
            return np.concatenate([taylor[:, axes].T for taylor in self.intrinsic_taylor])
        # The turn is linear in the Legendre coefficients.
        highest = max(map(len, curvatures)) - 1
        turns = self._taylor(lambda X, element: np.asarray(legendre.legvander(2 * X - 1, highest), dtype=float))
        rows = []
        for order, turn in enumerate(turns):
            for axis in axes:
                own = curvatures[axis]
                degrees = np.arange(len(own))
                # A polynomial has no Taylor coefficient beyond its degree: what is there is rounding.
                by_coefficient = turn[:, : len(own)] * (degrees >= order)
                rows.append(product(by_coefficient, as_vector(own)).T)
        return ca.vertcat(*rows)

    @cached_property
    def intrinsic_taylor(self) -> list[Array]:
        """Taylor coefficients of an unloaded turn that is known: one (intervals, 3) array for each l."""

        def curvature(X: Array, element: npt.NDArray[np.int64]) -> Array:
            return known(self.properties.intrinsic_curvature(X))

        return self._taylor(curvature)

    @cached_property
    def taylor_count(self) -> int:
        """Taylor coefficients read per interval: one where all turns share an axis."""
        if len(self.properties.turning_axes) < 2:
            return 1
        return magnus.coefficient_count(self.magnus_order)

    def _sampled_modes(self, X: Array, element: npt.NDArray[np.int64]) -> Array:
        samples = np.zeros((len(X), self.size))
        for c in self.angular:
            samples[:, self.columns[c]] = self.shape_functions(c, X, element)
        return samples

    def _taylor(self, field: Callable[[Array, npt.NDArray[np.int64]], Array]) -> list[Array]:
        """Taylor coefficients over every interval of ℓ h times a field sampled at Gauss points."""
        degree = max([*self.discretisation.modes, *map(len, self.properties.intrinsic)])
        # Enough Gauss points for the field's own polynomials, so that ∫ K is exact.
        points = max(self.taylor_count, degree // 2 + 1)
        tau, to_taylor = magnus.taylor_from_samples(self.taylor_count, points)
        left = self.grid.left_ends
        right = self.grid.right_ends
        width = right - left
        middle = (left + right) / 2
        X = middle[:, None] + width[:, None] * tau
        element = np.repeat(np.arange(self.grid.elements), self.grid.intervals * points)
        samples = field(X.ravel(), element)
        samples = samples.reshape(len(width), points, -1)
        # ∫ K ds over an interval: per X times ℓ, per interval times its width.
        lengths = self.length * width
        scaled = samples * lengths[:, None, None]
        return [np.einsum("p,ipn->in", row, scaled) for row in to_taylor]
