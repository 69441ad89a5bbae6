"""Loads and actuators that this version knows. A new one is a file in loads/ or actuators/ and a line below."""

from __future__ import annotations

from typing import Any

from cosserat_casadi.actuators.actuator import Actuator
from cosserat_casadi.actuators.chamber import Chamber
from cosserat_casadi.actuators.tendon import Tendon
from cosserat_casadi.loads.body_wrench import BodyWrench
from cosserat_casadi.loads.distributed_wrench import DistributedWrench
from cosserat_casadi.loads.gravity import Gravity
from cosserat_casadi.loads.load import Load
from cosserat_casadi.loads.point_wrench import PointForceAndMoment
from cosserat_casadi.loads.tip_wrench import TipWrench

EFFECTS: dict[str, Any] = {}
"""Loads and actuators by the word of the scene format."""


def register(member: type[Load | Actuator]) -> type[Load | Actuator]:
    """Make a kind of load or actuator known; also to be written above a class as a decorator.

    Raises:
        ValueError: another class has the same word.
    """
    known = EFFECTS.get(member.kind)
    if known is not None and type(known) is not member:
        raise ValueError(f"{member.kind!r} is the word of {type(known).__name__} already")
    EFFECTS[member.kind] = member()
    return member


for shipped in (Gravity, TipWrench, PointForceAndMoment, DistributedWrench, BodyWrench, Tendon, Chamber):
    register(shipped)
