"""Forces and moments on sections, along rods and on bodies, each dead or turning with the rod or body.

The internal force jumps at a section with a force, and the strain too. An element of the grid ends there, with
polynomials and nodes on either side, so every field is smooth inside an element and the accuracy stays spectral.
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
    """A force (N/m) and a moment (N m/m), constant or Legendre series in 2X − 1: f̄ and l̄ of report (1.14)."""

    record = scenes.DistributedWrench


@final
class BodyWrenchLoad(Load[scenes.BodyWrench]):
    """A force (N) and a moment (N m) at a point of a rigid body."""

    record = scenes.BodyWrench
