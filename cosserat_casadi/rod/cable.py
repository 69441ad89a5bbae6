"""A cable through the sections of a rod: its length and how it varies with the strains.

The cable runs at D(X) in the sections, so its tangent in the section's frame is T = Γ + K × D + D'/ℓ and its length
L = ℓ ∫ |T| dX. A tension τ does the work −τ δL. The stress of the cable against the elastic stress is therefore Λ_ad =
τ [D × t; t] with t = T/|T|, report (2.15), for every routing, and its generalised force τ ∂L/∂q needs no pose of any
section. The sums over the nodes below are exact derivatives of the length that the nodes give. See docs/theory.md
section 6.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import casadi as ca
import numpy as np

from cosserat_casadi.maths.block_operators import summed
from cosserat_casadi.maths.grid import Indices
from cosserat_casadi.maths.numbers import Numbers, as_matrix, each_times, is_zero, rows_of
from cosserat_casadi.maths.typing import FloatArray, Matrix, check_shape
from cosserat_casadi.rod.actuation import Conjugate
from cosserat_casadi.rod.kinematics import Shape

Row = Matrix | None
"""A field on the nodes of the routing, 1×k; None if it is zero for every shape."""


@dataclass(frozen=True)
class Routing:
    """Path of a cable in the sections, at the k nodes of the elements that it passes.

    Attributes:
        nodes: indices of the nodes, shape (k,).
        offset: D_x and D_y in the section, shape (2, k), m, numbers or expressions.
        slope: dD/dX, shape (2, k), m.
    """

    nodes: Indices
    offset: Numbers
    slope: Numbers

    def __post_init__(self) -> None:
        count = len(self.nodes)
        check_shape("offset", self.offset, 2, count)
        check_shape("slope", self.slope, 2, count)

    def on(self, shape: Shape) -> RoutedCable:
        """The cable on a rod of this shape; the quantity is its length."""
        return RoutedCable(shape, self)


@dataclass(frozen=True)
class Cable(Conjugate):
    """A cable through a deformed rod, whose quantity is its length.

    Attributes:
        shape: the rod's shape.
    """

    shape: Shape

    @property
    def mean_share(self) -> Matrix | None:
        """Mean tension along the course over the tension at its base, 1×1; None if the tension is uniform."""
        return None

    @property
    def mean_share_gradient(self) -> Matrix | None:
        """Derivative of the mean share by q, n×1; None if the tension is uniform."""
        return None


@dataclass(frozen=True)
class RoutedCable(Cable):
    """A cable on its routing through a deformed rod.

    Attributes:
        routing: path of the cable in the sections.
    """

    routing: Routing

    @cached_property
    def tangent(self) -> tuple[Row, Row, Row]:
        """T in the sections' frames, three rows."""
        # K × D with D = (D_x, D_y, 0), written by components so that zero rows are left out.
        kx, ky, kz, gx, gy, gz = self._strain
        dx, dy = self._offset
        length = self.shape.rod.length
        rates = self.shape.rod.grid.rates_in(self._node_elements)
        slope_x, slope_y = (_constant(each_times(row / length, rates)) for row in rows_of(self.routing.slope))
        return (
            added(gx, negative(product(kz, dy)), slope_x),
            added(gy, product(kz, dx), slope_y),
            added(gz, product(kx, dy), negative(product(ky, dx))),
        )

    @property
    def is_parallel(self) -> bool:
        """Whether the cable stays parallel to the rod: its direction is ±1 along the axis, and |T| has no curvature."""
        x, y, _ = self.tangent
        return x is None and y is None

    @cached_property
    def stretch(self) -> Matrix:
        """|T|, 1×k."""
        x, y, z = self.tangent
        if self.is_parallel:
            assert z is not None, "a cable has a tangent"
            return ca.fabs(z)
        squares = added(*[product(row, row) for row in (x, y, z)])
        assert squares is not None, "a cable has a tangent"
        return ca.sqrt(squares)

    @property
    def stretch_along(self) -> Row:
        """T_z per length of the rod, 1×k: negative where the strain would turn matter inside out."""
        along = self.tangent[2]
        if along is None:
            return None
        rates = self.shape.rod.grid.rates_in(self._node_elements)
        if rates is not None:
            along = along / as_matrix(rates).T
        if self.shape.ratio is not None:
            along = along / self.shape.ratio
        return along

    @cached_property
    def direction(self) -> tuple[Row, Row, Row]:
        """T = T/|T|, three rows."""
        x, y, z = (None if row is None else row / self.stretch for row in self.tangent)
        return x, y, z

    @cached_property
    def lever(self) -> dict[int, Row]:
        """Derivative of |T| by each admitted strain: the components of [D × t; t]."""
        # [D × t; t], angular part first.
        x, y, z = self.direction
        dx, dy = self._offset
        levers = {
            0: product(z, dy),
            1: negative(product(z, dx)),
            2: added(product(y, dx), negative(product(x, dy))),
            3: x,
            4: y,
            5: z,
        }
        return {c: levers[c] for c in self.shape.rod.admitted}

    @cached_property
    def value(self) -> Matrix:
        """Length L along the routing, 1×1, m."""
        lengths = ca.DM(self._node_lengths)
        return self.stretch @ lengths

    @cached_property
    def gradient(self) -> Matrix:
        """∂L/∂q, n×1, m."""
        return self._work_of(self.lever)

    def curvature(self, a: int, b: int) -> Row:
        """∂²(ℓ w |T|)/∂ξ_a∂ξ_b at the nodes of the whole rod, 1×M, m; None if it is zero for every shape.

        With T linear in the strains, ∂²|T| = (∂_aT·∂_bT − ∂_a|T| ∂_b|T|) / |T|.
        """
        # The length of a cable parallel to the rod is linear in the strains on either side of a vanishing path.
        if self.is_parallel:
            return None
        metric = self._metric(a, b)
        along = negative(product(self.lever[a], self.lever[b]))
        across = added(metric, along)
        if across is None:
            return None
        row = across / self.stretch * ca.DM(self._node_lengths).T
        # Nodes of elements that the cable does not pass have no entry.
        whole = type(row)(1, self.shape.rod.grid.size)
        whole[self.routing.nodes.tolist()] = row
        return whole

    @cached_property
    def _strain(self) -> list[Row]:
        """The six strains at the nodes of the routing."""
        nodes = self.routing.nodes.tolist()
        rows = self.shape.rod.strain_rows(self.shape.q, range(6), self.shape.ratio)
        return [None if row is None else row[nodes] for row in rows]

    @property
    def _offset(self) -> tuple[Row, Row]:
        dx, dy = rows_of(self.routing.offset)
        return _constant(dx), _constant(dy)

    @property
    def tangent_rates(self) -> list[tuple[Row, Row, Row]]:
        """∂T/∂ξ_c of the six strains, three rows each."""
        dx, dy = self._offset
        unit = ca.DM.ones(1, len(self.routing.nodes))
        return [
            (None, None, dy),
            (None, None, negative(dx)),
            (negative(dy), dx, None),
            (unit, None, None),
            (None, unit, None),
            (None, None, unit),
        ]

    def _work_of(self, levers: dict[int, Row]) -> Matrix:
        """Σ ℓ w lever ∂ξ/∂q over the nodes, n×1, m, of levers of the admitted strains, 1×k each."""
        weighted = {c: ca.DM(self._phi(c) * self._node_lengths[:, None]).T for c in levers}
        parts = [ca.DM(weighted[c].shape[0], 1) if row is None else weighted[c] @ row.T for c, row in levers.items()]
        return ca.vertcat(*parts)

    def _phi(self, c: int) -> FloatArray:
        """Φ of a strain at the nodes of the routing, shape (k, n_c)."""
        return np.asarray(self.shape.rod.at_nodes[c][self.routing.nodes])

    def _metric(self, a: int, b: int) -> Row:
        """Scalar product of the derivatives of T by two strains, 1×k."""
        pairs = zip(self.tangent_rates[a], self.tangent_rates[b], strict=True)
        metric = added(*[product(one, other) for one, other in pairs])
        # A zero without sign, whichever factor it comes from.
        return None if metric is None else metric + 0.0

    @property
    def _node_lengths(self) -> FloatArray:
        """Reference length of each node of the routing, the weight of densities per such length, ℓ w, (k,), m."""
        return self.shape.rod.reference_lengths[self.routing.nodes]

    @property
    def _node_elements(self) -> Indices:
        """Element of each node of the routing, shape (k,)."""
        return self.shape.rod.grid.element_of_node[self.routing.nodes]


def _constant(row: Numbers) -> Row:
    """A row of numbers or expressions; None if all are zero."""
    return None if is_zero(row) else as_matrix(row).T


def added(*rows: Row) -> Row:
    """Sum of fields."""
    return summed([row for row in rows if row is not None])


def product(a: Row, b: Row) -> Row:
    """Product of two fields, node by node."""
    if a is None or b is None:
        return None
    return a * b


def negative(row: Row) -> Row:
    """A field times −1."""
    return None if row is None else -row
