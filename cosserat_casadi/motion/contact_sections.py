"""The surface of a rod in motion against one obstacle: gaps along it, and where they are least.

Positions between the nodes are those of the polynomials through the nodes, as results have them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.polynomial import chebyshev as polynomial

from cosserat_casadi.compiling.shared_records import Held
from cosserat_casadi.equilibrium.contact.gaps import ball_radius
from cosserat_casadi.loads.penetration import section_radius
from cosserat_casadi.maths import chebyshev
from cosserat_casadi.maths.grid import Grid
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.function_table import kept_with
from cosserat_casadi.motion.coincident_ends import watched_ends
from cosserat_casadi.motion.contact_bodies import BodyFacing
from cosserat_casadi.motion.contact_gap import Facing
from cosserat_casadi.motion.contact_law import LOOKS
from cosserat_casadi.motion.lying_sections import laid_sections
from cosserat_casadi.motion.moving_points import MovingPoints, centre_of, nodes_of
from cosserat_casadi.motion.repeated_call import INTERPRETED, Libraries


@dataclass(frozen=True)
class RodFacing(Facing):
    """A rod and an obstacle that it may touch.

    Attributes:
        watched_ends: whether base and tip may be where it touches; not where they are held, or another rod has them.
    """

    watched_ends: tuple[bool, bool]

    @cached_property
    def length(self) -> float:
        """Length of the rod that gaps are counted in, m."""
        return float(self.model.discrete.rods[self.owner].properties.length)

    @cached_property
    def laid_at(self) -> FloatArray:
        """Abscissae of these sections, base to tip, shape (k,)."""
        return laid_sections(self.model, self.owner, self.watched_ends)

    def describe(self, held: Held) -> None:
        """Write elements, and how sections follow from nodes, into the record."""
        record = held.record
        record.elements, record.nodes = len(self.ends) - 1, self.nodes_of_element
        record.watches_base, record.watches_tip = self.watched_ends
        held.share("ends", np.array(self.ends))
        held.share("to_coefficients", np.ascontiguousarray(self.to_coefficients))
        held.share("looks", np.ascontiguousarray(self.looks))
        held.share("gaps_along", np.zeros(LOOKS * record.elements + 1))

    @cached_property
    def _grid(self) -> Grid:
        return self.model.discrete.rods[self.owner].grid

    @cached_property
    def ends(self) -> Sequence[float]:
        """Ends of the elements, base to tip: the bend of the gap jumps where curvatures do."""
        return self._grid.known_places

    @property
    def nodes_of_element(self) -> int:
        """Number of nodes of an element, both ends among them."""
        return int(self._grid.intervals) + 1

    @cached_property
    def to_coefficients(self) -> FloatArray:
        """Chebyshev coefficients of a polynomial from its values at the nodes of an element, (N + 1)×(N + 1)."""
        points = 2.0 * np.asarray(chebyshev.nodes(self._grid.intervals)) - 1.0
        return np.asarray(np.linalg.inv(polynomial.chebvander(points, self._grid.intervals)))

    @property
    def looks(self) -> FloatArray:
        """Weights of the nodes of an element at LOOKS sections spread evenly over it, and at its end."""
        local = 2.0 * np.linspace(0.0, 1.0, LOOKS + 1) - 1.0
        return np.asarray(polynomial.chebvander(local, self.nodes_of_element - 1) @ self.to_coefficients)

    @cached_property
    def radii(self) -> tuple[float, float]:
        """Radius at base and tip, between which it is linear, m."""
        base, tip = section_radius(self.model.discrete.rods[self.owner].properties, np.array([0.0, 1.0])).tolist()
        return base, tip


def facings(model: Model, libraries: Libraries = INTERPRETED) -> list[Facing]:
    """Every rod and every body with every obstacle that it may touch exactly.

    Args:
        model: the model, built for a motion.
        libraries: shared objects that have the functions of :func:`touching_points`.
    """
    # Its functions are those of every motion of the model.
    kept: dict[Libraries, list[Facing]] = kept_with(model, "_facings", dict)
    if libraries not in kept:
        kept[libraries] = _facings(model, libraries)
    return kept[libraries]


def touching_points(model: Model, libraries: Libraries = INTERPRETED) -> list[MovingPoints]:
    """Points of all rods and bodies that may touch; none in a scene without exact contact."""
    return list(dict.fromkeys(facing.points for facing in facings(model, libraries)))


def _facings(model: Model, libraries: Libraries) -> list[Facing]:
    found: list[Facing] = []
    exact = [obstacle for obstacle in model.scene.obstacles if not obstacle.is_smooth]
    for rod in model.scene.rods:
        concerned = [obstacle for obstacle in exact if obstacle.concerns(rod.name)]
        if not concerned:
            continue
        points = nodes_of(model, rod.name, libraries)
        for obstacle in concerned:
            ends = watched_ends(model, rod.name, obstacle)
            found.append(RodFacing(model, rod.name, obstacle, points, False, ends))
    for body in model.scene.bodies:
        concerned = [obstacle for obstacle in exact if obstacle.concerns_body(body.name)]
        if not concerned:
            continue
        points = centre_of(model, body.name, libraries)
        found += [BodyFacing(model, body.name, obstacle, points, True, ball_radius(body)) for obstacle in concerned]
    return found
