"""Bars, balls and other rods that no step may take a rod, a disk or a body through, where contact is smooth.

A smooth obstacle pushes where a rod is in it: a step that ends behind it has not felt it. The ends of a step are judged
by their depth; here the straight way between them is. So it is with rods that push each other.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
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
from cosserat_casadi.equilibrium.rod_contacts import section_positions
from cosserat_casadi.loads.contact_layer import ContactLayer
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.contact_pairs import ContactPair

EVERY = 2
"""Sections of rods that touch rods of which one is looked at."""


@dataclass(frozen=True)
class SmoothBarriers:
    """The smooth bars and balls of a scene."""

    model: Model

    @cached_property
    def watched(self) -> list[tuple[str, scenes.ObstacleRecord]]:
        """Pairs of a rod and an obstacle that has another side, on which the rod could come out."""
        scene = self.model.scene
        smooth = [obstacle for obstacle in scene.obstacles if obstacle.is_smooth and isfinite(obstacle.thickness)]
        return [(rod.name, obstacle) for rod in scene.rods for obstacle in smooth if obstacle.concerns(rod.name)]

    @cached_property
    def watched_bodies(self) -> list[ContactLayer]:
        """The layers of such obstacles for bodies and disks."""
        layers = [load for load in self.model.discrete.loads if isinstance(load, ContactLayer)]
        of_bodies = [layer for layer in layers if layer.body is not None or layer.at is not None]
        return [layer for layer in of_bodies if isfinite(layer.obstacle.thickness)]

    @property
    def any(self) -> bool:
        """Whether there is anything to watch."""
        return bool(self.watched or self.watched_bodies or self.model.discrete.pairs)

    def are_between(self, before: FloatArray, after: FloatArray, inputs: tuple[FloatArray, FloatArray]) -> bool:
        """Whether a rod or body is deep inside one on the straight way between two shapes, and at neither of its ends.

        Args:
            before: unknowns at the start, shape (model.size,).
            after: unknowns at the end, likewise.
            inputs: stacked inputs at start and end.
        """
        for rod, obstacle in self.watched:
            properties = self.model.discrete.rods[rod].properties
            start = self._looked_at[rod].positions(obstacle, before, inputs[0])
            end = self._looked_at[rod].positions(obstacle, after, inputs[1])
            assert obstacle.width is not None
            allowed = DEEP + obstacle.width / properties.length
            if is_inside_between(obstacle, properties, start, end, allowed):
                return True
        if any(self._is_inside_between(layer, before, after, inputs) for layer in self.watched_bodies):
            return True
        return self.rods_pass(before, after, inputs)

    def _is_inside_between(
        self, layer: ContactLayer, before: FloatArray, after: FloatArray, inputs: tuple[FloatArray, FloatArray]
    ) -> bool:
        """Whether the largest ball in a body or a disk is deep inside an obstacle on the way, as above."""
        start, end = (self._place(layer, *state) for state in zip((before, after), inputs, strict=True))
        discrete = self.model.discrete
        if layer.body is not None:
            length = discrete.body_frame(layer.body).length
        else:
            assert layer.rod is not None, "a layer of no body is of a rod"
            length = discrete.rods[layer.rod].properties.length
        radius = min(layer.radius, layer.thickness / 2) if layer.thickness else layer.radius
        assert layer.obstacle.width is not None
        allowed = DEEP + layer.obstacle.width / length
        return ball_is_inside_between(layer.obstacle, radius, length, start, end, allowed)

    def _place(self, layer: ContactLayer, x: FloatArray, inputs: FloatArray) -> FloatArray:
        """Position of a body or a disk in the axes of its obstacle, shape (3,), m."""
        if layer.body is not None:
            place = self.model.body[layer.body](x, inputs)[0].full().T
            return np.asarray(seen_from(self.model, layer.obstacle, x, inputs, place)[0])
        assert layer.rod is not None, "a layer of no body is of a rod"
        along = self._looked_at[layer.rod].positions(layer.obstacle, x, inputs)
        return np.array([np.interp(layer.at, SECTIONS, axis) for axis in along.T])

    def rods_pass(self, before: FloatArray, after: FloatArray, inputs: tuple[FloatArray, FloatArray]) -> bool:
        """Whether rods pass through each other, or a rod through itself, on the straight way, as above."""
        return any(self._pass_each_other(pair, before, after, inputs) for pair in self.model.discrete.pairs)

    def _pass_each_other(
        self, pair: ContactPair, before: FloatArray, after: FloatArray, inputs: tuple[FloatArray, FloatArray]
    ) -> bool:
        """Whether the axes of two rods come nearer than half their thickness on the way."""
        starts = section_positions(self.model, pair, before, inputs[0])
        ends = section_positions(self.model, pair, after, inputs[1])
        moved = [end - start for start, end in zip(starts, ends, strict=True)]
        # Every other section: they are nearer each other than half the thickness.
        meets = pair.meets[::EVERY, ::EVERY]
        apart, way = ((own[0][::EVERY, None] - own[1][None, ::EVERY])[meets] for own in (starts, moved))
        allowed = pair.thickness / 2
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
