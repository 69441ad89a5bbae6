"""A spectral grid on [0, 1] made of elements: Chebyshev nodes in each, integration matrices over all.

An element ends where something jumps (a point load), so every field is smooth inside an element and spectral
accuracy is kept. The node at a break appears twice, as the left and as the right limit. With one element this is
the plain Chebyshev grid. See docs/theory.md, section 3.

Elements may end at other abscissae of the rod than those of the grid, also at expressions of parameters. The grid is
then a reference: integrals run over its coordinate, along which each element has its own rate dX of the rod.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, cached_property
from itertools import pairwise

import casadi as ca
import numpy as np
import numpy.typing as npt
from numpy.polynomial import legendre

from cosserat_casadi.maths import chebyshev
from cosserat_casadi.maths.numbers import (
    Numbers,
    Scalar,
    any_symbolic,
    as_matrix,
    as_vector,
    is_same,
    is_symbolic,
    known,
    legendre_table,
)
from cosserat_casadi.maths.typing import FloatArray, Matrix

Indices = npt.NDArray[np.int64]
"""Indices of nodes, intervals or sections."""


@dataclass(frozen=True)
class Grid:
    """Elements on [0, 1] with the same number N of Chebyshev intervals, and so of N + 1 nodes, each.

    Attributes:
        breaks: element ends in the coordinate of the integrals, ascending, first 0 and last 1.
        intervals: Chebyshev intervals in each element, N ≥ 1.
        ends: abscissae X of these element ends on the rod, ascending, numbers or expressions; None if they are the
            breaks.
    """

    breaks: tuple[float, ...]
    intervals: int
    ends: tuple[Scalar, ...] | None = None

    @property
    def elements(self) -> int:
        """Number of elements E."""
        return len(self.breaks) - 1

    @property
    def size(self) -> int:
        """Number of nodes M = E (N + 1)."""
        return self.elements * self._nodes_per_element

    @property
    def places(self) -> tuple[Scalar, ...]:
        """Abscissae X of the element ends on the rod, base to tip."""
        return self.breaks if self.ends is None else self.ends

    @property
    def known_places(self) -> tuple[float, ...]:
        """Abscissae X of the element ends, base to tip, as numbers; for a grid whose element ends are numbers."""
        return tuple(known(as_vector(self.places)).tolist())

    @cached_property
    def reference_nodes(self) -> FloatArray:
        """The nodes in the coordinate that integrals run over, base to tip, shape (M,)."""
        local = chebyshev.nodes(self.intervals)
        parts = [start + (end - start) * local for start, end in self._spans()]
        return np.concatenate(parts)

    @cached_property
    def nodes(self) -> Numbers:
        """Abscissae X of the nodes on the rod, base to tip, shape (M,)."""
        return self.on_rod(self.reference_nodes, self.element_of_node)

    def nodes_at(self, indices: Indices) -> Numbers:
        """Abscissae X of some of the nodes, shape (len(indices),)."""
        return self.on_rod(self.reference_nodes[indices], self.element_of_node[indices])

    @cached_property
    def rates(self) -> Numbers | None:
        """Width of each element on the rod over its width in the coordinate, shape (E,); None if all are one."""
        if self.ends is None:
            return None
        widths = [end - start for start, end in pairwise(self.ends)]
        nominal = np.diff(self.breaks)
        relative = [width / own for width, own in zip(widths, nominal.tolist(), strict=True)]
        return as_vector(relative)

    @cached_property
    def element_of_node(self) -> Indices:
        """Element of each node, shape (M,)."""
        return np.repeat(np.arange(self.elements, dtype=np.int64), self._nodes_per_element)

    def rates_in(self, elements: Indices) -> Numbers | None:
        """Derivative of the rod's abscissa by the coordinate in elements, shape (len(elements),); None if it is one."""
        rates = self.rates
        if rates is None or not is_symbolic(rates):
            return None if rates is None else known(rates)[elements]
        return rates[elements.tolist()]

    def on_rod(self, coordinates: FloatArray, elements: Indices) -> Numbers:
        """Abscissae X of points of elements, given in the coordinate that integrals run over, shape (k,)."""
        rates = self.rates_in(elements)
        if self.ends is None or rates is None:
            return coordinates
        starts = as_vector(self.ends[:-1])
        from_start = coordinates - np.asarray(self.breaks)[elements]
        if any_symbolic([starts, rates]):
            begins: Matrix = as_matrix(starts)[elements.tolist()]
            moved: Matrix = begins + from_start * as_matrix(rates)
            return moved
        return np.asarray(known(starts)[elements] + from_start * known(rates))

    def in_coordinate(self, X: FloatArray, elements: Indices) -> FloatArray:
        """Coordinates of abscissae X of the rod in elements with known ends, shape (k,)."""
        if self.ends is None:
            return X
        starts = known(as_vector(self.places[:-1]))[elements]
        rates = self.rates_in(elements)
        assert rates is not None
        return np.asarray(self.breaks)[elements] + (X - starts) / known(rates)

    @cached_property
    def weights(self) -> FloatArray:
        """Clenshaw–Curtis weights of the whole grid in its coordinate, shape (M,), sum 1."""
        local = chebyshev.quadrature_weights(self.intervals)
        parts = [(end - start) * local for start, end in self._spans()]
        return np.concatenate(parts)

    @cached_property
    def integration_matrix(self) -> FloatArray:
        """Matrix S of the integral from the base over the coordinate, shape (M, M): (S f)_i ≈ ∫₀^{X_i} f dX."""
        local = chebyshev.integration_matrix(self.intervals)
        matrix = np.zeros((self.size, self.size))
        for element, (start, end) in enumerate(self._spans()):
            rows = self._nodes_of(element)
            matrix[rows, rows] = (end - start) * local
            # The elements before it add the same number at all of its nodes.
            before = slice(0, rows.start)
            matrix[rows, before] = self.weights[before]
        return matrix

    def integrated(self, fields: Matrix) -> Matrix:
        """Integrals from the base of fields at the nodes, f Sᵀ, k×M.

        Computed within each element plus the integrals of the elements before it, since S itself is half full.
        """
        integrals: list[Matrix] = []
        for start, own in zip(self._starts, ca.horzsplit(fields, self._nodes_per_element), strict=True):
            within = own @ start.T
            if integrals:
                within = within + ca.repmat(integrals[-1][:, -1], 1, self._nodes_per_element)
            integrals.append(within)
        return ca.horzcat(*integrals)

    def summed_by_integrals(self, fields: Matrix) -> Matrix:
        """Sums over the nodes of fields times the rows of S, f S, k×M: the transpose of :meth:`integrated`."""
        sums: list[Matrix] = []
        beyond: Matrix | None = None
        parts = zip(self._starts, ca.horzsplit(fields, self._nodes_per_element), strict=True)
        for start, own in reversed(list(parts)):
            within = own @ start
            if beyond is not None:
                within = within + beyond @ start[-1, :]
            total = ca.sum2(own)
            beyond = total if beyond is None else beyond + total
            sums.insert(0, within)
        return ca.horzcat(*sums)

    @cached_property
    def _starts(self) -> list[ca.DM]:
        """Matrix of the integral from the beginning of each element to its nodes."""
        rows = [self._nodes_of(element) for element in range(self.elements)]
        return [ca.DM(self.integration_matrix[own, own]) for own in rows]

    @cached_property
    def left_ends(self) -> FloatArray:
        """Base-side ends of the E·N intervals between neighbouring nodes, in the coordinate."""
        starts = self._nodes_by_element[:, :-1]
        return starts.ravel()

    @cached_property
    def right_ends(self) -> FloatArray:
        """Tip-side ends of the E·N intervals between neighbouring nodes, in the coordinate."""
        ends = self._nodes_by_element[:, 1:]
        return ends.ravel()

    @cached_property
    def section_of_node(self) -> Indices:
        """Index of each node among the E·N + 1 distinct sections, shape (M,)."""
        # The last node of an element and the first of the next are one section.
        first = self.intervals * np.arange(self.elements, dtype=np.int64)
        local = np.arange(self._nodes_per_element)
        sections = first[:, None] + local
        return sections.ravel()

    @cached_property
    def mirrored_intervals(self) -> Indices:
        """Index of the mirror image of each interval about the middle of its element, shape (E·N,)."""
        intervals = self.elements * self.intervals
        return self._mirrored(intervals)

    @cached_property
    def mirrored_nodes(self) -> Indices:
        """Index of the mirror image of each node about the middle of its element, shape (M,)."""
        return self._mirrored(self.size)

    def node_at(self, abscissa: Scalar) -> int:
        """Index of the last node of the element that ends at ``abscissa``; 0 for the base."""
        elements_before = self._end_number(abscissa)
        return max(elements_before * self._nodes_per_element - 1, 0)

    def nodes_in(self, start: Scalar, end: Scalar) -> Indices:
        """Indices of the nodes between two element ends; nodes at an inner end appear once for each side."""
        first = self._end_number(start)
        behind_last = self._end_number(end)
        elements = self.element_of_node
        return np.flatnonzero((elements >= first) & (elements < behind_last))

    def _end_number(self, abscissa: Scalar) -> int:
        """Index of an element end; an expression must be the object that the grid has."""
        for number, place in enumerate(self.places):
            if is_same(place, abscissa):
                return number
        raise ValueError(f"no element ends at {abscissa}")

    def element_of(self, X: FloatArray) -> Indices:
        """Element in which each abscissa of the rod lies; an end belongs to the element it ends."""
        inner = np.asarray(self.known_places[1:-1])
        # The search is from the left: an abscissa at a break stands before it.
        elements = np.searchsorted(inner, X, side="left")
        return elements.astype(np.int64)

    def interpolation_matrix(self, X: npt.ArrayLike) -> FloatArray:
        """Matrix from nodal values to values at abscissae X of the rod, in [0, 1], shape (M,) of one or (k, M) of k."""
        abscissae = np.atleast_1d(np.asarray(X, dtype=float))
        matrix = np.zeros((len(abscissae), self.size))
        elements = self.element_of(abscissae)
        spans = list(pairwise(self.known_places))
        # All rows of an element at once, since this is most of the work for many sections.
        for element in set(elements.tolist()):
            rows = np.flatnonzero(elements == element)
            start, end = spans[element]
            local = (abscissae[rows] - start) / (end - start)
            matrix[rows, self._nodes_of(element)] = chebyshev.interpolation_matrix(self.intervals, local)
        return matrix.reshape(*np.shape(X), self.size)

    def interpolated(self, fields: Matrix, X: Numbers) -> Matrix:
        """Fields at the nodes, k×M, at abscissae X of the rod in [0, 1], k×len(X).

        Abscissae and element ends may be expressions. An end belongs to the element that it ends.
        """
        if not any_symbolic([X, *self.places]):
            return fields @ ca.DM(self.interpolation_matrix(known(X)).T)
        # A Legendre series in each element has no poles at the nodes, unlike barycentric weights.
        to_values = legendre_table(self._nodes_per_element, chebyshev.nodes(self.intervals))
        to_coefficients = ca.DM(np.linalg.inv(known(to_values)).T)
        abscissae = ca.MX(as_matrix(X))
        inner = [-np.inf, *self.places[1:-1], np.inf]
        values: Matrix = ca.MX.zeros(fields.shape[0], abscissae.shape[0])
        spans = zip(pairwise(self.places), pairwise(inner), ca.horzsplit(fields, self._nodes_per_element), strict=True)
        for (start, end), (least, most), own in spans:
            # Outside of an element its value at the end is taken, so that nothing overflows before it is dropped.
            local = ca.fmin(ca.fmax((abscissae - start) / (end - start), 0), 1)
            lies_here = (abscissae > least) * (abscissae <= most)
            basis = as_matrix(legendre_table(self._nodes_per_element, local)).T
            values = values + (own @ to_coefficients @ basis) * ca.repmat(lies_here.T, fields.shape[0], 1)
        return values

    @property
    def _nodes_per_element(self) -> int:
        """N + 1."""
        return self.intervals + 1

    @property
    def _nodes_by_element(self) -> FloatArray:
        """The nodes in the coordinate, one element a row, shape (E, N + 1)."""
        return self.reference_nodes.reshape(self.elements, self._nodes_per_element)

    def _nodes_of(self, element: int) -> slice:
        """The nodes of an element among all nodes."""
        first = element * self._nodes_per_element
        return slice(first, first + self._nodes_per_element)

    def _mirrored(self, count: int) -> Indices:
        """The numbers 0 … count − 1, in equal runs, one for each element, each in reverse order."""
        numbers = np.arange(count, dtype=np.int64)
        by_element = numbers.reshape(self.elements, -1)
        mirrored = by_element[:, ::-1]
        return mirrored.ravel()

    def _spans(self) -> list[tuple[float, float]]:
        """Start and end of every element in the coordinate, base to tip."""
        return list(pairwise(self.breaks))


@cache
def gauss_legendre(count: int) -> tuple[FloatArray, FloatArray]:
    """Points and weights of Gauss–Legendre quadrature on [−1, 1], shape (count,) each; neither may be written to."""
    points, weights = legendre.leggauss(count)
    points.flags.writeable = False
    weights.flags.writeable = False
    return points, weights
