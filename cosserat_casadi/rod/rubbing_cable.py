"""A cable with friction along its course: its tension falls, or grows, with the angle through which it turns.

By Euler's and Eytelwein's law of the capstan dT = ∓μ T dφ along a cable that is about to slip, so that its tension is

    T(X) = T₀ exp(−μ p φ(X)),    φ(X) = ∫ |dt/dX| dX

with p = 1 if it was last pulled in at its base, p = −1 if it was let out, and t the direction of the cable in the
world: in the axes of the section |dt/dX| = |t' + ℓ K × t|. Contact with the rod does no work in a virtual change of
strain, in which the cable does not slip: each strain does work on the local tension, and the generalised force of T₀ is

    Σ ℓ w exp(−μ p φ) ∂|T|/∂q

over the nodes. It is not a gradient, so that a rod with such a cable has no potential. See docs/theory.md, section 6.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from typing import Any

import casadi as ca
import numpy as np
import numpy.typing as npt

from cosserat_casadi.maths import chebyshev
from cosserat_casadi.maths.block_operators import cumulative_sum
from cosserat_casadi.maths.grid import gauss_legendre
from cosserat_casadi.maths.typing import FloatArray, Matrix, check_shape
from cosserat_casadi.rod.cable import RoutedCable, Routing, Row, added, negative, product
from cosserat_casadi.rod.kinematics import Shape

Rows = tuple[Row, Row, Row]
"""A vector field in the axes of the sections."""

BETWEEN = 4
"""Gauss points between neighbouring nodes for the integral of |dt/dX|."""

STRAIGHT = 1e-6
"""Turn along a whole rod, rad, by which a cable's turn is smoothed: its derivative is finite for a straight cable."""


@dataclass(frozen=True)
class RubbingRouting:
    """A routing of a cable with friction.

    Attributes:
        routing: path of the cable in the sections.
        friction: μ p, coefficient of friction times the direction of slip, 1×1.
    """

    routing: Routing
    friction: Matrix

    def __post_init__(self) -> None:
        check_shape("friction", self.friction, 1, 1)

    def on(self, shape: Shape) -> RubbingCable:
        """The cable on a rod of this shape; the quantity is its length."""
        return RubbingCable(shape, self.routing, self.friction)


