"""Bars, balls and other rods that no step may take a rod, a disk or a body through, where contact is smooth.

A smooth obstacle pushes only a rod that is in it: a step that ends behind it meets no force. The ends of a step are
judged by their depth; this module checks the way between them, on which unknowns and inputs change linearly. A part of
the way is halved if its sections leave the straight line by more than the room beside an obstacle. Rods that push each
other are checked in this way too.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from math import isfinite
from typing import NamedTuple

import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.equilibrium.contact.passing_through import (
    DEEP,
    FINEST,
    SECTIONS,
    LookedAt,
    admitted_depth,
    ball_is_inside_between,
    is_inside_between,
    seen_from,
)
from cosserat_casadi.equilibrium.load_path import between
from cosserat_casadi.equilibrium.smooth_contact import section_positions
from cosserat_casadi.errors import SceneError
from cosserat_casadi.loads.contact_layer import ContactLayer
from cosserat_casadi.loads.penetration import section_radius
from cosserat_casadi.maths.numbers import Scalar, is_zero, least
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.contact_depth import thin_layers
from cosserat_casadi.model.contact_pairs import ContactPair, thickness
from cosserat_casadi.model.discrete_scene import DiscreteScene
from cosserat_casadi.numerics.continuation import Path, PathPoint

EVERY = 2
"""Stride through the sections of rods that touch rods."""

SAME = 1e-6
"""Distance of unknowns, over their norm, below which two equilibria count as one."""

SHORTEST = 2.0**-9
"""Share of a step below which a part is not halved but counts as barred."""

REMEMBERED = 16
"""Number of shares of a way of parameters whose models are kept: all cases use the same shares."""

ROUGHLY = 8
"""Stride through sections for series of states: rods are nearly straight between these sections."""


class _Way(NamedTuple):
    """A straight way of sections or of a body.

    Attributes:
        start: first positions, shape (k, 3), m.
        end: last positions, shape (k, 3), m.
        bend: largest distance of sections from the straight way in the middle of the step, m.
    """

    start: FloatArray
    end: FloatArray
    bend: float


PlacesAt = Callable[[float, FloatArray, FloatArray], list[FloatArray]]
"""Positions of rods and bodies from a share of a step on which the model changes, and its unknowns and inputs."""


@dataclass(frozen=True)
class SmoothBarriers:
    """The smooth bars and balls of a scene."""

    model: Model

    @cached_property
    def watched(self) -> list[tuple[str, scenes.ObstacleRecord]]:
        """Pairs of a rod and a smooth obstacle of finite thickness, which the rod could pass."""
        scene = self.model.scene
        thin = _thin_obstacles(scene)
        return [(rod.name, obstacle) for rod in scene.rods for obstacle in thin if obstacle.concerns(rod.name)]

    @cached_property
    def watched_bodies(self) -> list[ContactLayer]:
        """The layers of obstacles of finite thickness for bodies and disks."""
        return [layer for layer in thin_layers(self.model.discrete) if layer.body is not None or layer.at is not None]

    @property
    def any(self) -> bool:
        """Whether the scene has any barriers."""
        return bool(self.watched or self.watched_bodies or self.model.discrete.pairs)

    def compares_with(self, other: SmoothBarriers) -> bool:
        """Whether another model has the same names of rods, bodies and obstacles in its barriers."""
        return self._names == other._names

    @property
    def _names(self) -> tuple[list[tuple[str, str]], list[tuple[str | None, str]], list[tuple[object, ...]]]:
        of_rods = [(rod, obstacle.name) for rod, obstacle in self.watched]
        of_bodies = [(layer.body or layer.rod, layer.obstacle.name) for layer in self.watched_bodies]
        return of_rods, of_bodies, [(pair.rods, pair.sections) for pair in self.model.discrete.pairs]

    def are_between(
        self,
        before: FloatArray,
        after: FloatArray,
        inputs: tuple[FloatArray, FloatArray],
        places: PlacesAt | None = None,
    ) -> bool:
        """Whether a rod or body passes a bar or ball, or two rods pass each other, on the way between two shapes.

        Args:
            before: unknowns at the start, shape (model.size,).
            after: unknowns at the end, shape (model.size,).
            inputs: stacked inputs at start and end.
            places: positions of rods and bodies on the way; by default from this model.
        """
        last = self.model.inputs.nearer(*inputs)

        def places_at(share: float) -> list[FloatArray]:
            x, given = between(before, after, share), between(inputs[0], last, share)
            return self.places(x, given) if places is None else places(share, x, given)

        lengths = [self.model.length(pair.rods[0], inputs[1]) for pair in self.model.discrete.pairs]
        return self._barred(places_at, lengths, (0.0, 1.0), (places_at(0.0), places_at(1.0)))

    def places(self, x: FloatArray, inputs: FloatArray) -> list[FloatArray]:
        """Positions of sections of rods and of bodies in the axes of obstacles, then of sections of pairs, m."""
        of_rods = [self._looked_at[rod].positions(obstacle, x, inputs) for rod, obstacle in self.watched]
        of_bodies = [self._place(layer, x, inputs)[None] for layer in self.watched_bodies]
        pairs = [section_positions(self.model, pair, x, inputs) for pair in self.model.discrete.pairs]
        return [*of_rods, *of_bodies, *(side for pair in pairs for side in pair)]

    def _barred(
        self,
        places_at: Callable[[float], list[FloatArray]],
        lengths: list[float],
        part: tuple[float, float],
        ends: tuple[list[FloatArray], list[FloatArray]],
    ) -> bool:
        """Whether a part of a step leads through an obstacle or a rod.

        Args:
            places_at: share of the step ↦ positions.
            lengths: length of the first rod of each pair, m.
            part: the shares of the step at which the part starts and ends.
            ends: the positions at these shares.
        """
        halfway = sum(part) / 2
        middle = places_at(halfway)
        halves = zip(middle, *ends, strict=True)
        bends = [float(np.linalg.norm(own - (a + b) / 2, axis=1).max()) for own, a, b in halves]
        found = self._leads_through(ends, bends, lengths)
        if found is None and part[1] - part[0] > SHORTEST:
            return self._barred(places_at, lengths, (part[0], halfway), (ends[0], middle)) or self._barred(
                places_at, lengths, (halfway, part[1]), (middle, ends[1])
            )
        return found is not False

    def _leads_through(
        self, ends: tuple[list[FloatArray], list[FloatArray]], bends: list[float], lengths: list[float]
    ) -> bool | None:
        """Whether a way that is straight up to its bend, m, leads through an obstacle or a rod; None if undecided."""
        ways = iter([_Way(*own) for own in zip(*ends, bends, strict=True)])
        barred = [self._rod_is_inside(rod, obstacle, next(ways)) for rod, obstacle in self.watched]
        barred += [self._ball_is_inside(layer, next(ways)) for layer in self.watched_bodies]
        pairs = zip(self.model.discrete.pairs, lengths, strict=True)
        barred += [self._pass_each_other(pair, length, next(ways), next(ways)) for pair, length in pairs]
        if any(found is None for found in barred):
            return None
        return any(barred)

    def _rod_is_inside(self, rod: str, obstacle: scenes.ObstacleRecord, way: _Way) -> bool | None:
        """Whether a section of a rod is too deep in an obstacle on the way between positions; None if undecided."""
        properties = self.model.discrete.rods[rod].properties
        deepest = float(depth_allowed(obstacle, properties.length))
        thinnest = float(section_radius(properties, SECTIONS).min())
        admitted = float(admitted_depth(obstacle, properties.length, deepest, thinnest))
        given = (obstacle, properties, way.start, way.end, deepest)
        return _as_far_as_bent(lambda bend: is_inside_between(*given, bend=bend), way.bend, admitted)

    def _ball_is_inside(self, layer: ContactLayer, way: _Way) -> bool | None:
        """Whether the largest ball in a body or a disk is too deep in an obstacle on a way; None if undecided."""
        obstacle, radius, length = self._ball(layer)
        deepest = float(depth_allowed(obstacle, length))
        admitted = float(admitted_depth(obstacle, length, deepest, radius))
        given = (obstacle, radius, length, way.start, way.end, deepest)
        return _as_far_as_bent(lambda bend: ball_is_inside_between(*given, bend), way.bend, admitted)

    def _ball(self, layer: ContactLayer) -> tuple[scenes.ObstacleRecord, float, float]:
        """Obstacle of a layer, radius of the ball that it pushes, m, and unit of depths, m."""
        return layer.obstacle, float(ball_in(layer)), float(length_of(self.model.discrete, layer))

    def _place(self, layer: ContactLayer, x: FloatArray, inputs: FloatArray) -> FloatArray:
        """Position of a body or a disk in the axes of its obstacle, shape (3,), m."""
        if layer.body is not None:
            place = self.model.body[layer.body](x, inputs)[0].full().T
            return np.asarray(seen_from(self.model, layer.obstacle, x, inputs, place)[0])
        assert layer.rod is not None, "a layer belongs to a body or to a rod"
        along = self._looked_at[layer.rod].positions(layer.obstacle, x, inputs)
        return np.array([np.interp(layer.at, SECTIONS, axis) for axis in along.T])

    def passages(self, x: FloatArray, inputs: FloatArray) -> Iterator[int]:
        """Indices of the states with a barred straight way to the next state; see :meth:`are_between`.

        Args:
            x: unknowns of states in their order, shape (k, model.size).
            inputs: stacked inputs, shape (k, inputs).
        """
        if not (self.model.discrete.pairs or self._somewhere_inside(x, inputs)):
            return
        for row in range(len(x) - 1):
            if self.are_between(x[row], x[row + 1], (inputs[row], inputs[row + 1])):
                yield row

    def _somewhere_inside(self, x: FloatArray, inputs: FloatArray) -> bool:
        """Whether a rod or body may be too deep in an obstacle between successive states, within the ways' bends."""
        halfway = ((x[:-1] + x[1:]) / 2, (inputs[:-1] + inputs[1:]) / 2)
        for rod, obstacle in self.watched:
            properties = self.model.discrete.rods[rod].properties
            paths, middle = (self._looked_at[rod].paths(obstacle, *at, every=ROUGHLY) for at in ((x, inputs), halfway))
            bends = np.linalg.norm(middle - (paths[:-1] + paths[1:]) / 2, axis=2).max(axis=1, initial=0.0)
            deepest = float(depth_allowed(obstacle, properties.length))
            if is_inside_between(obstacle, properties, paths[:-1], paths[1:], deepest, ROUGHLY, bends):
                return True
        for layer in self.watched_bodies:
            path, middle = (
                np.array([self._place(layer, *state) for state in zip(*at, strict=True)])
                for at in ((x, inputs), halfway)
            )
            bends = np.linalg.norm(middle - (path[:-1] + path[1:]) / 2, axis=1)
            ball = self._ball(layer)
            if ball_is_inside_between(*ball, path[:-1], path[1:], float(depth_allowed(ball[0], ball[2])), bends):
                return True
        return False

    def _pass_each_other(self, pair: ContactPair, length: float, first: _Way, second: _Way) -> bool | None:
        """Whether the axes of two rods come nearer than half their thickness on a way; None if undecided."""
        # The spacing of these sections is below half the thickness, unless an input lengthens the rods.
        spacings = [
            max(np.linalg.norm(np.diff(places, axis=0), axis=1).max() for places in (own.start, own.end))
            for own in (first, second)
        ]
        along = [length * (np.arange(count) + 0.5) / count for count in pair.sections]
        meets = pair.meets(*along)[::EVERY, ::EVERY]
        apart, later = (
            (own[::EVERY, None] - other[None, ::EVERY])[meets]
            for own, other in ((first.start, second.start), (first.end, second.end))
        )
        way = later - apart
        half = float(thickness(self.model.discrete.rods, pair)) / 2
        bend = first.bend + second.bend
        allowed = max(half, float(np.hypot(*spacings)) * EVERY / 2)
        longest = np.sqrt(np.einsum("ki,ki->k", way, way).max(initial=0.0))
        # Other pairs of sections stay apart.
        near = np.einsum("ki,ki->k", apart, apart) <= (allowed + bend + longest) ** 2
        apart, way = apart[near], way[near]
        lengths = np.einsum("ki,ki->k", way, way)
        share = -np.einsum("ki,ki->k", apart, way) / np.where(lengths > 0.0, lengths, 1.0)
        nearest = np.linalg.norm(apart + np.clip(share, 0.0, 1.0)[:, None] * way, axis=1).min(initial=np.inf)
        return _as_far_as_bent(lambda bend: bool(nearest < allowed + bend), bend, half)

    @cached_property
    def _looked_at(self) -> dict[str, LookedAt]:
        of_disks = {layer.rod for layer in self.watched_bodies if layer.rod is not None}
        return {rod: LookedAt(self.model, rod) for rod in {rod for rod, _ in self.watched} | of_disks}


