"""Cables through the sections of a rod, of given tension or of given length."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar, final

from cosserat_casadi.actuators.actuator import Actuator
from cosserat_casadi.actuators.routing import routing
from cosserat_casadi.maths.grid import Grid
from cosserat_casadi.rod.cable import Routing


@final
class Tendon(Actuator):
    """A tension (N) along a routing through the sections; a length (m) makes the tension an unknown of the scene."""

    kind = "tendon"
    magnitudes: ClassVar[Mapping[str, str]] = {"tension": "N", "length": "m"}
    effort = "tension"
    conjugate = "length"
    units: ClassVar[Mapping[str, str]] = {"tension": "N", "length": "m"}
    energy_sign = 1.0
    least_effort = 0.0
    drawn_as = "cable"

    def quantity(self, actuator: Any, grid: Grid) -> Routing:
        """The routing, whose length the tension works on."""
        return routing(actuator, grid)

    def prescribes_conjugate(self, actuator: Any) -> bool:
        """Where the scene gives a length."""
        return actuator.length is not None

    def may_go_slack(self, actuator: Any) -> bool:
        """Where the scene lets a cable of given length sag."""
        return bool(actuator.slack)
