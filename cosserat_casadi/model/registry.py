"""The one open family: every effect this version knows. A new one is a file beside this and a line below."""

from __future__ import annotations

from cosserat_casadi.actuators.chamber import Chamber
from cosserat_casadi.actuators.tendon import Tendon
from cosserat_casadi.loads.body_wrench import BodyWrench
from cosserat_casadi.loads.distributed_wrench import DistributedWrench
from cosserat_casadi.loads.gravity import Gravity
from cosserat_casadi.loads.load import Effect
from cosserat_casadi.loads.point_wrench import PointForceAndMoment
from cosserat_casadi.loads.tip_wrench import TipWrench

EFFECTS: dict[str, Effect] = {
    effect.kind: effect
    for effect in (
        Gravity(),
        TipWrench(),
        PointForceAndMoment(),
        DistributedWrench(),
        BodyWrench(),
        Tendon(),
        Chamber(),
    )
}
"""Loads and actuators by the word of the scene format."""
