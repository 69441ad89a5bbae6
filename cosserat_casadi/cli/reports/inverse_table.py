"""The report of ``inverse --table``."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from rich.console import Console
from rich.markup import escape

from cosserat_casadi.cli.reports.format import print_written
from cosserat_casadi.cli.reports.model import error_words
from cosserat_casadi.control.inverse_result import Inverse
from cosserat_casadi.control.target_table import TargetTable
from cosserat_casadi.results.inverse_table import MET
from cosserat_casadi.spelling import counted

MOST_TOLD = 20
"""Largest number of printed failed rows; the file has them all."""


def print_inverse_table(
    console: Console,
    targets: TargetTable,
    found: Sequence[Inverse],
    outcomes: Sequence[str],
    output: Path,
) -> None:
    """Print the number of met rows; line, outcome and message of other rows; and the largest error."""
    failed = [row for row, outcome in enumerate(outcomes) if outcome != MET]
    rows = counted(len(outcomes), "row")
    if not failed:
        console.print(f"[bold green]The targets of {rows} are met.[/]")
    else:
        console.print(f"[bold red]{len(failed)} of {rows}: the target is not met.[/]")
    for row in failed[:MOST_TOLD]:
        message = escape(found[row].solution.message)
        console.print(f"line {targets.lines[row]}: {outcomes[row]}. {message}", soft_wrap=True)
    if len(failed) > MOST_TOLD:
        console.print(f"… and {len(failed) - MOST_TOLD} more; {escape(str(output))} names the outcome of each.")
    sentence = _error_sentence(targets, found)
    if sentence is not None:
        console.print(sentence, soft_wrap=True)
    print_written(console, [output])


def _error_sentence(targets: TargetTable, found: Sequence[Inverse]) -> str | None:
    """The largest estimated error of rows with an equilibrium, and the number of rows above the tolerance, if any."""
    errors = {
        row: inverse.solution.error_estimate
        for row, inverse in enumerate(found)
        if inverse.solution.converged and inverse.solution.error_estimate is not None
    }
    if not errors:
        return None
    worst = max(errors, key=lambda row: errors[row])
    solution = found[worst].solution
    tolerance = solution.model.scene.accuracy.tolerance
    error = error_words(errors[worst], solution.within_tolerance, tolerance)
    missed = sum(found[row].solution.within_tolerance is False for row in errors)
    sentence = f"Estimated error at most {error} (line {targets.lines[worst]})"
    if missed:
        return f"{sentence}, as in {counted(missed, 'row')}: {solution.remedy}"
    return f"{sentence}."
