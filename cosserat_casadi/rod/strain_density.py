"""A quantity given by its density along the rod, g(ξ), which CasADi differentiates.

It serves actuators with a quantity that is neither a cable's length nor linear in the strains, and the energy of a
nonlinear material. The density is a small function of the six strains of one section, and gradient and curvature are
its derivatives at the nodes.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, lru_cache

import casadi as ca
import numpy as np

from cosserat_casadi.maths.calls import ONE_DIRECTION
from cosserat_casadi.maths.grid import Indices
from cosserat_casadi.maths.numbers import Numbers, as_matrix, each_times, reciprocal
from cosserat_casadi.maths.typing import FloatArray, Matrix
from cosserat_casadi.rod.actuation import Conjugate
from cosserat_casadi.rod.kinematics import Shape
from cosserat_casadi.rod.strain import DiscreteRod

Density = Callable[[Matrix, Matrix], Matrix]
"""Strains of a section, 6×1, and its data, d×1 ↦ quantity per length of the rod, 1×1."""


@dataclass(frozen=True)
class StrainDensity:
    """A quantity L = ℓ Σ_k w_k g(ξ_k, data_k) over the nodes of a span.

    Attributes:
        density: g, a function of CasADi matrices.
        nodes: the k nodes of the span.
        data: numbers along the rod on which g depends, shape (d, k).
        of_change: whether g is a function of the change of the strains from the unloaded ones, ξ − ξ⁰.
    """

    density: Density
    nodes: Indices
    data: Numbers
    of_change: bool = False

    def on(self, shape: Shape) -> StrainDensityOnRod:
        """The quantity on a rod of this shape."""
        return StrainDensityOnRod(shape, self)


@dataclass(frozen=True)
class StrainDensityOnRod(Conjugate):
    """A quantity given by its density, on a rod.

    Attributes:
        shape: the rod's shape.
        quantity: the quantity.
    """

    shape: Shape
    quantity: StrainDensity

    @cached_property
    def value(self) -> Matrix:
        """L, 1×1."""
        density, _, _ = self._at_nodes
        lengths = each_times(self._reference_lengths, self._rates)
        return density @ as_matrix(lengths)

    @cached_property
    def gradient(self) -> Matrix:
        """∂L/∂q, n×1."""
        rod = self.shape.rod
        _, gradient, _ = self._at_nodes
        parts = []
        for c in rod.admitted:
            phi = rod.at_nodes[c][self.quantity.nodes]
            weighted = phi * self._reference_lengths[:, None]
            parts.append(ca.DM(weighted).T @ gradient[c, :].T)
        return ca.vertcat(*parts)

    def curvature(self, a: int, b: int) -> Matrix | None:
        """∂²(ℓ w g)/∂ξ_a∂ξ_b at the nodes, 1×M; None if it is zero for every shape."""
        _, _, second = self._at_nodes
        row = second[6 * b + a, :]
        if not row.nnz():
            return None
        whole = type(row)(1, self.shape.rod.grid.size)
        weights = each_times(self._reference_lengths, reciprocal(self._rates))
        whole[self.quantity.nodes.tolist()] = row * as_matrix(weights).T
        return whole

    @cached_property
    def strain(self) -> Matrix:
        """Arguments of the density: strains per length of the rod at the nodes, 6×k."""
        nodes = self.quantity.nodes.tolist()
        zero = ca.DM(1, len(nodes))
        strain = ca.vertcat(*[zero if row is None else row[nodes] for row in self._strain_rows])
        if self._rates is None:
            return strain
        # Rows are per length of the grid's coordinate.
        return strain @ ca.diag(as_matrix(1 / self._rates))

    @cached_property
    def _at_nodes(self) -> tuple[Matrix, Matrix, Matrix]:
        """Density, 1×k, its gradient, 6×k, and its second derivatives column by column, 36×k, at the nodes."""
        present = [c for c, row in enumerate(self._strain_rows) if row is not None]
        kernel = _kernel(self.quantity.density, tuple(present), self.quantity.data.shape[0])
        mapped = kernel.map(len(self.quantity.nodes))
        symbols = mapped.mx_in()
        # A CasADi map takes no options itself.
        densities = ca.Function("densities", symbols, mapped.call(symbols), ONE_DIRECTION)
        density, gradient, second = densities.call([self.strain, as_matrix(self.quantity.data)])
        return density, gradient, second

    @property
    def _reference_lengths(self) -> FloatArray:
        """Reference length of each node of the span, the weight of densities per such length, ℓ w, (k,), m."""
        return self.shape.rod.reference_lengths[self.quantity.nodes]

    @cached_property
    def _strain_rows(self) -> list[Matrix | None]:
        """Arguments of the density: strains at all nodes, 1×M each; None for strains that stay zero."""
        rod = self.shape.rod
        if self.quantity.of_change:
            return [rod.change_row(self.shape.q, c) for c in range(6)]
        return rod.strain_rows(self.shape.q, range(6), self.shape.ratio)

    @cached_property
    def _rates(self) -> Numbers | None:
        """Length of rod over reference length at the nodes of the span, shape (k,); None if it is one."""
        grid = self.shape.rod.grid
        rates = grid.rates_in(grid.element_of_node[self.quantity.nodes])
        ratio = self.shape.ratio
        if ratio is None:
            return rates
        return ratio * (ca.DM.ones(len(self.quantity.nodes)) if rates is None else as_matrix(rates))


@lru_cache(maxsize=32)
def _kernel(density: Density, present: tuple[int, ...], data_size: int) -> ca.Function:
    """(strain, data) ↦ (density, gradient, second derivatives) of one section, of the strains that may be present."""
    # A strain that is zero for every shape has no symbol, so that no code is written for it.
    first_column = [0] * len(present)
    pattern = ca.Sparsity.triplet(6, 1, list(present), first_column)
    strain = ca.SX.sym("strain", pattern)
    data = ca.SX.sym("data", data_size)
    # The function is called with symbols once; a map evaluates the derivatives.
    value = density(strain, data)
    gradient = ca.jacobian(value, strain).T
    second = ca.vec(ca.jacobian(gradient, strain))
    return ca.Function("density", [strain, data], ca.cse([value, gradient, second]))


def energy_beyond_hooke(shape: Shape) -> StrainDensityOnRod | None:
    """Elastic energy of a rod beyond its Hooke tensor's, J; None for a linear rod."""
    rod = shape.rod
    law = rod.properties.beyond_hooke
    if law is None:
        return None
    data = law.data(rod.grid.nodes).T
    return StrainDensity(law.density, np.arange(rod.grid.size), data, of_change=True).on(shape)


