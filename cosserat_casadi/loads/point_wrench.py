"""Force and moment on any section.

The internal force jumps at the section, the strain too. An element of the grid ends there, with polynomials and nodes
on either side, so every field is smooth inside an element and the accuracy stays spectral.
"""

from __future__ import annotations

from typing import final

from cosserat_casadi import scene as scenes
from cosserat_casadi.loads.load import Load


@final
class PointWrenchLoad(Load[scenes.PointWrench]):
    """A force (N) and a moment (N m) at X = at, dead or follower."""

    record = scenes.PointWrench
