"""The push of an obstacle that has a width: smooth contact, a load like any other.

With the gap g = d(r) − ρ between a section of radius ρ and the obstacle, the width w and the stiffness k

    u = k (w − g)₊⁴ / (12 w²),    f = −du/dg = k (w − g)₊³ / (3 w²),    df/dg = −k at g = 0,

per length of the rod. From the gap w on there is no force; where the gap is zero it is k w/3. Energy, force and
stiffness are continuous, and so is the derivative of the stiffness but for its kink at g = w.

In motion the force is f (1 − δ ġ): the power δ f ġ² that it dissipates is never negative. K. H. Hunt and F. R. E.
Crossley, J. Appl. Mech. 42 (1975) 440. It pulls only where a rod leaves faster than 1/δ.

Coulomb's friction acts on the point of the section that touches, ρ from its centre: with its velocity u along the
surface, μ times the force against u/√(u² + s²), as long as the section is pushed. Far above the slip speed s that is
Coulomb's law to the share ½ (s/u)²; what Coulomb's law lets stick creeps, slower than s until it is close to slipping.
Along the tangent of the rod, against it and across it the coefficient may be another. At rest nothing rubs.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal, final

import casadi as ca
import numpy as np

from cosserat_casadi.loads.load import Section, Site
from cosserat_casadi.loads.obstacle_load import ObstacleLoad, ObstacleLoadRecord, section_radii
from cosserat_casadi.maths.numbers import Numbers, stacked_rows
from cosserat_casadi.maths.typing import FloatArray, Matrix
from cosserat_casadi.obstacles.registry import SURFACES

STANDING = 1e-3
"""Cosine of a rod to the surface below which its tangent along the surface fades."""


class ContactLayer(ObstacleLoadRecord):
    """An obstacle with a width in front of one rod, or of a body that is a ball; no scene file names this load."""

    kind: Literal["contact_layer"] = "contact_layer"
    stiffness: float
    radius: float = 0.0

    @property
    def takes_energy(self) -> bool:
        """Whether it takes energy in motion; loads on bodies do not know how they move."""
        return self.body is None and (self.obstacle.damping > 0.0 or self.obstacle.rubs)


@final
class ContactLayerLoad(ObstacleLoad[ContactLayer]):
    """k (w − g)₊³ / (3 w²) along the normal of the obstacle: per length of a rod, or on a body, where k is in N/m."""

    record = ContactLayer
    # A straight rod in a bent lumen lies many widths outside: it is led in by a force that is next to nothing at first.
    growth = 2

    def energy(self, load: ContactLayer, section: Section, values: Mapping[str, Matrix]) -> Matrix:
        """The energy k (w − g)₊⁴ / (12 w²), J/m, or J of a body."""
        width = load.obstacle.width
        energy: Matrix = load.stiffness / (12 * width**2) * _depth(load, section) ** 4
        return energy

    def wrench(self, load: ContactLayer, section: Section, values: Mapping[str, Matrix]) -> tuple[Matrix, Matrix]:
        """Force, N/m, or N on a body, and the moment of friction about the centre, N."""
        width = load.obstacle.width
        normal = ca.gradient(SURFACES[load.obstacle.kind].distance(load.obstacle, section.position), section.position)
        pressing = load.stiffness / (3 * width**2) * _depth(load, section) ** 3
        # At rest the velocity stores nothing, and nothing is added.
        moves = load.takes_energy and bool(section.velocity.nnz())
        if moves and load.obstacle.damping > 0.0:
            pressing = pressing * (1 - load.obstacle.damping * ca.dot(normal, section.velocity))
        if not (moves and load.obstacle.rubs):
            return pressing * normal, ca.DM(3, 1)
        touching = -section.data[0] * normal
        rubbing = _friction(load, section, normal, ca.fmax(pressing, 0.0), touching)
        return pressing * normal + rubbing, ca.cross(touching, rubbing)

    def data(self, load: ContactLayer, site: Site) -> Numbers:
        """Radius of the sections, m."""
        return stacked_rows([section_radii(site.rod, site.X)])


def _friction(load: ContactLayer, section: Section, normal: Matrix, pressing: Matrix, touching: Matrix) -> Matrix:
    """Force of friction, N/m.

    Args:
        load: the push.
        section: of the rod.
        normal: of the obstacle, 3×1.
        pressing: force along it, not negative, N/m.
        touching: from the centre of the section to the point that touches, 3×1, m.
    """
    slip = load.obstacle.slip_speed
    along, back, across = load.obstacle.coefficients
    velocity = section.velocity + ca.cross(section.angular_velocity, touching)
    sliding = velocity - ca.dot(normal, velocity) * normal
    speed = ca.sqrt(ca.sumsqr(sliding) + slip**2)
    weighted = across * sliding
    if not along == back == across:
        tangent = section.rotation[:, 2]
        direction = tangent - ca.dot(normal, tangent) * normal
        # A rod that stands on the surface slides in no direction of its own.
        direction = direction / ca.sqrt(ca.sumsqr(direction) + STANDING**2)
        forward = ca.dot(direction, sliding)
        share = forward / ca.sqrt(forward**2 + slip**2)
        coefficient = (along * (1 + share) + back * (1 - share)) / 2
        weighted = weighted + (coefficient - across) * forward * direction
    friction: Matrix = -pressing / speed * weighted
    return friction


def _depth(load: ContactLayer, section: Section) -> Matrix:
    """(w − g)₊, m: how deep a section is in the layer in front of the obstacle."""
    radius = load.radius if load.body is not None else section.data[0]
    gap = SURFACES[load.obstacle.kind].distance(load.obstacle, section.position) - radius
    depth: Matrix = ca.fmax(load.obstacle.width - gap, 0.0)
    return depth


def pressure(layer: ContactLayer, gaps: FloatArray) -> FloatArray:
    """Force at rest for gaps in m: per length, N/m, or on a body, N."""
    width = layer.obstacle.width
    return np.asarray(layer.stiffness / (3 * width**2) * np.maximum(width - gaps, 0.0) ** 3)
