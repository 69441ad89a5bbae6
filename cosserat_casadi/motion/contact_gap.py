"""A rod or a body that an obstacle faces, and the gap between the two with its derivatives.

A gap is the distance of a point that moves with the unknowns, less what the surface lies outside of it. The least gap
over a stretch of a rod is a function of the unknowns alone: its gradient is the gradient of the gap at the place where
it is least, and its second derivative is less by what that place slides (E. Polak, *Optimization*, Springer 1997,
section 3.1).
"""

from __future__ import annotations

import ctypes
from abc import ABC, abstractmethod
from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import casadi as ca
import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.compiling.shared_records import Held
from cosserat_casadi.equilibrium.contact.obstacle_surfaces import distance_from, surface_at_once
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.motion.contact_law import (
    AT_END,
    DOUBLE,
    GAP_COUNTS,
    GAP_NUMBERS,
    LOOKS,
    FacingRecord,
    called,
    gap_size,
    program_record,
)
from cosserat_casadi.motion.moving_points import MovingPoints

FLATTEST = 1e-3
"""Least second derivative of the gap with X, over the length, at a place that slides: it slides ever faster.

A rod that rolls loses nothing; one that is held at sections instead is a polygon, and each section strikes. From 2e-2
on these blows took a twentieth of the energy of a rubber rod as it rolled onto its end, on 40 modes.
"""


STRIDE = 0.25
"""Longest way between two looks, over the radius of an obstacle and the rod: what passes deeper than 1/128 is seen."""

NO_PASSAGE = 1e30
"""Way, m, that nothing goes in a step: no obstacle is passed in it."""


class Rows(NamedTuple):
    """Weights of the points for a section, and for its derivative with X, shape (M,) each."""

    value: FloatArray
    first: FloatArray


class SectionGap:
    """A gap at one section, over the length of the rod, and what its derivatives are made of.

    Args:
        memory: the gap as C has written it, shape (gap_size() / 2,).
        points: number of the points of the rod or body.

    Attributes:
        value: the gap.
        slope: its derivative with X.
        bend: its second derivative with X.
        other_place: abscissa of the section of another rod that is nearest; None beside an obstacle.
    """

    other_place: float | None = None

    def __init__(self, memory: FloatArray, points: int) -> None:
        self._memory = memory
        self._points = points
        self.value, self.slope, self.bend = (float(number) for number in memory[1:4])

    @cached_property
    def rows(self) -> Rows:
        """Weights of the points."""
        first, count = self._memory[GAP_COUNTS : GAP_COUNTS + 1].view(np.int32).tolist()
        rows = np.zeros((2, self._points))
        rows[:, first : first + count] = self._memory[GAP_NUMBERS:].reshape(2, -1)[:, :count]
        return Rows(*rows)

    @property
    def normal(self) -> FloatArray:
        """Normal of the obstacle, shape (3,)."""
        return self._memory[4:7]

    @property
    def curvature(self) -> FloatArray:
        """Second derivative of the distance with the point, shape (3, 3), 1/m."""
        return self._memory[7:16].reshape(3, 3)

    @property
    def tangent(self) -> FloatArray:
        """Derivative of the position with X, shape (3,), m."""
        return self._memory[16:GAP_COUNTS]


class Minimum(NamedTuple):
    """A section whose gap is the least about it.

    Attributes:
        place: abscissa X.
        gap: over the length.
        inside: whether it is no end of the rod.
    """

    place: float
    gap: float
    inside: bool


