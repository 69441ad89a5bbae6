"""A cable that rubs on its course: its tension falls, or grows, by the angle that it turns through.

By Euler's and Eytelwein's law of the capstan dT = ∓μ T dφ along a cable that is about to slip, so that its tension is

    T(X) = T₀ exp(−μ p φ(X)),    φ(X) = ∫ |dt/dX| dX

with p = 1 where it was last pulled in at its base, p = −1 where it was let out, and t the direction of the cable in the
world: in the axes of the section |dt/dX| = |t' + ℓ K × t|. Contact with the rod does no work where the cable does not
slip: a virtual change of strain meets the tension of its place, and the generalised force of T₀ is

    Σ ℓ w exp(−μ p φ) ∂|T|/∂q

over the nodes. It is no gradient, so that a rod with such a cable has no potential. See docs/theory.md, section 6.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import casadi as ca
import numpy as np

from cosserat_casadi.maths import chebyshev
from cosserat_casadi.maths.grid import Grid
from cosserat_casadi.maths.shapes import check_shape
from cosserat_casadi.maths.typing import FloatArray, Matrix
from cosserat_casadi.rod.cable import RoutedCable, Routing, Row, added, negative, product
from cosserat_casadi.rod.kinematics import Shape

Rows = tuple[Row, Row, Row]
"""A vector field in the axes of the sections."""

BETWEEN = 4
"""Gauss points between neighbouring nodes: |dt/dX| has a kink where the cable straightens, which needs many."""

STRAIGHT = 1e-6
"""Turn of a whole rod, rad, below which a cable's turn is smooth: its derivative is finite where it is straight."""


@dataclass(frozen=True)
class RubbingRouting:
    """A routing on which a cable rubs.

    Attributes:
        routing: where the cable runs.
        friction: μ p, coefficient of friction times the direction of slip, 1×1.
    """

    routing: Routing
    friction: Matrix

    def __post_init__(self) -> None:
        check_shape("friction", self.friction, 1, 1)

    def on(self, shape: Shape) -> RubbingCable:
        """The cable on a rod of this shape: the quantity is its length."""
        return RubbingCable(shape, self.routing, self.friction)


