"""Bars, balls and other rods that no step may take a rod, a disk or a body through, where contact is smooth.

A smooth obstacle pushes where a rod is in it: a step that ends behind it has not felt it. The ends of a step are judged
by their depth; here the straight way between them is. So it is with rods that push each other.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from math import isfinite

import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.equilibrium.contact.passing_through import (
    DEEP,
    SECTIONS,
    LookedAt,
    ball_is_inside_between,
    is_inside_between,
    seen_from,
)
from cosserat_casadi.equilibrium.load_path import between
from cosserat_casadi.equilibrium.rod_contacts import section_positions
from cosserat_casadi.errors import SceneError
from cosserat_casadi.loads.contact_layer import ContactLayer
from cosserat_casadi.maths.numbers import Scalar, is_zero, least
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.contact_depth import thin_layers
from cosserat_casadi.model.contact_pairs import ContactPair, thickness
from cosserat_casadi.model.discrete_scene import DiscreteScene
from cosserat_casadi.numerics.continuation import Path, PathPoint

EVERY = 2
"""Sections of rods that touch rods of which one is looked at."""

SAME = 1e-6
"""Distance of unknowns, over their norm, within which two equilibria are one."""

ROUGHLY = 8
"""Sections of which one is looked at where many states follow each other: rods are nearly straight between them."""


@dataclass(frozen=True)
class SmoothBarriers:
    """The smooth bars and balls of a scene."""

    model: Model

    @cached_property
    def watched(self) -> list[tuple[str, scenes.ObstacleRecord]]:
        """Pairs of a rod and an obstacle that has another side, on which the rod could come out."""
        scene = self.model.scene
        thin = _thin_obstacles(scene)
        return [(rod.name, obstacle) for rod in scene.rods for obstacle in thin if obstacle.concerns(rod.name)]

    @cached_property
    def watched_bodies(self) -> list[ContactLayer]:
        """The layers of such obstacles for bodies and disks."""
        return [layer for layer in thin_layers(self.model.discrete) if layer.body is not None or layer.at is not None]

    @property
    def any(self) -> bool:
        """Whether there is anything to watch."""
        return bool(self.watched or self.watched_bodies or self.model.discrete.pairs)

    def compares_with(self, other: SmoothBarriers) -> bool:
        """Whether another model has the same rods and bodies beside the same obstacles, by name."""
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
        earlier: SmoothBarriers | None = None,
    ) -> bool:
        """Whether a rod or body is deep inside one on the straight way between two shapes, and at neither of its ends.

        Args:
            before: unknowns at the start, shape (model.size,).
            after: unknowns at the end, likewise.
            inputs: stacked inputs at start and end.
            earlier: of the model with the parameters at the start; where they are other ones.
        """
        at_start = earlier or self
        for rod, obstacle in self.watched:
            properties = self.model.discrete.rods[rod].properties
            start = at_start._looked_at[rod].positions(obstacle, before, inputs[0])
            end = self._looked_at[rod].positions(obstacle, after, inputs[1])
            if is_inside_between(obstacle, properties, start, end, float(depth_allowed(obstacle, properties.length))):
                return True
        for layer in self.watched_bodies:
            way = (at_start._place(layer, before, inputs[0]), self._place(layer, after, inputs[1]))
            if self._is_inside_between(layer, *way):
                return True
        return self.rods_pass(before, after, inputs, earlier)

    def _is_inside_between(self, layer: ContactLayer, start: FloatArray, end: FloatArray) -> bool:
        """Whether the largest ball in a body or a disk is deep inside an obstacle on the way between positions."""
        length, radius = float(length_of(self.model.discrete, layer)), float(ball_in(layer))
        depth = float(depth_allowed(layer.obstacle, length))
        return ball_is_inside_between(layer.obstacle, radius, length, start, end, depth)

    def _place(self, layer: ContactLayer, x: FloatArray, inputs: FloatArray) -> FloatArray:
        """Position of a body or a disk in the axes of its obstacle, shape (3,), m."""
        if layer.body is not None:
            place = self.model.body[layer.body](x, inputs)[0].full().T
            return np.asarray(seen_from(self.model, layer.obstacle, x, inputs, place)[0])
        assert layer.rod is not None, "a layer of no body is of a rod"
        along = self._looked_at[layer.rod].positions(layer.obstacle, x, inputs)
        return np.array([np.interp(layer.at, SECTIONS, axis) for axis in along.T])

    def passages(self, x: FloatArray, inputs: FloatArray) -> Iterator[int]:
        """Numbers of the states from which the straight way to the next one is barred, as :meth:`are_between` has it.

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
        """Whether a rod or body is deep inside an obstacle on the straight ways from state to state."""
        for rod, obstacle in self.watched:
            properties = self.model.discrete.rods[rod].properties
            paths = self._looked_at[rod].paths(obstacle, x, inputs, every=ROUGHLY)
            way = (paths[:-1], paths[1:])
            deepest = float(depth_allowed(obstacle, properties.length))
            if is_inside_between(obstacle, properties, *way, deepest, ROUGHLY):
                return True
        for layer in self.watched_bodies:
            path = np.array([self._place(layer, *state) for state in zip(x, inputs, strict=True)])
            if self._is_inside_between(layer, path[:-1], path[1:]):
                return True
        return False

    def rods_pass(
        self,
        before: FloatArray,
        after: FloatArray,
        inputs: tuple[FloatArray, FloatArray],
        earlier: SmoothBarriers | None = None,
    ) -> bool:
        """Whether rods pass through each other, or a rod through itself, on the straight way, as above."""
        at_start = earlier or self
        pairs = zip(at_start.model.discrete.pairs, self.model.discrete.pairs, strict=True)
        return any(
            self._pass_each_other(
                pair,
                self.model.length(pair.rods[0], inputs[1]),
                section_positions(at_start.model, pair_at_start, before, inputs[0]),
                section_positions(self.model, pair, after, inputs[1]),
            )
            for pair_at_start, pair in pairs
        )

    def _pass_each_other(
        self,
        pair: ContactPair,
        length: float,
        starts: tuple[FloatArray, FloatArray],
        ends: tuple[FloatArray, FloatArray],
    ) -> bool:
        """Whether the axes of two rods come nearer than half their thickness on the way of their sections."""
        moved = [end - start for start, end in zip(starts, ends, strict=True)]
        # Every other section: they are nearer each other than half the thickness.
        along = [length * (np.arange(count) + 0.5) / count for count in pair.sections]
        meets = pair.meets(*along)[::EVERY, ::EVERY]
        apart, way = ((own[0][::EVERY, None] - own[1][None, ::EVERY])[meets] for own in (starts, moved))
        allowed = float(thickness(self.model.discrete.rods, pair)) / 2
        squares = np.einsum("ki,ki->k", apart, apart)
        near = squares < (allowed + np.sqrt(np.max(np.einsum("ki,ki->k", way, way), initial=0.0))) ** 2
        apart, way = apart[near], way[near]
        lengths = np.einsum("ki,ki->k", way, way)
        share = -np.einsum("ki,ki->k", apart, way) / np.where(lengths > 0.0, lengths, 1.0)
        nearest = apart + np.clip(share, 0.0, 1.0)[:, None] * way
        return bool(np.any(np.linalg.norm(nearest, axis=1) < allowed))

    @cached_property
    def _looked_at(self) -> dict[str, LookedAt]:
        of_disks = {layer.rod for layer in self.watched_bodies if layer.rod is not None}
        return {rod: LookedAt(self.model, rod) for rod in {rod for rod, _ in self.watched} | of_disks}


