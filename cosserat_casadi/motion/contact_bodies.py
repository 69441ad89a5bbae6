"""A body in motion against one obstacle: the ball of its radius about its origin, which touches at one point."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from cosserat_casadi.equilibrium.contact.obstacle_surfaces import distance_along
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.motion.contact_gap import Facing, Minimum, Rows, SectionGap

CENTRE = Rows(np.ones(1), np.zeros(1), np.zeros(1))
"""Weights of the one point that a ball has: nothing slides along it."""


@dataclass(frozen=True)
class BodyFacing(Facing):
    """A body and an obstacle that it may touch.

    Attributes:
        radius: of the ball, m.
    """

    radius: float

    @cached_property
    def length(self) -> float:
        """Length of the longest rod that holds it, m."""
        return float(self.model.discrete.body_frame(self.owner).length)

    @property
    def radii(self) -> tuple[float, float]:
        """Its radius, twice, m."""
        return self.radius, self.radius

    def at(self, nodes: FloatArray, X: float, element: int | None = None) -> SectionGap:
        """The gap, whatever the abscissa."""
        still = np.zeros(3)
        distance = distance_along(self.obstacle, nodes[0], still, still)
        gap = (distance.value - self.radius) / self.length
        return SectionGap(gap, 0.0, 0.0, CENTRE, distance.normal, distance.curvature, still)

    def place(self, nodes: FloatArray, near: float, element: int | None = None) -> float:
        """The abscissa that it has."""
        return near

    @property
    def ends(self) -> Sequence[float]:
        """The abscissae of base and tip of a rod, whatever the body."""
        return (0.0, 1.0)

    def minima(self, nodes: FloatArray, below: float) -> list[Minimum]:
        """The ball, where its gap is not above a bound."""
        ball = self.deepest(nodes)
        return [ball] if ball.gap <= below else []

    @property
    def laid_at(self) -> FloatArray:
        """None: a ball touches at one point."""
        return np.zeros(0)

    def laid_gaps(self, nodes: FloatArray) -> FloatArray:
        """Gaps at these sections: none."""
        return np.zeros(0)

    def lowest(self, nodes: FloatArray, but: Sequence[float], ends: Sequence[float] = ()) -> float:
        """The gap, where the ball does not touch already; else infinite."""
        return float("inf") if but else self.deepest(nodes).gap

    def deepest(self, nodes: FloatArray) -> Minimum:
        """The ball."""
        return Minimum(0.0, self.at(nodes, 0.0).value, False)
