"""The commands in their order, each with its line in ``cosserat --help``; a command loads its module when it is run."""

from __future__ import annotations

from importlib import import_module
from typing import Any

import typer
from typer.core import TyperCommand, TyperGroup

LINES = {
    "new": "Write a scene with comments, to begin with.",
    "examples": "List the examples that come with the package, or copy them.",
    "docs": "Show a page of the documentation.",
    "solve": "Find the equilibrium of a scene.",
    "view": "Move a scene in a browser: sliders, the tip under the hand, vibrations, the motion.",
    "path": "Follow equilibria while an input moves, through folds.",
    "simulate": "Simulate the motion of a scene over time.",
    "modes": (
        "Find frequencies, damping and shapes of small vibrations about the equilibrium, and whether it is stable."
    ),
    "inverse": "Find inputs that bring rods and bodies to the targets of a scene.",
    "identify": "Find numbers of a scene from measurements, and what these leave open.",
    "estimate": "Find in every measured row what the robot feels: unknown inputs, with their standard deviations.",
    "sweep": "Solve a scene for every row of a grid or a table of inputs and parameters.",
    "check": "Validate a scene, say which effects were chosen and what the model and each effect will cost.",
    "export": "Write a scene as C sources, a page for a browser, an FMU, or a model of MuJoCo.",
    "tune": "Find one discretisation for ranges of inputs, or for load cases.",
}
"""First sentence of the help of every command; the module of a command and its function have its name."""


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
    """All commands: known by name and line until a command is run."""

    def __init__(self, **options: Any) -> None:
        super().__init__(**options)
        for name, line in LINES.items():
            self.add_command(TyperCommand(name, help=line))

    def resolve_command(self, context: Any, arguments: list[str]) -> tuple[str | None, Any, list[str]]:
        """The command that arguments begin with, and the arguments behind it."""
        name, command, rest = super().resolve_command(context, arguments)
        if name in LINES:
            command = load_command(name)
        return name, command, rest
