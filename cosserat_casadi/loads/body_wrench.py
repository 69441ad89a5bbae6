"""Force and moment at a point of a rigid body, dead or turning with the body."""

from __future__ import annotations

from typing import final

from cosserat_casadi import scene as scenes
from cosserat_casadi.loads.load import Load


@final
class BodyWrenchLoad(Load[scenes.BodyWrench]):
    """A force (N) and a moment (N m) on a body."""

    record = scenes.BodyWrench
