"""Pressurised channels along a rod.

A channel of area A at D(X) holds the volume V = A ℓ ∫ (Γ + K × D)_z dX, on which a pressure p does the work p δV: the
force p A e_z on the sections and the moment D × p A e_z, for every strain of the rod. A and D may grow with the
pressure; the energy is then −p V(ξ, p), and the work of the pressure on the wall stays in the wall.

A round wall of radii a and b, modulus E and Poisson's ratio ν and constant length widens by the share
u/a = (1 + ν) p/E ((1 − 2ν) a² + b²)/(b² − a²): Lamé's cylinder in plane strain.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import final

import casadi as ca
import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.actuators.actuator import Actuator
from cosserat_casadi.actuators.routing import routing
from cosserat_casadi.maths.grid import Grid
from cosserat_casadi.maths.numbers import Scalar, among, rows_of, stacked_rows
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.rod.actuation import StrainSum
from cosserat_casadi.scene.actuator_records import ChamberWall

SMALL_STRAIN = 0.1
"""Strain around the bore up to which the linear wall is used: a rubber wall has 2 to 7 % more area there."""

BENDINGS_AND_EXTENSION = (0, 1, 5)
"""Strains K_x, K_y and Γ_z, on which the pressure does work."""


@final
class ChamberActuator(Actuator[scenes.Chamber]):
    """A pressure (Pa) in a channel along the rod."""

    record = scenes.Chamber
    effort = "pressure"
    conjugate = "volume"
    conjugate_unit = "m³"
    energy_sign = -1.0

    def worked_on(self, actuator: scenes.Chamber, grid: Grid, values: Mapping[str, Matrix]) -> StrainSum:
        """The volume of the channel widened by the pressure."""
        volume = self.quantity(actuator, grid)
        if actuator.wall is None and not actuator.area_growth and not actuator.offset_growth:
            return volume
        of_area = _growth_of_area(actuator, values["pressure"])
        of_moment = of_area * _polynomial(actuator.offset_growth, actuator.reference_pressure, values["pressure"])
        return replace(volume, factors=(of_moment, of_moment, of_area))

    def margin(self, actuator: scenes.Chamber, values: Mapping[str, Matrix]) -> Matrix | None:
        """Remaining share of the area, or of the admitted strain of the wall."""
        pressure = values["pressure"]
        wall = actuator.wall
        if wall is None:
            return ca.MX(_growth_of_area(actuator, pressure)) if actuator.area_growth else None
        if wall.reinforced:
            return None
        strain = ca.MX(_widening(wall, pressure))
        return 1 - ca.fabs(strain) / SMALL_STRAIN

    def quantity(self, actuator: scenes.Chamber, grid: Grid) -> StrainSum:
        """The volume without pressure: A D_y, −A D_x and A for each unit of K_x, K_y and Γ_z; zero outside the span."""
        # (Γ + K × D)_z = Γ_z + K_x D_y − K_y D_x.
        channel = routing(actuator, grid)
        x, y = rows_of(channel.offset)
        along = _area(actuator) * stacked_rows([y, -x, np.ones(len(channel.nodes))])
        return StrainSum(BENDINGS_AND_EXTENSION, among(along, channel.nodes, grid.size))


def _area(actuator: scenes.Chamber) -> Scalar:
    """Cross-section without pressure, m²."""
    if actuator.wall is None:
        assert actuator.area is not None, "the record's rules ask for area or wall"
        return actuator.area
    return np.pi * actuator.wall.inner_radius**2


def _growth_of_area(actuator: scenes.Chamber, pressure: Matrix) -> Scalar:
    """Cross-section at a pressure (Pa) over that without pressure."""
    wall = actuator.wall
    if wall is None:
        return _polynomial(actuator.area_growth, actuator.reference_pressure, pressure)
    if wall.reinforced:
        return 1.0
    return (1 + _widening(wall, pressure)) ** 2


def _widening(wall: ChamberWall, pressure: Matrix) -> Scalar:
    """u/a, the strain around the bore of an unreinforced wall."""
    inner = wall.inner_radius**2
    outer = wall.outer_radius**2
    nu = wall.poisson_ratio
    by_pressure = (1 + nu) / wall.youngs_modulus * ((1 - 2 * nu) * inner + outer) / (outer - inner)
    return by_pressure * pressure


def _polynomial(coefficients: Sequence[Scalar], reference: Scalar | None, pressure: Matrix) -> Scalar:
    """The polynomial 1 + c₁ (p/p₀) + c₂ (p/p₀)² + … of a pressure."""
    if not coefficients:
        return 1.0
    assert reference is not None, "the record's rules ask for one"
    total: Scalar = 0.0
    for coefficient in reversed(coefficients):
        total = (total + coefficient) * (pressure / reference)
    return 1.0 + total
