"""Obstacles that this version knows. A new one is a file here and a line below."""

from __future__ import annotations

from typing import Any, TypeVar

from cosserat_casadi.obstacles.capsule import CapsuleObstacle
from cosserat_casadi.obstacles.lumen import LumenObstacle
from cosserat_casadi.obstacles.obstacle import Obstacle
from cosserat_casadi.obstacles.plane import PlaneObstacle
from cosserat_casadi.obstacles.sphere import SphereObstacle
from cosserat_casadi.scene.families import add_kind
from cosserat_casadi.scene.obstacles import OBSTACLES

Member = TypeVar("Member", bound=type[Obstacle[Any]])

SURFACES: dict[str, Any] = {}
"""Obstacles by the word of the scene format."""


def register_obstacle(member: Member) -> Member:
    """Make a kind of obstacle known, to the scene format and to the mechanics; decorates its class.

    Raises:
        ValueError: another class has the same word.
    """
    add_kind(SURFACES, OBSTACLES, member)
    return member


for shipped in (PlaneObstacle, SphereObstacle, CapsuleObstacle, LumenObstacle):
    register_obstacle(shipped)
