"""A rod or a body in motion against one obstacle: the sections of the rod, or the ball of the body, that may touch it.

Positions between the nodes follow the polynomials through the nodes, as in results.

A polynomial rod cannot lie flat along part of an element: its gap is zero at points, with ripples between them. A lying
rod is held at sections that are close compared with the ripples, whose depth is checked at the end.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.polynomial import chebyshev as polynomial
from numpy.polynomial import legendre

from cosserat_casadi.compiling.shared_records import Held
from cosserat_casadi.loads.penetration import section_radius
from cosserat_casadi.maths import chebyshev
from cosserat_casadi.maths.grid import Grid
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.materials import BENDING
from cosserat_casadi.motion.contact_gap import Facing
from cosserat_casadi.motion.contact_law import LOOKS

SECTIONS_FOR_MODE = 3
"""Sections that hold a lying rod, for each bending mode of an element.

One section a mode would hold the rod still. But a rod on a table, with eight modes, was then 1.1e-3 of its length deep
between the sections, and 5e-5 with three a mode, at much the same cost.
"""


@dataclass(frozen=True)
class RodFacing(Facing):
    """A rod and an obstacle that it may touch.

    Attributes:
        watched_ends: whether base and tip are watched for contact, see ``coincident_ends.watched_ends``.
    """

    watched_ends: tuple[bool, bool]

    @cached_property
    def length(self) -> float:
        """Length of the rod, by which gaps are divided, m."""
        return float(self.model.discrete.rods[self.owner].properties.length)

    @cached_property
    def laid_at(self) -> FloatArray:
        """Abscissae of the sections that hold the rod while it lies, from base to tip, shape (k,)."""
        return laid_sections(self.model, self.owner, self.watched_ends)

    def describe(self, held: Held) -> None:
        """Write the elements, and the interpolation of sections from nodes, into the record."""
        record = held.record
        record.elements, record.nodes = len(self.ends) - 1, self.nodes_of_element
        record.watches_base, record.watches_tip = self.watched_ends
        held.share("ends", np.array(self.ends))
        held.share("to_coefficients", np.ascontiguousarray(self.to_coefficients))
        held.share("looks", np.ascontiguousarray(self.looks))

    @cached_property
    def _grid(self) -> Grid:
        return self.model.discrete.rods[self.owner].grid

    @cached_property
    def ends(self) -> Sequence[float]:
        """Ends of the elements, from base to tip; the bend of the gap jumps there, as curvatures do."""
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
    def node_count(self) -> int:
        """Number of nodes of the rod."""
        return (len(self.ends) - 1) * self.nodes_of_element

    @property
    def looks(self) -> FloatArray:
        """Interpolation from the nodes of an element to LOOKS even sections and its end, (LOOKS + 1)×(N + 1)."""
        local = 2.0 * np.linspace(0.0, 1.0, LOOKS + 1) - 1.0
        return np.asarray(polynomial.chebvander(local, self.nodes_of_element - 1) @ self.to_coefficients)

    @cached_property
    def radii(self) -> tuple[float, float]:
        """Radius at base and tip, between which it is linear, m."""
        base, tip = section_radius(self.model.discrete.rods[self.owner].properties, np.array([0.0, 1.0])).tolist()
        return base, tip


@dataclass(frozen=True)
class BodyFacing(Facing):
    """A body and an obstacle that it may touch.

    Attributes:
        radius: radius of the ball, m.
    """

    radius: float

    @cached_property
    def length(self) -> float:
        """Length of the longest rod that holds the body, m."""
        return float(self.model.discrete.body_frame(self.owner).length)

    @property
    def radii(self) -> tuple[float, float]:
        """Radius of the ball, twice, m."""
        return self.radius, self.radius

    @property
    def ends(self) -> Sequence[float]:
        """The abscissae 0 and 1, for any body."""
        return (0.0, 1.0)

    @property
    def laid_at(self) -> FloatArray:
        """Empty array, shape (0,): a ball touches at one point and does not lie."""
        return np.zeros(0)

    def describe(self, held: Held) -> None:
        """Write into the record that the body is one point."""
        held.record.elements = held.record.nodes = 1


def lobatto(count: int) -> FloatArray:
    """Nodes of Lobatto's quadrature on [0, 1], both ends among them, shape (count + 1,)."""
    degree = np.zeros(count + 1)
    degree[-1] = 1.0
    inner = legendre.legroots(legendre.legder(degree)).real if count > 1 else np.zeros(0)
    return np.asarray((np.concatenate([[-1.0], np.sort(inner), [1.0]]) + 1.0) / 2.0)


def laid_sections(model: Model, rod: str, ends: tuple[bool, bool]) -> FloatArray:
    """Abscissae of the sections that hold a lying rod, base to tip, shape (k,): Lobatto nodes of each element.

    Args:
        model: the model.
        rod: name of the rod.
        ends: whether base and tip are among them, see ``coincident_ends.watched_ends``.
    """
    discretisation = model.discretisation[rod]
    (record,) = [one for one in model.scene.rods if one.name == rod]
    strains = zip(record.admitted, discretisation.modes, strict=True)
    # A rod that does not bend is held as one with a single mode.
    modes = max([1, *(count for strain, count in strains if strain in BENDING)])
    local = lobatto(SECTIONS_FOR_MODE * modes)
    parts = [start + (end - start) * local[1:] for start, end in pairwise(discretisation.breaks)]
    sections = np.concatenate([[0.0], *parts])
    base, tip = ends
    return sections[0 if base else 1 : None if tip else -1]
