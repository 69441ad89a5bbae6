"""Forces and moments, dead or follower: F₊ and f̄, l̄ of report (1.29), (1.14), on sections and on bodies.

The internal force jumps at a section with a force, the strain too. An element of the grid ends there, with polynomials
and nodes on either side, so every field is smooth inside an element and the accuracy stays spectral.
"""

from __future__ import annotations

from typing import final

from cosserat_casadi import scene as scenes
from cosserat_casadi.loads.load import BodyPoint, Load
from cosserat_casadi.maths.numbers import Scalar


@final
class TipWrenchLoad(Load[scenes.TipWrench]):
    """A force (N) and a moment (N m) at X = 1."""

    record = scenes.TipWrench

    def abscissa(self, load: scenes.TipWrench) -> float:
        """The tip."""
        return 1.0


@final
class PointWrenchLoad(Load[scenes.PointWrench]):
    """A force (N) and a moment (N m) at X = at."""

    record = scenes.PointWrench

    def abscissa(self, load: scenes.PointWrench) -> Scalar:
        """The loaded section."""
        at: Scalar = load.at
        return at


@final
class DistributedWrenchLoad(Load[scenes.DistributedWrench]):
    """Legendre coefficients in 2X − 1 of a force (N/m) and a moment (N m/m)."""

    record = scenes.DistributedWrench


@final
class BodyWrenchLoad(Load[scenes.BodyWrench]):
    """A force (N) and a moment (N m) at a point of a body."""

    record = scenes.BodyWrench

    def on_body(self, load: scenes.BodyWrench, body: scenes.Body) -> BodyPoint | None:
        """The point of the body it names."""
        if load.body != body.name:
            return None
        return BodyPoint(load.position)
