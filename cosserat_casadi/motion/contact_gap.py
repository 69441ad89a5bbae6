"""A rod or a body that an obstacle faces, and the gap between the two with its derivatives.

A gap is the distance of a point, which moves with the unknowns, from the obstacle, less the radius there. The least gap
over a stretch of a rod is a function of the unknowns alone: its gradient is the gradient of the gap at the place where
it is least, and its second derivative is reduced because that place slides (E. Polak, *Optimization*, Springer 1997,
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
"""Least second derivative of the gap by X, over the length, of a sliding contact; as it falls the place runs away.

A rolling rod loses no energy, but a rod held at fixed sections moves like a polygon, and each section strikes. With
2e-2 these blows took a twentieth of the energy of a rubber rod that rolled onto its end, on 40 modes.
"""


STRIDE = 0.25
"""Longest way between two checks, over the sum of the radii: a passage deeper than 1/128 of the sum is noticed."""

NO_PASSAGE = 1e30
"""Way, m, longer than any in a step: for obstacles that nothing can pass through in a step."""


class Rows(NamedTuple):
    """Weights of the points in the position of a section, and in its derivative with respect to X, shape (M,) each."""

    value: FloatArray
    first: FloatArray


class SectionGap:
    """The gap at one section, over the length of the rod, with the geometry that determines its derivatives.

    Args:
        memory: the gap as written by C, shape (gap_size() / 2,).
        points: number of points of the rod or body.

    Attributes:
        value: the gap.
        slope: first derivative of the gap with respect to X.
        bend: second derivative of the gap with respect to X.
        other_place: abscissa of the nearest section of the other rod; None for an obstacle.
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
        """Second derivative of the distance with respect to the point, shape (3, 3), 1/m."""
        return self._memory[7:16].reshape(3, 3)

    @property
    def tangent(self) -> FloatArray:
        """Derivative of the position with respect to X, shape (3,), m."""
        return self._memory[16:GAP_COUNTS]


