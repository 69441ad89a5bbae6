"""Cables through the sections of a rod, of given tension or of given length."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar, final

from cosserat_casadi.actuators.routing import routing, span_ends
from cosserat_casadi.loads.load import Effect, Site
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.rod.wrenches import Action, Cable


@final
class Tendon(Effect):
    """A tension (N) along a routing through the sections; a length (m) makes the tension an unknown of the scene."""

    kind = "tendon"
    magnitudes: ClassVar[Mapping[str, str]] = {"tension": "N", "length": "m"}

    def actions(self, load: Any, site: Site, values: Mapping[str, Matrix | None]) -> list[Action]:
        """The cable, where its tension is known."""
        tension = values["tension"]
        return [] if load.length is not None or tension is None else [Cable(routing(load, site.grid), tension)]

    def breaks(self, load: Any) -> tuple[float, ...]:
        """Where the cable enters the rod and where it is anchored."""
        return span_ends(load)
