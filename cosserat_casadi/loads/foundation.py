"""Springs per length, energy ½ Σ k_i d_i² with d the displacement of the section.

M. Hetényi, *Beams on Elastic Foundation*, University of Michigan Press 1946, for springs along three axes.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import final

import casadi as ca

from cosserat_casadi import scene as scenes
from cosserat_casadi.loads.load import Load, Section, Site, coefficients, legendre_series
from cosserat_casadi.maths.numbers import Numbers, rows_of, stacked_rows
from cosserat_casadi.maths.typing import Matrix


@final
class FoundationLoad(Load[scenes.Foundation]):
    """Stiffnesses (N/m²) along the axes of the world, or of the sections of the unloaded rod."""

    record = scenes.Foundation
    uniform = True

    def energy(self, load: scenes.Foundation, section: Section, values: Mapping[str, Matrix]) -> Matrix:
        """½ Σ k_i d_i², J/m."""
        displacement = section.position - section.data[:3]
        if load.frame == "body":
            unloaded = ca.reshape(section.data[3:], 3, 3)
            displacement = unloaded.T @ displacement
        return ca.dot(values["stiffness"], displacement**2) / 2

    def data(self, load: scenes.Foundation, site: Site) -> Numbers:
        """Unloaded positions, m, to which the springs are tied; for section axes also the rotations, by column."""
        if load.curve is None:
            tied_to: Numbers = site.unloaded_position
        else:
            tied_to = legendre_series(coefficients(load.curve), site.X)
        if load.frame == "world":
            return tied_to
        return stacked_rows([*rows_of(tied_to), *rows_of(site.unloaded_rotation)])