@dataclass(frozen=True)
class RubbingCable(RoutedCable):
    """A cable with friction on its routing through a deformed rod.

    Attributes:
        friction: μ p, coefficient of friction times the direction of slip, 1×1.
    """

    friction: Matrix

    @property
    def conservative(self) -> bool:
        """False: the force of a cable with friction is not a gradient."""
        return False

    @cached_property
    def shares(self) -> Matrix:
        """Tension along the course over the tension at its base, exp(−μ p φ), 1×k."""
        return ca.exp(-self.friction * self.turn)

    @cached_property
    def turn(self) -> Matrix:
        """Angle φ through which the cable turns from its base to each node, 1×k, rad."""
        turned = self.turn_slope @ self._interval_weights.T
        if self._kinks is not None:
            missed, _, _ = self._kinks
            turned = turned + missed * self._interval_widths.T
        # Made dense first: CasADi 3.8.2 sums a sparse MX wrongly.
        sections = ca.cumsum(ca.densify(ca.horzcat(ca.DM(1, 1), turned)), 1)
        return sections[:, self._sections]

    @cached_property
    def turn_slope(self) -> Matrix:
        """|dt/dX| at points between the nodes, 1×f, rad: √(u·u + ε²) with u = t' + ℓ K × t."""
        squares = added(*[product(row, row) for row in self._turning_between])
        if squares is None:
            return ca.DM.ones(1, self._interval_weights.shape[1]) * STRAIGHT
        return ca.sqrt(squares + STRAIGHT**2)

    @cached_property
    def pull(self) -> Matrix:
        """Generalised force of a unit of tension at the base, Σ ℓ w exp(−μ p φ) ∂|T|/∂q, n×1, m."""
        return self._work_of({c: product(lever, self.shares) for c, lever in self.lever.items()})

    def curvature(self, a: int, b: int) -> Row:
        """Curvature of the cable without friction times the share of tension at each node, 1×M, m."""
        row = super().curvature(a, b)
        if row is None:
            return None
        nodes = self.routing.nodes.tolist()
        whole = type(self.shares)(*row.shape)
        whole[nodes] = row[nodes] * self.shares
        return whole

    @cached_property
    def further_stiffness(self) -> Matrix:
        """Part of ∂ pull/∂q by the change of the shares of tension, n×n, m: it is not symmetric."""
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
        """Mean tension along the course over the tension at its base, 1×1."""
        return (self.stretch * self.shares) @ ca.DM(self._node_lengths) / self.value

    @cached_property
    def mean_share_gradient(self) -> Matrix:
        """∂ mean share/∂q, n×1."""
        by_shares = (self.stretch @ self._weighted_change).T
        return (self.pull + by_shares - self.mean_share * self.gradient) / self.value

    def rate(self, rate_of: Callable[[Matrix], Matrix]) -> Matrix:
        """Rate of the length on which the tension at the base does work, 1×1, from the rate of each part."""
        return rate_of(self.stretch) @ (self.shares.T * ca.DM(self._node_lengths))

    @cached_property
    def _weighted_change(self) -> Matrix:
        """Derivative of the shares by q times the lengths of the nodes, k×n, m."""
        by_turn = -self.friction * (self.shares * ca.DM(self._node_lengths).T)
        passed = cumulative_sum(self._interval_turn_gradient, self._interval_weights.shape[0])
        turned = ca.vertcat(ca.DM(1, passed.shape[1]), passed)[self._sections, :]
        return ca.diag(by_turn) @ turned

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
        return [None if row is None else row @ self._between.T for row in self._turning]

    @cached_property
    def _kinks(self) -> tuple[Matrix, Matrix, Matrix] | None:
        """Errors of the Gauss sums of |u| in intervals where u passes zero, and their derivatives by u at the ends.

        They are for u linear between its values at the ends, relative to the width of the interval, 1×I, and m×I each
        for the m components of u; None for a cable that does not turn.
        """
        rows = [row for row in self._turning if row is not None]
        if not rows:
            return None
        turning = ca.densify(ca.vertcat(*rows))
        kernel = _missed_by_gauss(len(rows)).map(len(self._left_nodes))
        missed, by_left, by_right = kernel(turning[:, self._left_nodes], turning[:, self._right_nodes])
        return missed, by_left, by_right

    @property
    def _interval_turn_gradient(self) -> Matrix:
        """Derivative by q of the turn of each interval between nodes, Σ w (u/|u|)·∂u/∂q, I×n."""
        units = [None if row is None else row / self.turn_slope for row in self._turning_between]
        # Matrices from values at the nodes to the angles of the intervals: few rows, which all strains share.
        to_angles = [
            None if unit is None else self._interval_weights @ (ca.diag(unit) @ self._between) for unit in units
        ]
        if self._kinks is not None:
            _, by_left, by_right = self._kinks
            present = [i for i, row in enumerate(self._turning) if row is not None]
            for k, i in enumerate(present):
                at_left = ca.diag(by_left[k, :] * self._interval_widths.T) @ self._picked(self._left_nodes)
                at_right = ca.diag(by_right[k, :] * self._interval_widths.T) @ self._picked(self._right_nodes)
                to_angles[i] = added(to_angles[i], at_left, at_right)
        columns = []
        for c in self.shape.rod.admitted:
            phi = ca.DM(self._phi(c))
            total: Matrix = ca.DM(self._interval_weights.shape[0], phi.shape[1])
            for to_angle, by_slope, by_value in zip(to_angles, *self._turning_rates(c), strict=True):
                if to_angle is None:
                    continue
                if by_slope is not None:
                    total = total + (to_angle @ self._differentiate) @ (ca.diag(by_slope) @ phi)
                if by_value is not None:
                    total = total + to_angle @ (ca.diag(by_value) @ phi)
            columns.append(total)
        return ca.horzcat(*columns)

    def _turning_rates(self, c: int) -> tuple[Rows, Rows]:
        """∂u/∂ξ_c = (∂t/∂ξ_c)' + ℓ K × ∂t/∂ξ_c + ℓ ∂K/∂ξ_c × t: the term to differentiate, and the other terms."""
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
        """∂t/∂ξ_c = (∂T/∂ξ_c − t ∂|T|/∂ξ_c) / |T|, three rows; None for a zero row."""
        # A cable parallel to the rod stays so.
        if self.is_parallel:
            return None, None, None
        stretched = self.lever[c]
        rows: list[Row] = []
        for rate, component in zip(self.tangent_rates[c], self.direction, strict=True):
            turned = added(rate, negative(product(component, stretched)))
            rows.append(None if turned is None else turned / self.stretch)
        x, y, z = rows
        return x, y, z

    def _along(self, row: Row) -> Row:
        """Derivative of a component of t by X, 1×k; None for a cable parallel to the rod."""
        if row is None or self.is_parallel:
            return None
        return row @ self._differentiate.T

    @property
    def _elements(self) -> FloatArray:
        """Widths of the elements that the cable passes, in the grid's coordinate, shape (E,)."""
        grid = self.shape.rod.grid
        nodes = self.routing.nodes
        first = nodes[:: grid.intervals + 1]
        last = nodes[grid.intervals :: grid.intervals + 1]
        return np.asarray(grid.reference_nodes[last] - grid.reference_nodes[first])

    @property
    def _sections(self) -> list[int]:
        """Index of each node among the distinct sections of the course."""
        intervals = self.shape.rod.grid.intervals
        local = np.arange(intervals + 1)
        starts = intervals * np.arange(len(self._elements))
        return list(map(int, (starts[:, None] + local).ravel()))

    @cached_property
    def _left_nodes(self) -> list[int]:
        """Node of the routing at which each interval begins."""
        grid = self.shape.rod.grid
        return [node for node in range(len(self.routing.nodes)) if (node + 1) % (grid.intervals + 1)]

    @property
    def _right_nodes(self) -> list[int]:
        """Node of the routing at which each interval ends."""
        return [node + 1 for node in self._left_nodes]

    def _picked(self, nodes: Sequence[int]) -> ca.DM:
        """Matrix from values at the k nodes of the routing to values at some nodes, len(nodes)×k."""
        return _sparse(np.eye(len(self.routing.nodes))[nodes])

    @property
    def _interval_widths(self) -> ca.DM:
        """Widths of the intervals, I×1."""
        return ca.densify(ca.sum2(self._interval_weights))

    @cached_property
    def _between(self) -> ca.DM:
        """Matrix from values at the nodes to those at the points between them, f×k."""
        places, _ = _gauss_points(self.shape.rod.grid.intervals)
        local = chebyshev.interpolation_matrix(self.shape.rod.grid.intervals, places.ravel())
        return _sparse(np.kron(np.eye(len(self._elements)), local))

    @cached_property
    def _interval_weights(self) -> ca.DM:
        """Weights of the integral over X of each interval between nodes, I×f."""
        _, weights = _gauss_points(self.shape.rod.grid.intervals)
        shares = np.zeros((len(weights), weights.size))
        for interval, row in enumerate(weights):
            shares[interval, interval * BETWEEN : (interval + 1) * BETWEEN] = row
        return _sparse(np.kron(np.diag(self._elements), shares))

    @cached_property
    def _differentiate(self) -> ca.DM:
        """Matrix of the derivative by X inside each element, k×k."""
        local = chebyshev.differentiation_matrix(self.shape.rod.grid.intervals)
        return _sparse(np.kron(np.diag(1 / self._elements), local))


