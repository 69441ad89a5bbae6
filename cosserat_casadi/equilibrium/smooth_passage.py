"""Bars and balls with a width that no step may take a rod through.

A smooth obstacle pushes where a rod is in it: a step that ends behind it has not felt it. The ends of a step are judged
by their depth; here the straight way between them is.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import isfinite

from cosserat_casadi import scene as scenes
from cosserat_casadi.equilibrium.contact.passing_through import DEEP, LookedAt, is_inside_between
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model


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

    def are_between(self, before: FloatArray, after: FloatArray, inputs: tuple[FloatArray, FloatArray]) -> bool:
        """Whether a rod is deep inside one on the straight way between two shapes, and at neither of its ends.

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
        return False

    @cached_property
    def _looked_at(self) -> dict[str, LookedAt]:
        return {rod: LookedAt(self.model, rod) for rod, _ in self.watched}
