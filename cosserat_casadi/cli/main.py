"""The command line: begin, solve, view, follow a path, simulate, find inputs, identify, sweep, check, export.

The module of a command is loaded when the command runs.
"""

from __future__ import annotations

import os
import platform
import signal
import sys
from collections.abc import Callable
from importlib import import_module
from typing import Annotated, Any

import typer
from rich.markup import escape
from typer.core import TyperCommand, TyperGroup

from cosserat_casadi.cli.exit_codes import INTERRUPTED, NOT_FOUND, NOT_WRITTEN, REFUSED, TERMINATED
from cosserat_casadi.cli.signals import (
    StoppedError,
    end_in_time,
    forget_signals,
    install_handlers,
    remove_handlers,
    remove_temporary_files,
    say_once,
    was_interrupted,
    was_terminated,
)
from cosserat_casadi.cli.terminal import Console, flush_streams, prepare_streams, silence_output
from cosserat_casadi.errors import CosseratError, ExportError, SceneError, WriteError
from cosserat_casadi.spelling import counted

LINES = {
    "new": "Write a scene with comments, to begin with.",
    "examples": "List the examples that come with the package, or copy them.",
    "docs": "Show a page of the documentation.",
    "solve": "Find the equilibrium of a scene.",
    "view": "Move a scene in a browser, by sliders or by its tip; see vibrations and motions.",
    "path": "Follow equilibria while an input moves, through folds.",
    "simulate": "Simulate the motion of a scene over time.",
    "modes": (
        "Find frequencies, damping and shapes of small vibrations about the equilibrium, and whether it is stable."
    ),
    "inverse": "Find inputs that bring rods and bodies to the targets of a scene.",
    "identify": "Find numbers of a scene from measurements, and say which stay open.",
    "estimate": "Estimate the unknown inputs of every measured row, with their standard deviations.",
    "sweep": "Solve a scene for every row of a grid or a table of inputs and parameters.",
    "check": "Validate a scene, and list its effects with the cost of the model and of each effect.",
    "export": "Write a scene as C sources, a page for a browser, an FMU, or a model of MuJoCo.",
    "tune": "Find one discretisation for ranges of inputs, or for load cases.",
}
"""First sentence of the help of every command; its module and its function have the name of the command."""

__all__ = ["INTERRUPTED", "NOT_FOUND", "REFUSED", "app", "main", "run"]

STOPPED = "Stopped. Unfinished files were not written."
"""Message about a command stopped by a signal."""


def load_command(name: str) -> Any:
    """The command of a name, with its arguments and options.

    Raises:
        KeyError: no command has this name.
    """
    if name not in LINES:
        raise KeyError(name)
    module = import_module(f"cosserat_casadi.cli.commands.{name}")
    alone = typer.Typer(add_completion=False, rich_markup_mode="markdown")
    alone.command(name)(getattr(module, name))
    return typer.main.get_command(alone)


class CommandGroup(TyperGroup):
    """Group of all commands, which are loaded only when run."""

    def __init__(self, **options: Any) -> None:
        super().__init__(**options)
        for name, line in LINES.items():
            self.add_command(TyperCommand(name, help=line))

    def resolve_command(self, context: Any, arguments: list[str]) -> tuple[str | None, Any, list[str]]:
        """The command at the start of the arguments, and the remaining arguments."""
        name, command, rest = super().resolve_command(context, arguments)
        if name in LINES:
            command = load_command(name)
        return name, command, rest


app = typer.Typer(
    cls=CommandGroup,
    help="Cosserat rods: from a scene file to the deformed rod.",
    no_args_is_help=True,
)


def _print_version(asked: bool) -> None:
    """Print the versions, and end."""
    if asked:
        # Imported here, because CasADi takes long to load, and help does not need it.
        import casadi as ca

        from cosserat_casadi import __version__

        typer.echo(f"cosserat_casadi {__version__}, CasADi {ca.__version__}, Python {platform.python_version()}")
        raise typer.Exit


@app.callback()
def _general(
    version: Annotated[
        bool,
        typer.Option(
            "--version", callback=_print_version, is_eager=True, help="Print the versions of the package and CasADi."
        ),
    ] = False,
) -> None:
    """Cosserat rods: from a scene file to the deformed rod."""


