"""Force and moment on any section.

The internal force jumps at the section, the strain too. An element of the grid ends there, with polynomials and nodes
of its own on either side, so every field is smooth inside an element and the accuracy stays spectral.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, final

from cosserat_casadi.effects.effect import Effect, Site
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.rod.wrenches import Action, PointWrench


@final
class PointForceAndMoment(Effect):
    """A force (N) and a moment (N m) at X = at, dead or follower."""

    kind = "point_wrench"
    magnitudes = ("force", "moment")

    def actions(self, load: Any, site: Site, values: Mapping[str, Matrix | None]) -> list[Action]:
        """The wrench on the section."""
        follower = load.frame == "body"
        force = site.placed(values["force"], follower=follower)
        moment = site.placed(values["moment"], follower=follower)
        return [PointWrench(load.at, force, moment, follower)]

    def breaks(self, load: Any) -> tuple[float, ...]:
        """The loaded section."""
        return (load.at,)
