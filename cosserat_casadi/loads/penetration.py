"""A cushion in front of an obstacle, energy k/3 (ρ − d)₊³ per length: a first guess of exact contact.

Rods sink into it by a small share of their length, and so do bodies, as balls of their radius. It gives a first guess
of places and forces, never a result; no scene file names this load.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar, Literal, final

import casadi as ca
import numpy as np

from cosserat_casadi.loads.disk_reach import disk_reach
from cosserat_casadi.loads.load import Section, Site
from cosserat_casadi.loads.obstacle_load import ObstacleLoad, ObstacleLoadRecord, section_radii
from cosserat_casadi.maths.numbers import Numbers, known
from cosserat_casadi.maths.typing import FloatArray, Matrix
from cosserat_casadi.obstacles.registry import SURFACES
from cosserat_casadi.rod.properties import RodProperties
from cosserat_casadi.scene.input_fields import InputField


class Penetration(ObstacleLoadRecord):
    """A soft obstacle, whose surface is raised by a height at each node of the rod."""

    inputs: ClassVar[Mapping[str, InputField]] = {
        "stiffness": InputField("N/m³", 1),
        "raised": InputField("m", 1, polynomial=True, nodal=True),
    }

    kind: Literal["penetration"] = "penetration"
    stiffness: float
    radius: float = 0.0
    thickness: float | None = None
    raised: tuple[tuple[float, ...]] = ((0.0,),)


@final
class PenetrationLoad(ObstacleLoad[Penetration]):
    """k (ρ − d)² per length along the normal of the obstacle, where a section of radius ρ is in it; k in N/m³.

    On a body it is a force, and k is in N/m².
    """

    record = Penetration
    nodal = "raised"

    def energy(self, load: Penetration, section: Section, values: Mapping[str, Matrix]) -> Matrix:
        """k/3 (ρ − d)³, J/m, or J of a body."""
        distance = SURFACES[load.obstacle.kind].distance(load.obstacle, section.position)
        if load.thickness is not None:
            normal = ca.gradient(distance, section.position)
            depth = disk_reach(normal, section.rotation[:, 2], load.radius, load.thickness)[0] - distance
        elif load.body is not None:
            depth = load.radius - distance
        else:
            radius, raised = section.data[0], section.data[1]
            depth = radius + raised - distance
        depth = ca.fmax(depth, 0.0)
        energy: Matrix = values["stiffness"] / 3 * depth**3
        return energy

    def data(self, load: Penetration, site: Site) -> Numbers:
        """Radius of the sections, m, and height by which the obstacle is raised there, m."""
        radii = section_radius(site.rod, known(site.X))[None]
        if site.nodal is None:
            return np.vstack([radii, np.zeros_like(radii)])
        return ca.vertcat(ca.DM(radii), site.nodal)


def section_radius(rod: RodProperties, X: FloatArray) -> FloatArray:
    """Radius of the sections of a rod whose sizes are numbers, shape (k,), m."""
    return known(section_radii(rod, X))
