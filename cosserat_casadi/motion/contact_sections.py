"""The surface of a rod in motion against one obstacle: gaps along it, where they are least, and their derivatives.

Positions between the nodes are those of the polynomials through the nodes, as results have them. The least gap over a
stretch of the rod is a function of the unknowns alone: its gradient is that of the gap at the place where it is least,
and its second derivative is less by what that place slides (E. Polak, *Optimization*, Springer 1997, section 3.1).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from itertools import pairwise
from typing import NamedTuple

import casadi as ca
import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.equilibrium.contact.surfaces import distance_along, distances
from cosserat_casadi.loads.penetration import section_radius
from cosserat_casadi.maths import chebyshev
from cosserat_casadi.maths.grid import Grid
from cosserat_casadi.maths.rotation import quaternion_to_matrix
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.system import Arguments, System
from cosserat_casadi.motion.laid_sections import laid_sections
from cosserat_casadi.motion.repeated_call import RepeatedCall

SECTIONS_IN_ELEMENT = 200
"""Sections of an element at which gaps are looked at first."""

MOST_ITERATIONS = 20
"""Newton iterations for the place where a gap is least."""

MOST_HALVINGS = 40
"""Halvings of a stretch in which there is such a place, where Newton's method does not find it."""

PLACED = 1e-14
"""Change of a place that counts as none."""

FAR = 0.02
"""Change of a place, over the length, from which on Newton's method is not believed to have stayed at one minimum."""

LEVEL_DIGITS = 10
"""Digits after the point of a gap over the length that tell hills from valleys."""

REMEMBERED_SECTIONS = 512
"""Sections whose weights are remembered."""

BEYOND = 0.05
"""How far beyond the ends of a rod its polynomials are followed, over the length."""


