"""The verified ranges and errors of a discretisation, for exported folders."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from cosserat_casadi.equilibrium.answer_error import UNKNOWN
from cosserat_casadi.equilibrium.locking import locking_sentence


@dataclass(frozen=True)
class Verified:
    """Ranges over which the error of a discretisation was estimated, and the estimates.

    Attributes:
        ranges: ``column=low:high`` of inputs and parameters; others have the scene's value.
        solves: number of solved points of the ranges.
        error_estimate: largest error estimate of these points; None if no point has an equilibrium.
        without_equilibrium: number of points without an equilibrium.
        within: whether the error is within the tolerance at all points with an equilibrium; None without a tolerance.
        locked: names of the inputs that move nothing on this discretisation, but would on more modes.
    """

    ranges: tuple[str, ...]
    solves: int
    error_estimate: float | None
    without_equilibrium: int
    within: bool | None
    locked: tuple[str, ...] = ()

    @property
    def sentence(self) -> str:
        """Ranges, solves and errors in words, for a header or a README."""
        where = ", ".join(self.ranges) or "the scene's own inputs"
        text = f"The discretisation was verified by {self.solves} solves over {where}:"
        if self.error_estimate is not None:
            known = self.error_estimate != UNKNOWN
            text += f" largest estimated error {self.error_estimate:.1e}." if known else " their error is not known."
        if self.within is False:
            text += " The discretisation does not keep the tolerance there."
        if self.locked:
            text += f" {locking_sentence(self.locked)}"
        if self.without_equilibrium:
            text += f" No equilibrium was found at {self.without_equilibrium} of these points."
        return f"{text} For inputs beyond these ranges choose the discretisation anew."

    def plain(self) -> dict[str, Any]:
        """Ranges, solves and errors as plain data, for a manifest."""
        error = self.error_estimate
        return {
            "ranges": list(self.ranges),
            "solves": self.solves,
            "error_estimate": None if error is None else float(f"{error:.2g}"),
            "without_equilibrium": self.without_equilibrium,
            "within_tolerance": self.within,
            "locked": list(self.locked),
        }
