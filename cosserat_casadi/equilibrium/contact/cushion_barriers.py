"""Bars and balls that rods and bodies must not come out of on the other side while they lie on soft cushions.

A cushion does not hold in its middle: a rod that is pushed, or jumps, beyond it is outside again, in an equilibrium
that it cannot have come to.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import isfinite

from cosserat_casadi import scene as scenes
from cosserat_casadi.equilibrium.contact.gaps import DENSE, body_gap, body_pairs, gap_along, inner_radius, pairs
from cosserat_casadi.equilibrium.contact.passing_through import (
    MIDDLE,
    LookedAt,
    ball_is_inside_between,
    is_inside_between,
)
from cosserat_casadi.equilibrium.solution import Solution
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.numerics.outcome import Outcome


@dataclass(frozen=True)
class Barriers:
    """The bars and balls that the unloaded rods of a model are outside of.

    Attributes:
        model: of a scene with obstacles.
        inputs: stacked inputs, shape (model.inputs.size,).
    """

    model: Model
    inputs: FloatArray

    @cached_property
    def watched(self) -> list[tuple[str, scenes.ObstacleRecord]]:
        """Rods with obstacles that they must not pass through; a rod that begins inside is pushed out to any side."""
        unloaded = self._shape(self.model.unloaded())
        return [
            (rod, obstacle)
            for rod, obstacle in pairs(self.model.scene)
            if isfinite(obstacle.thickness) and gap_along(unloaded, rod, obstacle, DENSE).min() >= 0.0
        ]

    @cached_property
    def watched_bodies(self) -> list[tuple[scenes.Body, scenes.ObstacleRecord]]:
        """Pairs of a body and an obstacle that it must not pass through."""
        unloaded = self._shape(self.model.unloaded())
        return [
            (body, obstacle)
            for body, obstacle in body_pairs(self.model.scene)
            if isfinite(obstacle.thickness) and body_gap(unloaded, body, obstacle) >= 0.0
        ]

    def are_between(self, before: FloatArray, after: FloatArray) -> bool:
        """Whether a rod or a body comes near the middle of one on the way between two shapes, given by unknowns."""
        for rod, obstacle in self.watched:
            properties = self.model.discrete.rods[rod].properties
            start = self._looked_at[rod].positions(obstacle, before, self.inputs)
            end = self._looked_at[rod].positions(obstacle, after, self.inputs)
            if is_inside_between(obstacle, properties, start, end, self._deepest(rod, obstacle)):
                return True
        for body, obstacle in self.watched_bodies:
            length = self.model.discrete.body_frame(body.name).length
            pose = self.model.body[body.name]
            way = (pose(before, self.inputs)[0].full().T, pose(after, self.inputs)[0].full().T)
            if ball_is_inside_between(obstacle, inner_radius(body), length, *way, self._deepest_ball(body, obstacle)):
                return True
        return False

    def give_way(self, x: FloatArray) -> bool:
        """Whether a rod or a body has sunk into an obstacle by more than half of the depth that is admitted."""
        shape = self._shape(x)
        rods_sink = any(
            gap_along(shape, rod, obstacle, DENSE).min() < -self._deepest(rod, obstacle) / 2
            for rod, obstacle in self.watched
        )
        bodies_sink = any(
            body_gap(shape, body, obstacle) < -self._deepest_ball(body, obstacle) / 2
            for body, obstacle in self.watched_bodies
        )
        return rods_sink or bodies_sink

    @cached_property
    def _looked_at(self) -> dict[str, LookedAt]:
        return {rod: LookedAt(self.model, rod) for rod, _ in self.watched}

    def _deepest(self, rod: str, obstacle: scenes.ObstacleRecord) -> float:
        """Depth of a rod in an obstacle that is admitted, over the length of the rod."""
        radius = obstacle.thickness / 2
        return MIDDLE * radius / self.model.discrete.rods[rod].properties.length

    def _deepest_ball(self, body: scenes.Body, obstacle: scenes.ObstacleRecord) -> float:
        """Depth of a body in an obstacle that is admitted, over the body's length: its centre stays off the middle."""
        radii = obstacle.thickness / 2 + inner_radius(body)
        return MIDDLE * radii / self.model.discrete.body_frame(body.name).length

    def _shape(self, x: FloatArray) -> Solution:
        """The rods at some unknowns, which need not be in equilibrium."""
        return Solution(self.model, self.inputs, x, Outcome.CONVERGED, "", residual_norm=0.0, iterations=0)
