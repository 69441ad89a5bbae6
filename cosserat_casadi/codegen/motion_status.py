"""Statuses of the functions in C that compute motions, in the order of their numbers."""

from __future__ import annotations

from enum import Enum


class MotionStatus(Enum):
    """Every way a step in C can end; the value is the sentence that a user reads. New members come last."""

    DONE = "Done: the equations of motion are solved to the tolerance."
    NOT_SOLVED = "The equations of the step were not solved, in parts neither: take shorter steps, or move less in one."
    NOT_FINITE = "A number that was given, or one that the equations gave, is not finite."
    SINGULAR = "The equations of the step are singular; constraints may contradict or repeat each other."
    BAD_STEP = "The length of the step is no positive number of seconds."
    INCONSISTENT = "Supports, joints or cables are not closed: start from an equilibrium."

    @property
    def label(self) -> str:
        """A word for a program."""
        return self.name.lower()


STATUSES = tuple(MotionStatus)
"""In the order of their numbers in C."""
