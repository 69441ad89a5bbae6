"""Forward sweep: from strain coordinates to the poses of the sections, report (1.9), (1.10), (2.17).

All fields are in the frame of the base section: the base is at the origin with the identity rotation, and the pose of
the base enters only with loads and results. See docs/theory.md sections 4 and 5.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import casadi as ca
import numpy as np

from cosserat_casadi.maths.rotation import directors
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.rod.strain import DiscreteRod, Ratio
from cosserat_casadi.rod.transport import IntervalRotations, interval_rotations, section_quaternions


@dataclass(frozen=True)
class Shape:
    """Poses of a rod's sections in its base frame.

    Attributes:
        rod: the matrices of the rod.
        q: strain coordinates, n×1.
        section_quaternion: quaternions of the distinct sections, 4×(intervals + 1).
        intervals: rotations of the intervals between them; None where the rotation is not their product.
        ratio: length of the rod relative to the reference length; None if it is fixed.
    """

    rod: DiscreteRod
    q: Matrix
    section_quaternion: Matrix
    intervals: IntervalRotations | None
    ratio: Ratio = None

    @cached_property
    def section_directors(self) -> tuple[Matrix, Matrix, Matrix]:
        """Directors of the distinct sections, three 3×(intervals + 1)."""
        return directors(self.section_quaternion)

    @cached_property
    def interval_begins(self) -> Matrix:
        """Rotation matrices of the sections at which the intervals begin, side by side, 3×(3·intervals)."""
        begins = [d[:, :-1] for d in self.section_directors]
        return side_by_side(begins)

    @property
    def interval_arguments(self) -> tuple[Matrix, Matrix, Matrix, Matrix]:
        """Turn, Ω, factors and rotation at the beginning of every interval: arguments of the kernels of derivatives."""
        intervals = self.intervals
        if intervals is None:
            raise ValueError("this rod's rotation is not a product of increments")
        return intervals.turn, intervals.omega, intervals.factors, self.interval_begins

    @cached_property
    def directors(self) -> tuple[Matrix, Matrix, Matrix]:
        """Directors d₁, d₂, d₃ at the nodes, three 3×M."""
        d1, d2, d3 = (self.at_nodes(d) for d in self.section_directors)
        return d1, d2, d3

    @cached_property
    def quaternion(self) -> Matrix:
        """Quaternions at the nodes, 4×M."""
        return self.at_nodes(self.section_quaternion)

    @cached_property
    def tangent(self) -> Matrix:
        """Tangent t = dr/dX = ℓ R Γ at the nodes, 3×M, m."""
        # Shear and extension; a component that is zero under every load has no row.
        strain = self.rod.strain_rows(self.q, (3, 4, 5), self.ratio)
        length = self.rod.length
        terms = []
        for director, row in zip(self.directors, strain, strict=True):
            if row is not None:
                terms.append(self.scale(director, length * row))
        return sum(terms[1:], terms[0])

    @cached_property
    def position(self) -> Matrix:
        """Positions at the nodes, 3×M, by integration of the tangent, in metres."""
        return self.rod.grid.integrated(self.tangent)

    def position_at(self, node: int) -> Matrix:
        """Position of one node, 3×1."""
        weights = ca.DM(self.rod.grid.integration_matrix[node])
        return self.tangent @ weights

    def mean_positions(self, weights: Matrix) -> Matrix:
        """Weighted means of the positions at the nodes, 3×k, in metres.

        Args:
            weights: weights of the nodes, M×k.
        """
        # One product with the tangents; positions of all nodes would take a second one with the whole matrix.
        of_tangents = ca.DM(self.rod.grid.integration_matrix).T @ weights
        return self.tangent @ of_tangents

    @staticmethod
    def scale(vectors: Matrix, row: Matrix) -> Matrix:
        """Each column of 3×M vectors times the entry of a 1×M row."""
        components = ca.vertsplit(vectors)
        scaled = [component * row for component in components]
        return ca.vertcat(*scaled)

    def to_body(self, vectors: Matrix) -> Matrix:
        """Coordinates in the sections' frames of 3×M vectors of the base frame."""
        components = [ca.sum1(d * vectors) for d in self.directors]
        return ca.vertcat(*components)

    def to_base(self, vectors: Matrix) -> Matrix:
        """Coordinates in the base frame of 3×M vectors given in the sections' frames."""
        x, y, z = ca.vertsplit(vectors)
        d1, d2, d3 = self.directors
        first = self.scale(d1, x)
        second = self.scale(d2, y)
        third = self.scale(d3, z)
        return first + second + third

    def rotation_at(self, node: int) -> Matrix:
        """Rotation matrix base_R_section of one node, 3×3."""
        columns = [d[:, node] for d in self.directors]
        return ca.horzcat(*columns)

    def rotations_at(self, nodes: list[int]) -> Matrix:
        """Rotation matrices base_R_section of k nodes side by side, 3×3k."""
        chosen = [d[:, nodes] for d in self.directors]
        return side_by_side(chosen)

    def at_nodes(self, sections: Matrix) -> Matrix:
        """Fields of the distinct sections, m×(intervals + 1), at the nodes, m×M."""
        grid = self.rod.grid
        # Both sides of a break are nodes on one section.
        if grid.elements == 1:
            return sections
        columns = np.asarray(grid.section_of_node).tolist()
        return sections[:, columns]


def side_by_side(directors: Sequence[Matrix]) -> Matrix:
    """Rotation matrices side by side, 3×3k, from their columns d₁, d₂, d₃, 3×k each."""
    stacked = ca.vertcat(*directors)
    return ca.reshape(stacked, 3, stacked.numel() // 3)


def shape(rod: DiscreteRod, q: Matrix, ratio: Ratio = None) -> Shape:
    """Forward sweep of report (2.17) in the base frame."""
    literal = rod.discretisation.transport == "permuted"
    intervals = None
    if rod.properties.turning_axes and not literal:
        intervals = interval_rotations(rod, q, ratio)
    quaternions = section_quaternions(rod, q, intervals, ratio)
    return Shape(rod, q, quaternions, intervals, ratio)