@dataclass(frozen=True)
class StiffnessBeyondHooke:
    """Stiffness of a rod beyond the Hooke tensor's at its strains, over EI/ℓ.

    Attributes:
        energy: elastic energy of the rod beyond the Hooke tensor's.
    """

    energy: StrainDensityOnRod

    @property
    def diagonal(self) -> Matrix:
        """Diagonal of the matrix, n×1."""
        parts = []
        for c in self._rod.admitted:
            squares = ca.sparsify(ca.DM(self._rod.at_nodes[c] ** 2))
            curvature = self.energy.curvature(c, c)
            parts.append(ca.DM(squares.shape[1], 1) if curvature is None else squares.T @ curvature.T)
        return ca.vertcat(*parts) / self._rod.energy_unit

    def times(self, q: Matrix) -> Matrix:
        """Product with strain coordinates, n×1; the matrix is not written."""
        admitted = self._rod.admitted
        tables = {c: ca.sparsify(ca.DM(self._rod.at_nodes[c])) for c in admitted}
        strains = {c: (tables[c] @ q[self._rod.columns[c]]).T for c in admitted}
        parts = []
        for a in admitted:
            stress = ca.MX(1, self._rod.grid.size)
            for b in admitted:
                curvature = self.energy.curvature(a, b)
                if curvature is not None:
                    stress = stress + curvature * strains[b]
            parts.append(tables[a].T @ stress.T)
        return ca.vertcat(*parts) / self._rod.energy_unit

    @property
    def _rod(self) -> DiscreteRod:
        """The rod, on its grid."""
        return self.energy.shape.rod


def stiffness_beyond_hooke(shape: Shape) -> StiffnessBeyondHooke | None:
    """Stiffness of a rod at a shape beyond the Hooke tensor's; None for a linear rod."""
    energy = energy_beyond_hooke(shape)
    return None if energy is None else StiffnessBeyondHooke(energy)
