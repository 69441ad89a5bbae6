"""Registry of obstacles. A new kind takes a file here and a line below."""

from __future__ import annotations

from cosserat_casadi.obstacles.capsule import CapsuleObstacle
from cosserat_casadi.obstacles.lumen import LumenObstacle
from cosserat_casadi.obstacles.obstacle import Obstacle
from cosserat_casadi.obstacles.plane import PlaneObstacle
from cosserat_casadi.obstacles.sphere import SphereObstacle
from cosserat_casadi.scene.families import register

SURFACES = Obstacle.kinds
"""Obstacles by the word of the scene format."""

for shipped in (PlaneObstacle, SphereObstacle, CapsuleObstacle, LumenObstacle):
    register(shipped)
