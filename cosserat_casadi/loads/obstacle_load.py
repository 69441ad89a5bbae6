"""Common part of the loads that an obstacle exerts: on rods, seen in the obstacle's axes, and on bodies as balls.

Rods keep from obstacles by the radius of their sections, bodies by theirs.
"""

from __future__ import annotations

from typing import Any, TypeVar

import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.loads.load import BodyPoint, Load
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
    """A load that an obstacle exerts."""

    def on_body(self, load: ObstacleRecordType, body: scenes.Body) -> BodyPoint | None:
        """The origin of the body, about which it is a ball."""
        return BodyPoint() if load.body == body.name else None

    def seen_from(self, load: ObstacleRecordType) -> str | None:
        """The body that the obstacle is fixed to."""
        body: str | None = load.obstacle.body
        return body

    def profiles(self, load: ObstacleRecordType, rod: RodProperties, X: Numbers, columns: int) -> Numbers:
        """Factors on the columns of the wrench, 1 all along the rod: numbers that vary are data of the sections."""
        return np.ones((columns, X.shape[0]))


def section_radii(rod: RodProperties, X: Numbers) -> Numbers:
    """Radius of the sections of a rod at abscissae X, shape (k,), m; zero where it is given by its stiffness."""
    if rod.diameter is None:
        return np.zeros(X.shape[0])
    return repeated(rod.diameter(X) / 2, X.shape[0])
