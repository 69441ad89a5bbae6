"""Force and moment per length, constant or polynomial along the rod: f̄ and l̄ of report (1.14)."""

from __future__ import annotations

from typing import final

from cosserat_casadi import scene as scenes
from cosserat_casadi.loads.load import Load


@final
class DistributedWrenchLoad(Load[scenes.DistributedWrench]):
    """Legendre coefficients in 2X − 1 of a force (N/m) and a moment (N m/m), dead or follower."""

    record = scenes.DistributedWrench
