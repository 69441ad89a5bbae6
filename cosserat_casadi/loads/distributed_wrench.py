"""Force and moment per length, constant or polynomial along the rod: f̄ and l̄ of report (1.14)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import final

from cosserat_casadi import scene as scenes
from cosserat_casadi.loads.load import Load, Section
from cosserat_casadi.maths.typing import Matrix


@final
class DistributedWrenchLoad(Load[scenes.DistributedWrench]):
    """Legendre coefficients in 2X − 1 of a force (N/m) and a moment (N m/m), dead or follower."""

    record = scenes.DistributedWrench

    def wrench(
        self, load: scenes.DistributedWrench, section: Section, values: Mapping[str, Matrix]
    ) -> tuple[Matrix, Matrix]:
        """The coefficients of the scene, unchanged, one column a degree."""
        return values["force"], values["moment"]
