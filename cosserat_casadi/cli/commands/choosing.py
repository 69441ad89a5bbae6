"""The choice of a discretisation with a progress bar."""

from __future__ import annotations

from cosserat_casadi.accuracy.choose import SAMPLES, Choice, choose
from cosserat_casadi.accuracy.ranges import Given
from cosserat_casadi.cli.progress import count_display
from cosserat_casadi.scene import Scene


def choose_with_progress(scene: Scene, ranges: Given | None = None, samples: int = SAMPLES) -> Choice:
    """One discretisation for ranges of inputs; see :func:`cosserat_casadi.accuracy.choose.choose`."""
    with count_display("Choosing modes and nodes") as show_count:
        return choose(scene, ranges, progress=show_count, samples=samples)
