"""Strain reduction: ξ = B (ξ_a⁰ + Φ q) + B̄ ξ_c, report (2.1)–(2.8), as constant matrices on the grid.

See docs/theory.md section 2.

A rod of length ℓ, drawn out from a reference length ℓ₀, is written in the strain per reference length (ℓ/ℓ₀) ξ:
coordinates and constant matrices stay those of ℓ₀, the intrinsic strain is multiplied by the ratio ℓ/ℓ₀, and the
stiffness divided by it. An element with ends moved off the grid is drawn out in this way too, by its own rate.

The coordinates q are dimensionless. Φ has one strain scale for each component, √(EI/(ℓ² H)), so that the stiffness
matrix divided by EI/ℓ has entries of order one for every slenderness: a rod with EA ℓ²/EI = 1e8 is as well
conditioned as one with 1e2.

Stiffness and viscosity in these coordinates are sums over Gauss points of the elements, report (2.14). An element that
is drawn out by its rate m has the strain Φ q / m along m times its nominal length: its coefficients are divided by m.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TypeAlias

import casadi as ca
import numpy as np
from numpy.polynomial import legendre

from cosserat_casadi.maths import chebyshev, magnus
from cosserat_casadi.maths.grid import Grid, Indices, gauss_legendre
from cosserat_casadi.maths.numbers import (
    Numbers,
    Scalar,
    any_symbolic,
    as_matrix,
    as_vector,
    column,
    each_times,
    is_symbolic,
    is_zero,
    known,
    legendre_table,
    product,
    reciprocal,
    repeated,
    without_rounding,
)
from cosserat_casadi.maths.typing import FloatArray, Matrix
from cosserat_casadi.rod.discretisation import Discretisation
from cosserat_casadi.rod.folded_matrix import FoldedAxes, FoldedMatrix, folded
from cosserat_casadi.rod.properties import Field, RodProperties

NOISE = 1e-14
"""Share of the largest entry of a section matrix below which an entry is zero: sums over Gauss points leave so much."""

_POLYNOMIALS: dict[str, Callable[[int, FloatArray], FloatArray]] = {
    "legendre": chebyshev.legendre_polynomials,
    "chebyshev": chebyshev.chebyshev_polynomials,
}


Ratio: TypeAlias = Matrix | None
"""Length of a rod relative to the reference length, 1×1; None if it is always 1."""


def per_reference_length(value: Matrix, ratio: Ratio) -> Matrix:
    """A density per length of the rod as a density per reference length; unchanged for a fixed length."""
    return value if ratio is None else value * ratio


@dataclass(frozen=True)
class DiscreteRod:
    """The constant matrices that turn strain coordinates into strains.

    Attributes:
        properties: the unloaded rod.
        discretisation: polynomials and grid.
        ends: abscissae of the element ends, numbers or expressions; None for the ends of the discretisation.
    """

    properties: RodProperties
    discretisation: Discretisation
    ends: tuple[Scalar, ...] | None = None

    @cached_property
    def grid(self) -> Grid:
        """The nodes of the rod."""
        return replace(self.discretisation.grid, ends=self.ends)

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
        """Strain by a unit of a coordinate, for each admitted component, 1/m or dimensionless."""
        mean = self.properties.mean_hooke
        unit = self.properties.bending_stiffness / self.length**2
        # A constant strain of this size stores EI/(2ℓ) in the rod.
        strains = [np.sqrt(unit / mean[c]) for c in self.admitted]
        return tuple(map(float, strains))

    @cached_property
    def columns(self) -> dict[int, slice]:
        """Slice of each admitted component in q, which is stacked component by component, then by element."""
        columns = {}
        start = 0
        for component, modes in zip(self.admitted, self.discretisation.modes, strict=True):
            end = start + modes * self.discretisation.elements
            columns[component] = slice(start, end)
            start = end
        return columns

    def shape_functions(self, component: int, X: FloatArray, element: Indices) -> FloatArray:
        """Φ_c at places X of the grid's coordinate, seen from the given elements, report (2.4): shape (len(X), n_c)."""
        number = self.admitted.index(component)
        modes = self.discretisation.modes[number]
        polynomials = _POLYNOMIALS[self.properties.basis]
        breaks = np.asarray(self.discretisation.breaks)
        # The polynomials of an element are in its own coordinate, from 0 to 1.
        start = breaks[element]
        width = breaks[element + 1] - start
        values = self.scales[number] * polynomials(modes, (X - start) / width)
        # The polynomials of the elements stand side by side.
        result = np.zeros((len(X), modes * self.discretisation.elements))
        for row, e in enumerate(element):
            own = slice(e * modes, (e + 1) * modes)
            result[row, own] = values[row]
        return result

    def degrees(self, component: int) -> Indices:
        """Degree of the polynomial of each coordinate of a component, shape (n_c,)."""
        number = self.admitted.index(component)
        degrees = np.arange(self.discretisation.modes[number])
        return np.tile(degrees, self.discretisation.elements)

    def parities(self, component: int) -> FloatArray:
        """1 for a polynomial that is even about the middle of its element, −1 for an odd one, shape (n_c,)."""
        even = self.degrees(component) % 2 == 0
        return np.where(even, 1.0, -1.0)

    @cached_property
    def turn_matrix(self) -> FoldedMatrix:
        """Matrix from q to the Taylor coefficients of the turns of all intervals, stacked by components."""
        return self.turn_axes.joined(self.size)

    @cached_property
    def turn_axes(self) -> FoldedAxes:
        """Matrices from the coordinates of each turning axis to the Taylor coefficients of the turns about it.

        The intervals of an element are mirror images: every mode enters only the sum or the difference of two mirrored
        intervals.
        """
        orders = len(self.taylor_matrices)
        count = len(self.grid.left_ends)
        mirror = np.concatenate([count * order + self.grid.mirrored_intervals for order in range(orders)])
        # The l-th Taylor coefficient takes the sign (−1)^l when the interval is turned round.
        signs = np.repeat((-1.0) ** np.arange(orders), count)
        matrices = []
        for axis in self.properties.turning_axes:
            none = np.zeros((count, self.size_of(axis) if axis in self.columns else 0))
            rows = np.vstack([matrices_of_order.get(axis, none) for matrices_of_order in self.taylor_matrices])
            parities = self.parities(axis) if axis in self.columns else np.zeros(0)
            matrices.append(folded(rows, mirror, signs, parities))
        return FoldedAxes(matrices, orders)

    @cached_property
    def at_nodes(self) -> dict[int, FloatArray]:
        """Φ_c at the nodes, shape (M, n_c) for each admitted component c."""
        grid = self.grid
        values = {}
        for c in self.admitted:
            values[c] = self.shape_functions(c, grid.reference_nodes, grid.element_of_node)
        return values

    @cached_property
    def reference_lengths(self) -> FloatArray:
        """Weight ℓ w of each node in sums over the grid's coordinate, to which strains refer, shape (M,), m."""
        return np.asarray(self.length * self.grid.weights)

    @cached_property
    def node_lengths(self) -> Numbers:
        """Length of rod that each node represents in sums, shape (M,), m."""
        return each_times(self.reference_lengths, self.node_rates)

    @cached_property
    def node_rates(self) -> Numbers | None:
        """Derivative of the rod's abscissa by the grid's coordinate at the nodes, shape (M,); None if it is one."""
        return self.grid.rates_in(self.grid.element_of_node)

    def strain_of(self, component: int, X: FloatArray) -> FloatArray:
        """Strain by each coordinate of a component at abscissae of a rod whose elements have known ends, (len(X), n_c).

        A break belongs to the element that it ends.
        """
        element = self.grid.element_of(X)
        per_reference = self.shape_functions(component, self.grid.in_coordinate(X, element), element)
        return known(each_times(per_reference, reciprocal(self.grid.rates_in(element))))

    @cached_property
    def node_matrices(self) -> dict[int, FoldedMatrix]:
        """Φ_c at the nodes, M×n_c for each admitted component c, folded: modes are even or odd."""
        signs = np.ones(self.grid.size)
        matrices = {}
        for c, values in self.at_nodes.items():
            matrices[c] = folded(values, self.grid.mirrored_nodes, signs, self.parities(c))
        return matrices

    @cached_property
    def stiffness(self) -> Numbers:
        """K_εε = ℓ ∫ Φᵀ H_a Φ dX of report (2.14) divided by EI/ℓ, shape (n, n), without unit."""
        return section_matrix(self, self.properties.hooke)

    @cached_property
    def viscosity(self) -> Numbers:
        """ℓ ∫ Φᵀ Υ Φ dX divided by EI/ℓ, Υ the coefficients of damping, shape (n, n), s; zero without damping."""
        if self.properties.damping is None:
            return np.zeros((self.size, self.size))
        return section_matrix(self, self.properties.damping)

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

    def at(self, q: Matrix, X: FloatArray, ratio: Matrix | float = 1.0) -> Matrix:
        """Strain ξ at any abscissae, 6×k, report (2.1); a break belongs to the element that it ends."""
        intrinsic = self.properties.intrinsic_strain(X)
        rows = []
        for c in range(6):
            row = as_matrix(column(intrinsic, c)).T
            if c in self.columns:
                phi = ca.DM(self.strain_of(c, X))
                strain = phi @ q[self.columns[c]]
                row = row + strain.T / ratio
            rows.append(row)
        return ca.vertcat(*rows)

    def strain_rows(self, q: Matrix, components: Sequence[int], ratio: Ratio = None) -> list[Matrix | None]:
        """Components of (ℓ/ℓ₀) ξ, times the rates of the elements, at the nodes as 1×M rows.

        A row that is zero under every load is None.
        """
        intrinsic = self.properties.intrinsic_strain(self.grid.nodes)
        # Strains that are neither admitted nor intrinsic stay zero, and cost nothing below.
        rows: list[Matrix | None] = []
        for c in components:
            row = None
            own = column(intrinsic, c)
            if not is_zero(own):
                row = per_reference_length(as_matrix(each_times(own, self.node_rates)).T, ratio)
            varying = self.change_row(q, c)
            if varying is not None:
                row = varying if row is None else row + varying
            rows.append(row)
        return rows

    def change_row(self, q: Matrix, component: int) -> Matrix | None:
        """The part of a row of :meth:`strain_rows` by the coordinates, 1×M; None for a strain that is not admitted."""
        if component not in self.columns:
            return None
        return (self.node_matrices[component] @ q[self.columns[component]]).T

    @cached_property
    def taylor_matrices(self) -> list[dict[int, FloatArray]]:
        """Matrices from q_c to the l-th Taylor coefficient of the turn of every interval, (intervals, n_c)."""
        X, element, *_ = self._taylor_samples
        samples = np.zeros((len(X), self.size))
        for c in self.angular:
            samples[:, self.columns[c]] = self.shape_functions(c, X, element)
        orders = []
        for order, per_interval in enumerate(self._taylor(samples)):
            matrices = {}
            for c in self.angular:
                # A polynomial has no Taylor coefficient beyond its degree: numbers there are rounding.
                within_degree = self.degrees(c) >= order
                matrices[c] = per_interval[:, self.columns[c]] * within_degree
            orders.append(matrices)
        return orders

    @cached_property
    def intrinsic_turn(self) -> Numbers:
        """Taylor coefficients of the unloaded turn of every interval, shape (size, intervals), rad.

        The order is: all turning axes of the first coefficient, then all of the next.
        """
        axes = list(self.properties.turning_axes)
        curvatures = self.properties.intrinsic[:3]
        if is_symbolic(self.grid.nodes):
            return self._moved_intrinsic_turn()
        if not any_symbolic(curvatures):
            return np.concatenate([taylor[:, axes].T for taylor in self.intrinsic_taylor])
        # The turn is linear in the Legendre coefficients.
        highest = max(map(len, curvatures))
        X, element, *_ = self._taylor_samples
        polynomials = legendre_table(highest, self.grid.on_rod(X, element))
        turns = self._taylor(self._per_coordinate(polynomials, element))
        rows = []
        for order, turn in enumerate(turns):
            for axis in axes:
                own = curvatures[axis]
                degrees = np.arange(len(own))
                # A polynomial has no Taylor coefficient beyond its degree: numbers there are rounding.
                by_coefficient = turn[:, : len(own)] * (degrees >= order)
                rows.append(product(by_coefficient, as_vector(own)).T)
        return ca.vertcat(*rows)

    @cached_property
    def intrinsic_taylor(self) -> list[FloatArray]:
        """Taylor coefficients of an unloaded turn in numbers: one array (intervals, 3) for each l."""
        X, element, *_ = self._taylor_samples
        curvature = self.properties.intrinsic_curvature(self.grid.on_rod(X, element))
        return self._taylor(self._per_coordinate(curvature, element))

    def _per_coordinate(self, values: Numbers, element: Indices) -> FloatArray:
        """Convert values per length of the rod, at coordinates in elements, to values per length of the grid."""
        return known(each_times(values, self.grid.rates_in(element)))

    def _moved_intrinsic_turn(self) -> Matrix:
        """Taylor coefficients of the unloaded turn, (size, intervals), rad, for element ends that are expressions.

        The unloaded curvature is sampled at the moved elements.
        """
        rows: list[Matrix] = []
        turns = [self._turn_of_samples(len(own)) for own in self.properties.intrinsic[:3]]
        for order in range(self.taylor_count):
            for axis in self.properties.turning_axes:
                own = self.properties.intrinsic[axis]
                if len(own) <= order or is_zero(own):
                    # A polynomial has no Taylor coefficient beyond its degree.
                    rows.append(ca.DM(1, len(self.grid.left_ends)))
                    continue
                by_sample = turns[axis][order]
                rows.append((ca.sparsify(ca.DM(by_sample)) @ self._element_samples(axis)).T)
        return ca.vertcat(*rows)

    def _element_samples(self, axis: int) -> Matrix:
        """Unloaded curvature about an axis times the element's rate, at enough Gauss points to determine it."""
        count = len(self.properties.intrinsic[axis])
        points, _ = gauss_legendre(count)
        breaks = np.asarray(self.grid.breaks)
        places = breaks[:-1, None] + np.diff(breaks)[:, None] * (points + 1) / 2
        element = np.repeat(np.arange(self.grid.elements), count)
        curvature = self.properties.intrinsic_curvature(self.grid.on_rod(places.ravel(), element))
        rates = self.grid.rates_in(element)
        return as_matrix(each_times(column(curvature, axis), rates))

    def _turn_of_samples(self, count: int) -> list[FloatArray]:
        """Matrices from ``count`` samples of each element to Taylor coefficients, (intervals, E·count) for each l."""
        points, _ = gauss_legendre(count)
        to_coefficients = np.linalg.inv(legendre.legvander(points, count - 1))

        def local_polynomials(X: FloatArray, element: Indices) -> FloatArray:
            breaks = np.asarray(self.grid.breaks)
            local = 2 * (X - breaks[element]) / np.diff(breaks)[element] - 1
            polynomials = np.zeros((len(X), self.grid.elements, count))
            polynomials[np.arange(len(X)), element] = legendre.legvander(local, count - 1)
            return polynomials.reshape(len(X), -1)

        to_samples = np.kron(np.eye(self.grid.elements), to_coefficients)
        X, element, *_ = self._taylor_samples
        return [without_rounding(turn @ to_samples) for turn in self._taylor(local_polynomials(X, element))]

    @cached_property
    def taylor_count(self) -> int:
        """Number of Taylor coefficients for each interval: one if all turns are about one axis."""
        if len(self.properties.turning_axes) < 2:
            return 1
        return magnus.coefficient_count(int(self.discretisation.transport.removeprefix("magnus")))

    def _taylor(self, samples: FloatArray) -> list[FloatArray]:
        """Taylor coefficients over every interval of ℓ h times a field, from its samples at the Gauss points."""
        _, _, lengths, to_taylor = self._taylor_samples
        samples = samples.reshape(len(lengths), -1, samples.shape[1])
        scaled = samples * lengths[:, None, None]
        return [np.einsum("p,ipn->in", row, scaled) for row in to_taylor]

    @cached_property
    def _taylor_samples(self) -> tuple[FloatArray, Indices, FloatArray, FloatArray]:
        """Gauss points of all intervals with their elements, lengths ℓ h of the intervals, and samples ↦ coefficients.

        Points are in the grid's coordinate; all intervals have one matrix, shape (count, points).
        """
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
        # ∫ K ds over an interval: per X times ℓ, per interval times its width.
        return X.ravel(), element, self.length * width, to_taylor


