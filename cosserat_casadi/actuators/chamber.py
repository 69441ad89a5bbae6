"""Pressurised channels along a rod.

A channel of area A at D(X) holds the volume V = A ℓ ∫ (Γ + K × D)_z dX, on which a pressure p does the work p δV: the
force p A e_z on the sections and the moment D × p A e_z, whatever the rod's strain.
"""

from __future__ import annotations

from typing import final

import casadi as ca
import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.actuators.actuator import Actuator
from cosserat_casadi.actuators.routing import routing
from cosserat_casadi.maths.grid import Grid
from cosserat_casadi.maths.numbers import is_symbolic, rows_of, stacked_rows
from cosserat_casadi.rod.actuation import StrainSum

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

    def quantity(self, actuator: scenes.Chamber, grid: Grid) -> StrainSum:
        """The volume: A D_y, −A D_x and A for each unit of K_x, K_y and Γ_z; zero outside the span."""
        # (Γ + K × D)_z = Γ_z + K_x D_y − K_y D_x.
        channel = routing(actuator, grid)
        x, y = rows_of(channel.offset)
        along = actuator.area * stacked_rows([y, -x, np.ones(len(channel.nodes))])
        if is_symbolic(along):
            to_nodes = ca.DM(np.eye(grid.size)[channel.nodes])
            return StrainSum(BENDINGS_AND_EXTENSION, along @ ca.sparsify(to_nodes))
        densities = np.zeros((3, grid.size))
        densities[:, channel.nodes] = along
        return StrainSum(BENDINGS_AND_EXTENSION, densities)
