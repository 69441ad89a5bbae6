"""Force and moment on the tip section: F₊ of report (1.29)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar, final

from cosserat_casadi.loads.load import Load, Section
from cosserat_casadi.maths.typing import Matrix


@final
class TipWrench(Load):
    """A force (N) and a moment (N m) at X = 1, dead or follower."""

    kind = "tip_wrench"
    magnitudes: ClassVar[Mapping[str, str]] = {"force": "N", "moment": "N m"}

    def abscissa(self, load: Any) -> float:
        """The tip."""
        return 1.0

    def wrench(self, load: Any, section: Section, values: Mapping[str, Matrix]) -> tuple[Matrix, Matrix]:
        """Force and moment as given."""
        return values["force"], values["moment"]