def has_barriers(scene: scenes.Scene) -> bool:
    """Whether a scene has smooth obstacles with another side, or rods that touch rods."""
    return bool(_thin_obstacles(scene) or scene.rod_contacts)


def _thin_obstacles(scene: scenes.Scene) -> list[scenes.ObstacleRecord]:
    """Smooth obstacles that have another side."""
    return [obstacle for obstacle in scene.obstacles if obstacle.is_smooth and isfinite(obstacle.thickness)]


def are_one(x: FloatArray, other: FloatArray) -> bool:
    """Whether the unknowns of two equilibria at the same inputs are those of one."""
    return bool(np.linalg.norm(x - other) <= SAME * (1 + np.linalg.norm(x)))


def length_of(discrete: DiscreteScene, layer: ContactLayer) -> Scalar:
    """Length that depths before a layer are relative to: of its rod, or of the longest one that holds its body, m."""
    if layer.body is not None:
        return discrete.body_frame(layer.body).length
    assert layer.rod is not None, "a layer of no body is of a rod"
    return discrete.rods[layer.rod].properties.length


def ball_in(layer: ContactLayer) -> Scalar:
    """Radius of the largest ball in the body or the disk of a layer, m."""
    return layer.radius if is_zero(layer.thickness) else least([layer.radius, layer.thickness / 2])


def depth_allowed(obstacle: scenes.ObstacleRecord, length: Scalar) -> Scalar:
    """Depth inside a smooth obstacle that is not deep, relative to the length."""
    assert obstacle.width is not None
    return DEEP + obstacle.width / length


def past_no_obstacle(
    path: Path,
    model: Model,
    inputs: tuple[FloatArray, FloatArray],
    parameters: tuple[FloatArray, FloatArray] | None = None,
    before_it: Model | None = None,
) -> Path:
    """A path without steps through smooth bars, balls and rods; the path itself in a scene that has none.

    Args:
        path: of a model on the straight line to other inputs, and perhaps parameters.
        model: the model.
        inputs: stacked inputs at t = 0 and 1.
        parameters: of a model that has them, at t = 0 and 1.
        before_it: the model that the start of the path is an equilibrium of, where it is another.
    """
    barriers = SmoothBarriers(model)
    if not barriers.any:
        return path

    # A step is looked at from the end of the last one.
    @lru_cache(maxsize=2)
    def barriers_at(t: float) -> SmoothBarriers:
        return barriers if parameters is None else SmoothBarriers(model.at(between(*parameters, t)))

    def admits(before: PathPoint, after: PathPoint) -> bool:
        (first, t), (last, target) = before, after
        at_ends = (between(*inputs, t), between(*inputs, target))
        try:
            earlier, later = barriers_at(t), barriers_at(target)
        except SceneError:
            # The scene refuses such parameters: where its rods would be is not known.
            return False
        of_start = None if before_it is None else SmoothBarriers(before_it)
        if of_start is not None and t == target == 0.0 and of_start.compares_with(later):
            earlier = of_start
        return not later.are_between(first, last, at_ends, earlier)

    return replace(path, admits=admits)
