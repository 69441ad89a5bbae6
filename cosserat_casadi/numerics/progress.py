"""Callbacks by which a long task reports its progress: a share, a count, or the stage in words.

An error in a callback ends the task and reaches the caller.
"""

from __future__ import annotations

from collections.abc import Callable

Progress = Callable[[float], None]
"""Callback with the share that is done, from 0 at the start to 1 at the end; ``shares.append`` records a solve."""

CountProgress = Callable[[int, int], None]
"""Callback with the number of finished parts and of all parts; the total may grow."""

Report = Callable[[str], None]
"""Callback with the name of each stage at its start."""

StageProgress = Callable[[str, int, int], None]
"""Callback with the present stage, the amount that is done, and the total; 0 of 0 if unknown."""


def not_told(*news: object) -> None:
    """Ignore progress: the callback by default."""
