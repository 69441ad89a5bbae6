"""A step of a motion with friction of exact contact: forces of contacts are behind the unknowns of the model."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.numerics.step import TimeStep, restricted


@dataclass(frozen=True)
class RubbingStep(TimeStep):
    """A step in which m contacts press; behind the unknowns stand m forces along normals and 2 m along the surfaces.

    Attributes:
        axes: whose parts along the surfaces are the first tangents, shape (m, 3).
        slips: whether each slips in the step; else it sticks.
        power: power of friction at the stages, taken from the motion, shape (s,), W.
        put_in: power of moving inputs against friction at the stages, shape (s,), W.
    """

    axes: FloatArray
    slips: tuple[bool, ...]
    power: FloatArray
    put_in: FloatArray

    def until(self, time: float) -> RubbingStep:
        """The part up to a time in it, with the powers of the whole interpolated."""
        share = (time - self.start.time) / self.size
        at = self.method.values_at(share * self.method.nodes)
        shorter = restricted(self, time)
        assert isinstance(shorter, RubbingStep), "a part of a step is a step"
        return replace(shorter, power=at @ self.power, put_in=at @ self.put_in)


def along_tangents(normal: FloatArray, axis: FloatArray, forces: FloatArray) -> FloatArray:
    """A vector of the world from its parts along both tangents of a surface, as C has them, shape (3,).

    Args:
        normal: of the surface, shape (3,).
        axis: whose part along the surface is the first tangent, shape (3,).
        forces: the parts, shape (2,).
    """
    first = axis - (axis @ normal) * normal
    first = first / np.linalg.norm(first)
    return np.asarray(forces[0] * first + forces[1] * np.cross(normal, first))
