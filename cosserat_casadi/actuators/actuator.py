"""Base class of actuators: an effort, and the quantity of the strains on which the effort does work.

A member is one file and one line of the registry. It names its effort and the conjugate quantity with their units, and
gives that quantity on the grid of a rod; residual, Jacobian, energy and outputs follow from it.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import ClassVar, Generic, Literal, TypeVar

from cosserat_casadi.actuators.routing import span_ends
from cosserat_casadi.loads.load import EFFECTS
from cosserat_casadi.maths.grid import Grid
from cosserat_casadi.maths.numbers import Scalar
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.rod.actuation import ShapeQuantity
from cosserat_casadi.scene.actuator_records import ACTUATORS, ActuatorRecord
from cosserat_casadi.scene.families import Kind

RecordType = TypeVar("RecordType", bound=ActuatorRecord)


class Actuator(Kind, ABC, Generic[RecordType]):
    """One kind of actuator. The methods take ``actuator``, the frozen record of the scene.

    Attributes:
        record: the record of the scene, with the unit and the least value of the effort.
        kind: the word of the scene format.
        effort: name of the effort, an input of the record.
        conjugate: name of the quantity on which the effort does work.
        conjugate_unit: SI unit of that quantity.
        energy_sign: 1 if the energy is effort times quantity, as for a tension; −1 if this is the work on the rod, as
            for a pressure.
        drawn_as: style in figures: a thin line with a knob at its end, or a broad translucent line.
    """

    record: ClassVar[type[ActuatorRecord]]
    family = ACTUATORS
    kinds = EFFECTS
    effort: ClassVar[str]
    conjugate: ClassVar[str]
    conjugate_unit: ClassVar[str]
    energy_sign: ClassVar[float]
    drawn_as: ClassVar[Literal["cable", "channel"]] = "channel"

    @property
    def effort_unit(self) -> str:
        """SI unit of the effort."""
        return self.record.inputs[self.effort].unit

    @abstractmethod
    def quantity(self, actuator: RecordType, grid: Grid) -> ShapeQuantity:
        """The conjugate quantity on the grid of the rod."""

    def worked_on(self, actuator: RecordType, grid: Grid, values: Mapping[str, Matrix]) -> ShapeQuantity:
        """The conjugate quantity for these inputs, 1×1 each; by default it does not depend on them."""
        return self.quantity(actuator, grid)

    def margin(self, actuator: RecordType, values: Mapping[str, Matrix]) -> Matrix | None:
        """Margin of inputs, 1×1 each, to the end of the actuator's law; not positive beyond it.

        None for an actuator whose law has no end.
        """
        return None

    def compliance(self, actuator: RecordType) -> tuple[Scalar, Scalar]:
        """Extension of the prescribed quantity by a unit of effort: 1/EA per metre, and 1/k; zeros if rigid."""
        return 0.0, 0.0

    def resting_effort(self, actuator: RecordType) -> Scalar:
        """Effort at which an elastic actuator has its prescribed conjugate."""
        return 0.0

    def acts_on(self, actuator: RecordType, rod: str) -> bool:
        """Whether the actuator acts on the rod of this name."""
        return bool(actuator.rod == rod)

    def breaks(self, actuator: RecordType) -> tuple[Scalar, ...]:
        """Abscissae at which the stress jumps: entry and end of the actuator."""
        return span_ends(actuator)

    def prescribes_conjugate(self, actuator: RecordType) -> bool:
        """Whether the scene prescribes the conjugate, so that the effort is an unknown."""
        return False

    def may_go_slack(self, actuator: RecordType) -> bool:
        """Whether an unknown effort is zero if the conjugate is below its prescribed value."""
        return False
