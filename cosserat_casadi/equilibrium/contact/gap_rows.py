"""Equations of known contacts: zero gap where rods and bodies touch, zero slope of the gap at places that move.

Along a line they are the moments of the gap with the polynomials of its force. Over a stretch of the width w a force
per length f_j P_j moves the gap by about w⁴ f_j/j⁴: on short stretches by less than rounding, which does not determine
f_j. A compliance of the surface below rounding makes f_j small there; the mean f_0 is not changed:

    ∫ P_j (d − ρ) + c/w f_j = 0,    j > 0.

On a plane all gaps of a line but the first count from the gap at its start, by the stretch of rod between alone: they
have the rounding of this stretch, not of the whole rod, which on a width of 5e-4 leaves 1e-5 of the forces open.

See docs/contact.md.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import casadi as ca
import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.equilibrium.contact.contact_state import ContactState, Place, Touch, is_sought
from cosserat_casadi.equilibrium.contact.gaps import obstacle_of, support_of
from cosserat_casadi.equilibrium.contact.obstacle_surfaces import surface
from cosserat_casadi.loads.load import polynomials_at
from cosserat_casadi.loads.obstacle_load import section_radii
from cosserat_casadi.loads.rods_point import across
from cosserat_casadi.maths.numbers import Scalar, as_matrix, is_symbolic, known
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.model.floating_frames import FrameName
from cosserat_casadi.model.system import System
from cosserat_casadi.rod.strain import DiscreteRod

GIVES = 1e-17
"""c, relative to the length of the rod: compliance of a surface to a force EI/ℓ³ that varies along a whole rod."""


def gap_rows(system: System, state: ContactState, modes: Mapping[str, int], forces: Matrix) -> Matrix:
    """Residuals of the contacts, without unit: for each contact the rows of its sections, then the moments along it.

    Args:
        system: the scene with the contacts.
        state: the contacts.
        modes: polynomials of the curvature of each rod, by name.
        forces: dimensionless forces of all contacts, in the order of the loads.
    """
    rows: list[Matrix] = [ca.MX(0, 1)]
    for touch, _, along in state.with_forces(forces, modes):
        if touch.of_body:
            rows.append(_body_gap(system, touch))
            continue
        if touch.other is not None:
            rows += _rods_gap(system, touch)
            continue
        distances = Distances(system, touch.owner, obstacle_of(system.discrete.scene, touch.obstacle))
        from_start = replace(distances, since=touch.start) if _counts_from_start(system, touch) else distances
        for end, moves in zip(touch.carriers, touch.carriers_move, strict=True):
            gap, slope = (distances if end is touch.start else from_start).at(end)
            rows.append(gap)
            if moves:
                rows.append(slope)
        if touch.is_line:
            for start, end, own in touch.by_stretch(along, modes[touch.owner]):
                varying = ca.vertcat(0, own[1:, :])
                rows.append(from_start.moments(start, end, own.shape[0]) + GIVES / (end - start) * varying)
    return ca.vertcat(*rows)


def _counts_from_start(system: System, touch: Touch) -> bool:
    """Whether the gaps of a contact count from the gap at its start; a base that lies on a plane has no such gap."""
    sought = touch.is_line and not touch.starts_at_base
    return sought and obstacle_of(system.discrete.scene, touch.obstacle).kind == "plane"


def rows_from_start(system: System, state: ContactState, modes: Mapping[str, int]) -> Iterator[tuple[int, int]]:
    """Each row of a gap that counts from the gap at the start of its line, and the row of this start."""
    start = 0
    for touch in state.touches:
        if _counts_from_start(system, touch):
            sections = range(2, 3 + len(touch.seams))
            counts = touch.moment_counts(modes[touch.owner])
            means = len(touch.carriers) + len(touch.moving) + np.cumsum([0, *counts[:-1]])
            yield from ((start + row, start) for row in (*sections, *means.tolist()))
        start += len(force_widths(ContactState((touch,)), modes))


def force_widths(state: ContactState, modes: Mapping[str, int]) -> list[Place | None]:
    """Share of the rod over which the force of each gap row is spread; None for slopes, which have no force.

    The share of a force at a section is one: a gap at a section is not an average over a stretch.
    """
    widths: list[Place | None] = []
    for touch in state.touches:
        if touch.other is not None:
            widths += [1.0, *(None for _ in touch.sought)]
            continue
        for moves in touch.carriers_move:
            widths.append(1.0)
            if moves:
                widths.append(None)
        if touch.is_line:
            counts = touch.moment_counts(modes[touch.owner])
            for (start, end), count in zip(touch.stretches, counts, strict=True):
                widths += [end - start] * count
    return widths


def _body_gap(system: System, touch: Touch) -> Matrix:
    """Distance of a body's surface from an obstacle, over the length of the longest rod that holds it."""
    body = system.discrete.bodies[touch.owner]
    pose = system.frame(FrameName("body", touch.owner))
    distance, normal, _ = surface(obstacle_of(system.discrete.scene, touch.obstacle))(pose.position)
    reach, _ = support_of(body, normal, pose.rotation)
    gap: Matrix = (distance - reach) / system.discrete.body_frame(touch.owner).length
    return gap


