"""Force and moment on the tip section: F₊ of report (1.29)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar, final

from cosserat_casadi.loads.load import Effect, Site
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.rod.wrenches import Action


@final
class TipWrench(Effect):
    """A force (N) and a moment (N m) at X = 1, dead or follower."""

    kind = "tip_wrench"
    magnitudes: ClassVar[Mapping[str, str]] = {"force": "N", "moment": "N m"}

    def actions(self, load: Any, site: Site, values: Mapping[str, Matrix | None]) -> list[Action]:
        """The wrench on the tip section."""
        return [site.wrench_at(1.0, values, follower=load.frame == "body")]
