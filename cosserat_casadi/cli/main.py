"""The command line: solve, follow a path, find inputs, sweep, check, export, tune, bench."""

from __future__ import annotations

import sys
from collections.abc import Callable

import typer
from rich.console import Console
from rich.markup import escape

from cosserat_casadi.bench.reference import NoReferenceError
from cosserat_casadi.cli.commands.bench import bench
from cosserat_casadi.cli.commands.check import check
from cosserat_casadi.cli.commands.export import export
from cosserat_casadi.cli.commands.inverse import inverse
from cosserat_casadi.cli.commands.path import path
from cosserat_casadi.cli.commands.solve import solve
from cosserat_casadi.cli.commands.sweep import sweep
from cosserat_casadi.cli.commands.tune import tune
from cosserat_casadi.cli.exit_codes import INTERRUPTED, NOT_FOUND, REFUSED
from cosserat_casadi.cli.reports.problems import print_refusal
from cosserat_casadi.errors import CosseratError, ExportError, SceneError

__all__ = ["INTERRUPTED", "NOT_FOUND", "REFUSED", "app", "main", "run"]

app = typer.Typer(
    help="Cosserat rods: from a scene file to the deformed rod.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_show_locals=False,
)

# In the order in which --help lists them.
for command in (solve, path, inverse, sweep, check, export, tune, bench):
    app.command()(command)


def main() -> None:
    """Entry point: errors become sentences and exit codes."""
    sys.exit(run(app))


def run(command: Callable[..., object]) -> int:
    """Run a command; return its exit code, and print the reasons of a refusal on standard error."""
    console = Console(stderr=True)
    try:
        exit_code = command(standalone_mode=False)
    except (SceneError, ExportError) as error:
        print_refusal(console, error)
        return REFUSED
    # A NoReferenceError is a CosseratError, but the input is in order: it comes first.
    except NoReferenceError as error:
        _print_error(console, str(error))
        return NOT_FOUND
    except CosseratError as error:
        _print_error(console, str(error))
        return REFUSED
    except KeyboardInterrupt:
        console.print("Stopped. Files that were not finished were not written.")
        return INTERRUPTED
    # Raised by commands that end with a code of their own.
    except typer.Exit as stop:
        return stop.exit_code
    except typer.Abort:
        return INTERRUPTED
    except Exception as error:
        # Typer's own refusals (an unknown option, a missing argument) have no public base class to catch.
        if hasattr(error, "format_message") and hasattr(error, "exit_code"):
            _print_error(console, error.format_message())
            return int(error.exit_code)
        raise
    if isinstance(exit_code, int):
        return exit_code
    return 0


def _print_error(console: Console, sentence: str) -> None:
    console.print(f"[bold red]Error:[/] {escape(sentence)}", highlight=False)
