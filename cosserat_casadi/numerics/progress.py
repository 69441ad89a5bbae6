"""How a long task tells its caller where it is: the share that is done, and the stage in words."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

StageProgress = Callable[[str, int, int], None]
"""Told the stage under way, how much of it is done, and of how much; 0 of 0 where that is not known."""


class Progress(Protocol):
    """A callback that a task calls after every step.

    It takes one number, so that ``progress=shares.append`` is enough to record a solve. Errors that it raises end the
    task and reach the caller.
    """

    def __call__(self, done: float, /) -> None:
        """Take note of the share that is done.

        Args:
            done: 0 at the start of the task, 1 at its end.
        """


class Report(Protocol):
    """A callback that a task of several stages calls at the start of each."""

    def __call__(self, stage: str, /) -> None:
        """Take note of the stage."""


def not_told(*news: object) -> None:
    """Take no note of progress that nobody asked for."""
