"""Cables through the sections of a rod, of given tension or of given length."""

from __future__ import annotations

from collections.abc import Mapping
from typing import final

from cosserat_casadi import scene as scenes
from cosserat_casadi.actuators.actuator import Actuator
from cosserat_casadi.actuators.routing import routing, straight_routing
from cosserat_casadi.maths.grid import Grid
from cosserat_casadi.maths.numbers import Scalar, is_zero
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.rod.actuation import ShapeQuantity
from cosserat_casadi.rod.cable import Routing
from cosserat_casadi.rod.rubbing_cable import RubbingRouting
from cosserat_casadi.rod.straight_cable import HoleRouting


@final
class TendonActuator(Actuator[scenes.Tendon]):
    """A tension (N) along a routing through the sections; a length (m) makes the tension an unknown of the scene."""

    record = scenes.Tendon
    effort = "tension"
    conjugate = "length"
    conjugate_unit = "m"
    energy_sign = 1.0
    drawn_as = "cable"

    def quantity(self, actuator: scenes.Tendon, grid: Grid) -> Routing | HoleRouting:
        """The routing, on whose length the tension does work."""
        if actuator.holes is not None:
            return straight_routing(actuator, grid)
        return routing(actuator, grid)

    def worked_on(self, actuator: scenes.Tendon, grid: Grid, values: Mapping[str, Matrix]) -> ShapeQuantity:
        """The routing, with friction for these inputs."""
        friction = actuator.friction * values["pull"]
        if is_zero(friction) or is_zero(actuator.friction):
            return self.quantity(actuator, grid)
        if actuator.holes is not None:
            return straight_routing(actuator, grid, friction)
        return RubbingRouting(routing(actuator, grid), friction)

    def breaks(self, actuator: scenes.Tendon) -> tuple[Scalar, ...]:
        """The ends of its span, and its holes."""
        return (*super().breaks(actuator), *(actuator.holes or ()))

    def compliance(self, actuator: scenes.Tendon) -> tuple[Scalar, Scalar]:
        """Compliance 1/EA of the cable, 1/N, and 1/k of its winch, m/N."""
        by_length: Scalar = 0.0 if actuator.axial_stiffness is None else 1 / actuator.axial_stiffness
        at_base: Scalar = 0.0 if actuator.winch_stiffness is None else 1 / actuator.winch_stiffness
        return by_length, at_base

    def resting_effort(self, actuator: scenes.Tendon) -> Scalar:
        """The pretension, N."""
        return actuator.pretension

    def prescribes_conjugate(self, actuator: scenes.Tendon) -> bool:
        """Whether the scene gives a length."""
        return actuator.length is not None

    def may_go_slack(self, actuator: scenes.Tendon) -> bool:
        """Whether the scene lets a cable of given length go slack."""
        return bool(actuator.slack)
