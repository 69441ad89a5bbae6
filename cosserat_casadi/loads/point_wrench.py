"""Force and moment on any section.

The internal force jumps at the section, the strain too. An element of the grid ends there, with polynomials and nodes
of its own on either side, so every field is smooth inside an element and the accuracy stays spectral.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar, final

from cosserat_casadi.loads.load import Load, Section
from cosserat_casadi.maths.typing import Matrix


@final
class PointForceAndMoment(Load):
    """A force (N) and a moment (N m) at X = at, dead or follower."""

    kind = "point_wrench"
    magnitudes: ClassVar[Mapping[str, str]] = {"force": "N", "moment": "N m"}

    def abscissa(self, load: Any) -> float:
        """The loaded section."""
        return float(load.at)

    def wrench(self, load: Any, section: Section, values: Mapping[str, Matrix]) -> tuple[Matrix, Matrix]:
        """Force and moment as given."""
        return values["force"], values["moment"]