class Minimum(NamedTuple):
    """A section at which the gap has a local minimum.

    Attributes:
        place: abscissa X.
        gap: gap over the length.
        inside: whether it is between the ends of the rod.
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
        points: points of the rod or of the body; if a rod is touched, the points of that rod follow.
        of_body: whether the owner is a body.
    """

    model: Model
    owner: str
    against: scenes.ObstacleRecord | scenes.RodContact
    points: MovingPoints
    of_body: bool

    @property
    def obstacle(self) -> scenes.ObstacleRecord:
        """The obstacle of a pair; not for a pair of two rods."""
        assert not isinstance(self.against, scenes.RodContact), "asked for of obstacles"
        return self.against

    @property
    def touched(self) -> str:
        """Name of the obstacle, or of the other rod."""
        return self.obstacle.name

    @property
    @abstractmethod
    def length(self) -> float:
        """Length by which gaps are divided, m."""

    @property
    @abstractmethod
    def radii(self) -> tuple[float, float]:
        """Radii at base and tip of a rod, between which the radius is linear, or the radius of a body twice, m."""

    @cached_property
    def force_unit(self) -> float:
        """Unit of the contact forces, N."""
        return self.model.discrete.contact_unit(self.owner, of_body=self.of_body)

    @cached_property
    def energy_unit(self) -> float:
        """Work of a unit force along a unit gap, J."""
        return self.force_unit * self.length

    def nodes(self, x: FloatArray, inputs: FloatArray) -> FloatArray:
        """Positions of the points in the axes of the obstacle, shape (M, 3), m."""
        return self.points.positions(x, inputs)

    @property
    def carrier(self) -> str | None:
        """Name of the body that carries the obstacle; None for an obstacle in the world and for another rod."""
        return None if isinstance(self.against, scenes.RodContact) else self.against.body

    def axes(self, x: FloatArray, inputs: FloatArray) -> FloatArray:
        """Rotation from the axes of the obstacle, those of its body, to the axes of the world, shape (3, 3)."""
        if self.carrier is None:
            return np.eye(3)
        own = inputs[: self.model.inputs.size]
        return np.asarray(self.model.body[self.carrier](x, own)[2].full())

    @property
    def stride(self) -> float:
        """Longest way between two checks for contact in steps of given size, m."""
        return min(NO_PASSAGE, STRIDE * (float(self.obstacle.thickness) / 2.0 + min(self.radii)))

    @property
    @abstractmethod
    def ends(self) -> Sequence[float]:
        """Abscissae between which the gap is smooth: ends of the elements, from base to tip."""

    @property
    @abstractmethod
    def laid_at(self) -> FloatArray:
        """Abscissae of the sections that hold a rod while it lies, from base to tip, shape (k,); empty for a body."""

    @abstractmethod
    def describe(self, held: Held) -> None:
        """Write into the record the interpolation that gives sections from points."""

    @property
    def surfaces(self) -> dict[str, ca.Function]:
        """Functions of a point that define the surface of the obstacle, by their names in the records of C."""
        return {"surface": surface_at_once(self.obstacle), "distance": distance_from(self.obstacle)}

    @cached_property
    def in_law(self) -> Held:
        """Record of the pair for the contact law in C without friction."""
        return self.record(self.points.in_law)

    def record(self, points: Held) -> Held:
        """Make the record of the pair for C, without its friction law; ``points`` is the record of its points."""
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
        """Read a gap that C has written, shape (gap_size(),)."""
        return SectionGap(memory[: len(memory) // 2], self.points.count)

    def at(self, nodes: FloatArray, X: float, element: int | None = None) -> SectionGap:
        """Gap at a section by the polynomials of an element, by default the one that contains the section.

        The section may be a little beyond the ends of the rod and of the element.
        """
        memory = np.empty(gap_size())
        number = self.element(X) if element is None else element
        called("gap_at", self.in_law.address, _address(nodes), X, number, memory.ctypes.data)
        return self.gap(memory)

    def place(self, nodes: FloatArray, near: float, element: int) -> float:
        """Abscissa of the minimum of the gap next to ``near``, by the polynomials of an element."""
        return float(called("gap_place", self.in_law.address, _address(nodes), near, element))

    def element(self, X: float) -> int:
        """Number of the element that contains a section; where two elements meet, the one towards the tip."""
        return min(max(bisect_right(self.ends, X) - 1, 0), len(self.ends) - 2)

    def minima(self, nodes: FloatArray, below: float) -> list[Minimum]:
        """Local minima of the gap that do not exceed a bound over the length, from base to tip."""
        # A section that is looked at has one valley at most.
        places, gaps = np.zeros((2, LOOKS * (len(self.ends) - 1) + 1))
        room = places.ctypes.data, gaps.ctypes.data
        count = called("gap_valleys", self.in_law.address, _address(nodes), below, *room)
        return [_minimum(place, gap) for place, gap in zip(places[:count].tolist(), gaps[:count].tolist(), strict=True)]

    def laid_gaps(self, nodes: FloatArray) -> FloatArray:
        """Gaps at the sections that hold a rod while it lies, over the length, shape (k,)."""
        gaps = np.zeros(len(self.laid_at))
        called("laid_gaps", self.in_law.address, _address(nodes), gaps.ctypes.data)
        return gaps

    def lowest(self, nodes: FloatArray, but: Sequence[float], ends: Sequence[float] = ()) -> float:
        """Least gap over the length outside the valleys about some abscissae; infinite if nothing is outside of them.

        Args:
            nodes: positions of the points, shape (M, 3), m.
            but: abscissae whose valleys are left out.
            ends: ends of the rod that are left out where the gap has a minimum there.
        """
        return self._lowest(nodes, but, ends, all_ends=False).gap

    def deepest(self, nodes: FloatArray) -> Minimum:
        """The section with the least gap of all, held ends included."""
        return self._lowest(nodes, (), (), all_ends=True)

    def _lowest(self, nodes: FloatArray, but: Sequence[float], ends: Sequence[float], *, all_ends: bool) -> Minimum:
        place, gap = ctypes.c_double(), ctypes.c_double()
        places, left_out = ((ctypes.c_double * len(numbers))(*numbers) for numbers in (but, ends))
        lists = (places, (ctypes.c_int * len(but))(), len(but), left_out, len(ends))
        found = ctypes.byref(place), ctypes.byref(gap)
        called("lowest_gap", self.in_law.address, _address(nodes), all_ends, *lists, *found)
        return _minimum(place.value, gap.value)

    def gradient(self, x: FloatArray, inputs: FloatArray, gap: SectionGap) -> FloatArray:
        """Gradient of a gap with respect to the unknowns, shape (n,)."""
        return self.points.gradient(x, inputs, self.weights(gap))

    def by_inputs(self, x: FloatArray, inputs: FloatArray, gap: SectionGap) -> FloatArray:
        """Gradient of a gap with respect to the inputs, shape (m,)."""
        return self.points.by_inputs(x, inputs, self.weights(gap))

    def turning(self, by_nodes: FloatArray, gap: SectionGap, *, slides: bool) -> FloatArray:
        """Second derivative of a gap by the unknowns, less the part by second derivatives of the points, shape (n, n).

        Args:
            by_nodes: derivative of the points with respect to the unknowns, shape (M, 3, n), m.
            gap: the gap.
            slides: whether its place is where the gap is least; else it is fixed.
        """
        return np.asarray(self.turning_distance(by_nodes, gap, slides=slides) / self.length)

    def turning_distance(self, by_nodes: FloatArray, gap: SectionGap, *, slides: bool) -> FloatArray:
        """Second derivative of a distance along motions of the points, m.

        Args:
            by_nodes: motions of the points, shape (M, 3, n), or (M, 3) for one motion, m.
            gap: the gap.
            slides: whether its place is where the gap is least; else it is fixed.

        Returns:
            the derivative, shape (n, n), or () for one motion.
        """
        moved = np.tensordot(gap.rows.value, by_nodes, 1)
        second = moved.T @ gap.curvature @ moved
        if slides:
            turned = np.tensordot(gap.rows.first, by_nodes, 1)
            slope = gap.normal @ turned + gap.tangent @ gap.curvature @ moved
            second = second - np.multiply.outer(slope, slope) / (gap.bend * self.length)
        return np.asarray(second)

    def rates(
        self, x: FloatArray, v: FloatArray, inputs: Sequence[FloatArray], gap: SectionGap, *, slides: bool
    ) -> tuple[float, float]:
        """Rate of a gap, 1/s, and its second rate at zero accelerations of the unknowns, 1/s².

        Args:
            x: unknowns, shape (n,).
            v: rates of the unknowns, shape (n,), 1/s.
            inputs: the stacked inputs, their rates and their accelerations, shape (m,) each.
            gap: the gap.
            slides: whether its place is where the gap is least; else it is fixed.
        """
        value, rate, acceleration = inputs
        velocities, accelerations = self.points.straight_on(x, value, v, rate)
        first = float(gap.normal @ (gap.rows.value @ velocities))
        second = float(gap.normal @ (gap.rows.value @ accelerations))
        second += float(self.turning_distance(velocities, gap, slides=slides))
        if np.any(acceleration):
            second += self.length * float(self.by_inputs(x, value, gap) @ acceleration)
        return first / self.length, second / self.length

    def weights(self, gap: SectionGap) -> FloatArray:
        """Derivative of a gap with respect to the positions of the points, stacked point by point, shape (3M,), 1/m."""
        return np.outer(gap.rows.value, gap.normal / self.length).ravel()


def _address(nodes: FloatArray) -> int:
    """Address of the positions in memory, row after row."""
    assert nodes.flags.c_contiguous, "positions come from the points, row after row"
    return nodes.ctypes.data


def _minimum(place: float, gap: float) -> Minimum:
    """Return a section with its gap; a place next to an end of the rod, to rounding, counts as that end."""
    inside = AT_END < place < 1.0 - AT_END
    return Minimum(place if inside else float(round(place)), gap, inside)
