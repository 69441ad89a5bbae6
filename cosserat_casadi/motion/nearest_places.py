"""Where the gap of two rods is least, as a function of their nodes, for equations that do not change with contacts.

The gap is the distance of two centres less both radii. It is least over a stretch of the first rod and all of the
second. A look at some sections of both finds the valley, and Newton's method for both abscissae, within their bounds,
its bottom. The derivative of its last step is that of the bottom: the slopes of the gap vanish there, or a bound holds.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import casadi as ca
import numpy as np

from cosserat_casadi.equilibrium.contact.gap_rows import RodSurface
from cosserat_casadi.maths import chebyshev
from cosserat_casadi.maths.calls import KEPT
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.model.section_poses import element_holds, element_polynomials
from cosserat_casadi.model.system import System

LOOKS = 3
"""Sections of a stretch of the first rod that are looked at first, both ends among them."""

OTHER_LOOKS = 17
"""Sections of the second rod that are looked at first."""

STEPS = 7
"""Number of steps of Newton's method: from the neighbour of a place that is looked at, six of them reach rounding."""

STRIDE = 0.1
"""Longest change of an abscissa in a step."""

UPRIGHT = 1e-6
"""Least share of the larger bend in a step: along parallel rods the gap has none."""

COINCIDENT = 1e-9
"""Least distance of two centres, over the length of the first rod: closer together they have no direction."""


@dataclass(frozen=True)
class NearestPlaces:
    """The places at which the gap of two rods is least.

    Attributes:
        system: the scene in symbols.
        rods: names of both rods.
        ends: abscissae of the ends of the stretches of the first rod, base to tip.
        number: number of the pair of rods, for different names of functions in generated code.
    """

    system: System
    rods: tuple[str, str]
    ends: Sequence[float]
    number: int

    @cached_property
    def places(self) -> Matrix:
        """Abscissae on both rods for each stretch, 2×(len(ends) − 1)."""
        bounds = ca.DM(list(pairwise(self.ends))).T
        count = bounds.shape[1]
        # As products of matrices, copies have derivatives that are short in C.
        copies = ca.DM.ones(1, count)
        series = [ca.vec(self._series(rod)) @ copies for rod in self.rods]
        given = [*series, self._p @ copies, bounds]
        found = self._search.map(count)(*given)
        places: Matrix = self._step(last=True).map(count)(*given, found)
        return places

    def _series(self, rod: str) -> Matrix:
        """Coefficients of the Chebyshev series of the centres in each element of a rod, 3×M, m."""
        grid = self.system.discrete.rods[rod].grid
        to_coefficients = ca.DM(chebyshev.chebyshev_coefficients(np.eye(grid.intervals + 1)))
        elements = ca.horzsplit(nodes_by_products(self.system, rod), grid.intervals + 1)
        return ca.horzcat(*[nodes @ to_coefficients.T for nodes in elements])

    @property
    def _p(self) -> ca.MX:
        return self.system.discrete.parameters.symbol

    @cached_property
    def _arguments(self) -> list[ca.MX]:
        """Symbols of the series of both rods, stacked, of the parameters, and of the bounds on the first rod, 2×1."""
        grids = [self.system.discrete.rods[rod].grid for rod in self.rods]
        sizes = [*(3 * grid.size for grid in grids), self._p.shape[0], 2]
        return [ca.MX.sym(name, size) for name, size in zip(("own", "other", "p", "bounds"), sizes, strict=True)]

    def _centre(self, k: int, X: Matrix) -> Matrix:
        """Centre of a section of the k-th rod by its series in symbols, 3×1, m."""
        grid = self.system.discrete.rods[self.rods[k]].grid
        series = ca.horzsplit(ca.reshape(self._arguments[k], 3, grid.size), grid.intervals + 1)
        parts = []
        for element, coefficients in enumerate(series):
            part = coefficients @ element_polynomials(grid, element, X)
            parts.append(element_holds(grid, element, X) * part if grid.elements > 1 else part)
        return sum(parts[1:], parts[0])

    def _radius(self, k: int, X: Matrix) -> Matrix:
        radius: Matrix = RodSurface(self.system, self.rods[k]).radius(X)
        return radius

    def _step(self, *, last: bool) -> ca.Function:
        """(first series, second series, p, bounds, places) ↦ places after a step of Newton's method.

        The steps have the bends of half the squared distance, which serve far from the bottom too; the last one has
        the bends of the gap.
        """
        places = ca.MX.sym("places", 2)
        centres = [self._centre(k, places[k]) for k in range(2)]
        apart = centres[0] - centres[1]
        length = self.system.discrete.rods[self.rods[0]].properties.length
        distance = ca.sqrt(ca.sumsqr(apart) + (COINCIDENT * length) ** 2)
        gap = (distance - sum(self._radius(k, places[k]) for k in range(2))) / length
        ways = ca.jacobian(apart, places)
        bends = (
            ca.hessian(gap, places)[0] if last else ca.hessian(ca.sumsqr(apart) / 2, places)[0] / (distance * length)
        )
        straight = ways.T @ ways / (distance * length)
        step = _bounded_step()(places, self._arguments[3], ca.gradient(gap, places), bends, straight)
        function = ca.Function(f"step_{self.number}", [*self._arguments, places], ca.cse([step])).expand()
        if last:
            return function
        symbols = function.sx_in()
        return ca.Function(function.name(), symbols, function.call(symbols), KEPT)

    @cached_property
    def _search(self) -> ca.Function:
        """(first series, second series, p, bounds) ↦ places before the last step, which has their derivatives."""
        places = self._first
        step = self._step(last=False)
        for _ in range(STEPS - 1):
            places = step(*self._arguments, places)
        # Steps before the last one do not change its derivatives.
        constant = {"is_diff_in": [False] * len(self._arguments), **KEPT}
        return ca.Function(f"search_{self.number}", self._arguments, [places], constant)

    @cached_property
    def _first(self) -> Matrix:
        """The places whose gap is least among the sections that are looked at first, 2×1."""
        bounds = self._arguments[3]
        shares = np.linspace(0.0, 1.0, LOOKS)
        looks = [bounds[0] + share * (bounds[1] - bounds[0]) for share in shares.tolist()]
        X = np.linspace(0.0, 1.0, OTHER_LOOKS)
        others = ca.horzcat(*[self._centre(1, ca.MX(place)) for place in X.tolist()])
        radii = ca.horzcat(*[self._radius(1, place) for place in X.tolist()])
        columns = [ca.vertcat(self._centre(0, look), self._radius(0, look), look) for look in looks]
        least = _least(LOOKS, OTHER_LOOKS)
        places: Matrix = least(ca.horzcat(*columns), ca.vertcat(others, radii, ca.DM(X).T))
        return places


