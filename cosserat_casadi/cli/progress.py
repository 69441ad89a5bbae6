"""The progress of a running command on standard error, and its interruption."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING

from rich.progress import (
    BarColumn,
    Progress,
    ProgressColumn,
    SpinnerColumn,
    Task,
    TaskProgressColumn,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)
from rich.text import Text

from cosserat_casadi.cli.signals import StoppedError, remembered_interrupt, take_time
from cosserat_casadi.cli.terminal import Console
from cosserat_casadi.numerics.progress import StageProgress

# Only for annotations: a solve needs no module of motions for its progress.
if TYPE_CHECKING:
    from cosserat_casadi.motion.trajectory import MotionProgress


@dataclass(frozen=True)
class SolveDisplay:
    """Callbacks that a solve reports to.

    Attributes:
        show_share: function of the finished share of the present stage, 0 to 1.
        show_stage: function of the name of a new stage.
    """

    show_share: Callable[[float], None]
    show_stage: Callable[[str], None]


class RateColumn(ProgressColumn):
    """Column with the number of finished items per second, once known."""

    def render(self, task: Task) -> Text:
        """The rate as text."""
        return Text(f"{task.speed:,.0f}/s") if task.speed else Text("")


def progress_bar(*more: ProgressColumn) -> Progress:
    """A progress bar on standard error that is removed at the end."""
    columns = (
        SpinnerColumn(),
        TextColumn("{task.description}"),
        BarColumn(),
        TaskProgressColumn(),
        TimeElapsedColumn(),
        *more,
    )
    # The display uses standard error: standard output is for results, and may go into a file.
    return Progress(*columns, console=Console(stderr=True), transient=True)


@contextmanager
def solve_display(command: str) -> Iterator[SolveDisplay]:
    """A bar for a solve; an interrupt inside ends the command with its exit code."""
    with progress_bar() as bar, remembered_interrupt() as raise_interrupt:
        task = bar.add_task("Building the model", total=1.0)

        def show_share(share: float) -> None:
            raise_interrupt()
            bar.update(task, completed=share)

        def show_stage(stage: str) -> None:
            raise_interrupt()
            bar.update(task, description=f"{command}: {stage}", completed=0.0)

        with _stopped_without_files(bar):
            yield SolveDisplay(show_share, show_stage)


@contextmanager
def motion_display() -> Iterator[Callable[[MotionProgress], None]]:
    """A bar for a simulation, with the present time, the time step and the remaining run time.

    An interrupt before the start of the motion ends the command; during the motion it is raised at the next report.
    """
    with progress_bar(TimeRemainingColumn()) as bar, remembered_interrupt() as raise_interrupt:
        task = bar.add_task("Building the model", total=1.0)

        def show_motion(progress: MotionProgress) -> None:
            raise_interrupt()
            # After the first step there is a partial motion to write.
            if progress.time > 0.0:
                take_time()
            times = f"t = {progress.time:.4g} of {progress.duration:.4g} s, step {progress.step:.2g} s"
            bar.update(task, description=f"{progress.stage}: {times}", completed=progress.share)

        with _stopped_without_files(bar):
            yield show_motion


@contextmanager
def share_display(description: str) -> Iterator[Callable[[float], None]]:
    """A bar for a task that reports its finished share."""
    with progress_bar() as bar:
        task = bar.add_task(description, total=1.0)

        def show_share(share: float) -> None:
            bar.update(task, completed=share)

        yield show_share


@contextmanager
def _stopped_without_files(bar: Progress) -> Iterator[None]:
    """Context that ends the command after an interrupt, with the sentence that no file changed."""
    try:
        yield
    except KeyboardInterrupt:
        bar.console.print("Stopped. Nothing was written.")
        raise StoppedError from None


@contextmanager
def count_display(description: str, *columns: ProgressColumn) -> Iterator[StageProgress]:
    """A bar for the successive stages of a task, with further columns.

    An interrupt is raised at the next report.

    Args:
        description: description of the first stage.
        columns: further columns, such as the rate or the remaining time.
    """
    with progress_bar(*columns) as bar, remembered_interrupt() as raise_interrupt:
        task = bar.add_task(description, total=None)
        shown_stage = description

        def show_count(stage: str, done: int, total: int) -> None:
            nonlocal shown_stage
            raise_interrupt()
            if stage == shown_stage:
                bar.update(task, completed=done, total=total or None)
            else:
                # The rate is measured since the last reset, since stages have different rates.
                bar.reset(task, description=stage, completed=done, total=total or None)
            shown_stage = stage

        yield show_count
