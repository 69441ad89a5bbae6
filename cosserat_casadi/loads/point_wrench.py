"""Force and moment on any section.

The internal force jumps at the section, the strain too. An element of the grid ends there, with polynomials and nodes
of its own on either side, so every field is smooth inside an element and the accuracy stays spectral.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar, final

from cosserat_casadi.loads.load import Effect, Site
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.rod.wrenches import Action


@final
class PointForceAndMoment(Effect):
    """A force (N) and a moment (N m) at X = at, dead or follower."""

    kind = "point_wrench"
    magnitudes: ClassVar[Mapping[str, str]] = {"force": "N", "moment": "N m"}

    def actions(self, load: Any, site: Site, values: Mapping[str, Matrix | None]) -> list[Action]:
        """The wrench on the section."""
        return [site.wrench_at(load.at, values, follower=load.frame == "body")]

    def breaks(self, load: Any) -> tuple[float, ...]:
        """The loaded section."""
        return (load.at,)
