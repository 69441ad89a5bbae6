"""Common part of the loads by obstacles: on rods, in the obstacle's axes, and on bodies as balls.

Sections of rods keep away from obstacles by their radius, bodies by theirs.
"""

from __future__ import annotations

from typing import Any, TypeVar

import numpy as np

from cosserat_casadi.loads.load import Load
from cosserat_casadi.maths.numbers import Numbers, repeated
from cosserat_casadi.rod.properties import RodProperties
from cosserat_casadi.scene.load_records import LoadRecord


class ObstacleLoadRecord(LoadRecord):
    """A load that an obstacle exerts on a rod, or on a body."""

    obstacle: Any
    rod: str | None = None
    body: str | None = None


ObstacleRecordType = TypeVar("ObstacleRecordType", bound=ObstacleLoadRecord)
"""Record of the load."""


class ObstacleLoad(Load[ObstacleRecordType]):
    """A load that an obstacle exerts; on a body at its origin, about which the body is a ball."""

    uniform = True

    def seen_from(self, load: ObstacleRecordType) -> str | None:
        """Name of the body that the obstacle is fixed to; None for the world."""
        body: str | None = load.obstacle.body
        return body


def section_radii(rod: RodProperties, X: Numbers) -> Numbers:
    """Radius of the sections of a rod at abscissae X, shape (k,), m; zero for a rod given by its stiffness."""
    if rod.diameter is None:
        return np.zeros(X.shape[0])
    return repeated(rod.diameter(X) / 2, X.shape[0])
