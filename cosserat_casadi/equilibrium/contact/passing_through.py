"""Whether rods would pass through obstacles on the way from one shape to another.

A solve that starts from a solution knows its shape alone: if inputs change much, Newton's method may end behind an
obstacle, in an equilibrium that the rods could not have reached.

Sections move in straight lines. A distance changes by no more than the length of the way, so that a part of the rod and
of the way is free of the obstacle if the distance in its middle is larger than the width of the part; other parts are
halved.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from cosserat_casadi import scene as scenes
from cosserat_casadi.equilibrium.contact.body_obstacles import in_axes_of
from cosserat_casadi.equilibrium.contact.gaps import (
    DENSE,
    ball_gaps,
    body_pairs,
    inner_radius,
    pairs,
    rod_pairs,
    section_gaps,
    seen_sections,
)
from cosserat_casadi.equilibrium.solution import Solution, SolvedPoses
from cosserat_casadi.loads.penetration import section_radius
from cosserat_casadi.maths.calls import evaluated
from cosserat_casadi.maths.numbers import Scalar, least
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.rod.properties import RodProperties

SECTIONS = DENSE
"""Abscissae of the sections whose ways are checked."""

OF_RODS = DENSE[::4]
"""Abscissae of rods that are looked at on the way past other rods."""

WAYS = 17
"""Shares of their way at which the places of two rods are compared."""

HALVINGS = 30
"""Times that the part of a way is halved in which lines may cut each other."""

DEEP = 1e-3
"""Depth on the way, relative to the length, above the depth of the chord of a rod that slides along an obstacle."""

MIDDLE = 0.7
"""Share of the distance from the surface to the middle of a bar or ball by which a rod may sink in.

