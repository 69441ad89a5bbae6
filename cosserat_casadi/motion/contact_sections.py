"""The surface of a rod in motion against one obstacle: gaps along it, and where they are least.

Positions between the nodes are those of the polynomials through the nodes, as results have them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import casadi as ca
import numpy as np
from numpy.polynomial import chebyshev as polynomial

from cosserat_casadi.equilibrium.contact.gaps import ball_radius
from cosserat_casadi.equilibrium.contact.obstacle_surfaces import distance_from, surface
from cosserat_casadi.loads.penetration import section_radius
from cosserat_casadi.maths import chebyshev
from cosserat_casadi.maths.grid import Grid
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.function_table import kept_with
from cosserat_casadi.motion.coincident_ends import watched_ends
from cosserat_casadi.motion.contact_bodies import BodyFacing
from cosserat_casadi.motion.contact_gap import FAR, Facing, Minimum, Rows, SectionGap
from cosserat_casadi.motion.lying_sections import laid_sections
from cosserat_casadi.motion.moving_points import MovingPoints, centre_of, nodes_of
from cosserat_casadi.motion.repeated_call import INTERPRETED, Libraries, RepeatedCall

SECTIONS_IN_ELEMENT = 200
"""Sections of an element at which gaps are looked at first."""

MOST_ITERATIONS = 20
"""Newton iterations for the place where a gap is least."""

ITERATIONS_AT_ONCE = 4
"""Iterations of one call: next to a place as many do."""

MOST_HALVINGS = 40
"""Halvings of a stretch in which there is such a place, where Newton's method does not find it."""

PLACED = 1e-14
"""Change of a place that counts as none."""

AT_END = 1e-12
"""Distance from an end, over the length, at which a place is that end."""

OFF = 10.0
"""Gap of a section, over the largest fall of the gap up to the next one, from which on the rod is off the obstacle."""

LEVEL_DIGITS = 10
"""Digits after the point of a gap over the length that tell hills from valleys."""