class Sections:
    """World positions of the nodes of one rod, as functions of the unknowns and inputs of a model.

    Args:
        model: the model, built for a motion.
        rod: name of the rod.
    """

    def __init__(self, model: Model, rod: str) -> None:
        x = ca.MX.sym("x", model.size)
        inputs = ca.MX.sym("inputs", model.inputs.size)
        system = System(model.discrete, Arguments(x, inputs))
        base = system.base(rod)
        shape = system.shapes[rod]
        turned = quaternion_to_matrix(base.quaternion) @ shape.position
        positions = ca.densify(ca.vec(ca.repmat(ca.MX(base.position), 1, turned.shape[1]) + turned))
        weights = ca.MX.sym("weights", positions.shape[0])
        total = ca.dot(weights, positions)
        gradient = ca.densify(ca.gradient(total, x))
        self.positions = RepeatedCall(ca.Function("positions", [x, inputs], [positions]))
        self.gradient = RepeatedCall(ca.Function("gradient", [x, inputs, weights], [gradient]))
        self._symbols = [x, inputs, weights]
        self._written = (positions, total, gradient)

    @cached_property
    def by_inputs(self) -> RepeatedCall:
        """(x, inputs, weights) ↦ derivative of the weighted sum of the positions with the inputs, shape (m,)."""
        derivative = ca.densify(ca.gradient(self._written[1], self._symbols[1]))
        return RepeatedCall(ca.Function("by_inputs", self._symbols, [derivative]))

    def straight_on(
        self, x: FloatArray, inputs: FloatArray, v: FloatArray, rate: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Velocities and accelerations of the nodes while unknowns and inputs change evenly, shape (M, 3) each."""
        first, second = np.split(self._straight_on(x, inputs, v, rate), 2)
        return first.reshape(-1, 3), second.reshape(-1, 3)

    def hessian(self, x: FloatArray, inputs: FloatArray, weights: FloatArray) -> FloatArray:
        """Second derivative of the weighted sum of the positions with the unknowns, shape (n, n)."""
        stacked = self._hessian(x, inputs, weights)
        return stacked.reshape(len(x), len(x))

    def jacobian(self, x: FloatArray, inputs: FloatArray) -> FloatArray:
        """Derivative of the positions with the unknowns, shape (nodes, 3, n)."""
        stacked = self._jacobian(x, inputs)
        return stacked.reshape(len(x), -1, 3).transpose(1, 2, 0)

    @cached_property
    def _straight_on(self) -> RepeatedCall:
        x, inputs, _ = self._symbols
        v = ca.MX.sym("v", x.shape[0])
        rate = ca.MX.sym("rate", inputs.shape[0])
        state = ca.vertcat(x, inputs)
        change = ca.vertcat(v, rate)
        at_once = ca.MX.sym("state", state.shape[0])
        positions = ca.graph_substitute(
            self._written[0], [x, inputs], ca.vertsplit(at_once, [0, x.shape[0], at_once.shape[0]])
        )
        first = ca.jtimes(positions, at_once, change)
        second = ca.jtimes(first, at_once, change)
        written = ca.Function("moved", [at_once, v, rate], [ca.densify(ca.vertcat(first, second))])
        return RepeatedCall(ca.Function("straight_on", [x, inputs, v, rate], [written(state, v, rate)]))

    @cached_property
    def _hessian(self) -> RepeatedCall:
        second = ca.densify(ca.jacobian(self._written[2], self._symbols[0]))
        return RepeatedCall(ca.Function("hessian", self._symbols, [ca.vec(second)]))

    @cached_property
    def _jacobian(self) -> RepeatedCall:
        first = ca.densify(ca.jacobian(self._written[0], self._symbols[0]))
        return RepeatedCall(ca.Function("jacobian", self._symbols[:2], [ca.vec(first)]))


class Rows(NamedTuple):
    """Weights of the nodes for the position of a section, and for its first two derivatives with X, shape (M,) each."""

    value: FloatArray
    first: FloatArray
    second: FloatArray


class Gap(NamedTuple):
    """A gap at one section, over the length of the rod, and what its derivatives are made of.

    Attributes:
        value: the gap.
        slope: its derivative with X.
        bend: its second derivative with X.
        rows: of the section.
        normal: of the obstacle, shape (3,).
        curvature: second derivative of the distance with the point, shape (3, 3), 1/m.
        tangent: derivative of the position with X, shape (3,), m.
    """

    value: float
    slope: float
    bend: float
    rows: Rows
    normal: FloatArray
    curvature: FloatArray
    tangent: FloatArray


class Minimum(NamedTuple):
    """A section whose gap is the least about it.

    Attributes:
        place: abscissa X.
        gap: over the length.
        inside: whether it is no end of the rod.
    """

    place: float
    gap: float
    inside: bool


@dataclass(frozen=True)
class Facing:
    """A rod and an obstacle that it may touch.

    Attributes:
        model: the model, built for a motion.
        rod: name of the rod.
        obstacle: the obstacle.
        sections: of the rod.
    """

    model: Model
    rod: str
    obstacle: scenes.ObstacleRecord
    sections: Sections

    @cached_property
    def length(self) -> float:
        """Length of the rod that gaps are counted in, m."""
        return float(self.model.discrete.rods[self.rod].properties.length)

    @cached_property
    def looked_at(self) -> FloatArray:
        """Abscissae at which gaps are looked at first, shape (k,)."""
        ends = self._grid.known_places
        parts = [np.linspace(0.0, 1.0, 2)]
        for start, end in pairwise(ends):
            parts.append(np.linspace(start, end, SECTIONS_IN_ELEMENT + 1))
        return np.unique(np.concatenate(parts))

    def nodes(self, x: FloatArray, inputs: FloatArray) -> FloatArray:
        """World positions of the nodes, shape (M, 3), m."""
        return self.sections.positions(x, inputs).reshape(-1, 3)

    def gaps(self, nodes: FloatArray) -> FloatArray:
        """Gaps at the sections looked at, over the length, shape (k,)."""
        positions = self._looking @ nodes
        return np.asarray(distances(self.obstacle, positions) - self._looked_radii) / self.length

    def laid_gaps(self, nodes: FloatArray) -> FloatArray:
        """Gaps at the sections at which the rod is held where it lies, over the length, shape (k,)."""
        weights, radii = self._laid
        return np.asarray(distances(self.obstacle, weights @ nodes) - radii) / self.length

    @cached_property
    def laid_at(self) -> FloatArray:
        """Abscissae of these sections, base to tip, shape (k,)."""
        return laid_sections(self.model, self.rod)

    @cached_property
    def _laid(self) -> tuple[FloatArray, FloatArray]:
        radii = section_radius(self.model.discrete.rods[self.rod].properties, self.laid_at)
        return np.asarray(self._grid.interpolation_matrix(self.laid_at)), radii

    def at(self, nodes: FloatArray, X: float) -> Gap:
        """The gap at a section, a little beyond the ends of the rod too."""
        rows = self._rows(X)
        tangent = rows.first @ nodes
        distance = distance_along(self.obstacle, rows.value @ nodes, tangent, rows.second @ nodes)
        taper = self._radii[1] - self._radii[0]
        gap = distance.value - self._radii[0] - X * taper
        slope = distance.slope - taper
        length = self.length
        return Gap(
            gap / length,
            slope / length,
            distance.bend / length,
            rows,
            distance.normal,
            distance.curvature,
            tangent,
        )

    def place(self, nodes: FloatArray, near: float) -> float:
        """Abscissa next to another where the gap is least; not beyond the ends by more than a little."""
        X = self._stationary(nodes, near)
        if abs(X - near) <= FAR:
            return X
        # Down the gaps from section to section no other minimum can be met.
        beside = float(self.looked_at[self._downhill(self._level(nodes), near)])
        X = self._stationary(nodes, beside)
        return X if abs(X - beside) <= FAR else beside

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

    def lowest(self, nodes: FloatArray, but: Sequence[float]) -> float:
        """The least gap over the length but for those in the valleys of some abscissae; infinite where there is none.

        Args:
            nodes: positions, shape (M, 3), m.
            but: these abscissae.
        """
        gaps = self._level(nodes)
        left_out = [self._downhill(gaps, place) for place in but]
        others = [i for i in self._lowest(gaps) if all(abs(i - one) > 1 for one in left_out)]
        if not others:
            return float("inf")
        return self._refined(nodes, min(others, key=lambda i: float(gaps[i]))).gap

    def deepest(self, nodes: FloatArray) -> Minimum:
        """The section whose gap is the least of all, the base included."""
        gaps = self.gaps(nodes)
        return self._refined(nodes, int(np.argmin(gaps)))

    def gradient(self, x: FloatArray, inputs: FloatArray, gap: Gap) -> FloatArray:
        """Derivative of a gap with the unknowns, shape (n,)."""
        return self.sections.gradient(x, inputs, self._weights(gap)) / self.length

    def by_inputs(self, x: FloatArray, inputs: FloatArray, gap: Gap) -> FloatArray:
        """Derivative of a gap with the inputs, shape (m,)."""
        return self.sections.by_inputs(x, inputs, self._weights(gap)) / self.length

    def hessian(self, x: FloatArray, inputs: FloatArray, gap: Gap, *, slides: bool) -> FloatArray:
        """Second derivative of a gap with the unknowns, shape (n, n).

        Args:
            x: unknowns, shape (n,).
            inputs: stacked inputs, shape (m,).
            gap: the gap.
            slides: whether its place is where the gap is least, and not a given one.
        """
        by_nodes = self.sections.jacobian(x, inputs)
        moved = np.einsum("k,kin->in", gap.rows.value, by_nodes)
        second = self.sections.hessian(x, inputs, self._weights(gap)) + moved.T @ gap.curvature @ moved
        if slides:
            turned = np.einsum("k,kin->in", gap.rows.first, by_nodes)
            slope = gap.normal @ turned + gap.tangent @ gap.curvature @ moved
            second = second - np.outer(slope, slope) / (gap.bend * self.length)
        return np.asarray(second / self.length)

    def rates(
        self, x: FloatArray, v: FloatArray, inputs: Sequence[FloatArray], gap: Gap, *, slides: bool
    ) -> tuple[float, float]:
        """Rate of a gap, 1/s, and its second derivative without the part of the accelerations of the unknowns, 1/s².

        Args:
            x: unknowns, shape (n,).
            v: their rates, likewise, 1/s.
            inputs: the stacked inputs, their rates and their accelerations, shape (m,) each.
            gap: the gap.
            slides: whether its place is where the gap is least, and not a given one.
        """
        value, rate, acceleration = inputs
        velocities, accelerations = self.sections.straight_on(x, value, v, rate)
        velocity = gap.rows.value @ velocities
        first = float(gap.normal @ velocity)
        second = float(gap.normal @ (gap.rows.value @ accelerations) + velocity @ gap.curvature @ velocity)
        if slides:
            slope = float(gap.normal @ (gap.rows.first @ velocities) + gap.tangent @ gap.curvature @ velocity)
            second -= slope**2 / (gap.bend * self.length)
        if np.any(acceleration):
            second += self.length * float(self.by_inputs(x, value, gap) @ acceleration)
        return first / self.length, second / self.length

    def _stationary(self, nodes: FloatArray, near: float) -> float:
        """Newton's method for a place where the slope is zero; not a number where it leads nowhere."""
        X = near
        for _ in range(MOST_ITERATIONS):
            gap = self.at(nodes, X)
            if not gap.bend > 0.0:
                return float("nan")
            change = -gap.slope / gap.bend
            X += change
            if not -BEYOND <= X <= 1.0 + BEYOND:
                return float("nan")
            if abs(change) <= PLACED:
                break
        return X

    def _level(self, nodes: FloatArray) -> FloatArray:
        """Gaps at the sections looked at, without the rounding that makes hills of what is flat, shape (k,)."""
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
        """Numbers of the sections that are no higher than their neighbours, of equal ones the first and the last.

        The base of a rod that is held has a gap that does not change: it is left out.
        """
        padded = np.concatenate([[np.inf], gaps, [np.inf]])
        falls = padded[:-2] - gaps
        rises = padded[2:] - gaps
        lowest = np.flatnonzero((falls >= 0.0) & (rises >= 0.0) & (falls + rises > 0.0))
        return [int(i) for i in lowest if self._floats or i > 0]

    def _refined(self, nodes: FloatArray, index: int) -> Minimum:
        """The minimum next to a section that is looked at."""
        beside = float(self.looked_at[index])
        here = self.at(nodes, beside).value
        X = self._stationary(nodes, beside)
        if not (0.0 < X < 1.0 and abs(X - beside) <= FAR):
            X = self._bracketed(nodes, index)
        # A flat gap, as of a straight rod along a plane, has no place of its own.
        if not 0.0 < X < 1.0:
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
        return self.model.discrete.rods[self.rod].grid

    @cached_property
    def _looking(self) -> FloatArray:
        return np.asarray(self._grid.interpolation_matrix(self.looked_at))

    @cached_property
    def _looked_radii(self) -> FloatArray:
        return section_radius(self.model.discrete.rods[self.rod].properties, self.looked_at)

    @cached_property
    def _radii(self) -> tuple[float, float]:
        """Radius at base and tip, between which it is linear, m."""
        base, tip = section_radius(self.model.discrete.rods[self.rod].properties, np.array([0.0, 1.0])).tolist()
        return base, tip

    @cached_property
    def _floats(self) -> bool:
        return self.model.discrete.unloaded.floating_base(self.rod) is not None

    def _rows(self, X: float) -> Rows:
        return _rows_of(self._grid, X)

    def _weights(self, gap: Gap) -> FloatArray:
        """Weights of the positions of the nodes, stacked node by node, whose sum varies as the gap does."""
        return np.outer(gap.rows.value, gap.normal).ravel()


@lru_cache(maxsize=REMEMBERED_SECTIONS)
def _rows_of(grid: Grid, X: float) -> Rows:
    """Weights of the nodes of a grid for one section: those of a section that stays are asked for over and over."""
    ends = grid.known_places
    element = int(grid.element_of(np.array([X]))[0])
    width = ends[element + 1] - ends[element]
    share = (X - ends[element]) / width
    local = chebyshev.interpolation_matrix(grid.intervals, [share], beyond=BEYOND / width)[0]
    per_element = grid.intervals + 1
    own = slice(element * per_element, (element + 1) * per_element)
    rows = np.zeros((3, grid.size))
    rows[0, own] = local
    rows[1, own] = local @ _differentiated(grid.intervals, 1) / width
    rows[2, own] = local @ _differentiated(grid.intervals, 2) / width**2
    return Rows(*rows)


_differentiated = lru_cache(maxsize=32)(chebyshev.differentiation_matrix)


def _step_down(gaps: FloatArray, index: int) -> float:
    """How much lower than a section that is looked at the minimum next to it may be."""
    neighbours = gaps[max(index - 1, 0) : index + 2]
    return float(neighbours.max() - gaps[index])


def facings(model: Model) -> list[Facing]:
    """Every rod with every obstacle that it may touch exactly."""
    found = []
    for rod in model.scene.rods:
        concerned = [one for one in model.scene.obstacles if one.concerns(rod.name) and not one.is_smooth]
        if concerned:
            sections = Sections(model, rod.name)
            found += [Facing(model, rod.name, obstacle, sections) for obstacle in concerned]
    return found
