"""What ``inverse --table`` prints."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from rich.console import Console
from rich.markup import escape

from cosserat_casadi.cli.reports.format import print_plain, print_written
from cosserat_casadi.control.inverse_result import Inverse
from cosserat_casadi.control.target_table import TargetTable
from cosserat_casadi.results.inverse_table import MET
from cosserat_casadi.spelling import counted

MOST_TOLD = 20
"""Rows that failed which are told; the file has them all."""


def print_inverse_table(
    console: Console,
    targets: TargetTable,
    found: Sequence[Inverse],
    outcomes: Sequence[str],
    output: Path,
) -> None:
    """Print how many rows are met, and of the others the line, the outcome and why."""
    failed = [row for row, outcome in enumerate(outcomes) if outcome != MET]
    rows = counted(len(outcomes), "row")
    if not failed:
        print_plain(console, f"[bold green]The targets of {rows} are met.[/]")
    else:
        print_plain(console, f"[bold red]{len(failed)} of {rows}: the target is not met.[/]")
    for row in failed[:MOST_TOLD]:
        message = escape(found[row].solution.message)
        print_plain(console, f"line {targets.lines[row]}: {outcomes[row]}. {message}", soft_wrap=True)
    if len(failed) > MOST_TOLD:
        print_plain(console, f"… and {len(failed) - MOST_TOLD} more; {escape(str(output))} names the outcome of each.")
    print_written(console, [output])
