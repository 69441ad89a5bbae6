"""Actuators in the mechanics of a rod: an effort does work on a quantity that is a function of the strains alone.

The quantity is a sum over the nodes, L = ℓ Σ w_k g(ξ_k), the length of a cable or the volume of a channel. An effort τ
with the energy τ L adds τ ∂L/∂q to the residual and τ ∂²L/∂q² to its Jacobian; no pose of a section enters. In the
notation of report (2.15), (2.16) the stress against the elastic one is Λ_ad = τ ∂g/∂ξ. See docs/theory.md section 6.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import casadi as ca
import numpy as np

from cosserat_casadi.maths.numbers import (
    Numbers,
    Scalar,
    any_symbolic,
    as_matrix,
    column,
    known,
    product,
    repeated,
    row_times,
    rows_of,
)
from cosserat_casadi.maths.typing import FloatArray, Matrix, check_shape
from cosserat_casadi.rod.kinematics import Shape
from cosserat_casadi.rod.wrenches import LineWrench


class SectionMotions(Protocol):
    """Variations of a rod's sections with its strain coordinates."""

    def motion_of(self, nodes: list[int]) -> Matrix:
        """[δr; δθ] of the sections of k nodes, stacked component by component, 6k×n, m and rad."""


class Conjugate(ABC):
    """A length or volume on which an effort does work, for a rod of known strain.

    By default the effort reaches every section undiminished: the pull is the gradient.
    """

    @property
    @abstractmethod
    def value(self) -> Matrix:
        """L, 1×1."""

    @property
    @abstractmethod
    def gradient(self) -> Matrix:
        """∂L/∂q, n×1."""

    @abstractmethod
    def curvature(self, a: int, b: int) -> Matrix | None:
        """∂²(ℓ w g)/∂ξ_a∂ξ_b at the nodes, 1×M; None if it is zero for every shape."""

    @property
    def pull(self) -> Matrix:
        """Generalised force of a unit of effort, n×1: the gradient ∂L/∂q, less losses by friction along the rod."""
        return self.gradient

    @property
    def wrench(self) -> LineWrench | None:
        """Wrenches on sections with the pull as generalised force; None if the pull is computed from strains alone.

        They are self-equilibrated. The rod takes them among its loads, in the sweeps of the loads.
        """
        return None

    @property
    def wrench_nodes(self) -> list[int]:
        """The k nodes that the wrenches act on."""
        return []

    @property
    def further_stiffness(self) -> Matrix | None:
        """Part of ∂ pull/∂q beyond the curvature and the wrenches, n×n; None if there is none."""
        return None

    @property
    def section_stiffness(self) -> Matrix | None:
        """Derivative of minus the wrench by the motions [δr; δθ] of its nodes, stacked by component, 6k×6k, or None."""
        return None

    @property
    def conservative(self) -> bool:
        """Whether the pull is the gradient of L."""
        return True

    def rate(self, rate_of: Callable[[Matrix], Matrix]) -> Matrix:
        """Rate of the quantity on which a unit of effort does work, 1×1; ``rate_of`` gives the rate of a value."""
        return rate_of(self.value)


class ShapeQuantity(Protocol):
    """A length or volume on which an effort does work, as a function of the rod's shape."""

    def on(self, shape: Shape) -> Conjugate:
        """The quantity on a rod of this shape."""


@dataclass(frozen=True)
class Actuation:
    """An effort on a rod.

    Attributes:
        quantity: the length or volume on which the effort does work.
        effort: 1×1; the energy is effort times quantity, so a pressure is negative and a tension positive.
    """

    quantity: ShapeQuantity
    effort: Matrix

    def __post_init__(self) -> None:
        check_shape("effort", self.effort, 1, 1)


@dataclass(frozen=True)
class StrainSum:
    """A quantity that is linear in the strains: L = ℓ Σ_c f_c Σ_k w_k (g_ck + H_ck ε_ck) ξ_ck.

    Attributes:
        components: the strains c that it depends on.
        densities: g, shape (len(components), M), numbers or expressions.
        factors: f, one for each component, such as an input that scales constant densities; None if all are 1.
        unloaded: strains ε in the shape of the densities, which the Hooke tensor H turns into stresses; None without
            any.
    """

    components: Sequence[int]
    densities: Numbers
    factors: Sequence[Scalar] | None = None
    unloaded: Numbers | None = None

    def on(self, shape: Shape) -> StrainSumOnRod:
        """The quantity on a rod of this shape."""
        return StrainSumOnRod(shape, self)


@dataclass(frozen=True)
class StrainSumOnRod(Conjugate):
    """A quantity that is linear in the strains, on a rod: its gradient is constant.

    Attributes:
        shape: the rod's shape.
        quantity: the quantity.
    """

    shape: Shape
    quantity: StrainSum

    @cached_property
    def value(self) -> Matrix:
        """L, 1×1."""
        rod = self.shape.rod
        strains = rod.strain_rows(self.shape.q, self.quantity.components, self.shape.ratio)
        total = ca.DM(0.0)
        for component, row, weights in zip(self.quantity.components, strains, self._weighted, strict=True):
            if row is not None:
                total = total + self._times_factor(component, row @ as_matrix(weights))
        return total

    @cached_property
    def gradient(self) -> Matrix:
        """∂L/∂q, n×1."""
        rod = self.shape.rod
        weights = dict(zip(self.quantity.components, self._weighted, strict=True))
        rows: list[tuple[FloatArray, Numbers]] = []
        for c in rod.admitted:
            phi = rod.at_nodes[c]
            # Strains on which the quantity does not depend have no weight.
            own = weights.get(c, np.zeros(rod.grid.size))
            rows.append((phi.T, own))
        if self.quantity.factors is not None or any_symbolic(own for _, own in rows):
            products = [product(to_rows, own) for to_rows, own in rows]
            return ca.vertcat(*[self._times_factor(c, own) for c, own in zip(rod.admitted, products, strict=True)])
        gradient = np.concatenate([to_rows @ known(own) for to_rows, own in rows])
        return ca.sparsify(ca.DM(gradient))

    def curvature(self, a: int, b: int) -> None:
        """Zero."""
        return

    def _times_factor(self, component: int, value: Matrix) -> Matrix:
        """The term of a strain in the quantity, times its factor."""
        if self.quantity.factors is None or component not in self.quantity.components:
            return value
        return self.quantity.factors[list(self.quantity.components).index(component)] * value

    @property
    def _weighted(self) -> list[Numbers]:
        """ℓ w (g + H ε) of each component, shape (M,)."""
        rod = self.shape.rod
        rows = rows_of(self.quantity.densities)
        if self.quantity.unloaded is not None:
            hooke = rod.properties.hooke(rod.grid.nodes)
            for i, (c, strain) in enumerate(
                zip(self.quantity.components, rows_of(self.quantity.unloaded), strict=True)
            ):
                stress = row_times(repeated(column(hooke, c), rod.grid.size), strain)
                symbolic = any_symbolic([rows[i], stress])
                rows[i] = as_matrix(rows[i]) + as_matrix(stress) if symbolic else known(rows[i]) + known(stress)
        return [row_times(rod.reference_lengths, row) for row in rows]
