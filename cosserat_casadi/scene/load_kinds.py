"""The kinds of loads that ship: importing this module registers them all."""

from __future__ import annotations

from typing import Annotated

from cosserat_casadi.scene.flow import Flow
from cosserat_casadi.scene.foundation import Foundation
from cosserat_casadi.scene.loads import LOADS, BodyWrench, DistributedWrench, Gravity, PointWrench, TipWrench
from cosserat_casadi.scene.magnet import Magnet

# The type checker knows the kinds that ship; a scene may hold any that is registered.
Load = Annotated[
    Gravity | TipWrench | PointWrench | DistributedWrench | BodyWrench | Magnet | Foundation | Flow,
    LOADS,
]
