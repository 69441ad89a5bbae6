"""World poses of several sections of a rod, and their derivatives with the unknowns.

A section between nodes lies on the polynomials through the values at the nodes (:func:`interpolation_weights`); a
quaternion is scaled to unit length there. Derivatives follow from the variations of the rod's fields, as in the
Jacobian of the residual: automatic differentiation would pass through the whole rod again for every section.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import casadi as ca
import numpy as np

from cosserat_casadi.maths import chebyshev
from cosserat_casadi.maths.grid import Grid
from cosserat_casadi.maths.numbers import any_symbolic
from cosserat_casadi.maths.rotation import quaternion_product
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.model.discrete_scene import DiscreteScene
from cosserat_casadi.model.system import System


@dataclass(frozen=True)
class SectionPoses:
    """Poses of sections of a rod.

    Attributes:
        system: rods and frames in symbols or numbers.
        rod: name of the rod.
        weights: weights of the values at its nodes, nodes×k.
    """

    system: System
    rod: str
    weights: Matrix

    @cached_property
    def stacked(self) -> Matrix:
        """Position and quaternion of each section, 7×k."""
        return ca.densify(ca.vertcat(self.positions, self.quaternions))

    @property
    def count(self) -> int:
        """Number k of sections."""
        return int(self.weights.shape[1])

    @cached_property
    def positions(self) -> Matrix:
        """World positions, 3×k, m."""
        base = self.system.base(self.rod)
        base_positions = ca.repmat(base.position, 1, self.count)
        own_positions = self.system.shapes[self.rod].mean_positions(self.weights)
        return base_positions + base.rotation @ own_positions

    @cached_property
    def quaternions(self) -> Matrix:
        """Unit quaternions world_Q_section, 4×k."""
        # Between nodes the norm of an interpolated quaternion is 1 only to the accuracy of the grid.
        unit = self._interpolated / ca.repmat(self._lengths, 4, 1)
        base_quaternions = ca.repmat(self.system.base(self.rod).quaternion, 1, self.count)
        return quaternion_product(ca.densify(base_quaternions), unit)

    @cached_property
    def by_unknowns(self) -> Matrix:
        """∂[position; quaternion]/∂x of one section after another, 7k×size; x must be symbols."""
        discrete = self.system.discrete
        floats = discrete.unloaded.floating_base(self.rod) is not None
        literal = discrete.rods[self.rod].discretisation.transport == "permuted"
        # Here a floating base has its own unknowns, and the literal system has no variations.
        if floats or literal:
            return ca.densify(ca.jacobian(ca.vec(self.stacked), self.system.arguments.x))
        strains = discrete.unknowns.strain(self.rod)
        before = ca.DM(7 * self.count, strains.start)
        after = ca.DM(7 * self.count, discrete.size - strains.stop)
        return ca.densify(ca.horzcat(before, self._by_strains(), after))

    @cached_property
    def _interpolated(self) -> Matrix:
        """Weighted means of the quaternions at the nodes in the frame of the base, 4×k."""
        return ca.densify(self.system.shapes[self.rod].quaternion @ self.weights)

    @cached_property
    def _lengths(self) -> Matrix:
        return ca.sqrt(ca.sum1(self._interpolated * self._interpolated))

    def _by_strains(self) -> Matrix:
        """Derivatives by the strain coordinates of the rod, 7k×n."""
        tangent = self.system.tangents[self.rod]
        rotation = self.system.base(self.rod).rotation
        moved = ca.vertsplit(tangent.displacement(self.weights), 3)
        turned = ca.vertsplit(tangent.quaternion_change(self.weights), 4)
        base_quaternions = ca.MX(ca.repmat(self.system.base(self.rod).quaternion, 1, moved[0].shape[1]))
        rows = []
        for k, (displacement, change) in enumerate(zip(moved, turned, strict=True)):
            unit = self._interpolated[:, k] / self._lengths[k]
            # δ(Q̃ / |Q̃|) = (1 − Q Qᵀ) δQ̃ / |Q̃|.
            across = change - unit @ (unit.T @ change)
            rows.append(rotation @ displacement)
            rows.append(quaternion_product(base_quaternions, ca.densify(across / self._lengths[k])))
        return ca.vertcat(*rows)


def interpolation_weights(discrete: DiscreteScene, rod: str, X: Matrix) -> Matrix:
    """Weights of the nodal values at X, M×1: Chebyshev series of the element that holds X."""
    grid = discrete.rods[rod].grid
    to_coefficients = chebyshev.chebyshev_coefficients(np.eye(grid.intervals + 1))
    rows = []
    for element in range(grid.elements):
        weights = ca.DM(to_coefficients).T @ element_polynomials(grid, element, X)
        if grid.elements > 1:
            weights = element_holds(grid, element, X) * weights
        rows.append(weights)
    return ca.vertcat(*rows)


def element_polynomials(grid: Grid, element: int, X: Matrix) -> Matrix:
    """Chebyshev polynomials of an element at X, (intervals + 1)×1; beyond its ends they go on."""
    start, end = grid.places[element : element + 2]
    return _chebyshev_values(grid.intervals, (X - start) / (end - start))


def section_weights(discrete: DiscreteScene, rod: str, X: Sequence[float]) -> Matrix:
    """Weights of the nodal values at k known abscissae, M×k: numbers unless a parameter moves element ends."""
    grid = discrete.rods[rod].grid
    if any_symbolic(grid.places):
        return ca.horzcat(*[interpolation_weights(discrete, rod, ca.MX(abscissa)) for abscissa in X])
    return ca.sparsify(ca.DM(grid.interpolation_matrix(np.asarray(X, dtype=float)).T))


def element_holds(grid: Grid, element: int, X: Matrix) -> Matrix | int:
    """1 where X lies in the element, which owns its tip-side end, else 0."""
    breaks = grid.places
    # The polynomials of the first and the last element extrapolate beyond the ends of the rod.
    above: Matrix | int = breaks[element] < X if element > 0 else 1
    below: Matrix | int = breaks[element + 1] >= X if element + 2 < len(breaks) else 1
    return above * below


def _chebyshev_values(degree: int, X: Matrix) -> Matrix:
    """Chebyshev polynomials on [0, 1] up to a degree at X, (degree + 1)×1, by their recurrence."""
    x = 2 * X - 1
    values = [ca.MX(1.0), x]
    for _ in range(degree - 1):
        following = 2 * x * values[-1] - values[-2]
        values.append(following)
    return ca.vertcat(*values[: degree + 1])
