"""Sections of a rod at any places of its elements: fields at its nodes are interpolated to them."""

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
    """Sections of a rod; where parameters move its elements, they stay where they are in their elements.

    Attributes:
        rod: the rod.
        coordinates: places in the coordinate of the grid, shape (k,).
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
        """Matrix :attr:`to_sections`, k×M, without zeros: a section reads the nodes of its element."""
        return sparse(self.to_sections)

    @cached_property
    def X(self) -> Numbers:
        """Abscissae of the rod, shape (k,)."""
        return self.rod.grid.on_rod(self.coordinates, self.elements)

    @cached_property
    def rates(self) -> Numbers | None:
        """Rate dX of the rod's abscissa at the sections, shape (k,); None where it is one."""
        return self.rod.grid.rates_in(self.elements)


@dataclass(frozen=True)
class SummedSections:
    """Sections of each element at which a load per length is summed: Gauss points of equal parts of it.

    A load that comes and goes within an element is summed in the middle of equal parts more exactly than by nodes as
    many. One that ends with an element takes more points a part. One along all of an element is summed by Gauss points
    of the element as exactly as by nodes.

    Attributes:
        rod: the rod.
        counts: sections of each element.
        points: Gauss points of each part; 0 where an element is one part.
    """

    rod: DiscreteRod
    counts: tuple[int, ...]
    points: int = 1

    def finer(self, factor: int) -> SummedSections:
        """Sections of the same kind, ``factor`` times as many in each element."""
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
        """Places in an element from 0 to 1, and the share of it that each stands for, shape (count,) each."""
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
        """Length of rod that each section stands for, shape (k,), m."""
        return each_times(self._reference_lengths, self.placed.rates)

    def at_sections(self, field: Matrix) -> Matrix:
        """A field at the nodes, m×M, at the sections, m×k."""
        if self.points != 1:
            return self._by_element(field, ca.MX(self._from_nodes))
        return field @ self.placed.interpolation.T

    def at_nodes(self, loads: Matrix) -> Matrix:
        """Loads per length at the sections, m×k, as loads at the nodes that do the same work, m×M."""
        # Lengths of sections and of nodes are drawn out alike where parameters move elements.
        lengths, of_nodes = self._reference_lengths, self.rod.reference_lengths
        if self.points != 1:
            # The block is in C once, and turned there.
            block = ca.MX(self._from_nodes)
            rows, columns = block.shape
            scale = ca.MX(ca.DM(lengths[:columns])) @ ca.MX(ca.DM(1 / of_nodes[:rows]).T)
            return self._by_element(loads, scale * block.T)
        return loads @ sparse(lengths[:, None] / of_nodes * self.placed.to_sections)

    @property
    def _from_nodes(self) -> ca.DM:
        """Matrix from values at the nodes of an element to those at its sections, each of which has as many."""
        elements = self.rod.grid.elements
        return ca.DM(self.placed.to_sections[: self.size // elements, : self.rod.grid.size // elements].T)

    def _by_element(self, field: Matrix, block: ca.MX) -> Matrix:
        """Product of the parts of a field in each element with the block that all of them have."""
        return ca.horzcat(*[part @ block for part in ca.horzsplit(field, block.shape[0])])

    @cached_property
    def _reference_lengths(self) -> FloatArray:
        elements = self.rod.length * np.diff(self.rod.grid.breaks)
        shares = [self._rule(count)[1] for count in self.counts]
        return np.concatenate([element * share for element, share in zip(elements, shares, strict=True)])