Deeper rods come out on the other side. A rod with a radius touches before its centre line is at the surface.
"""

FINEST = 0.25
"""Width of the smallest parts of a way, over the admitted depth: no way through the middle is missed."""


@dataclass(frozen=True)
class LookedAt:
    """Positions of the checked sections of a rod, for one shape after the other.

    Attributes:
        model: model of the scene.
        rod: name of the rod.
    """

    model: Model
    rod: str

    def positions(self, obstacle: scenes.ObstacleRecord, x: FloatArray, inputs: FloatArray) -> FloatArray:
        """Positions at the abscissae SECTIONS, in the axes of an obstacle, shape (k, 3), m.

        Args:
            obstacle: the obstacle.
            x: unknowns, shape (model.size,).
            inputs: stacked inputs, shape (model.inputs.size,).
        """
        at_nodes = self.model.fields[self.rod](x, inputs)[0].full()
        return seen_from(self.model, obstacle, x, inputs, np.asarray(self._interpolation @ at_nodes.T))

    def paths(
        self,
        obstacle: scenes.ObstacleRecord,
        x: FloatArray,
        inputs: FloatArray,
        *,
        every: int,
    ) -> FloatArray:
        """Positions as of :meth:`positions` in T states, at one of ``every`` SECTIONS, shape (T, k, 3), m.

        Args:
            obstacle: the obstacle.
            x: unknowns, shape (T, model.size).
            inputs: stacked inputs, shape (T, model.inputs.size).
            every: stride through SECTIONS.
        """
        at_nodes = evaluated(self.model.fields[self.rod], x, inputs)[0]
        positions = np.asarray(self._interpolation[::every] @ np.swapaxes(at_nodes, 1, 2))
        if obstacle.body is None:
            return positions
        of_body, _, rotations = evaluated(self.model.body[obstacle.body], x, inputs)
        return np.asarray((positions - np.swapaxes(of_body, 1, 2)) @ rotations)

    @cached_property
    def _interpolation(self) -> FloatArray:
        """Matrix from values at the nodes to values at the sections, shape (k, nodes)."""
        return self.model.discrete.rods[self.rod].grid.interpolation_matrix(SECTIONS)


def seen_from(
    model: Model, obstacle: scenes.ObstacleRecord, x: FloatArray, inputs: FloatArray, positions: FloatArray
) -> FloatArray:
    """Convert positions in the world, shape (k, 3), to the axes of an obstacle."""
    if obstacle.body is None:
        return positions
    position, quaternion, rotation = (part.full() for part in model.body[obstacle.body](x, inputs))
    return in_axes_of(SolvedPoses(position[:, 0], rotation, quaternion[:, 0]), positions)


def passes_through(before: Solution, after: Solution, deepest: float = DEEP) -> bool:
    """Whether a section or a body is inside an obstacle on the straight way from one shape to another.

    Args:
        before: a shape.
        after: another, of the same scene.
        deepest: admitted depth on the way, see :func:`is_inside_between`.
    """
    for rod, obstacle in pairs(after.model.scene):
        start = seen_sections(before, rod, obstacle, SECTIONS)
        end = seen_sections(after, rod, obstacle, SECTIONS)
        if is_inside_between(obstacle, after.model.discrete.rods[rod].properties, start, end, deepest):
            return True
    for rods in rod_pairs(after.model.scene):
        ways = [[solution.pose(OF_RODS, rod).position for solution in (before, after)] for rod in rods]
        if lines_cross_between(*ways):
            return True
    for body, obstacle in body_pairs(after.model.scene):
        length = after.model.discrete.body_frame(body.name).length
        way = (before.body(body.name).position, after.body(body.name).position)
        if ball_is_inside_between(obstacle, inner_radius(body), length, *way, deepest):
            return True
    return False


def lines_cross_between(first: Sequence[FloatArray], second: Sequence[FloatArray]) -> bool:
    """Whether two lines cut each other on the straight way of their points from one shape to another.

    Four points lie in a plane where the volume that they span vanishes. Two pieces of the lines cut each other where
    that is so and either ends on both sides of the other.

    Args:
        first: positions of the points of a line at both ends of the way, shape (k, 3) each, m.
        second: positions of those of the other line.
    """
    starts, ends = zip(first, second, strict=True)
    reach = max(float(np.linalg.norm(np.diff(line, axis=0), axis=1).max()) for line in (*starts, *ends))
    way = sum(float(np.linalg.norm(end - start, axis=1).max()) for start, end in (first, second))
    apart = np.linalg.norm(starts[0][:-1, None] - starts[1][None, :-1], axis=2)
    pieces = np.nonzero(apart <= 2 * reach + way)

    def corners(share: FloatArray) -> list[FloatArray]:
        """Ends of the pieces of both lines at shares of the way, shape (…, 3) each."""
        return [
            line[0][number + k] + share[..., None] * (line[1][number + k] - line[0][number + k])
            for line, number in zip((first, second), pieces, strict=True)
            for k in (0, 1)
        ]

    def volume(share: FloatArray) -> FloatArray:
        a, b, c, d = corners(share)
        return np.asarray(np.einsum("...i,...i->...", np.cross(b - a, d - c), c - a))

    looks = np.linspace(0.0, 1.0, WAYS)
    volumes = np.array([volume(np.full(len(pieces[0]), share)) for share in looks])
    steps, changed = np.nonzero(np.diff(np.sign(volumes), axis=0))
    pieces = tuple(number[changed] for number in pieces)
    low, high = looks[steps], looks[steps + 1]
    sign = np.sign(volumes[steps, changed])
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        before = np.sign(volume(middle)) == sign
        low, high = np.where(before, middle, low), np.where(before, high, middle)
    a, b, c, d = corners(low)
    across = np.cross(b - a, d - c)
    square = np.einsum("...i,...i->...", across, across)
    cut = np.ones(len(square), dtype=bool)
    for along in (d - c, b - a):
        share = np.einsum("...i,...i->...", np.cross(c - a, along), across)
        cut &= (share >= 0.0) & (share <= square)
    return bool(np.any(cut & (square > 0.0)))


def admitted_depth(obstacle: scenes.ObstacleRecord, length: Scalar, deepest: Scalar, radius: Scalar) -> Scalar:
    """Admitted depth inside an obstacle on the way, m.

    Args:
        obstacle: the obstacle.
        length: unit of depths, m.
        deepest: admitted depth relative to it; the result is at most :data:`MIDDLE` of the distance to the middle.
        radius: radius of a ball, or of the thinnest section of a rod, m.
    """
    return least([deepest * length, MIDDLE * (obstacle.thickness / 2 + radius)])


def ball_is_inside_between(
    obstacle: scenes.ObstacleRecord,
    radius: float,
    length: float,
    start: FloatArray,
    end: FloatArray,
    deepest: float = DEEP,
    bend: float | FloatArray = 0.0,
) -> bool:
    """Whether a ball is inside an obstacle on a straight way from one position to another.

    Args:
        obstacle: the obstacle.
        radius: radius of the ball, m.
        length: unit of depths, m.
        start: first position, shape (3,), or first positions of several ways, shape (ways, 3), m.
        end: last position, of the shape of ``start``, m.
        deepest: admitted depth on the way, at most :data:`MIDDLE` of the distance to the middle.
        bend: largest distance of the way, or each way, from the straight one, m; a number, or shape (ways,).
    """
    admitted = float(admitted_depth(obstacle, length, deepest, radius))
    # A ball is a stretch of zero length.
    ends = (np.repeat(np.atleast_2d(start), 2, axis=0), np.repeat(np.atleast_2d(end), 2, axis=0))
    sinking = _sinking(lambda positions, _: ball_gaps(obstacle, radius, positions), *ends, np.zeros(2), admitted, bend)
    return bool(sinking.any())


def is_inside_between(
    obstacle: scenes.ObstacleRecord,
    properties: RodProperties,
    start: FloatArray,
    end: FloatArray,
    deepest: float = DEEP,
    every: int = 1,
    bend: float | FloatArray = 0.0,
) -> bool:
    """Whether a section of a rod is inside an obstacle on a straight way to another.

    Args:
        obstacle: the obstacle.
        properties: properties of the rod.
        start: first positions at the abscissae SECTIONS, in the axes of the obstacle, shape (k, 3), m; or first
            positions of several ways, shape (ways, k, 3).
        end: last positions, of the shape of ``start``, m.
        deepest: admitted depth on the way over the length, at most :data:`MIDDLE` of the distance to the middle.
        every: stride through SECTIONS of the positions.
        bend: largest distance of sections from the straight way, m, or from each way, shape (ways,).
    """
    thinnest = float(section_radius(properties, SECTIONS).min())
    admitted = float(admitted_depth(obstacle, properties.length, deepest, thinnest))
    sinking = _sinking(
        lambda positions, X: section_gaps(obstacle, properties, positions, X),
        start,
        end,
        SECTIONS[::every],
        admitted,
        np.maximum(_off_chords(start), _off_chords(end)) + bend,
    )
    return bool(sinking.any())


def _off_chords(positions: FloatArray) -> FloatArray:
    """Bound on the distance of rods from the chords between their sections, shape (ways,), m.

    Between sections at a distance h an arc of the curvature κ is κ h²/8 off its chord, and second differences of
    positions are κ h². The bound is twice that, since the curvature changes between sections.
    """
    bends = np.linalg.norm(np.diff(positions, 2, axis=-2), axis=-1)
    return np.atleast_1d(bends.max(axis=-1, initial=0.0) / 4)


def _sinking(
    gaps_at: Callable[[FloatArray, FloatArray], FloatArray],
    start: FloatArray,
    end: FloatArray,
    X: FloatArray,
    admitted: float,
    off: float | FloatArray = 0.0,
) -> npt.NDArray[np.bool_]:
    """Whether each straight way of sections has a gap below −admitted, shape (ways,).

    Args:
        gaps_at: function from positions, shape (k, 3), and their abscissae to gaps, m.
        start: first positions at X, between which the rod is straight, one way after another, shape (…, 3), m.
        end: last positions, of the shape of ``start``, m.
        X: abscissae, shape (k,).
        admitted: admitted depth, m.
        off: bound on the distance of the rod from the chords between its sections, m, on all ways or each, (ways,).
    """
    start, end = start.reshape(-1, 3), end.reshape(-1, 3)
    sections = len(X)
    sunk = np.zeros(len(start) // sections, dtype=bool)
    least: FloatArray = np.broadcast_to(np.asarray(off - admitted, dtype=float), sunk.shape)
    joints = np.arange(1, len(start)) % sections == 0
    X = np.tile(X, len(sunk))
    # Types are declared: inferring the types of variables that the loop changes takes the type checker six seconds.
    ways: FloatArray = np.asarray(np.linalg.norm(end - start, axis=1), dtype=float)
    stretches: FloatArray = np.maximum(
        *(np.linalg.norm(np.diff(positions, axis=0), axis=1) for positions in (start, end))
    )
    first: npt.NDArray[np.int_] = np.flatnonzero(~joints)
    # Middle and width of each part, in the index of the section and in the share of the way.
    section: FloatArray = first + np.float64(0.5)
    share: FloatArray = np.full(len(first), 0.5)
    along: FloatArray = np.ones(len(first))
    across: FloatArray = np.ones(len(first))
    while len(first):
        weight: FloatArray = (section - first)[:, None]
        before: FloatArray = (1 - weight) * start[first] + weight * start[first + 1]
        after: FloatArray = (1 - weight) * end[first] + weight * end[first + 1]
        abscissae = X[first] + weight[:, 0] * (X[first + 1] - X[first])
        gaps = gaps_at(before + share[:, None] * (after - before), abscissae)
        way = first // sections
        sunk[way[gaps < least[way]]] = True
        by_section = along * stretches[first]
        by_way = across * np.maximum(ways[first], ways[first + 1])
        reach = (by_section + by_way) / 2
        halved = (gaps - reach < least[way]) & (reach > FINEST * admitted) & ~sunk[way]
        longer = (by_section > by_way)[halved]
        first = np.tile(first[halved], 2)
        section, share, along, across = (part[halved] for part in (section, share, along, across))
        along = np.where(longer, along / 2, along)
        across = np.where(longer, across, across / 2)
        by_half = np.where(longer, along / 2, 0.0), np.where(longer, 0.0, across / 2)
        along, across = (np.tile(part, 2) for part in (along, across))
        section = np.concatenate([section - by_half[0], section + by_half[0]])
        share = np.concatenate([share - by_half[1], share + by_half[1]])
    return sunk
