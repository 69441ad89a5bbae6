"""The page of all commands, from the commands themselves."""

from __future__ import annotations

from typing import Any

from typer.main import get_command

from cosserat_casadi.cli.main import LINES, app, load_command

WORDS = """# Every command and option

What `cosserat COMMAND --help` says, from the commands themselves. [The command line](command-line.md) says what they
are for, how they end, and what is in the files that they write."""


def command_page() -> str:
    """The page: a section for each command, in the order of ``cosserat --help``."""
    group: Any = get_command(app)
    sections = [_section(name, load_command(name)) for name in LINES]
    general = ["## Without a command", _table(group.params)]
    return "\n\n".join([WORDS, *sections, *general]) + "\n"


def _section(name: str, command: Any) -> str:
    arguments = [parameter for parameter in command.params if parameter.param_type_name == "argument"]
    line = " ".join(["cosserat", name, "[OPTIONS]", *[_metavar(argument) for argument in arguments]])
    return "\n\n".join([f"## {name}", command.help, f"```text\n{line}\n```", _table(command.params)])


def _table(parameters: list[Any]) -> str:
    """Arguments and options, one a row."""
    rows = [_row(parameter) for parameter in parameters if not getattr(parameter, "hidden", False)]
    return "\n".join(["| option | default | meaning |", "|---|---|---|", *rows])


def _row(parameter: Any) -> str:
    names = _metavar(parameter)
    if parameter.param_type_name == "option":
        names = ", ".join([*parameter.opts, *parameter.secondary_opts])
        if not getattr(parameter, "is_flag", False):
            names += f" {_metavar(parameter)}"
    default = "–"
    if parameter.required:
        default = "required"
    elif parameter.default not in (None, False, ()) and not callable(parameter.default):
        default = f"`{parameter.default}`"
    meaning = (parameter.help or "").replace("|", "\\|")
    return f"| `{names}` | {default} | {meaning} |"


def _metavar(parameter: Any) -> str:
    """What stands for the value of a parameter."""
    return str(parameter.metavar or parameter.name.upper())
