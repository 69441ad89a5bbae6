"""Weight: linear density times acceleration, a dead force per length, f̄ of report (1.17); mass times it on bodies."""

from __future__ import annotations

from collections.abc import Mapping
from typing import final

import casadi as ca
import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.loads.load import BodyPoint, Load, Section
from cosserat_casadi.maths.numbers import Numbers, is_symbolic, is_zero
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.rod.properties import RodProperties


@final
class GravityLoad(Load[scenes.Gravity]):
    """A uniform field of acceleration (m/s²) on the rods and bodies it names, or on all."""

    record = scenes.Gravity
    per_mass = True

    def acts_on(self, load: scenes.Gravity, rod: str) -> bool:
        """Whether the load acts on this rod: every rod, unless the load names some rods or bodies."""
        return bool(load.acts_on_rod(rod))

    def on_body(self, load: scenes.Gravity, body: scenes.Body) -> BodyPoint | None:
        """The load on a body: its mass as factor, at its centre of mass."""
        if is_zero(body.mass) or not load.acts_on_body(body.name):
            return None
        return BodyPoint(body.centre_of_mass, body.mass)

    def wrench(self, load: scenes.Gravity, section: Section, values: Mapping[str, Matrix]) -> tuple[Matrix, Matrix]:
        """The acceleration, a force per mass."""
        # The profile of a rod and the factor of a body multiply it by the mass.
        return values["acceleration"], ca.DM(3, 1)

    def profiles(self, load: scenes.Gravity, rod: RodProperties, X: Numbers, columns: int) -> Numbers:
        """Mass per length, kg/m."""
        # A rod without mass has no weight, and costs nothing.
        if rod.linear_density is None:
            return np.zeros((1, X.shape[0]))
        density = rod.linear_density(X)
        return density.T if is_symbolic(density) else np.asarray(density[None, :])
