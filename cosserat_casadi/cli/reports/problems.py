"""Why an input is refused."""

from __future__ import annotations

from rich.console import Console
from rich.markup import escape

from cosserat_casadi.cli.reports.format import print_plain
from cosserat_casadi.errors import ExportError, SceneError
from cosserat_casadi.spelling import counted


def print_refusal(console: Console, error: SceneError | ExportError) -> None:
    """Print every reason for which an input is refused."""
    count = counted(len(error.problems), "problem")
    print_plain(console, f"[bold red]Refused:[/] {count}.")
    for problem in error.problems:
        # Not wrapped: a path cut in two cannot be copied.
        print_plain(console, f"  {escape(str(problem))}", soft_wrap=True)
