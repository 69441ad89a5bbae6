"""Pressurised channels along a rod.

A channel of area A at D(X) holds the volume V = A ℓ ∫ (Γ + K × D)_z dX, on which a pressure p does the work p δV: the
force p A e_z on the sections and the moment D × p A e_z, whatever the rod's strain.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar, final

import casadi as ca
import numpy as np

from cosserat_casadi.actuators.routing import routing, span_ends
from cosserat_casadi.loads.load import Effect, Site
from cosserat_casadi.maths.grid import Grid
from cosserat_casadi.maths.typing import FloatArray, Matrix
from cosserat_casadi.rod.wrenches import Action, ActuationStress

PRESSED = (0, 1, 5)
"""Strains on which the pressure does work: bendings and extension."""


@final
class Chamber(Effect):
    """A pressure (Pa) in a channel along the rod."""

    kind = "chamber"
    magnitudes: ClassVar[Mapping[str, str]] = {"pressure": "Pa"}

    def actions(self, load: Any, site: Site, values: Mapping[str, Matrix | None]) -> list[Action]:
        """The stress of the pressure, against the elastic one."""
        pressure = values["pressure"]
        if pressure is None:
            return []
        places = ca.DM.triplet(list(PRESSED), [0, 1, 2], ca.DM.ones(3), 6, 3)
        return [ActuationStress(-pressure * places, volume_rates(load, site.grid))]

    def breaks(self, load: Any) -> tuple[float, ...]:
        """The ends of the channel."""
        return span_ends(load)


def volume_rates(chamber: Any, grid: Grid) -> FloatArray:
    """Rates of the volume per length with K_x, K_y and Γ_z, shape (3, M): m³ and m²; zero outside the span."""
    place = routing(chamber, grid)
    x, y = place.offset
    rates = np.zeros((3, grid.size))
    rates[:, place.nodes] = chamber.area * np.array([y, -x, np.ones_like(x)])
    return rates
