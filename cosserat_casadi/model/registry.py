"""Registry of loads and actuators. A new kind takes a file in loads/ or actuators/ and a line below."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from cosserat_casadi.actuators.chamber import ChamberActuator
from cosserat_casadi.actuators.muscle import MuscleActuator
from cosserat_casadi.actuators.tendon import TendonActuator
from cosserat_casadi.loads.body_wrench import BodyWrenchLoad
from cosserat_casadi.loads.contact_friction import ContactFrictionLoad
from cosserat_casadi.loads.contact_layer import ContactLayerLoad
from cosserat_casadi.loads.contact_line import ContactLineLoad
from cosserat_casadi.loads.contact_point import ContactPointLoad
from cosserat_casadi.loads.distributed_wrench import DistributedWrenchLoad
from cosserat_casadi.loads.flow import FlowLoad
from cosserat_casadi.loads.foundation import FoundationLoad
from cosserat_casadi.loads.gravity import GravityLoad
from cosserat_casadi.loads.load import EFFECTS
from cosserat_casadi.loads.magnet import MagnetLoad
from cosserat_casadi.loads.penetration import PenetrationLoad
from cosserat_casadi.loads.point_wrench import PointWrenchLoad
from cosserat_casadi.loads.rods_point import RodsPointLoad
from cosserat_casadi.loads.tip_wrench import TipWrenchLoad
from cosserat_casadi.scene.families import register
from cosserat_casadi.scene.load_records import LoadRecord

__all__ = ["EFFECTS", "register", "remembering"]

for shipped in (
    GravityLoad,
    TipWrenchLoad,
    PointWrenchLoad,
    DistributedWrenchLoad,
    BodyWrenchLoad,
    MagnetLoad,
    FoundationLoad,
    FlowLoad,
    TendonActuator,
    ChamberActuator,
    MuscleActuator,
):
    register(shipped)

for found in (
    ContactPointLoad,
    ContactLineLoad,
    ContactFrictionLoad,
    RodsPointLoad,
    PenetrationLoad,
    ContactLayerLoad,
):
    # The push of obstacles, and of rods: no scene file names it as a load, so that the scene format does not have it.
    EFFECTS[found.kind] = found()


def remembering(loads: Iterable[LoadRecord]) -> list[Any]:
    """Loads with a memory of the sections of their ``rod``: loads of an ``obstacle`` with friction."""
    return [load for load in loads if EFFECTS[load.kind].remembers(load)]