def section_matrix(rod: DiscreteRod, diagonal: Field) -> Numbers:
    """ℓ ∫ Φᵀ D Φ dX divided by EI/ℓ for coefficients D of the six strains, shape (n, n)."""
    points = [_gauss_points(rod, e) for e in range(rod.grid.elements)]
    coefficients = [_per_reference_length(rod, diagonal, e, X) for e, (X, _) in enumerate(points)]
    if any_symbolic(coefficients):
        return _symbolic_section_matrix(rod, coefficients)
    result = np.zeros((rod.size, rod.size))
    for e, (X, weight) in enumerate(points):
        weighted = known(coefficients[e]) * weight[:, None]
        element = np.full(len(X), e)
        # Strains do not couple: the tensor is diagonal, and so are its blocks.
        for c, columns in rod.columns.items():
            phi = rod.shape_functions(c, X, element)
            result[columns, columns] += phi.T @ (weighted[:, [c]] * phi)
    return without_rounding(result, NOISE)


def _gauss_points(rod: DiscreteRod, element: int) -> tuple[FloatArray, FloatArray]:
    """Places of an element in the grid's coordinate, shape (k,), and the weights ℓ w / (EI/ℓ) of a sum over them.

    The points suffice for the product of two polynomials with a section stiffness of degree four.
    """
    points, weights = gauss_legendre(max(rod.discretisation.modes) + 8)
    start, end = rod.grid.breaks[element : element + 2]
    width = end - start
    X = start + width * (points + 1) / 2
    lengths = weights * width / 2 * rod.length
    return X, lengths / rod.energy_unit


