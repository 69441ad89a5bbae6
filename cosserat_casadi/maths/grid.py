"""A spectral grid on [0, 1] made of elements: Chebyshev nodes in each, integration matrices over all.

An element ends where something jumps (a point load), so every field is smooth inside an element and spectral
accuracy is kept. The node at a break appears twice, as the left and as the right limit. With one element this is
the plain Chebyshev grid. See docs/theory.md, section 3.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from cosserat_casadi.maths import chebyshev
from cosserat_casadi.maths.typing import FloatArray

Indices = npt.NDArray[np.int64]
"""Indices of rows: of nodes, of intervals, of sections."""


@dataclass(frozen=True)
class Grid:
    """Elements on [0, 1] with the same number N of Chebyshev intervals, and so of N + 1 nodes, each.

    Attributes:
        breaks: element ends, ascending, first 0 and last 1.
        intervals: Chebyshev intervals in each element, N ≥ 1.
    """

    breaks: tuple[float, ...]
    intervals: int

    @property
    def elements(self) -> int:
        """Number of elements E."""
        return len(self.breaks) - 1

    @property
    def size(self) -> int:
        """Number of nodes M = E (N + 1)."""
        return self.elements * self._nodes_per_element

    @cached_property
    def nodes(self) -> FloatArray:
        """Abscissae of the nodes, base to tip, shape (M,)."""
        local = chebyshev.nodes(self.intervals)
        parts = [start + (end - start) * local for start, end in self._spans()]
        return np.concatenate(parts)

    @cached_property
    def weights(self) -> FloatArray:
        """Clenshaw–Curtis weights of the whole grid, shape (M,), sum 1."""
        local = chebyshev.quadrature_weights(self.intervals)
        parts = [(end - start) * local for start, end in self._spans()]
        return np.concatenate(parts)

    @cached_property
    def integration_matrix(self) -> FloatArray:
        """Matrix S of the integral from the base, shape (M, M): (S f)_i ≈ ∫₀^{X_i} f dX."""
        local = chebyshev.integration_matrix(self.intervals)
        matrix = np.zeros((self.size, self.size))
        for element, (start, end) in enumerate(self._spans()):
            rows = self._nodes_of(element)
            matrix[rows, rows] = (end - start) * local
            # What the elements before it add is the same at all of its nodes.
            before = slice(0, rows.start)
            matrix[rows, before] = self.weights[before]
        return matrix

    @cached_property
    def left_ends(self) -> FloatArray:
        """Base-side ends of the E·N intervals between neighbouring nodes."""
        starts = self._nodes_by_element[:, :-1]
        return starts.ravel()

    @cached_property
    def right_ends(self) -> FloatArray:
        """Tip-side ends of the E·N intervals between neighbouring nodes."""
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
        """Index of the interval that mirrors each one about the middle of its element, shape (E·N,)."""
        intervals = self.elements * self.intervals
        return self._mirrored(intervals)

    @cached_property
    def mirrored_nodes(self) -> Indices:
        """Index of the node that mirrors each one about the middle of its element, shape (M,)."""
        return self._mirrored(self.size)

    def node_at(self, abscissa: float) -> int:
        """Index of the node that ends the element whose tip is at ``abscissa`` (a break, not 0)."""
        elements_before = self.breaks.index(abscissa)
        return elements_before * self._nodes_per_element - 1

    def nodes_in(self, start: float, end: float) -> Indices:
        """Indices of the nodes of the elements between two breaks, each side of a break with its own."""
        # An element is inside as a whole or not at all.
        middles = self._nodes_by_element.mean(axis=1)
        inside = (middles > start) & (middles < end)
        return np.flatnonzero(np.repeat(inside, self._nodes_per_element))

    def element_of(self, X: FloatArray) -> Indices:
        """Element in which each abscissa lies; a break belongs to the element it ends."""
        inner = np.asarray(self.breaks[1:-1])
        # From the left: an abscissa that equals a break stands before it.
        elements = np.searchsorted(inner, X, side="left")
        return elements.astype(np.int64)

    def interpolation_matrix(self, X: FloatArray) -> FloatArray:
        """Matrix from nodal values to values at abscissae X in [0, 1], shape (len(X), M)."""
        matrix = np.zeros((len(X), self.size))
        elements = self.element_of(X)
        spans = self._spans()
        for row, element in enumerate(elements):
            start, end = spans[element]
            local = (X[row] - start) / (end - start)
            columns = self._nodes_of(element)
            matrix[row, columns] = chebyshev.interpolation_matrix(self.intervals, [local])
        return matrix

    @property
    def _nodes_per_element(self) -> int:
        """N + 1."""
        return self.intervals + 1

    @property
    def _nodes_by_element(self) -> FloatArray:
        """Abscissae of the nodes, one element a row, shape (E, N + 1)."""
        return self.nodes.reshape(self.elements, self._nodes_per_element)

    def _nodes_of(self, element: int) -> slice:
        """The nodes of an element among all nodes."""
        first = element * self._nodes_per_element
        return slice(first, first + self._nodes_per_element)

    def _mirrored(self, count: int) -> Indices:
        """The numbers 0 … count − 1, in equal runs, one an element, with the order turned round in each."""
        numbers = np.arange(count, dtype=np.int64)
        by_element = numbers.reshape(self.elements, -1)
        mirrored = by_element[:, ::-1]
        return mirrored.ravel()

    def _spans(self) -> list[tuple[float, float]]:
        """Start and end of every element, base to tip."""
        return list(pairwise(self.breaks))
