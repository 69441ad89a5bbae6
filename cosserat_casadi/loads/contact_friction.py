"""Friction at a point of exact contact: a force along the surface that acts where the section touches.

The section of radius ρ touches at −ρ n from its centre, with the normal n of the obstacle, so that a force t along the
surface has the moment −ρ n × t about the centre. The force is no input of the scene: it follows from the path, see
paths/rubbing_equations.py. No scene file names this load.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar, Literal, final

import casadi as ca

from cosserat_casadi.loads.load import Section, Site
from cosserat_casadi.loads.obstacle_load import ObstacleLoad, ObstacleLoadRecord, section_radii
from cosserat_casadi.maths.numbers import Numbers, stacked_rows
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.obstacles.registry import SURFACES
from cosserat_casadi.scene.input_fields import InputField


class ContactFriction(ObstacleLoadRecord):
    """Friction of an obstacle on one section of a rod."""

    inputs: ClassVar[Mapping[str, InputField]] = {"force": InputField("N", 3, axes="world")}

    kind: Literal["contact_friction"] = "contact_friction"
    at: Any
    force: tuple[float, float, float]


@final
class ContactFrictionLoad(ObstacleLoad[ContactFriction]):
    """Force t and moment −ρ n × t about the centre of the section, in the axes of the obstacle."""

    record = ContactFriction

    def wrench(self, load: ContactFriction, section: Section, values: Mapping[str, Matrix]) -> tuple[Matrix, Matrix]:
        """Force, N, and moment about the centre, N m."""
        distance = SURFACES[load.obstacle.kind].distance(load.obstacle, section.position)
        arm = -section.data[0] * ca.gradient(distance, section.position)
        return values["force"], ca.cross(arm, values["force"])

    def data(self, load: ContactFriction, site: Site) -> Numbers:
        """Radius of the section, m."""
        return stacked_rows([section_radii(site.rod, site.X)])
