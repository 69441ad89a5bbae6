"""The report of ``modes``."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from rich.console import Console
from rich.markup import escape
from rich.table import Table

from cosserat_casadi.cli.reports.format import print_outcome, print_plain, print_written
from cosserat_casadi.motion.vibration_modes import Mode, Modes


def print_modes(console: Console, modes: Modes, written: Sequence[Path]) -> None:
    """Print the outcome, the modes, their discretisation, and the files that were written."""
    grows = any(mode.grows for mode in modes.modes)
    print_outcome(console, modes.model.scene.title, modes.message, good=modes.converged, doubtful=grows)
    if modes.modes:
        console.print(_modes_table(modes))
        print_plain(console, escape("; ".join(modes.model.resolution_words)))
    print_written(console, written)


def _modes_table(modes: Modes) -> Table:
    table = Table()
    for heading in ("mode", "frequency, Hz", "|λ|, 1/s", "damping ratio", "estimated error"):
        table.add_column(heading, justify="right")
    table.add_column("motion")
    for number, mode in enumerate(modes.modes, start=1):
        table.add_row(str(number), *_cells(mode))
    return table


def _cells(mode: Mode) -> list[str]:
    """Frequency, size of the eigenvalue, damping ratio, error and kind of a mode."""
    error = ""
    if mode.error_estimate is not None and mode.eigenvalue != 0.0:
        error = f"{mode.error_estimate:.1e}"
    frequency = ""
    damping = ""
    # What does not swing has a rate and no frequency.
    if mode.oscillates:
        frequency = f"{mode.frequency:.8g}"
        damping = f"{mode.damping_ratio:.6g}"
    return [frequency, f"{mode.angular_frequency:.8g}", damping, error, mode.words]
