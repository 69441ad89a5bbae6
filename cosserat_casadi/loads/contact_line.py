"""The force per length of an obstacle that a stretch of a rod lies on: energy −λ(X) d(r) per length.

λ is a polynomial along the stretch, given by its Legendre coefficients. As the force of contact at a point, it is not
an input of the scene but follows from the contact.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar, Literal, final

import casadi as ca

from cosserat_casadi.loads.load import Section, Site, polynomials_at
from cosserat_casadi.loads.obstacle_load import ObstacleLoad, ObstacleLoadRecord
from cosserat_casadi.maths.numbers import Numbers
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.obstacles.registry import SURFACES
from cosserat_casadi.scene.input_fields import InputField


class ContactLine(ObstacleLoadRecord):
    """Exact contact of a stretch of a rod with an obstacle."""

    inputs: ClassVar[Mapping[str, InputField]] = {"force": InputField("N/m", 1, polynomial=True)}

    kind: Literal["contact_line"] = "contact_line"
    rod: str
    span: Any
    force: tuple[tuple[float, ...]]


@final
class ContactLineLoad(ObstacleLoad[ContactLine]):
    """λ along the normal of the obstacle."""

    record = ContactLine

    def energy(self, load: ContactLine, section: Section, values: Mapping[str, Matrix]) -> Matrix:
        """−λ d(r), J/m."""
        force = ca.mtimes(values["force"], section.data)
        energy: Matrix = -force * SURFACES[load.obstacle.kind].distance(load.obstacle, section.position)
        return energy

    def data(self, load: ContactLine, site: Site) -> Numbers:
        """Values of the Legendre polynomials over the stretch."""
        start, end = load.span
        return polynomials_at(len(load.force[0]), (site.X - start) / (end - start))
