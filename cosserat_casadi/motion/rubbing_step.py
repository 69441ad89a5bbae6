"""A step of a motion with friction of exact contact; contact forces stand behind the unknowns of the model."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.numerics.step import TimeStep, restricted


@dataclass(frozen=True)
class RubbingStep(TimeStep):
    """A step with m pressing contacts; behind the unknowns stand m forces along normals, then 2 m along tangents.

    Attributes:
        axes: axis of each contact, whose part along the surface is the first tangent, shape (m, 3).
        slips: whether each contact slips in the step; else it sticks.
        power: power that friction takes from the motion at the stages, shape (s,), W.
        put_in: power of moving inputs against friction at the stages, shape (s,), W.
    """

    axes: FloatArray
    slips: tuple[bool, ...]
    power: FloatArray
    put_in: FloatArray

    def until(self, time: float) -> RubbingStep:
        """The part of the step up to a time in it, s; its powers are interpolated between those of the whole step."""
        share = (time - self.start.time) / self.size
        at = self.method.values_at(share * self.method.nodes)
        shorter = restricted(self, time)
        assert isinstance(shorter, RubbingStep), "a part of a step is a step"
        return replace(shorter, power=at @ self.power, put_in=at @ self.put_in)


def along_tangents(normal: FloatArray, axis: FloatArray, forces: FloatArray) -> FloatArray:
    """A vector in world axes from its parts along the two tangents that C uses, shape (3,).

    Args:
        normal: unit normal of the surface, shape (3,).
        axis: axis whose part along the surface is the first tangent, shape (3,).
        forces: parts of the vector along both tangents, shape (2,).
    """
    first = axis - (axis @ normal) * normal
    first = first / np.linalg.norm(first)
    return np.asarray(forces[0] * first + forces[1] * np.cross(normal, first))