def _as_far_as_bent(is_barred: Callable[[float], bool], bend: float, admitted: float) -> bool | None:
    """Whether a way is barred: True or False for a straight way; None if only a way within the bend may be barred.

    Args:
        is_barred: whether a way within a distance, m, from the straight one may be barred.
        bend: largest distance of the way from the straight one, m.
        admitted: admitted depth, m; a bend below the share :data:`FINEST` of it is ignored.
    """
    if bend <= FINEST * admitted:
        return is_barred(0.0)
    return None if is_barred(bend) else False


def quaternions_of(model: Model) -> list[int]:
    """Indices of the first entries of quaternions in the inputs followed by the parameters."""
    return model.inputs.quaternions + [model.inputs.size + start for start in model.parameters.quaternions]


def places_along(model: Model, parameters: tuple[FloatArray, FloatArray]) -> PlacesAt:
    """Positions of rods and bodies on the straight way from parameters to others.

    Args:
        model: a model with parameters.
        parameters: parameters at the shares 0 and 1, shape (model.parameters.size,) each.
    """
    last = model.parameters.nearer(*parameters)

    @lru_cache(maxsize=REMEMBERED)
    def at(share: float) -> SmoothBarriers:
        p = model.parameters.between(parameters[0], last, share)
        return SmoothBarriers(model.unjudged(model.parameters.split(p)))

    return lambda share, x, inputs: at(share).places(x, inputs)