def _per_reference_length(rod: DiscreteRod, diagonal: Field, element: int, X: FloatArray) -> Numbers:
    """Coefficients for strains per reference length at k points of an element, shape (k, 6), or one row for all."""
    elements = np.full(len(X), element)
    coefficients = diagonal(rod.grid.on_rod(X, elements))
    rate = rod.grid.rates_in(elements)
    if rate is None:
        return coefficients
    if is_symbolic(rate) and not is_symbolic(coefficients):
        same = coefficients == coefficients[:1]
        coefficients = coefficients[:1] if np.all(same) else coefficients
    # One row for all times the one rate of the element.
    return each_times(coefficients, reciprocal(rate[: coefficients.shape[0]]))


def _symbolic_section_matrix(rod: DiscreteRod, by_element: Sequence[Numbers]) -> Numbers:
    """The section matrix for coefficients that are expressions, in which its entries are linear."""
    points = [_gauss_points(rod, e) for e in range(rod.grid.elements)]
    element = np.repeat(np.arange(rod.grid.elements), [len(X) for X, _ in points])
    X = np.concatenate([X for X, _ in points])
    weights = np.concatenate([weight for _, weight in points])
    uniform = all(part.shape[0] == 1 for part in by_element)
    by_row = None
    if uniform and rod.ends is None:
        # One row stands for all points of all elements.
        coefficients = as_matrix(by_element[0])
    elif uniform:
        # One row stands for all points of its element.
        coefficients = ca.vertcat(*map(as_matrix, by_element))
        by_row = (element[:, None] == np.arange(rod.grid.elements)).astype(float)
    else:
        rows = [repeated(part, len(own)) for part, (own, _) in zip(by_element, points, strict=True)]
        coefficients = ca.vertcat(*map(as_matrix, rows))
    blocks = []
    for c in rod.columns:
        phi = rod.shape_functions(c, X, element)
        # One column for each point: the product of two modes there, for every pair of modes.
        pairs = (phi[:, :, None] * phi[:, None, :] * weights[:, None, None]).reshape(len(X), -1).T
        if by_row is not None:
            pairs = without_rounding(pairs @ by_row)
        own = column(coefficients, c)
        size = phi.shape[1]
        blocks.append(ca.reshape(product(pairs, own), size, size))
    matrix = ca.diagcat(*blocks)
    # The expressions may belong only to strains that the rod does not admit.
    return matrix if is_symbolic(matrix) else ca.DM(matrix).full()