BEYOND = 0.05
"""How far beyond the ends of a rod and of its elements polynomials are followed, over the length."""


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
    def looked_at(self) -> FloatArray:
        """Abscissae at which gaps are looked at first, shape (k,)."""
        ends = self._grid.known_places
        parts = [np.linspace(0.0, 1.0, 2)]
        for start, end in pairwise(ends):
            parts.append(np.linspace(start, end, SECTIONS_IN_ELEMENT + 1))
        return np.unique(np.concatenate(parts))

    def gaps(self, nodes: FloatArray) -> FloatArray:
        """Gaps at the sections looked at, over the length, shape (k,)."""
        positions = self._looking @ nodes
        return (self._looked_distances(positions.ravel()) - self._looked_radii) / self.length

    def laid_gaps(self, nodes: FloatArray) -> FloatArray:
        """Gaps at the sections at which the rod is held where it lies, over the length, shape (k,)."""
        weights, radii = self._laid
        return (self._laid_distances((weights @ nodes).ravel()) - radii) / self.length

    @cached_property
    def laid_at(self) -> FloatArray:
        """Abscissae of these sections, base to tip, shape (k,)."""
        return laid_sections(self.model, self.owner, self.watched_ends)

    @cached_property
    def _laid(self) -> tuple[FloatArray, FloatArray]:
        radii = section_radius(self.model.discrete.rods[self.owner].properties, self.laid_at)
        return np.asarray(self._grid.interpolation_matrix(self.laid_at)), radii

    def at(self, nodes: FloatArray, X: float, element: int | None = None) -> SectionGap:
        """The gap at a section, a little beyond the ends of the rod and of an element too."""
        element, start, width = self._element_of(X, element)
        coefficients = self._coefficients(nodes, element)
        at = (np.array([number]) for number in ((X - start) / width, start, width))
        gap, normal, curvature, tangent, basis = self._section.matrices(coefficients, *at)
        value, slope, bend = (gap[:, 0] / self.length).tolist()
        rows = np.zeros((3, len(nodes)))
        count = len(basis)
        rows[:, element * count : (element + 1) * count] = basis.T @ self.to_coefficients
        return SectionGap(value, slope, bend, Rows(*rows), normal[:, 0], curvature, tangent[:, 0])

    def place(self, nodes: FloatArray, near: float, element: int | None = None) -> float:
        """Abscissa next to another where the gap is least; not beyond the ends by more than a little."""
        X = self._stationary(nodes, near, element)
        if abs(X - near) <= FAR:
            return X
        # Down the gaps from section to section no other minimum can be met.
        beside = float(self.looked_at[self._downhill(self._level(nodes), near)])
        if element is None or self.ends[element] <= beside <= self.ends[element + 1]:
            X = self._stationary(nodes, beside, element)
            return X if abs(X - beside) <= FAR else beside
        # By the polynomials of its element it may be farther beyond an end of that one than it is.
        end = min(max(beside, self.ends[element]), self.ends[element + 1])
        X = self._stationary(nodes, end, element)
        # At the end itself it would seem to have stayed within its element.
        return X if abs(X - end) <= BEYOND else float(np.clip(beside, end - BEYOND, end + BEYOND))

    def minima(self, nodes: FloatArray, below: float) -> list[Minimum]:
        """Sections whose gaps are the least about them, and not above a bound, base to tip.

        Args:
            nodes: positions, shape (M, 3), m.
            below: the bound, over the length.
        """
        gaps = self._level(nodes)
        near = [i for i in self._lowest(gaps) if gaps[i] <= below + _step_down(gaps, i)]
        found = [self._refined(nodes, i) for i in near]
        return [minimum for minimum in found if minimum.gap <= below]

    def lowest(self, nodes: FloatArray, but: Sequence[float], ends: Sequence[float] = ()) -> float:
        """The least gap over the length but for those in the valleys of some abscissae; infinite where there is none.

        Args:
            nodes: positions, shape (M, 3), m.
            but: these abscissae.
            ends: ends of the rod that are left out where they are lower than all beside them.
        """
        gaps = self._level(nodes)
        left_out = [self._downhill(gaps, place) for place in but]
        others = [
            i for i in self._lowest(gaps) if self.looked_at[i] not in ends and all(abs(i - one) > 1 for one in left_out)
        ]
        if not others:
            return float("inf")
        # Far from zero no one asks how much lower it is beside a section.
        return min(
            float(gaps[i]) if gaps[i] > OFF * _step_down(gaps, i) else self._refined(nodes, i).gap
            for i in _maybe_lowest(gaps, others)
        )

    def deepest(self, nodes: FloatArray) -> Minimum:
        """The section whose gap is the least of all, the base included."""
        gaps = self.gaps(nodes)
        found = [self._refined(nodes, i) for i in _maybe_lowest(gaps, _valleys(gaps))]
        return min(found, key=lambda minimum: minimum.gap)

    def _stationary(self, nodes: FloatArray, near: float, element: int | None = None) -> float:
        """Newton's method for a place where the slope is zero; not a number where it leads nowhere."""
        X = near
        for _ in range(MOST_ITERATIONS // ITERATIONS_AT_ONCE):
            number, start, width = self._element_of(X, element)
            at = (np.array([value]) for value in ((X - start) / width, start, width))
            found = self._places.matrices(self._coefficients(nodes, number), *at)
            share, change = (float(part[0, 0]) for part in found)
            X = start + width * share
            # Not where it is not a number.
            if not -BEYOND <= X <= 1.0 + BEYOND:
                return float("nan")
            # Beyond its element the gap is that of the next one.
            if abs(width * change) <= PLACED and self._element_of(X, element)[0] == number:
                break
        return X

    def _element_of(self, X: float, element: int | None) -> tuple[int, float, float]:
        """An element next to a section, or the element that it lies in: number, abscissa of its base, and width."""
        ends = self.ends
        if element is None or not ends[element] - BEYOND <= X <= ends[element + 1] + BEYOND:
            element = self.element(X)
        return element, ends[element], ends[element + 1] - ends[element]

    def _coefficients(self, nodes: FloatArray, element: int) -> FloatArray:
        """Chebyshev coefficients of the positions in an element, column after column, shape (3 (N + 1),), m."""
        count = len(self.to_coefficients)
        return (self.to_coefficients @ nodes[element * count : (element + 1) * count]).ravel(order="F")

    def _level(self, nodes: FloatArray) -> FloatArray:
        """Gaps at the watched sections, rounded so that a flat gap has no hills, shape (k,)."""
        return np.round(self.gaps(nodes), LEVEL_DIGITS)

    def _downhill(self, gaps: FloatArray, near: float) -> int:
        """Number of the section, of those looked at, that is least in the valley of an abscissa."""
        index = int(np.argmin(np.abs(self.looked_at - near)))
        while index > 0 and gaps[index - 1] < gaps[index]:
            index -= 1
        while index < len(gaps) - 1 and gaps[index + 1] < gaps[index]:
            index += 1
        return index

    def _lowest(self, gaps: FloatArray) -> list[int]:
        """Numbers of the sections in valleys, but for ends that are not watched.

        An end that is held has a gap that does not change, and one that is another rod's too is watched there.
        """
        last = len(gaps) - 1
        base, tip = self.watched_ends
        return [i for i in _valleys(gaps) if (base or i > 0) and (tip or i < last)]

    def _refined(self, nodes: FloatArray, index: int) -> Minimum:
        """The minimum next to a section that is looked at."""
        beside = float(self.looked_at[index])
        here = self.at(nodes, beside).value
        X = self._stationary(nodes, beside)
        if not (_inside(X) and abs(X - beside) <= FAR):
            X = self._bracketed(nodes, index)
        # A flat gap, as of a straight rod along a plane, has no place of its own.
        if not _inside(X):
            return Minimum(beside, here, 0.0 < beside < 1.0)
        return Minimum(X, self.at(nodes, X).value, True)

    def _bracketed(self, nodes: FloatArray, index: int) -> float:
        """Where the slope changes its sign between the neighbours of a section that is looked at; else not a number.

        About a bar that is thin beside the distance of the sections Newton's method leads nowhere from beside it.
        """
        last = len(self.looked_at) - 1
        low, high = (float(self.looked_at[i]) for i in (max(index - 1, 0), min(index + 1, last)))
        if not self.at(nodes, low).slope < 0.0 < self.at(nodes, high).slope:
            return float("nan")
        for _ in range(MOST_HALVINGS):
            middle = (low + high) / 2.0
            if self.at(nodes, middle).slope < 0.0:
                low = middle
            else:
                high = middle
        return (low + high) / 2.0

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

    @cached_property
    def _section(self) -> RepeatedCall:
        """(coefficients, share of the element, its base, its width) ↦ gap and two derivatives with X, and more of it.

        Normal, curvature, tangent, and the Chebyshev polynomials with two derivatives with X, (N + 1)×3.
        """
        return RepeatedCall(self._gap_function, 5)

    @cached_property
    def _places(self) -> RepeatedCall:
        """The same arguments ↦ share at which Newton's method arrives, and its last change."""
        arguments = [ca.MX.sym(name, *self._gap_function.size_in(k)) for k, name in enumerate("cswx")]
        coefficients, share, start, width = arguments
        change = ca.MX(0)
        for _ in range(ITERATIONS_AT_ONCE):
            gap = self._gap_function(coefficients, share, start, width)[0]
            # Where the gap has no bend, the least one is elsewhere.
            change = ca.if_else(gap[2] > 0, -gap[1] / gap[2], np.nan) / width
            share = share + change
        return RepeatedCall(ca.Function("places", arguments, [share, change]), 2)

    @cached_property
    def _gap_function(self) -> ca.Function:
        count = self._grid.intervals + 1
        coefficients = ca.SX.sym("coefficients", 3 * count)
        share, start, width = (ca.SX.sym(name) for name in ("share", "start", "width"))
        z = 2 * share - 1
        polynomials = [ca.SX(1), z]
        for _ in range(count - 2):
            polynomials.append(2 * z * polynomials[-1] - polynomials[-2])
        value = ca.vertcat(*polynomials[:count])
        first = ca.jacobian(value, share) / width
        second = ca.jacobian(first, share) / width
        basis = ca.densify(ca.horzcat(value, first, second))
        curve = ca.reshape(coefficients, count, 3).T @ basis
        tangent = curve[:, 1]
        function = surface(self.obstacle)
        distance, normal, curvature = function.expand().call([curve[:, 0]])
        base, tip = self.radii
        taper = tip - base
        gap = ca.vertcat(
            distance - base - (start + width * share) * taper,
            ca.dot(normal, tangent) - taper,
            ca.bilin(curvature, tangent, tangent) + ca.dot(normal, curve[:, 2]),
        )
        results = [ca.densify(part) for part in (gap, normal, curvature, tangent, basis)]
        return ca.Function("gap", [coefficients, share, start, width], results)

    @cached_property
    def _looking(self) -> FloatArray:
        return np.asarray(self._grid.interpolation_matrix(self.looked_at))

    @cached_property
    def _looked_distances(self) -> RepeatedCall:
        return RepeatedCall(distance_from(self.obstacle).map(len(self.looked_at)))

    @cached_property
    def _laid_distances(self) -> RepeatedCall:
        return RepeatedCall(distance_from(self.obstacle).map(len(self.laid_at)))

    @cached_property
    def _looked_radii(self) -> FloatArray:
        return section_radius(self.model.discrete.rods[self.owner].properties, self.looked_at)

    @cached_property
    def radii(self) -> tuple[float, float]:
        """Radius at base and tip, between which it is linear, m."""
        base, tip = section_radius(self.model.discrete.rods[self.owner].properties, np.array([0.0, 1.0])).tolist()
        return base, tip


def _inside(X: float) -> bool:
    """Whether a section lies between the ends of the rod; rounding alone makes it no other one than the end."""
    return AT_END < X < 1.0 - AT_END


def _step_down(gaps: FloatArray, index: int) -> float:
    """How much lower than a section that is looked at the minimum next to it may be."""
    neighbours = gaps[max(index - 1, 0) : index + 2]
    return float(neighbours.max() - gaps[index])


def _valleys(gaps: FloatArray) -> list[int]:
    """Numbers of the sections that are no higher than their neighbours, of equal ones the first and the last."""
    padded = np.concatenate([[np.inf], gaps, [np.inf]])
    falls = padded[:-2] - gaps
    rises = padded[2:] - gaps
    return [int(i) for i in np.flatnonzero((falls >= 0.0) & (rises >= 0.0) & (falls + rises > 0.0))]


def _maybe_lowest(gaps: FloatArray, indices: Sequence[int]) -> list[int]:
    """Which of some sections that are looked at may have the lowest minimum next to them.

    A valley between two sections may be lower than another one at a section, such as an end, whose gap is less.
    """
    lowest = min(float(gaps[i]) for i in indices)
    return [i for i in indices if gaps[i] - _step_down(gaps, i) <= lowest]


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
