"""The command line, called as a function: a process of its own would import everything anew for each command."""

from __future__ import annotations

import contextlib
import io
import os
import shlex
import warnings
from dataclasses import dataclass
from pathlib import Path
from unittest.mock import patch

from cosserat_casadi.cli.main import app, run

WIRE = """[[rods]]
name = "wire"
length = 0.2
strain = "kirchhoff"
material = { youngs_modulus = 60e9, poisson_ratio = 0.33, density = 6450.0 }
section = { shape = "circle", radius = 0.5e-3 }
[[loads]]
name = "push"
kind = "tip_wrench"
rod = "wire"
force = [0.2, 0, 0]
"""
"""A wire with a push at its tip, the tables that many scenes of commands begin with."""


@dataclass(frozen=True)
class Ended:
    """A command that has ended.

    Attributes:
        returncode: its exit code.
        stdout: what it wrote to standard output.
        stderr: what it wrote to standard error.
    """

    returncode: int
    stdout: str
    stderr: str


def cosserat(*arguments: str, cwd: Path) -> Ended:
    """Run a command in a folder, as in a pipe of 80 columns."""
    output = io.TextIOWrapper(io.BytesIO(), encoding="utf-8")
    errors = io.TextIOWrapper(io.BytesIO(), encoding="utf-8")
    with contextlib.ExitStack() as stack:
        stack.enter_context(contextlib.chdir(cwd))
        stack.enter_context(patch.dict(os.environ, COLUMNS="80"))
        stack.enter_context(warnings.catch_warnings())
        warnings.simplefilter("default")
        stack.enter_context(contextlib.redirect_stdout(output))
        stack.enter_context(contextlib.redirect_stderr(errors))
        code = run(lambda **options: app(list(arguments), **options))
    return Ended(code, written(output), written(errors))


def written(stream: io.TextIOWrapper[io.BytesIO]) -> str:
    """What a stream has got."""
    stream.flush()
    return stream.buffer.getvalue().decode()


def cosserat_line(line: str, cwd: Path) -> Ended:
    """Run a line that begins with ``cosserat``."""
    program, *arguments = shlex.split(line)
    assert program == "cosserat", line
    return cosserat(*arguments, cwd=cwd)
