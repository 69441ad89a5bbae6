"""Force and moment on any section.

The internal force jumps at the section, the strain too. An element of the grid ends there, with polynomials and nodes
on either side, so every field is smooth inside an element and the accuracy stays spectral.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import final

from cosserat_casadi import scene as scenes
from cosserat_casadi.loads.load import Load, Section
from cosserat_casadi.maths.numbers import Scalar
from cosserat_casadi.maths.typing import Matrix


@final
class PointWrenchLoad(Load[scenes.PointWrench]):
    """A force (N) and a moment (N m) at X = at, dead or follower."""

    record = scenes.PointWrench

    def abscissa(self, load: scenes.PointWrench) -> Scalar:
        """The loaded section."""
        at: Scalar = load.at
        return at

    def wrench(self, load: scenes.PointWrench, section: Section, values: Mapping[str, Matrix]) -> tuple[Matrix, Matrix]:
        """Force and moment of the scene, unchanged."""
        return values["force"], values["moment"]