@dataclass(frozen=True)
class RubbingCable(RoutedCable):
    """A cable that rubs on its routing through a deformed rod.

    Attributes:
        friction: μ p, coefficient of friction times the direction of slip, 1×1.
    """

    friction: Matrix

    @property
    def conservative(self) -> bool:
        """Its force is no gradient."""
        return False

    @cached_property
    def shares(self) -> Matrix:
        """Tension along the course relative to that at its base, exp(−μ p φ), 1×k."""
        shares: Matrix = ca.exp(-self.friction * self.turn)
        return shares

    @cached_property
    def turn(self) -> Matrix:
        """Angle φ that the cable has turned through since its base, 1×k, rad."""
        return self.turn_rate @ ca.DM(self._integrate).T

    @cached_property
    def turn_rate(self) -> Matrix:
        """|dt/dX| at points between the nodes, 1×f, rad: √(u·u + ε²) with u = t' + ℓ K × t."""
        squares = added(*[product(row, row) for row in self._turning_between])
        if squares is None:
            return ca.DM.ones(1, self._integrate.shape[1]) * STRAIGHT
        return ca.sqrt(squares + STRAIGHT**2)

    @cached_property
    def pull(self) -> Matrix:
        """Generalised force of a unit of tension at the base, Σ ℓ w exp(−μ p φ) ∂|T|/∂q, n×1, m."""
        parts: list[Matrix] = []
        for c, lever in self.lever.items():
            weighted = ca.DM(self._phi(c) * self._node_lengths[:, None])
            if lever is None:
                parts.append(ca.DM(weighted.shape[1], 1))
            else:
                parts.append(weighted.T @ (lever * self.shares).T)
        return ca.vertcat(*parts)

    def curvature(self, a: int, b: int) -> Row:
        """What the lever's change adds to ∂ pull/∂q, as of a cable that does not rub times its share, 1×M, m."""
        row = super().curvature(a, b)
        if row is None:
            return None
        nodes = self.routing.nodes.tolist()
        whole = type(self.shares)(*row.shape)
        whole[nodes] = row[nodes] * self.shares
        return whole

    @cached_property
    def further_stiffness(self) -> Matrix:
        """What the change of the shares adds to ∂ pull/∂q, n×n, m: not symmetric."""
        rows: list[Matrix] = []
        for c, lever in self.lever.items():
            phi = ca.DM(self._phi(c))
            if lever is None:
                rows.append(ca.DM(phi.shape[1], self.shape.rod.size))
            else:
                rows.append(phi.T @ (ca.diag(lever) @ self._weighted_change))
        return ca.vertcat(*rows)

    @cached_property
    def mean_share(self) -> Matrix:
        """Mean of the tension along the course relative to that at its base, 1×1."""
        return (self.stretch * self.shares) @ ca.DM(self._node_lengths) / self.value

    @cached_property
    def mean_share_gradient(self) -> Matrix:
        """∂ mean share/∂q, n×1."""
        by_shares = (self.stretch @ self._weighted_change).T
        return (self.pull + by_shares - self.mean_share * self.gradient) / self.value

    def rate(self, rate_of: Callable[[Matrix], Matrix]) -> Matrix:
        """Rate of the length that the tension at the base works on, from the rate of each part of the length, 1×1."""
        return rate_of(self.stretch) @ (self.shares.T * ca.DM(self._node_lengths))

    @cached_property
    def _weighted_change(self) -> Matrix:
        """Derivative of the shares with q times the lengths of the nodes, k×n, m."""
        by_turn = -self.friction * (self.shares * ca.DM(self._node_lengths).T)
        return ca.diag(by_turn) @ (ca.DM(self._integrate) @ self._turn_rate_gradient)

    @cached_property
    def _turning(self) -> Rows:
        """U = t' + ℓ K × t in the sections' frames, three rows, rad."""
        x, y, z = self.direction
        kx, ky, kz = self._curvature
        return (
            added(self._along(x), product(ky, z), negative(product(kz, y))),
            added(self._along(y), product(kz, x), negative(product(kx, z))),
            added(self._along(z), product(kx, y), negative(product(ky, x))),
        )

    @cached_property
    def _curvature(self) -> Rows:
        """ℓ K, three rows, rad."""
        length = self.shape.rod.length
        x, y, z = (None if row is None else length * row for row in self._strain[:3])
        return x, y, z

    @cached_property
    def _turning_between(self) -> list[Row]:
        """U at the points between the nodes, three rows, rad."""
        between = ca.DM(self._between).T
        return [None if row is None else row @ between for row in self._turning]

    @property
    def _turn_rate_gradient(self) -> Matrix:
        """∂|dt/dX|/∂q = (u/|u|)·∂u/∂q at the points between the nodes, f×n."""
        units = [None if row is None else row / self.turn_rate for row in self._turning_between]
        columns = []
        for c in self.shape.rod.admitted:
            phi = ca.DM(self._phi(c))
            total: Matrix = ca.DM(self._integrate.shape[1], phi.shape[1])
            for unit, by_slope, by_value in zip(units, *self._turning_rates(c), strict=True):
                if unit is None:
                    continue
                changed: Matrix = ca.DM(*phi.shape)
                if by_slope is not None:
                    changed = changed + ca.DM(self._differentiate) @ (ca.diag(by_slope) @ phi)
                if by_value is not None:
                    changed = changed + ca.diag(by_value) @ phi
                total = total + ca.diag(unit) @ (ca.DM(self._between) @ changed)
            columns.append(total)
        return ca.horzcat(*columns)

    def _turning_rates(self, c: int) -> tuple[Rows, Rows]:
        """∂u/∂ξ_c = (∂t/∂ξ_c)' + ℓ K × ∂t/∂ξ_c + ℓ ∂K/∂ξ_c × t: what is differentiated, and what is not."""
        direction_rate = self._direction_rate(c)
        turned = _crossed(self._curvature, direction_rate)
        if c >= 3:
            return direction_rate, turned
        axis: list[Row] = [None, None, None]
        axis[c] = self.shape.rod.length * ca.DM.ones(1, len(self.routing.nodes))
        x, y, z = axis
        about = _crossed((x, y, z), self.direction)
        x, y, z = (added(first, second) for first, second in zip(turned, about, strict=True))
        return direction_rate, (x, y, z)

    def _direction_rate(self, c: int) -> Rows:
        """∂t/∂ξ_c = (∂T/∂ξ_c − t ∂|T|/∂ξ_c) / |T|, three rows; None for one that vanishes."""
        # A cable parallel to the rod stays so.
        if self.direction[0] is None and self.direction[1] is None:
            return None, None, None
        stretched = self.lever[c]
        rows: list[Row] = []
        for rate, component in zip(self.tangent_rates[c], self.direction, strict=True):
            turned = added(rate, negative(product(component, stretched)))
            rows.append(None if turned is None else turned / self.stretch)
        x, y, z = rows
        return x, y, z

    def _along(self, row: Row) -> Row:
        """Derivative of a field with X, 1×k; a constant has none."""
        if row is None:
            return None
        if isinstance(row, ca.DM) and float(ca.mmax(row)) == float(ca.mmin(row)):
            return None
        return row @ ca.DM(self._differentiate).T

    def _phi(self, c: int) -> FloatArray:
        """Φ of a strain at the nodes of the routing, shape (k, n_c)."""
        return np.asarray(self.shape.rod.at_nodes[c][self.routing.nodes])

    @cached_property
    def _between(self) -> FloatArray:
        """Matrix from values at the nodes to those at the points between them, shape (f, k)."""
        nodes = self.routing.nodes
        return np.asarray(_between(self.shape.rod.grid.intervals, len(nodes))[0])

    @cached_property
    def _integrate(self) -> FloatArray:
        """Matrix of the integral over X from the beginning of the course to the nodes, shape (k, f)."""
        grid = self.shape.rod.grid
        nodes = self.routing.nodes
        _, weights = _between(grid.intervals, len(nodes))
        first = nodes[:: grid.intervals + 1]
        last = nodes[grid.intervals :: grid.intervals + 1]
        widths = grid.nodes[last] - grid.nodes[first]
        per_element = weights.shape[1] // len(widths)
        return np.asarray(weights * np.repeat(widths, per_element))

    @cached_property
    def _differentiate(self) -> FloatArray:
        """Matrix of the derivative with X inside each element, shape (k, k)."""
        nodes = self.routing.nodes
        return np.asarray(_differentiation_matrix(self.shape.rod.grid)[np.ix_(nodes, nodes)])


