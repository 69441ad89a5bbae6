"""A spectral grid on [0, 1] made of elements: Chebyshev nodes in each, integration matrices over all.

An element ends where something jumps (a point load), so every field is smooth inside an element and spectral
accuracy is kept. The node at a break appears twice, as the left and as the right limit. With one element this is
the plain Chebyshev grid.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from cosserat_casadi.maths import chebyshev

Array = npt.NDArray[np.float64]
Indices = npt.NDArray[np.int64]


@dataclass(frozen=True)
class Grid:
    """Elements on [0, 1] with the same number of Chebyshev intervals each.

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
        return self.elements * (self.intervals + 1)

    @cached_property
    def nodes(self) -> Array:
        """Abscissae of the nodes, base to tip, shape (M,)."""
        local = chebyshev.nodes(self.intervals)
        return np.concatenate([a + (b - a) * local for a, b in self._spans()])

    @cached_property
    def weights(self) -> Array:
        """Clenshaw–Curtis weights of the whole grid, shape (M,), sum 1."""
        local = chebyshev.quadrature_weights(self.intervals)
        return np.concatenate([(b - a) * local for a, b in self._spans()])

    @cached_property
    def integration_matrix(self) -> Array:
        """Matrix S of the integral from the base, shape (M, M): (S f)_i ≈ ∫₀^{X_i} f dX."""
        local = chebyshev.integration_matrix(self.intervals)
        width = self.intervals + 1
        matrix = np.zeros((self.size, self.size))
        for e, (a, b) in enumerate(self._spans()):
            rows = slice(e * width, (e + 1) * width)
            matrix[rows, rows] = (b - a) * local
            matrix[rows, : e * width] = self.weights[: e * width]
        return matrix

    @cached_property
    def left_ends(self) -> Array:
        """Base-side ends of the E·N intervals between neighbouring nodes."""
        return self.nodes.reshape(self.elements, -1)[:, :-1].ravel()

    @cached_property
    def right_ends(self) -> Array:
        """Tip-side ends of the E·N intervals between neighbouring nodes."""
        return self.nodes.reshape(self.elements, -1)[:, 1:].ravel()

    @cached_property
    def section_of_node(self) -> Indices:
        """Index of each node among the E·N + 1 distinct sections, shape (M,)."""
        first = np.arange(self.elements)[:, None] * self.intervals
        return (first + np.arange(self.intervals + 1)).ravel().astype(np.int64)

    @cached_property
    def mirrored_intervals(self) -> Indices:
        """Index of the interval that mirrors each one about the middle of its element, shape (E·N,)."""
        return np.arange(self.elements * self.intervals).reshape(self.elements, -1)[:, ::-1].ravel().astype(np.int64)

    @cached_property
    def mirrored_nodes(self) -> Indices:
        """Index of the node that mirrors each one about the middle of its element, shape (M,)."""
        return np.arange(self.size).reshape(self.elements, -1)[:, ::-1].ravel().astype(np.int64)

    def node_at(self, abscissa: float) -> int:
        """Index of the node that ends the element whose tip is at ``abscissa`` (a break, not 0)."""
        element = self.breaks.index(abscissa)
        return element * (self.intervals + 1) - 1

    def element_of(self, X: Array) -> Indices:
        """Element in which each abscissa lies; a break belongs to the element it ends."""
        inner = np.asarray(self.breaks[1:-1])
        return np.searchsorted(inner, X, side="left").astype(np.int64)

    def interpolation_matrix(self, X: Array) -> Array:
        """Matrix from nodal values to values at abscissae X in [0, 1], shape (len(X), M)."""
        width = self.intervals + 1
        matrix = np.zeros((len(X), self.size))
        for row, (x, e) in enumerate(zip(X, self.element_of(X), strict=True)):
            a, b = self.breaks[e], self.breaks[e + 1]
            local = chebyshev.interpolation_matrix(self.intervals, np.array([(x - a) / (b - a)]))
            matrix[row, e * width : (e + 1) * width] = local[0]
        return matrix

    def _spans(self) -> list[tuple[float, float]]:
        return list(zip(self.breaks[:-1], self.breaks[1:], strict=True))
