"""Force and moment per length, constant or polynomial along the rod: f̄ and l̄ of report (1.14)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar, final

from cosserat_casadi.loads.load import Load, Section
from cosserat_casadi.maths.typing import Matrix


@final
class DistributedWrench(Load):
    """Legendre coefficients in 2X − 1 of a force (N/m) and a moment (N m/m), dead or follower."""

    kind = "distributed_wrench"
    magnitudes: ClassVar[Mapping[str, str]] = {"force": "N/m", "moment": "N m/m"}

    def wrench(self, load: Any, section: Section, values: Mapping[str, Matrix]) -> tuple[Matrix, Matrix]:
        """The coefficients as given, one column a degree."""
        return values["force"], values["moment"]