@dataclass(frozen=True)
class Facing(ABC):
    """A rod or a body, and an obstacle or another rod that it may touch.

    Attributes:
        model: the model, built for a motion.
        owner: name of the rod, or of the body.
        against: the obstacle, or the contact with the other rod.
        points: of the rod, or of the body; behind those of a rod stand those of the other rod.
        of_body: whether it is a body.
    """

    model: Model
    owner: str
    against: scenes.ObstacleRecord | scenes.RodContact
    points: MovingPoints
    of_body: bool

    @property
    def obstacle(self) -> scenes.ObstacleRecord:
        """The obstacle of a pair that is not of two rods."""
        assert not isinstance(self.against, scenes.RodContact), "asked for of obstacles"
        return self.against

    @property
    def touched(self) -> str:
        """Name of the obstacle, or of the other rod."""
        return self.obstacle.name

    @property
    @abstractmethod
    def length(self) -> float:
        """Length that gaps are counted in, m."""

    @property
    @abstractmethod
    def radii(self) -> tuple[float, float]:
        """Radius at base and tip of a rod, between which it is linear, or of a body twice, m."""

    @cached_property
    def force_unit(self) -> float:
        """Unit of the contact forces, N."""
        return self.model.discrete.contact_unit(self.owner, of_body=self.of_body)

    @cached_property
    def energy_unit(self) -> float:
        """Work of a unit of force along a unit of the gap, J."""
        return self.force_unit * self.length

    def nodes(self, x: FloatArray, inputs: FloatArray) -> FloatArray:
        """Positions of the points in the axes of the obstacle, shape (M, 3), m."""
        return self.points.positions(x, inputs)

    @property
    def carrier(self) -> str | None:
        """Name of the body that carries the obstacle; None where it stands still, and beside another rod."""
        return None if isinstance(self.against, scenes.RodContact) else self.against.body

    def axes(self, x: FloatArray, inputs: FloatArray) -> FloatArray:
        """Rotation from the axes of the obstacle, which are those of its body, to the world's, shape (3, 3)."""
        if self.carrier is None:
            return np.eye(3)
        own = inputs[: self.model.inputs.size]
        return np.asarray(self.model.body[self.carrier](x, own)[2].full())

    @property
    def stride(self) -> float:
        """Longest way between two looks for contact in steps of given length, m."""
        return min(NO_PASSAGE, STRIDE * (float(self.obstacle.thickness) / 2.0 + min(self.radii)))

    @property
    @abstractmethod
    def ends(self) -> Sequence[float]:
        """Abscissae between which the gap is smooth: ends of the elements, base to tip."""

    @property
    @abstractmethod
    def laid_at(self) -> FloatArray:
        """Abscissae of the sections at which it is held where it lies, base to tip, shape (k,); none of a body."""

    @abstractmethod
    def describe(self, held: Held) -> None:
        """Write into the record how the sections follow from the points."""

    @property
    def surfaces(self) -> dict[str, ca.Function]:
        """Functions of a point that tell where the obstacle is, by the names that records in C have for them."""
        return {"surface": surface_at_once(self.obstacle), "distance": distance_from(self.obstacle)}

    @cached_property
    def in_law(self) -> Held:
        """The pair as the law in C without friction has it."""
        return self.record(self.points.in_law)

    def record(self, points: Held) -> Held:
        """The record of the pair for C, without a function of friction; ``points`` is the record of its points."""
        record = FacingRecord(is_body=self.of_body, laid_count=len(self.laid_at), restitution=self.against.restitution)
        record.length, record.force_unit, record.stride = self.length, self.force_unit, self.stride
        record.radius_at_base, record.radius_at_tip = self.radii
        record.coefficients = (DOUBLE * 3)(*self.against.coefficients)
        held = Held(record)
        held.point("points", points)
        held.share("laid", np.ascontiguousarray(self.laid_at, dtype=float))
        for name, function in self.surfaces.items():
            held.point(name, program_record(function))
        self.describe(held)
        held.share("fitted", np.zeros(3 * self.points.count))
        held.share("gaps_along", np.zeros(LOOKS * record.elements + 1))
        return held

    def gap(self, memory: FloatArray) -> SectionGap:
        """A gap that C has written, shape (gap_size(),)."""
        return SectionGap(memory[: len(memory) // 2], self.points.count)

    def at(self, nodes: FloatArray, X: float, element: int | None = None) -> SectionGap:
        """The gap at a section, by the polynomials of an element next to it; None for the element that it lies in.

        It is looked at a little beyond the ends of the rod and of an element too.
        """
        memory = np.empty(gap_size())
        number = self.element(X) if element is None else element
        called("gap_at", self.in_law.address, _address(nodes), X, number, memory.ctypes.data)
        return self.gap(memory)

    def place(self, nodes: FloatArray, near: float, element: int) -> float:
        """Abscissa next to another where the gap is least, by the polynomials of an element."""
        return float(called("gap_place", self.in_law.address, _address(nodes), near, element))

    def element(self, X: float) -> int:
        """Number of the element of a section; of two that meet there the one beyond."""
        return min(max(bisect_right(self.ends, X) - 1, 0), len(self.ends) - 2)

    def minima(self, nodes: FloatArray, below: float) -> list[Minimum]:
        """Sections whose gaps are the least about them, and not above a bound over the length, base to tip."""
        # A section that is looked at has one valley at most.
        places, gaps = np.zeros((2, LOOKS * (len(self.ends) - 1) + 1))
        room = places.ctypes.data, gaps.ctypes.data
        count = called("gap_valleys", self.in_law.address, _address(nodes), below, *room)
        return [_minimum(place, gap) for place, gap in zip(places[:count].tolist(), gaps[:count].tolist(), strict=True)]

    def laid_gaps(self, nodes: FloatArray) -> FloatArray:
        """Gaps at the sections at which it is held where it lies, over the length, shape (k,)."""
        gaps = np.zeros(len(self.laid_at))
        called("laid_gaps", self.in_law.address, _address(nodes), gaps.ctypes.data)
        return gaps

    def lowest(self, nodes: FloatArray, but: Sequence[float], ends: Sequence[float] = ()) -> float:
        """The least gap over the length but for those in the valleys of some abscissae; infinite where there is none.

        Args:
            nodes: positions, shape (M, 3), m.
            but: these abscissae.
            ends: ends of the rod that are left out where they are lower than all beside them.
        """
        return self._lowest(nodes, but, ends, all_ends=False).gap

    def deepest(self, nodes: FloatArray) -> Minimum:
        """The section whose gap is the least of all, sections that are held included."""
        return self._lowest(nodes, (), (), all_ends=True)

    def _lowest(self, nodes: FloatArray, but: Sequence[float], ends: Sequence[float], *, all_ends: bool) -> Minimum:
        place, gap = ctypes.c_double(), ctypes.c_double()
        places, left_out = ((ctypes.c_double * len(numbers))(*numbers) for numbers in (but, ends))
        lists = (places, (ctypes.c_int * len(but))(), len(but), left_out, len(ends))
        found = ctypes.byref(place), ctypes.byref(gap)
        called("lowest_gap", self.in_law.address, _address(nodes), all_ends, *lists, *found)
        return _minimum(place.value, gap.value)

    def gradient(self, x: FloatArray, inputs: FloatArray, gap: SectionGap) -> FloatArray:
        """Derivative of a gap with the unknowns, shape (n,)."""
        return self.points.gradient(x, inputs, self.weights(gap))

    def by_inputs(self, x: FloatArray, inputs: FloatArray, gap: SectionGap) -> FloatArray:
        """Derivative of a gap with the inputs, shape (m,)."""
        return self.points.by_inputs(x, inputs, self.weights(gap))

    def turning(self, by_nodes: FloatArray, gap: SectionGap, *, slides: bool) -> FloatArray:
        """Second derivative of a gap with the unknowns without the second derivative of the points, shape (n, n).

        Args:
            by_nodes: derivative of the points with the unknowns, shape (M, 3, n), m.
            gap: the gap.
            slides: whether its place is where the gap is least, and not a given one.
        """
        moved = np.tensordot(gap.rows.value, by_nodes, 1)
        second = moved.T @ gap.curvature @ moved
        if slides:
            turned = np.tensordot(gap.rows.first, by_nodes, 1)
            slope = gap.normal @ turned + gap.tangent @ gap.curvature @ moved
            second = second - np.outer(slope, slope) / (gap.bend * self.length)
        return np.asarray(second / self.length)

    def rates(
        self, x: FloatArray, v: FloatArray, inputs: Sequence[FloatArray], gap: SectionGap, *, slides: bool
    ) -> tuple[float, float]:
        """Rate of a gap, 1/s, and its second derivative without the part of the accelerations of the unknowns, 1/s².

        Args:
            x: unknowns, shape (n,).
            v: rates of the unknowns, shape (n,), 1/s.
            inputs: the stacked inputs, their rates and their accelerations, shape (m,) each.
            gap: the gap.
            slides: whether its place is where the gap is least, and not a given one.
        """
        value, rate, acceleration = inputs
        velocities, accelerations = self.points.straight_on(x, value, v, rate)
        velocity = gap.rows.value @ velocities
        first = float(gap.normal @ velocity)
        second = float(gap.normal @ (gap.rows.value @ accelerations) + velocity @ gap.curvature @ velocity)
        if slides:
            slope = float(gap.normal @ (gap.rows.first @ velocities) + gap.tangent @ gap.curvature @ velocity)
            second -= slope**2 / (gap.bend * self.length)
        if np.any(acceleration):
            second += self.length * float(self.by_inputs(x, value, gap) @ acceleration)
        return first / self.length, second / self.length

    def weights(self, gap: SectionGap) -> FloatArray:
        """Weights of the positions of the points, stacked point by point, whose sum varies as the gap does, 1/m."""
        return np.outer(gap.rows.value, gap.normal / self.length).ravel()


def _address(nodes: FloatArray) -> int:
    """Where positions are in memory, row after row."""
    assert nodes.flags.c_contiguous, "positions come from the points, row after row"
    return nodes.ctypes.data


def _minimum(place: float, gap: float) -> Minimum:
    """A section with its gap; rounding alone makes no other one of an end of the rod."""
    inside = AT_END < place < 1.0 - AT_END
    return Minimum(place if inside else float(round(place)), gap, inside)
