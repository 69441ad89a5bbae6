"""Forward sweep: from strain coordinates to the poses of the sections, report (1.9), (1.10), (2.17).

Everything is in the frame of the base section: the base starts at the origin with the identity rotation, and the
pose of the base enters where loads come in and results go out.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import casadi as ca
import numpy as np

from cosserat_casadi.maths.rotation import directors
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.rod.strain import DiscreteRod, Ratio
from cosserat_casadi.rod.transport import Increments, increments, transport


@dataclass(frozen=True)
class Shape:
    """Poses of a rod's sections in its base frame.

    Attributes:
        rod: the matrices of the rod.
        q: strain coordinates, n×1.
        section_quaternion: quaternions of the distinct sections, 4×(intervals + 1).
        steps: rotations of the intervals between them; None where the rotation is not their product.
        ratio: length of the rod relative to the reference length, where that is free.
    """

    rod: DiscreteRod
    q: Matrix
    section_quaternion: Matrix
    steps: Increments | None
    ratio: Ratio = None

    @cached_property
    def section_directors(self) -> tuple[Matrix, Matrix, Matrix]:
        """Directors of the distinct sections, three 3×(intervals + 1)."""
        return directors(self.section_quaternion)

    @cached_property
    def interval_rotations(self) -> Matrix:
        """Rotation matrices of the sections at which the intervals begin, side by side, 3×(3·intervals)."""
        columns = ca.vertcat(*[d[:, :-1] for d in self.section_directors])
        return ca.reshape(columns, 3, columns.numel() // 3)

    @property
    def interval_arguments(self) -> tuple[Matrix, Matrix, Matrix, Matrix]:
        """Turn, Ω, factors and rotation at the beginning of every interval, as the kernels of derivatives take them."""
        if self.steps is None:
            raise ValueError("this rod's rotation is not a product of increments")
        return self.steps.turn, self.steps.omega, self.steps.factors, self.interval_rotations

    @cached_property
    def directors(self) -> tuple[Matrix, Matrix, Matrix]:
        """Directors d₁, d₂, d₃ at the nodes, three 3×M."""
        d1, d2, d3 = (self._at_nodes(d) for d in self.section_directors)
        return d1, d2, d3

    @cached_property
    def quaternion(self) -> Matrix:
        """Quaternions at the nodes, 4×M."""
        return self._at_nodes(self.section_quaternion)

    @cached_property
    def tangent(self) -> Matrix:
        """Rate of position dr/dX = ℓ R Γ at the nodes, 3×M, in metres."""
        strain = self.rod.strain_rows(self.q, (3, 4, 5), self.ratio)
        length = self.rod.properties.length
        pairs = [(d, row) for d, row in zip(self.directors, strain, strict=True) if row is not None]
        scaled = [self.scale(d, length * row) for d, row in pairs]
        total = scaled[0]
        for term in scaled[1:]:
            total = total + term
        return total

    @cached_property
    def position(self) -> Matrix:
        """Positions at the nodes, 3×M, by integration of the tangent, in metres."""
        return self.tangent @ ca.DM(self.rod.grid.integration_matrix).T

    def position_at(self, node: int) -> Matrix:
        """Position of one node, 3×1."""
        return self.tangent @ ca.DM(self.rod.grid.integration_matrix[node])

    @staticmethod
    def scale(vectors: Matrix, row: Matrix) -> Matrix:
        """Each column of 3×M vectors times the entry of a 1×M row."""
        return ca.vertcat(*[component * row for component in ca.vertsplit(vectors)])

    def to_body(self, vectors: Matrix) -> Matrix:
        """Coordinates in the sections' frames of 3×M vectors of the base frame."""
        return ca.vertcat(*[ca.sum1(d * vectors) for d in self.directors])

    def to_base(self, vectors: Matrix) -> Matrix:
        """Coordinates in the base frame of 3×M vectors given in the sections' frames."""
        terms = [self.scale(d, row) for d, row in zip(self.directors, ca.vertsplit(vectors), strict=True)]
        return terms[0] + terms[1] + terms[2]

    def rotation_at(self, node: int) -> Matrix:
        """Rotation matrix base_R_section of one node, 3×3."""
        return ca.horzcat(*[d[:, node] for d in self.directors])

    def _at_nodes(self, sections: Matrix) -> Matrix:
        if self.rod.grid.elements == 1:
            return sections
        return sections[:, np.asarray(self.rod.grid.section_of_node).tolist()]


def shape(rod: DiscreteRod, q: Matrix, ratio: Ratio = None) -> Shape:
    """Forward sweep of report (2.17) in the base frame."""
    product = bool(rod.properties.turning_axes) and rod.discretisation.transport != "permuted"
    steps = increments(rod, q, ratio) if product else None
    return Shape(rod, q, transport(rod, q, steps, ratio), steps, ratio)
