"""A rod in motion that may touch another rod: its sections, and the sections of the other rod nearest to them.

For a section of the first rod the other rod is a moving obstacle. The gap is the least distance d of the section from
the other centre line, less both radii: d = |r(X) − s(Y)| with the normal n from s to r. The contact is where the gap is
least along the first rod too. So the gap is a minimum over both abscissae, or over Y alone if X is fixed. Its gradient
equals the gradient of d at fixed X and Y; its second derivative is reduced because X and Y slide:

    δ²d − cᵀ M⁻¹ c,   M = ∂²d/∂(X, Y)², c the derivatives of ∂d/∂(X, Y) with respect to the unknowns.

M is eliminated one abscissa at a time: Y first, then X, along which the bend of the gap includes the sliding of Y.

Forces on both rods are opposite and collinear: they have neither a resultant nor a moment.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import casadi as ca
import numpy as np

from cosserat_casadi.compiling.shared_records import Held
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.motion.contact_gap import STRIDE, Rows, SectionGap
from cosserat_casadi.motion.contact_law import AT_END, LOOKS, FacingRecord
from cosserat_casadi.motion.contact_sections import RodFacing


class RodGap(SectionGap):
    """A gap between sections of two rods.

    Args:
        memory: both sections as written by C, shape (gap_size(),).
        points: number of points of both rods.

    Attributes:
        other: the gap at the section of the other rod, with the section of the first rod as obstacle.
        other_place: abscissa of the section of the other rod.
    """

    other_place: float

    def __init__(self, memory: FloatArray, points: int) -> None:
        own, other = np.split(memory, 2)
        super().__init__(own, points)
        self.other = SectionGap(other, points)
        self.other_place = float(other[0])

    @cached_property
    def own_rows(self) -> Rows:
        """Weights of the points in the position of the section of the first rod, and in its tangent."""
        return SectionGap(self._memory, self._points).rows

    @cached_property
    def rows(self) -> Rows:
        """Weights of the points in the vector from the other section to the first one, and in its derivative by X."""
        return Rows(self.own_rows.value - self.other.rows.value, self.own_rows.first)

    @property
    def other_slides(self) -> bool:
        """Whether the section of the other rod slides; at an end of that rod it stays."""
        return AT_END < self.other_place < 1.0 - AT_END


@dataclass(frozen=True)
class RodsFacing(RodFacing):
    """A rod and another rod that it may touch.

    Attributes:
        other: the other rod.
    """

    other: RodFacing

    @property
    def touched(self) -> str:
        """Name of the other rod."""
        return self.other.owner

    @property
    def stride(self) -> float:
        """Longest way of a point of either rod between two checks for contact in steps of given size, m."""
        return STRIDE * (min(self.radii) + min(self.other.radii)) / 2.0

    @property
    def surfaces(self) -> dict[str, ca.Function]:
        """No functions: the nodes of the other rod define its surface."""
        return {}

    def describe(self, held: Held) -> None:
        """Write the elements, the interpolation of sections from nodes, and the other rod into the record."""
        super().describe(held)
        held.point("other", self._other_record())

    def _other_record(self) -> Held:
        """The record of the other rod."""
        other = self.other
        record = FacingRecord(length=other.length)
        record.radius_at_base, record.radius_at_tip = other.radii
        held = Held(record)
        other.describe(held)
        sizes = {
            "fitted": 3 * other.points.count,
            "seen_from": 3,
            "looked_at": 3 * (LOOKS * record.elements + 1),
            "balls": 4 * record.elements,
        }
        for name, size in sizes.items():
            held.share(name, np.zeros(size))
        return held

    def gap(self, memory: FloatArray) -> RodGap:
        """Read a gap that C has written, shape (gap_size(),)."""
        return RodGap(memory, self.points.count)

    def turning_distance(self, by_nodes: FloatArray, gap: SectionGap, *, slides: bool) -> FloatArray:
        """Second derivative of a distance along motions of the points of both rods, m, shape (n, n) or ()."""
        assert isinstance(gap, RodGap), "gaps of rods are of two sections"
        moved = np.tensordot(gap.rows.value, by_nodes, 1)
        return np.asarray(moved.T @ gap.other.curvature @ moved - self._taken(by_nodes, gap, slides=slides))

    def _taken(self, by_nodes: FloatArray, gap: RodGap, *, slides: bool) -> FloatArray:
        """Reduction cᵀ M⁻¹ c of the second derivative of the distance by the sliding of both abscissae, m.

        Args:
            by_nodes: motions of all points, shape (M, 3, n), or (M, 3) for one motion.
            gap: the gap.
            slides: whether the place on the first rod is where the gap is least; else it is fixed.

        Returns:
            the reduction, shape (n, n), or () for one motion.
        """
        # While both sections are held the distance has the curvature of a ball.
        ball = gap.other.curvature
        moved = np.tensordot(gap.rows.value, by_nodes, 1)
        of_own, of_other = (np.tensordot(rows.first, by_nodes, 1) for rows in (gap.own_rows, gap.other.rows))
        own = gap.normal @ of_own + gap.tangent @ ball @ moved
        # Where Newton's method has gone astray numbers may be none: its step is not taken then.
        with np.errstate(all="ignore"):
            taken = np.zeros(np.shape(own) * 2)
            if gap.other_slides:
                other = -(gap.normal @ of_other) - gap.other.tangent @ ball @ moved
                bend = np.float64(gap.other.bend * self.other.length)
                taken = np.multiply.outer(other, other) / bend
                # The first place changes as the other one slides along, with which the gap has its bend.
                own = own + (gap.tangent @ ball @ gap.other.tangent) / bend * other
            if slides:
                taken = taken + np.multiply.outer(own, own) / np.float64(gap.bend * self.length)
        return taken