def main() -> None:
    """Entry point: errors become sentences and exit codes."""
    # For matrices of rods further threads of BLAS mostly wait, and take the cores of other processes.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    prepare_streams()
    try:
        install_handlers()
        end_in_time(STOPPED, {signal.SIGINT: INTERRUPTED, signal.SIGTERM: TERMINATED})
        # Called as a command, not as an app, which would replace our hook for uncaught errors by Typer's.
        exit_code = run(typer.main.get_command(app))
        remove_handlers()
    except KeyboardInterrupt:
        # A signal at the start or the end of the command is outside the handlers of run.
        remove_handlers()
        exit_code = _stopped()
    if exit_code == INTERRUPTED and was_terminated():
        exit_code = TERMINATED
    if was_interrupted():
        # Interrupted CasADi objects must not be finalised after the interpreter: the process ends without cleanup.
        flush_streams()
        remove_temporary_files()
        os._exit(exit_code)
    sys.exit(exit_code)


def run(command: Callable[..., object]) -> int:
    """Run a command; return its exit code, and print the reasons of a refusal on standard error."""
    console = Console(stderr=True)
    forget_signals()
    try:
        exit_code = command(standalone_mode=False)
        flush_streams()
    except StoppedError:
        return INTERRUPTED
    except (KeyboardInterrupt, typer.Abort):
        return _stopped()
    # Raised by commands with a specific exit code.
    except typer.Exit as stop:
        return stop.exit_code
    except Exception as error:
        # An interrupt inside CasADi or in an import appears as another error.
        if was_interrupted():
            return _stopped()
        return _failed(console, error)
    # Typer's exit code for an interrupt that a command does not catch.
    if exit_code == INTERRUPTED:
        return _stopped()
    return exit_code if isinstance(exit_code, int) else 0


def _failed(console: Console, error: Exception) -> int:
    """Print the reason of a failure, and return its exit code.

    Raises:
        Exception: the error itself, if it is an internal one.
    """
    if isinstance(error, CosseratError):
        if isinstance(error, SceneError | ExportError):
            _print_refusal(console, error)
        else:
            _print_error(console, str(error))
        console.print(f"Help: cosserat docs {error.page}")
        # A full disk is not a fault of the input.
        return NOT_WRITTEN if isinstance(error, WriteError) else REFUSED
    if isinstance(error, BrokenPipeError):
        # The reader has closed the pipe, e.g. head.
        silence_output()
        return NOT_WRITTEN
    # Without a number it is not an error of the system.
    if isinstance(error, OSError) and error.errno is not None:
        silence_output()
        _print_error(console, _system_sentence(error))
        return NOT_WRITTEN
    # Refusals by Typer (an unknown option, a missing argument) have no public base class.
    if hasattr(error, "format_message") and hasattr(error, "exit_code"):
        # Validation puts a prefix before the sentence.
        sentence = error.format_message().replace("Value error, ", "")
        # A command without arguments has printed its help, and has no sentence.
        if not sentence:
            return int(error.exit_code)
        _print_error(console, sentence)
        context = getattr(error, "ctx", None)
        if context is not None:
            console.print(f"Help: {context.command_path} --help")
        return int(error.exit_code)
    raise error


def _stopped() -> int:
    say_once(STOPPED)
    return INTERRUPTED


def _system_sentence(error: OSError) -> str:
    """The message of the system with the file; without a name it is standard output or a temporary file."""
    if error.filename is None:
        return f"Standard output or a temporary file could not be written: {error.strerror}"
    return f"{error.filename}: {error.strerror}"


def _print_refusal(console: Console, error: SceneError | ExportError) -> None:
    """Print every reason for the refusal of an input."""
    count = counted(len(error.problems), "problem")
    console.print(f"[bold red]Refused:[/] {count}.")
    for problem in error.problems:
        # Lines do not wrap, so that paths can be copied.
        console.print(f"  {escape(str(problem))}", soft_wrap=True)


def _print_error(console: Console, sentence: str) -> None:
    console.print(f"[bold red]Error:[/] {escape(sentence)}")
