"""A rod in motion that faces another rod: its sections, and the sections of the other rod that are nearest to them.

A section of the first rod sees the other rod as an obstacle that moves. The gap is the least distance d of the section
from the other centre line, less both radii: d = |r(X) − s(Y)| with the normal n from s to r. The contact is where the
gap is least along the first rod too. So the gap is a minimum over both abscissae, or over Y alone where X is held. Its
gradient with the unknowns is that of d with X and Y held; its second derivative is less by what X and Y slide:

    δ²d − cᵀ M⁻¹ c,   M the second derivatives of d with X and Y, c how its first ones change with the unknowns.

M is eliminated place by place: Y first, and then X, along which the gap bends as Y slides along.

Forces on both rods are opposite and on one line: they leave neither a resultant nor a moment.
"""

from __future__ import annotations

from collections.abc import Sequence
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
        memory: both sections as C has written them, shape (gap_size(),).
        points: number of the points of both rods.

    Attributes:
        other: the section of the other rod, seen from the section of the first one.
        other_place: its abscissa.
    """

    other_place: float

    def __init__(self, memory: FloatArray, points: int) -> None:
        own, other = np.split(memory, 2)
        super().__init__(own, points)
        self.other = SectionGap(other, points)
        self.other_place = float(other[0])

    @cached_property
    def own_rows(self) -> Rows:
        """Weights of the points for the section of the first rod, and for its tangent."""
        return SectionGap(self._memory, self._points).rows

    @cached_property
    def rows(self) -> Rows:
        """Weights of the points for the way from the other section to the first one, and for its change with X."""
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
        """Longest way of a point of either rod between two looks for contact in steps of given length, m."""
        return STRIDE * (min(self.radii) + min(self.other.radii)) / 2.0

    @property
    def surfaces(self) -> dict[str, ca.Function]:
        """No functions of a point tell where the other rod is: its nodes do."""
        return {}

    def describe(self, held: Held) -> None:
        """Write elements, how sections follow from nodes, and the other rod into the record."""
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
        """A gap that C has written, shape (gap_size(),)."""
        return RodGap(memory, self.points.count)

    def turning(self, by_nodes: FloatArray, gap: SectionGap, *, slides: bool) -> FloatArray:
        """Second derivative of a gap with the unknowns without the second derivative of the points, shape (n, n)."""
        assert isinstance(gap, RodGap), "gaps of rods are of two sections"
        moved = np.tensordot(gap.rows.value, by_nodes, 1)
        second = moved.T @ gap.other.curvature @ moved - self._taken(by_nodes, gap, slides=slides)
        return np.asarray(second / self.length)

    def rates(
        self, x: FloatArray, v: FloatArray, inputs: Sequence[FloatArray], gap: SectionGap, *, slides: bool
    ) -> tuple[float, float]:
        """Rate of a gap, 1/s, and its second derivative without the part of the accelerations of the unknowns, 1/s²."""
        assert isinstance(gap, RodGap), "gaps of rods are of two sections"
        value, rate, acceleration = inputs
        velocities, accelerations = self.points.straight_on(x, value, v, rate)
        velocity = gap.rows.value @ velocities
        first = float(gap.normal @ velocity)
        second = float(gap.normal @ (gap.rows.value @ accelerations) + velocity @ gap.other.curvature @ velocity)
        second -= float(self._taken(velocities, gap, slides=slides))
        if np.any(acceleration):
            second += self.length * float(self.by_inputs(x, value, gap) @ acceleration)
        return first / self.length, second / self.length

    def _taken(self, by_nodes: FloatArray, gap: RodGap, *, slides: bool) -> FloatArray:
        """Part of the second derivative of the distance that the sliding of both abscissae takes away, cᵀ M⁻¹ c, m.

        Args:
            by_nodes: motion of all points, shape (M, 3, n), or (M, 3) of one motion.
            gap: the gap.
            slides: whether the place on the first rod is where the gap is least, and not a given one.

        Returns:
            shape (n, n), or () of one motion.
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
