"""Whether rods would pass through obstacles on the way from one shape to another.

A solve that starts from a solution knows its shape alone: where inputs change much, Newton's method may end behind an
obstacle, in an equilibrium that the rods could not have come to.
"""

from __future__ import annotations

import numpy as np

from cosserat_casadi.equilibrium.contact.gaps import pairs
from cosserat_casadi.equilibrium.contact.surfaces import distance_from
from cosserat_casadi.equilibrium.solution import Solution
from cosserat_casadi.loads.penetration import section_radius

SECTIONS = np.linspace(0.0, 1.0, 101)
"""Abscissae that are looked at."""

STRIDE = 5e-3
"""Way of a section between two looks, relative to the length of the rod."""

MOST_LOOKS = 200
"""Most looks on the way."""

DEEP = 1e-3
"""Depth on the way, relative to the length, that is more than the chord of a rod that slides along an obstacle."""


def passes_through(before: Solution, after: Solution) -> bool:
    """Whether a section is inside an obstacle on the straight way from one shape to the other."""
    for rod, obstacle in pairs(after.model.scene):
        start = before.pose(SECTIONS, rod).position
        way = after.pose(SECTIONS, rod).position - start
        properties = after.model.discrete.rods[rod].properties
        farthest = float(np.linalg.norm(way, axis=1).max())
        looks = min(int(farthest / (STRIDE * properties.length)), MOST_LOOKS)
        shares = np.linspace(0.0, 1.0, looks + 2)[1:-1]
        if not len(shares):
            continue
        positions = start + shares[:, None, None] * way
        distances = distance_from(obstacle).map(positions.shape[0] * len(SECTIONS))(positions.reshape(-1, 3).T)
        gaps = distances.full().reshape(len(shares), -1) - section_radius(properties, SECTIONS)
        if gaps.min() < -DEEP * properties.length:
            return True
    return False
