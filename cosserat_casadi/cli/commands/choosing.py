"""The choice of a discretisation with a progress bar."""

from __future__ import annotations

from cosserat_casadi.accuracy.choose import SAMPLES, Choice, choose
from cosserat_casadi.accuracy.ranges import Given
from cosserat_casadi.cli.progress import progress_bar
from cosserat_casadi.scene import Scene


def choose_with_progress(scene: Scene, ranges: Given | None = None, samples: int = SAMPLES) -> Choice:
    """One discretisation for ranges of inputs; see :func:`cosserat_casadi.accuracy.choose.choose`."""
    with progress_bar() as bar:
        task = bar.add_task("Choosing modes and nodes", total=None)

        def show_count(done: int, total: int) -> None:
            bar.update(task, completed=done, total=total)

        return choose(scene, ranges, progress=show_count, samples=samples)
