"""Active moment and force in the sections of a rod, as by muscles and active materials.

A muscle of activation a has in each section the active moment a p(X) (l + D × f) and the active force a p(X) f, in
section axes, beside the elastic ones. Its work on the rod is a W with W = ℓ ∫ p ((l + D × f)·K + f·Γ) dX. A moment K_b
κ₀(X) is equivalent to an unloaded curvature κ₀(X), which the scene may give instead.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, final

import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.actuators.actuator import Actuator
from cosserat_casadi.actuators.routing import offset_at
from cosserat_casadi.loads.load import coefficients, combined, legendre_series
from cosserat_casadi.maths.grid import Grid
from cosserat_casadi.maths.numbers import Numbers, among, is_zero, rows_of, stacked_rows
from cosserat_casadi.maths.splines import spline_basis
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.rod.actuation import StrainSum


@final
class MuscleActuator(Actuator[scenes.Muscle]):
    """An activation (without unit) of a moment and a force in the sections."""

    record = scenes.Muscle
    effort = "activation"
    conjugate = "work"
    conjugate_unit = "J"
    energy_sign = -1.0

    def quantity(self, actuator: scenes.Muscle, grid: Grid) -> StrainSum:
        """The work of a unit of activation: p (l + D × f) for each unit of K and p f for each of Γ."""
        return _work(actuator, grid, coefficients((actuator.profile,)))

    def worked_on(self, actuator: scenes.Muscle, grid: Grid, values: Mapping[str, Matrix]) -> StrainSum:
        """The work of a unit of activation with the profile among the inputs, 1×1, J; by default the record's."""
        profile = values["profile"]
        if profile.is_constant():
            return self.quantity(actuator, grid)
        return _work(actuator, grid, profile)


def _work(actuator: scenes.Muscle, grid: Grid, series: Numbers) -> StrainSum:
    """Work of a unit of activation, for a profile of Legendre coefficients, or of values at knots, shape (1, k)."""
    nodes = grid.nodes_in(*actuator.span)
    X = grid.nodes_at(nodes)
    if actuator.knots is None:
        along = legendre_series(series, X)
    else:
        along = combined(series, spline_basis(np.array(actuator.knots), X))
    (profile,) = rows_of(along)
    offset, _ = offset_at(actuator, X)
    x, y = rows_of(offset)
    fx, fy, fz = actuator.force
    lx, ly, lz = actuator.moment
    stresses = [lx + y * fz, ly - x * fz, lz + x * fy - y * fx, fx, fy, fz]
    strains = [*actuator.curvature, 0.0, 0.0, 0.0]
    # A muscle with zeros alone, as in a sweep over its moment, does no work on the first strain.
    components = [c for c in range(6) if not is_zero(stresses[c]) or not is_zero(strains[c])] or [0]

    def everywhere(numbers: Sequence[Any]) -> Numbers:
        return among(stacked_rows([numbers[c] * profile for c in components]), nodes, grid.size)

    unloaded = None if is_zero(strains) else everywhere(strains)
    return StrainSum(components, everywhere(stresses), unloaded=unloaded)
