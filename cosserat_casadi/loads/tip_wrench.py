"""Force and moment on the tip section: F₊ of report (1.29)."""

from __future__ import annotations

from typing import final

from cosserat_casadi import scene as scenes
from cosserat_casadi.loads.load import Load


@final
class TipWrenchLoad(Load[scenes.TipWrench]):
    """A force (N) and a moment (N m) at X = 1, dead or follower."""

    record = scenes.TipWrench

    def abscissa(self, load: scenes.TipWrench) -> float:
        """The tip."""
        return 1.0
