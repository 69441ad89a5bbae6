"""Kinds that tests register are forgotten when they are done."""

from __future__ import annotations

from typing import Any

from cosserat_casadi.actuators.actuator import Actuator
from cosserat_casadi.loads.load import Load
from cosserat_casadi.model.registry import EFFECTS
from cosserat_casadi.scene.actuators import ACTUATORS
from cosserat_casadi.scene.loads import LOADS


def forget(member: type[Load[Any]] | type[Actuator[Any]]) -> None:
    """Undo the registration of a kind."""
    EFFECTS.pop(member.kind, None)
    for family in (LOADS, ACTUATORS):
        family.records.pop(member.kind, None)
