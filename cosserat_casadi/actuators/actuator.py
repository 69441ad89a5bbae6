"""What an actuator is: an effort, and the quantity of the strains that the effort works on.

A member is one file and one line of the registry. It names its effort and the conjugate quantity with their units, and
gives that quantity on the grid of a rod; residual, Jacobian, energy and outputs follow from it.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import Any, ClassVar, Literal

from cosserat_casadi.actuators.routing import span_ends
from cosserat_casadi.maths.grid import Grid
from cosserat_casadi.rod.actuation import Quantity


class Actuator(ABC):
    """One kind of actuator. The methods take ``actuator``, the frozen record of the scene.

    Attributes:
        kind: the word of the scene format.
        magnitudes: fields that may stay free at run time, the model's inputs, each with its unit.
        effort: name of the effort, a field of the record.
        conjugate: name of the quantity that the effort works on.
        units: of both, by name.
        energy_sign: 1 where the energy is effort times quantity, as of a tension; −1 where the effort does that much
            work on the rod, as a pressure does.
        least_effort: what the effort cannot fall below; None where it may have either sign.
        drawn_as: a thin line with a knob at its end, or a broad translucent one.
    """

    kind: ClassVar[str]
    magnitudes: ClassVar[Mapping[str, str]]
    effort: ClassVar[str]
    conjugate: ClassVar[str]
    units: ClassVar[Mapping[str, str]]
    energy_sign: ClassVar[float]
    least_effort: ClassVar[float | None] = None
    drawn_as: ClassVar[Literal["cable", "channel"]] = "channel"

    @abstractmethod
    def quantity(self, actuator: Any, grid: Grid) -> Quantity:
        """The conjugate quantity on the grid of the rod."""

    def acts_on(self, actuator: Any, rod: str) -> bool:
        """Whether the actuator acts on the rod of this name."""
        return bool(actuator.rod == rod)

    def breaks(self, actuator: Any) -> tuple[float, ...]:
        """Abscissae at which the stress jumps: where the actuator enters the rod and where it ends."""
        return span_ends(actuator)

    def prescribes_conjugate(self, actuator: Any) -> bool:
        """Whether the scene gives the quantity, so that the effort is an unknown."""
        return False

    def may_go_slack(self, actuator: Any) -> bool:
        """Whether an unknown effort vanishes where the quantity is below what is prescribed."""
        return False