def nodes_by_products(system: System, rod: str) -> Matrix:
    """World positions of the nodes of a rod, 3×M, m, by products of matrices, whose derivatives are short in C."""
    base, shape = system.base(rod), system.shapes[rod]
    return ca.MX(base.position) @ ca.DM.ones(1, shape.rod.grid.size) + base.rotation @ shape.position


def _least(count: int, others: int) -> ca.Function:
    """(sections of the first rod, 5×count, of the second, 5×others) ↦ the abscissae of two whose gap is least, 2×1.

    A section has its centre, m, its radius, m, and its abscissa.
    """
    own, other = ca.SX.sym("own", 5, count), ca.SX.sym("other", 5, others)
    least, places = ca.SX(np.inf), ca.SX(2, 1)
    for i in range(count):
        for j in range(others):
            gap = ca.norm_2(own[:3, i] - other[:3, j]) - own[3, i] - other[3, j]
            is_less = gap < least
            least = ca.if_else(is_less, gap, least)
            places = ca.if_else(is_less, ca.vertcat(own[4, i], other[4, j]), places)
    return ca.Function("least", [own, other], [places])


def _bounded_step() -> ca.Function:
    """(places, bounds, slopes, bends, bends of straight rods) ↦ places after a step within their bounds, 2×1.

    The step goes to the least of a quadratic within the bounds. Where its bends make no valley it has the bends of
    straight rods, which have no hill.
    """
    places, bounds, slopes = ca.SX.sym("places", 2), ca.SX.sym("bounds", 2), ca.SX.sym("slopes", 2)
    bends, straight = ca.SX.sym("bends", 2, 2), ca.SX.sym("straight", 2, 2)
    least = UPRIGHT * (straight[0, 0] + straight[1, 1])
    is_valley = ca.logic_and(bends[0, 0] > least, ca.det(bends) > least * bends[0, 0])
    bend = ca.if_else(is_valley, bends, straight + least * ca.SX.eye(2))
    low = ca.fmax(ca.vertcat(bounds[0], 0.0) - places, -STRIDE)
    high = ca.fmin(ca.vertcat(bounds[1], 1.0) - places, STRIDE)
    whole = -ca.solve(bend, slopes)
    tries = [ca.fmin(ca.fmax(whole, low), high)]
    for held, other in ((0, 1), (1, 0)):
        for bound in (low, high):
            free = -(slopes[other] + bend[other, held] * bound[held]) / bend[other, other]
            step = [ca.fmin(ca.fmax(free, low[other]), high[other])] * 2
            step[held] = bound[held]
            tries.append(ca.vertcat(*step))
    best, lowest = tries[0], ca.dot(slopes, tries[0]) + ca.dot(tries[0], bend @ tries[0]) / 2
    for step in tries[1:]:
        value = ca.dot(slopes, step) + ca.dot(step, bend @ step) / 2
        best = ca.if_else(value < lowest, step, best)
        lowest = ca.fmin(value, lowest)
    return ca.Function("bounded_step", [places, bounds, slopes, bends, straight], [places + best])
