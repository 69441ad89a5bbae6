"""Force and moment on a rigid body, at a point of it, dead or turning with the body."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar, final

import numpy as np

from cosserat_casadi.loads.load import BodyAction, Effect, Site
from cosserat_casadi.maths.typing import FloatArray, Matrix
from cosserat_casadi.rod.wrenches import Action


@final
class BodyWrench(Effect):
    """A force (N) and a moment (N m) on a body."""

    kind = "body_wrench"
    magnitudes: ClassVar[Mapping[str, str]] = {"force": "N", "moment": "N m"}

    def actions(self, load: Any, site: Site, values: Mapping[str, Matrix | None]) -> list[Action]:
        """Nothing: it acts on no rod."""
        return []

    def acts_on(self, load: Any, rod: str) -> bool:
        """No rod."""
        return False

    def on_body(self, load: Any, body: Any, values: Mapping[str, Matrix | None]) -> BodyAction | None:
        """The wrench, on the body it names."""
        if load.body != body.name:
            return None
        return BodyAction(load.position, values["force"], values["moment"], load.frame == "body")

    def has_potential_on_bodies(self, load: Any, values: Mapping[str, FloatArray], *, flat: bool) -> bool:
        """A force of fixed direction has; a moment of fixed direction where bodies turn about one axis."""
        dead = load.frame == "world"
        return (dead or not np.any(values["force"])) and ((dead and flat) or not np.any(values["moment"]))