def places_between(earlier: SmoothBarriers, later: SmoothBarriers) -> PlacesAt:
    """Positions on straight lines from one model to another, if no parameters lead from one to the other."""

    def places(share: float, x: FloatArray, inputs: FloatArray) -> list[FloatArray]:
        both = zip(earlier.places(x, inputs), later.places(x, inputs), strict=True)
        return [between(*own, share) for own in both]

    return places


def has_barriers(scene: scenes.Scene) -> bool:
    """Whether a scene has smooth obstacles of finite thickness, or contacts of rods."""
    return bool(_thin_obstacles(scene) or scene.rod_contacts)


def _thin_obstacles(scene: scenes.Scene) -> list[scenes.ObstacleRecord]:
    """Smooth obstacles of finite thickness."""
    return [obstacle for obstacle in scene.obstacles if obstacle.is_smooth and isfinite(obstacle.thickness)]


def are_one(x: FloatArray, other: FloatArray) -> bool:
    """Whether two vectors of unknowns at the same inputs are the same equilibrium to rounding."""
    return bool(np.linalg.norm(x - other) <= SAME * (1 + np.linalg.norm(x)))


def length_of(discrete: DiscreteScene, layer: ContactLayer) -> Scalar:
    """Unit of depths in a layer: the length of its rod, or of the longest rod that holds its body, m."""
    if layer.body is not None:
        return discrete.body_frame(layer.body).length
    assert layer.rod is not None, "a layer belongs to a body or to a rod"
    return discrete.rods[layer.rod].properties.length


