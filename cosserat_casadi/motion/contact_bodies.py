"""A body in motion against one obstacle: the ball of its radius about its origin, which touches at one point."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from cosserat_casadi.compiling.shared_records import Held
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.motion.contact_gap import Facing


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

    @property
    def ends(self) -> Sequence[float]:
        """The abscissae of base and tip of a rod, whatever the body."""
        return (0.0, 1.0)

    @property
    def laid_at(self) -> FloatArray:
        """None: a ball touches at one point."""
        return np.zeros(0)

    def describe(self, held: Held) -> None:
        """Write into the record that it is one point."""
        held.record.elements = held.record.nodes = 1
