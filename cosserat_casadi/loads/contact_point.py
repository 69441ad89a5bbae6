"""The force of an obstacle on one section: energy −N d(r) with d the distance, so that the force is N along its normal.

What holds a section off an obstacle acts through its centre: without friction it has no moment about it. N is no input
of the scene but follows from the contact, see equilibrium/contact; no scene file names this load.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar, Literal, final

from cosserat_casadi.loads.load import Load, Section
from cosserat_casadi.maths.numbers import Scalar
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.obstacles.registry import SURFACES
from cosserat_casadi.scene.inputs import InputField
from cosserat_casadi.scene.loads import LoadRecord


class ContactPoint(LoadRecord):
    """An obstacle that touches one section of a rod."""

    inputs: ClassVar[Mapping[str, InputField]] = {"force": InputField("N", 1, lower=0.0)}

    kind: Literal["contact_point"] = "contact_point"
    rod: str
    obstacle: Any
    at: Any
    force: float


@final
class ContactPointLoad(Load[ContactPoint]):
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
