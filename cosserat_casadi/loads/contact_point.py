"""The force of an obstacle on one section, or on a body that is a ball: energy −N d(r) with d the distance.

So the force is N along the normal. It acts through the centre of the section or of the ball: without friction it has no
moment about it. N is no input of the scene but follows from the contact, see equilibrium/contact; no scene file names
this load.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar, Literal, final

from cosserat_casadi.loads.load import Section
from cosserat_casadi.loads.obstacle_load import ObstacleLoad, ObstacleLoadRecord
from cosserat_casadi.maths.numbers import Scalar
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.obstacles.registry import SURFACES
from cosserat_casadi.scene.input_fields import InputField


class ContactPoint(ObstacleLoadRecord):
    """An obstacle that touches one section of a rod, or a body."""

    inputs: ClassVar[Mapping[str, InputField]] = {"force": InputField("N", 1, lower=0.0)}

    kind: Literal["contact_point"] = "contact_point"
    at: Any
    force: float


@final
class ContactPointLoad(ObstacleLoad[ContactPoint]):
    """N along the normal of the obstacle."""

    record = ContactPoint

    def abscissa(self, load: ContactPoint) -> Scalar:
        """The section that is touched."""
        at: Scalar = load.at
        return at

    def energy(self, load: ContactPoint, section: Section, values: Mapping[str, Matrix]) -> Matrix:
        """−N d(r), J."""
        energy: Matrix = -values["force"] * SURFACES[load.obstacle.kind].distance(load.obstacle, section.position)
        return energy
