"""A rod or a body that an obstacle faces, and the gap between the two with its derivatives.

A gap is that of a point that moves with the unknowns, less what the surface lies outside of it. The least gap over a
stretch of a rod is a function of the unknowns alone: its gradient is that of the gap at the place where it is least,
and its second derivative is less by what that place slides (E. Polak, *Optimization*, Springer 1997, section 3.1).
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.motion.moving_points import MovingPoints

FAR = 0.02
"""Change of a place, over the length, from which on Newton's method is not believed to have stayed at one minimum."""

FLATTEST = 1e-3
"""Least second derivative of the gap with X, over the length, at a place that slides: it slides ever faster.

A rod that rolls loses nothing; one that is held at sections instead is a polygon, and each of them strikes. From 2e-2
on these blows took a twentieth of the energy of a rubber rod as it rolled onto its end, on 40 modes.
"""


class Rows(NamedTuple):
    """Weights of the points for a section, and for its first two derivatives with X, shape (M,) each."""

    value: FloatArray
    first: FloatArray
    second: FloatArray


class SectionGap(NamedTuple):
    """A gap at one section, over the length of the rod, and what its derivatives are made of.

    Attributes:
        value: the gap.
        slope: its derivative with X.
        bend: its second derivative with X.
        rows: of the section.
        normal: of the obstacle, shape (3,).
        curvature: second derivative of the distance with the point, shape (3, 3), 1/m.
        tangent: derivative of the position with X, shape (3,), m.
    """

    value: float
    slope: float
    bend: float
    rows: Rows
    normal: FloatArray
    curvature: FloatArray
    tangent: FloatArray


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
    """A rod or a body, and an obstacle that it may touch.

    Attributes:
        model: the model, built for a motion.
        owner: name of the rod, or of the body.
        obstacle: the obstacle.
        points: of the rod, or of the body.
        of_body: whether it is a body.
    """

    model: Model
    owner: str
    obstacle: scenes.ObstacleRecord
    points: MovingPoints
    of_body: bool

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
        """World positions of the points, shape (M, 3), m."""
        return self.points.positions(x, inputs)

    @abstractmethod
    def at(self, nodes: FloatArray, X: float, element: int | None = None) -> SectionGap:
        """The gap at a section, by the polynomials of an element next to it; None for the element that it lies in."""

    @abstractmethod
    def place(self, nodes: FloatArray, near: float, element: int | None = None) -> float:
        """Abscissa next to another where the gap is least, by these polynomials."""

    @property
    @abstractmethod
    def ends(self) -> Sequence[float]:
        """Abscissae between which the gap is smooth: ends of the elements, base to tip."""

    def element(self, X: float) -> int:
        """Number of the element of a section; of two that meet there the one beyond."""
        return min(max(bisect_right(self.ends, X) - 1, 0), len(self.ends) - 2)

    @abstractmethod
    def minima(self, nodes: FloatArray, below: float) -> list[Minimum]:
        """Sections whose gaps are the least about them, and not above a bound over the length, base to tip."""

    @property
    @abstractmethod
    def laid_at(self) -> FloatArray:
        """Abscissae of the sections at which it is held where it lies, base to tip, shape (k,); none of a body."""

    @abstractmethod
    def laid_gaps(self, nodes: FloatArray) -> FloatArray:
        """Gaps at these sections, over the length, shape (k,)."""

    @abstractmethod
    def lowest(self, nodes: FloatArray, but: Sequence[float], ends: Sequence[float] = ()) -> float:
        """The least gap over the length but for those in the valleys of some abscissae, and at some ends; may be ∞."""

    @abstractmethod
    def deepest(self, nodes: FloatArray) -> Minimum:
        """The section whose gap is the least of all, sections that are held included."""

    def gradient(self, x: FloatArray, inputs: FloatArray, gap: SectionGap) -> FloatArray:
        """Derivative of a gap with the unknowns, shape (n,)."""
        return self.points.gradient(x, inputs, self.weights(gap))

    def by_inputs(self, x: FloatArray, inputs: FloatArray, gap: SectionGap) -> FloatArray:
        """Derivative of a gap with the inputs, shape (m,)."""
        return self.points.by_inputs(x, inputs, self.weights(gap))

    def turning(self, by_nodes: FloatArray, gap: SectionGap, *, slides: bool) -> FloatArray:
        """Second derivative of a gap with the unknowns without that of the points, shape (n, n).

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
            v: their rates, likewise, 1/s.
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
