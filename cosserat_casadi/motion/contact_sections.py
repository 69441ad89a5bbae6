"""A rod or a body in motion against one obstacle: the sections of the rod that may touch it, or the ball of the body.

Positions between the nodes follow the polynomials through the nodes, as results have them.

A rod on polynomials cannot lie flat along a part of an element: its gap is zero at points and ripples between them. It
is kept out at sections that are close beside the ripples, and the remaining ripples are checked at the end.
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
from cosserat_casadi.motion.contact_gap import Facing
from cosserat_casadi.motion.contact_law import LOOKS

BENDING = (0, 1)
"""Numbers of the strains that bend a rod."""

SECTIONS_FOR_MODE = 3
"""Sections of an element for each of its modes of bending.

One would do to hold it still. With eight modes a rod that lies on a table was then 1.1e-3 of its length deep between
them, and 5e-5 with three, at much the same cost of time.
"""


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
    def node_count(self) -> int:
        """Number of nodes of the rod."""
        return (len(self.ends) - 1) * self.nodes_of_element

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


@dataclass(frozen=True)
class BodyFacing(Facing):
    """A body and an obstacle that it may touch.

    Attributes:
        radius: of the ball, m.
    """

    radius: float

    @cached_property
    def length(self) -> float:
        """Length of the longest rod that holds it, m."""
        return float(self.model.discrete.body_frame(self.owner).length)

    @property
    def radii(self) -> tuple[float, float]:
        """Radius of the ball at base and tip, twice one number, m."""
        return self.radius, self.radius

    @property
    def ends(self) -> Sequence[float]:
        """The abscissae of base and tip of a rod, whatever the body."""
        return (0.0, 1.0)

    @property
    def laid_at(self) -> FloatArray:
        """Places that a body lies at, shape (0,): a ball touches at one point."""
        return np.zeros(0)

    def describe(self, held: Held) -> None:
        """Write into the record that it is one point."""
        held.record.elements = held.record.nodes = 1


def lobatto(count: int) -> FloatArray:
    """Nodes of Lobatto's quadrature on [0, 1], both ends among them, shape (count + 1,)."""
    degree = np.zeros(count + 1)
    degree[-1] = 1.0
    inner = legendre.legroots(legendre.legder(degree)).real if count > 1 else np.zeros(0)
    return np.asarray((np.concatenate([[-1.0], np.sort(inner), [1.0]]) + 1.0) / 2.0)


def laid_sections(model: Model, rod: str, ends: tuple[bool, bool]) -> FloatArray:
    """Abscissae of these sections, base to tip, shape (k,): Lobatto's in each element.

    Args:
        model: the model.
        rod: name of the rod.
        ends: whether base and tip are among them; not where they are held, or another rod has them.
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
