"""Common part of the loads that an obstacle exerts: on rods, seen in the obstacle's axes, and on bodies as balls."""

from __future__ import annotations

from typing import Any, TypeVar

from cosserat_casadi import scene as scenes
from cosserat_casadi.loads.load import BodyPoint, Load
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
