"""States along a robot of concentric tubes, from its tip to the base plate."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from cosserat_casadi.maths.pose import Pose
from cosserat_casadi.maths.typing import Matrix


class AnyState(Protocol):
    """Common part of all states along a robot: angles and torques of the tubes, pose of the frame, energy."""

    @property
    def angles(self) -> Matrix:
        """Of the tubes against the frame, n×1, rad."""

    @property
    def torques(self) -> Matrix:
        """In the tubes, n×1, N m."""

    @property
    def pose(self) -> Pose:
        """Of the frame."""

    @property
    def energy(self) -> Matrix:
        """From the tip on, 1×1, J."""


@dataclass(frozen=True)
class March:
    """A robot, integrated from its tip to the base plate.

    Attributes:
        ends: stacked states at the ends of the pieces.
        stations: stacked states at all ends of steps from the tip to the plate, a column each.
        starts: stacked states that the steps begin with, beyond the loads that act there, a column each.
        sections: stacked sections of the steps, with the loads, a column each.
    """

    ends: list[Matrix]
    stations: Matrix
    starts: Matrix
    sections: Matrix
