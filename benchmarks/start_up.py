"""What it takes until the first answer: processor time of fresh processes, each the least of several.

Imports are measured beyond ``import casadi, numpy``; commands as a whole, with the start of the interpreter. Python
keeps what it has compiled of a package, so that each process is run once before those that are measured.
"""

from __future__ import annotations

import os
import resource
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

ROOT = Path(__file__).parents[1]

COSSERAT = "from cosserat_casadi.cli.main import main; main()"

BASIS = "import casadi, numpy"
"""Of what every import is measured beyond."""

SOLVER = "from cosserat_casadi import read_scene, solve"
"""What a program loads that solves a scene."""


@dataclass(frozen=True)
class Start:
    """A process that is measured.

    Attributes:
        what: how it is called in the table.
        code: a program in Python.
        arguments: of the program.
        bound: seconds that it should take at most; None where no bound is set.
        beyond_basis: whether the time of :data:`BASIS` is taken off.
    """

    what: str
    code: str
    arguments: tuple[str, ...]
    bound: float | None
    beyond_basis: bool = False


STARTS = (
    Start("import cosserat_casadi", f"{BASIS}; import cosserat_casadi", (), 0.25, beyond_basis=True),
    Start("from cosserat_casadi import solve", f"{BASIS}; {SOLVER}", (), None, beyond_basis=True),
    Start("cosserat --help", COSSERAT, ("--help",), 0.5),
    Start("cosserat solve nitinol_wire", COSSERAT, ("solve", "examples/nitinol_wire.toml"), 1.0),
    Start("cosserat solve helical_tendon", COSSERAT, ("solve", "examples/helical_tendon.toml"), 1.5),
    Start("cosserat solve six_rod_platform", COSSERAT, ("solve", "examples/six_rod_platform.toml"), 4.0),
)


def processor_time(code: str, arguments: tuple[str, ...], cache: Path, runs: int) -> float:
    """The least processor time of several processes, s."""
    environment = {**os.environ, "PYTHONPYCACHEPREFIX": str(cache), "OPENBLAS_NUM_THREADS": "1"}
    environment.pop("PYTHONDONTWRITEBYTECODE", None)
    times = []
    for _ in range(runs + 1):
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        command = [sys.executable, "-c", code, *arguments]
        subprocess.run(
            command, cwd=ROOT, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=True
        )
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        times.append(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
    return min(times[1:])


def main(runs: Annotated[int, typer.Option(help="Processes of which the least time counts.")] = 5) -> None:
    """Print the processor time of each start beside the time that it should take at most."""
    with tempfile.TemporaryDirectory() as folder:
        cache = Path(folder)
        basis = processor_time(BASIS, (), cache, runs)
        print(f"{'start':<42}{'time, s':>8}{'at most, s':>12}")
        for start in STARTS:
            time = processor_time(start.code, start.arguments, cache, runs)
            if start.beyond_basis:
                time -= basis
            bound = "" if start.bound is None else f"{start.bound:.2f}"
            print(f"{start.what:<42}{time:>8.2f}{bound:>12}")


if __name__ == "__main__":
    typer.run(main)
