"""The kinds of loads that ship: importing this module registers them all."""

from __future__ import annotations

from typing import Annotated

from cosserat_casadi.scene.flow_record import Flow
from cosserat_casadi.scene.foundation_record import Foundation
from cosserat_casadi.scene.load_records import LOADS, BodyWrench, DistributedWrench, Gravity, PointWrench, TipWrench
from cosserat_casadi.scene.magnet_record import Magnet

# The type checker knows the kinds that ship; a scene may hold any that is registered.
Load = Annotated[
    Gravity | TipWrench | PointWrench | DistributedWrench | BodyWrench | Magnet | Foundation | Flow,
    LOADS,
]
