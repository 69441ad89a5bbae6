"""Forces and moments on the tip of a rod, on any section, per length, and on a rigid body: dead, or turning with these.

The internal force jumps at a loaded section, the strain too. An element of the grid ends there, with polynomials and
nodes on either side, so every field is smooth inside an element and the accuracy stays spectral.
"""

from __future__ import annotations

from typing import final

from cosserat_casadi import scene as scenes
from cosserat_casadi.loads.load import Load


@final
class TipWrenchLoad(Load[scenes.TipWrench]):
    """A force (N) and a moment (N m) at X = 1: F₊ of report (1.29)."""

    record = scenes.TipWrench

    def abscissa(self, load: scenes.TipWrench) -> float:
        """The tip."""
        return 1.0


@final
class PointWrenchLoad(Load[scenes.PointWrench]):
    """A force (N) and a moment (N m) at X = at."""

    record = scenes.PointWrench


@final
class DistributedWrenchLoad(Load[scenes.DistributedWrench]):
    """Legendre coefficients in 2X − 1 of a force (N/m) and a moment (N m/m): f̄ and l̄ of report (1.14)."""

    record = scenes.DistributedWrench


@final
class BodyWrenchLoad(Load[scenes.BodyWrench]):
    """A force (N) and a moment (N m) on a body, at a point of it."""

    record = scenes.BodyWrench
