"""The force of an obstacle on one section, or on a body that is a ball or a disk: energy −N d(r) with d the distance.

So the force is N along the normal. It acts through the centre of the section or of the ball: without friction it has no
moment about it. The reach of a disk depends on the direction: its energy is −N (d − reach), and has a moment. N is not
an input of the scene but follows from the contact, see equilibrium/contact; no scene file names this load.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar, Literal, final

import casadi as ca

from cosserat_casadi.loads.disk_reach import disk_reach
from cosserat_casadi.loads.load import Section
from cosserat_casadi.loads.obstacle_load import ObstacleLoad, ObstacleLoadRecord
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.obstacles.registry import SURFACES
from cosserat_casadi.scene.input_fields import InputField


class ContactPoint(ObstacleLoadRecord):
    """Exact contact of an obstacle with one section of a rod, or a body; radius and thickness belong to a disk."""

    inputs: ClassVar[Mapping[str, InputField]] = {"force": InputField("N", 1, lower=0.0)}

    kind: Literal["contact_point"] = "contact_point"
    at: Any
    force: float
    radius: float = 0.0
    thickness: float | None = None


@final
class ContactPointLoad(ObstacleLoad[ContactPoint]):
    """N along the normal of the obstacle."""

    record = ContactPoint

    def energy(self, load: ContactPoint, section: Section, values: Mapping[str, Matrix]) -> Matrix:
        """−N d(r), J, or −N (d − reach) of a disk."""
        gap = SURFACES[load.obstacle.kind].distance(load.obstacle, section.position)
        if load.thickness is not None:
            normal = ca.gradient(gap, section.position)
            gap = gap - disk_reach(normal, section.rotation[:, 2], load.radius, load.thickness)[0]
        energy: Matrix = -values["force"] * gap
        return energy