def _rods_gap(system: System, touch: Touch) -> list[Matrix]:
    """Gap of two rods at a section of each, and its derivatives by the moving places, over the length of the first."""
    own, other = (RodSurface(system, rod) for rod in touch.rods)
    apart = centres_apart(system, touch)
    normal, _ = across(apart)
    gap = ca.dot(normal, apart) - own.radius(touch.start) - other.radius(touch.other)
    sides = [(own, touch.start, normal), (other, touch.other, -normal)]
    slopes = [ca.dot(normal, side.rate(place)) - side.taper for side, place, normal in sides if is_sought(place)]
    length = system.discrete.rods[touch.owner].properties.length
    return [row / length for row in (gap, *slopes)]


def centres_apart(system: System, touch: Touch) -> Matrix:
    """Vector from the touching section of the second of two rods to that of the first, world axes, 3×1, m."""
    own, other = (RodSurface(system, rod) for rod in touch.rods)
    assert touch.other is not None, "two rods"
    return own.centre(touch.start) - other.centre(touch.other)


@dataclass(frozen=True)
class RodSurface:
    """Sections of a rod at places of contact, as expressions.

    Attributes:
        system: the scene.
        rod: name of the rod.
    """

    system: System
    rod: str

    @property
    def discrete(self) -> DiscreteRod:
        """The constant matrices of the rod."""
        return self.system.discrete.rods[self.rod]

    @cached_property
    def _world_R_base(self) -> Matrix:
        return self.system.base(self.rod).rotation

    @cached_property
    def _radii(self) -> tuple[Scalar, Scalar]:
        """Radius at base and tip, between which it is linear, m."""
        radii = section_radii(self.discrete.properties, np.array([0.0, 1.0]))
        base, tip = (radii[0], radii[1]) if is_symbolic(radii) else known(radii).tolist()
        return base, tip

    def radius(self, X: Place) -> Place:
        """Radius of a section, m."""
        base, _ = self._radii
        return base + X * self.taper

    def centre(self, X: Scalar) -> Matrix:
        """World position of the section at an end of an element, 3×1, m."""
        return self.system.position_at(self.rod, self.discrete.grid.node_at(X))

    @property
    def taper(self) -> Scalar:
        """Derivative of the radius by X, m."""
        base, tip = self._radii
        return tip - base

    def rate(self, X: Scalar) -> Matrix:
        """Derivative of the centre by X at an end of an element, world axes, 3×1, m."""
        grid = self.discrete.grid
        node = grid.node_at(X)
        tangent = self._world_R_base @ self.system.shapes[self.rod].tangent[:, node]
        # The tangent is the rate of the coordinate that integrals run over, which a moving element stretches.
        rate = grid.rates_in(grid.element_of_node[[node]])
        if rate is not None:
            tangent = tangent / as_matrix(rate)[0]
        return tangent


@dataclass(frozen=True)
class Distances(RodSurface):
    """Distances of a rod's surface from an obstacle, over the length of the rod, as expressions.

    Attributes:
        obstacle: the obstacle.
        since: start of a line on a plane, from whose gap the distances count; None for distances from the obstacle.
    """

    obstacle: scenes.ObstacleRecord
    since: Place | None = None

    def _gap(self, node: int, X: Place) -> tuple[Matrix, Matrix]:
        """Distance of the surface at a node, m, and the normal of the obstacle there, in the axes it is given in."""
        if self.since is not None:
            _, normal, _ = surface(self.obstacle)(ca.DM.zeros(3))
            integrals = self.discrete.grid.integration_matrix
            weights = integrals[node] - integrals[self.discrete.grid.node_at(self.since) + 1]
            between = self._world_R_base @ (self.system.shapes[self.rod].tangent @ ca.sparsify(ca.DM(weights)))
            rise = ca.dot(normal, self.system.turned_to(self.obstacle.body, between))
            return rise - self.taper * (X - self.since), normal
        position = self.system.position_at(self.rod, node)
        distance, normal, _ = surface(self.obstacle)(self.system.seen_from(self.obstacle.body, position))
        return distance - self.radius(X), normal

    def at(self, X: Scalar) -> tuple[Matrix, Matrix]:
        """Distance and its derivative by X at an end of an element, over the length."""
        gap, normal = self._gap(self.discrete.grid.node_at(X), X)
        slope = ca.dot(normal, self.system.turned_to(self.obstacle.body, self.rate(X))) - self.taper
        length = self.discrete.properties.length
        return gap / length, slope / length

    def moments(self, start: Scalar, end: Scalar, count: int) -> Matrix:
        """∫ P_j (d − ρ) over a stretch, relative to it, for the first Legendre polynomials, count×1."""
        grid = self.discrete.grid
        nodes = grid.nodes_in(start, end)
        X = grid.nodes_at(nodes)
        width = end - start
        gaps = ca.vertcat(*[self._gap(int(node), X[i])[0] for i, node in enumerate(nodes)])
        polynomials = as_matrix(polynomials_at(count, (X - start) / width))
        # Weights of the whole rod are scaled: over the stretch they add up to one.
        weights = grid.weights[nodes] / grid.weights[nodes].sum()
        return polynomials @ (ca.DM(weights) * gaps) / self.discrete.properties.length