def ball_in(layer: ContactLayer) -> Scalar:
    """Radius of the largest ball in the body or the disk of a layer, m."""
    return layer.radius if is_zero(layer.thickness) else least([layer.radius, layer.thickness / 2])


def depth_allowed(obstacle: scenes.ObstacleRecord, length: Scalar) -> Scalar:
    """Admitted depth inside a smooth obstacle on a step, relative to the length."""
    assert obstacle.width is not None
    return DEEP + obstacle.width / length


def past_no_obstacle(
    path: Path,
    model: Model,
    inputs: tuple[FloatArray, FloatArray],
    parameters: tuple[FloatArray, FloatArray] | None = None,
    before_it: PlacesAt | None = None,
) -> Path:
    """A path that refuses steps through smooth bars, balls and rods; the path itself in a scene without these.

    Args:
        path: path of a model on the straight line to other inputs, and perhaps parameters.
        model: the model.
        inputs: stacked inputs at t = 0 and 1.
        parameters: parameters at t = 0 and 1; None without parameters.
        before_it: positions on the way from another model, if the start is an equilibrium of that model.
    """
    barriers = SmoothBarriers(model)
    if not barriers.any:
        return path

    def admits(before: PathPoint, after: PathPoint) -> bool:
        (first, t), (last, target) = before, after
        at_ends = (between(*inputs, t), between(*inputs, target))
        own, places = barriers, before_it if t == target == 0.0 else None
        try:
            if parameters is not None:
                step = (between(*parameters, t), between(*parameters, target))
                own = SmoothBarriers(model.unjudged(model.parameters.split(model.parameters.between(*step, 1.0))))
                places = places_along(model, step)
            return not own.are_between(first, last, at_ends, places)
        except SceneError:
            # The scene refuses such parameters: the positions of its rods are unknown.
            return False

    return replace(path, admits=admits)
