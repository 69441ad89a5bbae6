"""Statuses of the functions in C that solve concentric tubes, in the order of their numbers."""

from __future__ import annotations

from enum import Enum


class TubeStatus(Enum):
    """Every way a call in C can end; the value is the sentence that a user reads. New members come last."""

    CONVERGED = "Equilibrium found: the tubes meet the rotations of their drives."
    MAX_ITERATIONS = "No equilibrium found: the iterations ran out before the tubes met the rotations of their drives."
    NOT_FINITE = "No equilibrium found: a number that was given, or one that the equations gave, is not finite."
    SINGULAR = "The robot is about to snap: the Jacobian is singular."
    LOAD_STALLED = (
        "No equilibrium found: the way from straight tubes without loads, or from the solution started at, could not "
        "be followed further; the robot may snap there."
    )
    UNRESOLVED = (
        "An equilibrium of the discrete model was found, but the tubes are not resolved by its steps: export them with "
        "a smaller tolerance."
    )
    NOT_IN_EQUILIBRIUM = "The unknowns are no equilibrium for these inputs: solve first."
    LOST_TRACK = (
        "The solution of the last turn could not be followed to these inputs within the bounds of one turn: the robot "
        "may snap on the way; move the inputs less in a turn, or solve anew."
    )
    OUT_OF_RANGE = (
        "A translation is below zero or above the length of its tube, or no tube stands out of the plate: nothing was "
        "computed."
    )

    @property
    def label(self) -> str:
        """A word for a program."""
        return self.name.lower()


STATUSES = tuple(TubeStatus)
"""In the order of their numbers in C."""
