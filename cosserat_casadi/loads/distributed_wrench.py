"""Force and moment per length, constant or polynomial along the rod: f̄ and l̄ of report (1.14)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar, final

from cosserat_casadi.loads.load import Effect, Site
from cosserat_casadi.maths.chebyshev import legendre_polynomials
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.rod.wrenches import Action, LineWrench


@final
class DistributedWrench(Effect):
    """Legendre coefficients in 2X − 1 of a force (N/m) and a moment (N m/m), dead or follower."""

    kind = "distributed_wrench"
    magnitudes: ClassVar[Mapping[str, str]] = {"force": "N/m", "moment": "N m/m"}

    def actions(self, load: Any, site: Site, values: Mapping[str, Matrix | None]) -> list[Action]:
        """One line wrench for each of force and moment: their polynomials may differ in degree."""
        follower = load.frame == "body"
        force = site.placed(values["force"], follower=follower)
        moment = site.placed(values["moment"], follower=follower)
        found: list[Action] = []
        for is_force, vector in ((True, force), (False, moment)):
            if vector is None:
                continue
            profiles = legendre_polynomials(vector.shape[1], site.grid.nodes).T
            found.append(LineWrench(vector if is_force else None, None if is_force else vector, profiles, follower))
        return found
