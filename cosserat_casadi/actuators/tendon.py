"""Cables through the sections of a rod, of given tension or of given length."""

from __future__ import annotations

from typing import final

from cosserat_casadi import scene as scenes
from cosserat_casadi.actuators.actuator import Actuator
from cosserat_casadi.actuators.routing import routing
from cosserat_casadi.maths.grid import Grid
from cosserat_casadi.rod.cable import Routing


@final
class TendonActuator(Actuator[scenes.Tendon]):
    """A tension (N) along a routing through the sections; a length (m) makes the tension an unknown of the scene."""

    record = scenes.Tendon
    effort = "tension"
    conjugate = "length"
    conjugate_unit = "m"
    energy_sign = 1.0
    drawn_as = "cable"

    def quantity(self, actuator: scenes.Tendon, grid: Grid) -> Routing:
        """The routing, whose length the tension works on."""
        return routing(actuator, grid)

    def prescribes_conjugate(self, actuator: scenes.Tendon) -> bool:
        """Where the scene gives a length."""
        return actuator.length is not None

    def may_go_slack(self, actuator: scenes.Tendon) -> bool:
        """Where the scene lets a cable of given length sag."""
        return bool(actuator.slack)
