"""Weight: linear density times acceleration, a dead force per length, f̄ of report (1.17); on bodies mass times it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar, final

from cosserat_casadi.loads.load import BodyAction, Effect, Site
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.rod.wrenches import Action, LineWrench


@final
class Gravity(Effect):
    """A uniform field of acceleration (m/s²) on the rods it names, or on all."""

    kind = "gravity"
    magnitudes: ClassVar[Mapping[str, str]] = {"acceleration": "m/s²"}

    def actions(self, load: Any, site: Site, values: Mapping[str, Matrix | None]) -> list[Action]:
        """The rod's weight per length, N/m."""
        acceleration = site.placed(values["acceleration"], follower=False)
        if acceleration is None or site.rod.linear_density is None:
            return []
        profile = site.rod.linear_density(site.grid.nodes)[None, :]
        return [LineWrench(acceleration, None, profile, follower=False)]

    def acts_on(self, load: Any, rod: str) -> bool:
        """Every rod, unless the load names some rods or bodies."""
        return bool(load.acts_on_rod(rod))

    def on_body(self, load: Any, body: Any, values: Mapping[str, Matrix | None]) -> BodyAction | None:
        """The body's weight, at its centre of mass."""
        acceleration = values["acceleration"]
        if acceleration is None or body.mass == 0.0 or not load.acts_on_body(body.name):
            return None
        return BodyAction(body.centre_of_mass, body.mass * acceleration, None, follower=False)
