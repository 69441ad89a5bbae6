"""How a long task tells its caller where it is: the share that is done, a count, or the stage in words.

Errors that such a function raises end the task and reach the caller.
"""

from __future__ import annotations

from collections.abc import Callable

Progress = Callable[[float], None]
"""Told the share that is done, from 0 at the start to 1 at the end: ``shares.append`` records a solve."""

CountProgress = Callable[[int, int], None]
"""Told how many of how many parts are done; the total may grow."""

Report = Callable[[str], None]
"""Told each stage when it begins."""

StageProgress = Callable[[str, int, int], None]
"""Told the stage under way, how much of it is done, and of how much; 0 of 0 where that is not known."""


def not_told(*news: object) -> None:
    """Take no note of progress that nobody asked for."""