def _between(intervals: int, count: int) -> tuple[FloatArray, FloatArray]:
    """Interpolation to Gauss points between the nodes of each element, and running sums to the nodes.

    Args:
        intervals: between the nodes of an element.
        count: nodes of all elements.

    Returns:
        matrices (f, count), and (count, f) for elements of width one.
    """
    nodes = chebyshev.nodes(intervals)
    points, weights = np.polynomial.legendre.leggauss(BETWEEN)
    widths = np.diff(nodes)
    places = nodes[:-1, None] + widths[:, None] * (points + 1) / 2
    local = chebyshev.interpolation_matrix(intervals, places.ravel())
    shares = np.kron(np.diag(widths), weights[None, :] / 2)
    sums = np.vstack([np.zeros((1, shares.shape[1])), np.cumsum(shares, axis=0)])
    elements = count // (intervals + 1)
    # An element begins with all that those before it add.
    before = np.tril(np.ones((elements, elements)), -1)
    running = np.kron(np.eye(elements), sums) + np.kron(before, np.tile(sums[-1:], (intervals + 1, 1)))
    return np.kron(np.eye(elements), local), running


def _differentiation_matrix(grid: Grid) -> FloatArray:
    """Derivative with X of the polynomials of each element, shape (M, M)."""
    local = chebyshev.differentiation_matrix(grid.intervals)
    widths = np.diff(np.asarray(grid.breaks))
    return np.asarray(np.kron(np.diag(1 / widths), local))


def _crossed(a: Rows, b: Rows) -> Rows:
    """Cross product of fields that are three rows each."""
    ax, ay, az = a
    bx, by, bz = b
    return (
        added(product(ay, bz), negative(product(az, by))),
        added(product(az, bx), negative(product(ax, bz))),
        added(product(ax, by), negative(product(ay, bx))),
    )