def _gauss_points(intervals: int) -> tuple[FloatArray, FloatArray]:
    """Gauss points between the nodes of an element of width one and their weights, shape (intervals, points) each."""
    nodes = chebyshev.nodes(intervals)
    points, weights = gauss_legendre(BETWEEN)
    widths = np.diff(nodes)[:, None]
    return nodes[:-1, None] + widths * (points + 1) / 2, widths * weights / 2


@cache
def _missed_by_gauss(components: int) -> ca.Function:
    """(u₀, u₁) ↦ ∫₀¹ √(|u|² + ε²) ds less its Gauss sum for u = u₀ + s (u₁ − u₀), and the derivatives by both.

    With e₀, e₁ the values of the root at both ends, q their sum, L = |u₁ − u₀| and σ = (e₁ − e₀)/L the integral is, as
    in the potential of a straight segment,

        ∫ = q/4 [1 + σ² + (1 − σ²)(1 − c²) artanh(c)/c],    c = L/q.

    The error counts if the directions at both ends are more than a right angle apart, in full if they are opposite:
    only then does u come near zero. For a course that turns evenly, as a helix does, u is not linear, and the sum is
    exact.
    """
    left = ca.SX.sym("left", components)
    right = ca.SX.sym("right", components)
    e0 = ca.sqrt(ca.sumsqr(left) + STRAIGHT**2)
    e1 = ca.sqrt(ca.sumsqr(right) + STRAIGHT**2)
    q = e0 + e1
    # If u is equal at both ends L is zero: its square is kept away from zero.
    squared_length = ca.sumsqr(right - left) + STRAIGHT**2
    length = ca.sqrt(squared_length)
    both = ca.dot(left, right)
    # q² − L², which rounding must not make negative if u passes exactly through zero.
    gap = ca.fmax(2 * (e0 * e1 + both) + STRAIGHT**2, STRAIGHT**2)
    artanh = ca.log(q + length) - ca.log(gap) / 2
    share = gap / q**2 * artanh * q / length
    # 1 − σ².
    across = 2 * (e0 * e1 - both - STRAIGHT**2) / squared_length
    integral = q / 2 - q / 4 * across * (1 - share)
    points, weights = gauss_legendre(BETWEEN)
    gauss_sum = ca.SX(0)
    for point, weight in zip(((points + 1) / 2).tolist(), (weights / 2).tolist(), strict=True):
        between = left + point * (right - left)
        gauss_sum += weight * ca.sqrt(ca.sumsqr(between) + STRAIGHT**2)
    opposite = ca.fmax(-both / (e0 * e1), 0)
    counted = opposite**2 * (2 - opposite**2)
    missed = counted * (integral - gauss_sum)
    results = ca.cse([missed, ca.jacobian(missed, left).T, ca.jacobian(missed, right).T])
    return ca.Function("missed_by_gauss", [left, right], results, ["left", "right"], ["missed", "by_left", "by_right"])


def _sparse(matrix: npt.NDArray[Any]) -> ca.DM:
    """A matrix without its zeros."""
    return ca.sparsify(ca.DM(matrix))


def _crossed(a: Rows, b: Rows) -> Rows:
    """Cross product of fields that are three rows each."""
    ax, ay, az = a
    bx, by, bz = b
    return (
        added(product(ay, bz), negative(product(az, by))),
        added(product(az, bx), negative(product(ax, bz))),
        added(product(ax, by), negative(product(ay, bx))),
    )
