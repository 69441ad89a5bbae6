"""Sections of a rod anywhere in its elements; fields at its nodes are interpolated to them."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import casadi as ca
import numpy as np

from cosserat_casadi.maths.block_operators import sparse
from cosserat_casadi.maths.grid import Indices, gauss_legendre
from cosserat_casadi.maths.numbers import Numbers, each_times
from cosserat_casadi.maths.typing import FloatArray, Matrix
from cosserat_casadi.rod.strain import DiscreteRod


@dataclass(frozen=True)
class PlacedSections:
    """Sections of a rod; if parameters move its elements, they move along and keep their place in the element.

    Attributes:
        rod: the rod.
        coordinates: coordinates on the grid, shape (k,).
    """

    rod: DiscreteRod
    coordinates: FloatArray

    @cached_property
    def elements(self) -> Indices:
        """Element of each section, shape (k,)."""
        return replace(self.rod.grid, ends=None).element_of(self.coordinates)

    @cached_property
    def to_sections(self) -> FloatArray:
        """Matrix from values at the nodes to values at the sections, shape (k, M)."""
        return replace(self.rod.grid, ends=None).interpolation_matrix(self.coordinates)

    @cached_property
    def interpolation(self) -> ca.DM:
        """Sparse matrix :attr:`to_sections`, k×M: a section depends on the nodes of its element alone."""
        return sparse(self.to_sections)

    @cached_property
    def X(self) -> Numbers:
        """Abscissae of the rod, shape (k,)."""
        return self.rod.grid.on_rod(self.coordinates, self.elements)

    @cached_property
    def rates(self) -> Numbers | None:
        """Derivative of the rod's abscissa by the grid's coordinate at the sections, shape (k,); None if it is one."""
        return self.rod.grid.rates_in(self.elements)


@dataclass(frozen=True)
class SummedSections:
    """Sections of each element at which a load per length is summed: Gauss points of equal parts of the element.

    For a load on a part of an element the midpoints of equal parts are more exact than as many nodes. A load that ends
    with the element needs more points in each part. For a load along the whole element Gauss points of the element are
    as exact as nodes.

    Attributes:
        rod: the rod.
        counts: number of sections of each element.
        points: number of Gauss points of each part; 0 for an element that is one part.
    """

    rod: DiscreteRod
    counts: tuple[int, ...]
    points: int = 1

    def finer(self, factor: int) -> SummedSections:
        """Sections with ``factor`` times as many in each element."""
        return replace(self, counts=tuple(factor * count for count in self.counts))

    @cached_property
    def placed(self) -> PlacedSections:
        """The sections."""
        ends = self.rod.grid.breaks
        places = [
            start + (end - start) * self._rule(count)[0]
            for count, start, end in zip(self.counts, ends[:-1], ends[1:], strict=True)
        ]
        return PlacedSections(self.rod, np.concatenate(places))

    def _rule(self, count: int) -> tuple[FloatArray, FloatArray]:
        """Coordinates in an element from 0 to 1, and weights, shares of the element, shape (count,) each."""
        points, weights = gauss_legendre(self.points or count)
        parts = count // len(points)
        places = np.arange(parts)[:, None] + (points + 1) / 2
        return places.ravel() / parts, np.tile(weights / 2 / parts, parts)

    @property
    def size(self) -> int:
        """Number of sections k."""
        return sum(self.counts)

    @cached_property
    def lengths(self) -> Numbers:
        """Length of rod that each section represents in sums, shape (k,), m."""
        return each_times(self._reference_lengths, self.placed.rates)

    def at_sections(self, field: Matrix) -> Matrix:
        """Values at the sections, m×k, of a field at the nodes, m×M."""
        if self.points != 1:
            return self._by_element(field, ca.MX(self._from_nodes))
        return field @ self.placed.interpolation.T

    def at_nodes(self, loads: Matrix) -> Matrix:
        """Loads at the nodes, m×M, that do the same work as loads per length at the sections, m×k."""
        # Moved elements stretch the lengths of sections and of nodes by one factor, which cancels.
        lengths, of_nodes = self._reference_lengths, self.rod.reference_lengths
        if self.points != 1:
            # The block stands in C once and is transposed there.
            block = ca.MX(self._from_nodes)
            rows, columns = block.shape
            scale = ca.MX(ca.DM(lengths[:columns])) @ ca.MX(ca.DM(1 / of_nodes[:rows]).T)
            return self._by_element(loads, scale * block.T)
        return loads @ sparse(lengths[:, None] / of_nodes * self.placed.to_sections)

    @property
    def _from_nodes(self) -> ca.DM:
        """Matrix from the nodes of an element to its sections, if all elements have equally many."""
        elements = self.rod.grid.elements
        return ca.DM(self.placed.to_sections[: self.size // elements, : self.rod.grid.size // elements].T)

    def _by_element(self, field: Matrix, block: ca.MX) -> Matrix:
        """Product of the part of a field in each element with the common block."""
        return ca.horzcat(*[part @ block for part in ca.horzsplit(field, block.shape[0])])

    @cached_property
    def _reference_lengths(self) -> FloatArray:
        elements = self.rod.length * np.diff(self.rod.grid.breaks)
        shares = [self._rule(count)[1] for count in self.counts]
        return np.concatenate([element * share for element, share in zip(elements, shares, strict=True)])
