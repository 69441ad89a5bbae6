"""Whether rods would pass through obstacles on the way from one shape to another.

A solve that starts from a solution knows its shape alone: where inputs change much, Newton's method may end behind an
obstacle, in an equilibrium that the rods could not have come to.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.equilibrium.contact.body_obstacles import in_axes_of
from cosserat_casadi.equilibrium.contact.gaps import (
    DENSE,
    ball_gaps,
    ball_radius,
    body_pairs,
    pairs,
    section_gaps,
    seen_sections,
)
from cosserat_casadi.equilibrium.solution import Solution, SolvedPoses
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.rod.properties import RodProperties

SECTIONS = DENSE
"""Abscissae that are looked at."""

STRIDE = 1e-3
"""Way of a section between two looks, relative to the length of the rod: thinner obstacles may be missed."""

MOST_LOOKS = 400
"""Most looks on the way."""

DEEP = 1e-3
"""Depth on the way, relative to the length, that is more than the chord of a rod that slides along an obstacle."""


@dataclass(frozen=True)
class LookedAt:
    """The sections of a rod that are looked at, of shapes that are asked for one after the other.

    Attributes:
        model: of the scene.
        rod: name of the rod.
    """

    model: Model
    rod: str

    def positions(self, obstacle: scenes.ObstacleRecord, x: FloatArray, inputs: FloatArray) -> FloatArray:
        """Positions at the abscissae SECTIONS, in the axes that an obstacle is given in, shape (k, 3), m.

        Args:
            obstacle: what sees them.
            x: unknowns, shape (model.size,).
            inputs: stacked inputs, shape (model.inputs.size,).
        """
        at_nodes = self.model.fields[self.rod](x, inputs)[0].full()
        in_world = np.asarray(self._interpolation @ at_nodes.T)
        if obstacle.body is None:
            return in_world
        position, quaternion, rotation = (part.full() for part in self.model.body[obstacle.body](x, inputs))
        return in_axes_of(SolvedPoses(position.T, rotation[None], quaternion.T), in_world)

    @cached_property
    def _interpolation(self) -> FloatArray:
        """Matrix from values at the nodes to values at the sections, shape (k, nodes)."""
        return self.model.discrete.rods[self.rod].grid.interpolation_matrix(SECTIONS)


def passes_through(before: Solution, after: Solution) -> bool:
    """Whether a section or a body is inside an obstacle on the straight way from one shape to the other."""
    for rod, obstacle in pairs(after.model.scene):
        start = seen_sections(before, rod, obstacle, SECTIONS)
        end = seen_sections(after, rod, obstacle, SECTIONS)
        if is_inside_between(obstacle, after.model.discrete.rods[rod].properties, start, end):
            return True
    for body, obstacle in body_pairs(after.model.scene):
        length = after.model.discrete.body_frame(body.name).length
        way = (before.body(body.name).position, after.body(body.name).position)
        if ball_is_inside_between(obstacle, ball_radius(body), length, *way):
            return True
    return False


def ball_is_inside_between(
    obstacle: scenes.ObstacleRecord,
    radius: float,
    length: float,
    start: FloatArray,
    end: FloatArray,
    deepest: float = DEEP,
) -> bool:
    """Whether a ball is inside an obstacle on the straight way from one position to another, shape (1, 3) each, m.

    Args:
        obstacle: the obstacle.
        radius: of the ball, m.
        length: what depths are relative to, m.
        start: position.
        end: another.
        deepest: depth on the way up to which it is not inside.
    """
    way = float(np.linalg.norm(end - start))
    gaps = ball_gaps(obstacle, radius, start + _shares(way, length)[:, None] * (end - start))
    return bool(gaps.min() < -deepest * length)


def is_inside_between(
    obstacle: scenes.ObstacleRecord,
    properties: RodProperties,
    start: FloatArray,
    end: FloatArray,
    deepest: float = DEEP,
) -> bool:
    """Whether a section of a rod is inside an obstacle on the straight way from its positions to others.

    Args:
        obstacle: the obstacle.
        properties: of the rod.
        start: positions at the abscissae SECTIONS, in the axes that the obstacle is given in, shape (k, 3), m.
        end: others, likewise.
        deepest: depth on the way, relative to the length of the rod, up to which it is not inside.
    """
    gaps_at_start = section_gaps(obstacle, properties, start, SECTIONS)
    gaps_at_end = section_gaps(obstacle, properties, end, SECTIONS)
    ways = np.linalg.norm(end - start, axis=1)
    # A distance changes by no more than the way: on a shorter one nothing can have come between.
    doubtful = ways > np.maximum(gaps_at_start, 0.0) + np.maximum(gaps_at_end, 0.0)
    if not doubtful.any():
        return False
    shares = _shares(float(ways[doubtful].max()), properties.length)
    positions = start[doubtful] + shares[:, None, None] * (end - start)[doubtful]
    X = np.broadcast_to(SECTIONS[doubtful], positions.shape[:2])
    gaps = section_gaps(obstacle, properties, positions.reshape(-1, 3), X.ravel())
    return bool(gaps.min() < -deepest * properties.length)


def _shares(way: float, length: float) -> FloatArray:
    """Shares of a way, without its ends, at which is looked, shape (looks,).

    Args:
        way: its length, m.
        length: length of the rod or body that the way is relative to, m.
    """
    looks = int(np.clip(way / (STRIDE * length), 1, MOST_LOOKS))
    return np.linspace(0.0, 1.0, looks + 2)[1:-1]
