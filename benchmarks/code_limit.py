"""The jump in time where Jacobians are too long for code by columns: rods near that limit, written in both ways.

Each rod is compiled by columns and in loops, and both programs are run in turn; the best of all runs counts. What the
laws of accuracy/cost.py foresee stands in brackets. The time of gcc is processor time for all that is timed. Rows go to
build/code_limit.csv one by one: the same command goes on where it was stopped. `--write` puts what is there into
docs/accuracy.md.
"""

from __future__ import annotations

import resource
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any
from unittest.mock import patch

import typer
from doc_tables import put, table
from rows import append, read

from cosserat_casadi import build, discretise, scene_from_dict
from cosserat_casadi.accuracy.cost import spread_on, terms_of, time_in_columns, time_in_loops
from cosserat_casadi.codegen import kernels
from cosserat_casadi.codegen.columns import in_columns, on_path
from cosserat_casadi.codegen.timed_program import Program, Times
from cosserat_casadi.compiling.compiler import find_compiler
from cosserat_casadi.compiling.scalars_in_c import columns_in_fours
from cosserat_casadi.maths.calls import with_dense_results
from cosserat_casadi.model.build import Model

ROOT = Path(__file__).parents[1]
PAGE = ROOT / "docs" / "accuracy.md"
FILE = ROOT / "build" / "code_limit.csv"
BEGIN, END = "<!-- limit: written by benchmarks/code_limit.py -->", "<!-- end of limit -->"
HEAD = [
    "rod", "modes of each strain", "intervals", "statements by columns", "by columns, µs", "in loops, µs", "jump",
    "gcc by columns, s", "gcc in loops, s",
]  # fmt: skip

ROUNDS = 3
"""How often each of two programs is run."""

ROD: dict[str, Any] = {
    "name": "rod",
    "length": 0.5,
    "section": {"shape": "circle", "radius": 1e-3},
    "material": {"youngs_modulus": 2e9, "poisson_ratio": 0.3},
}
PUSH = {"name": "push", "kind": "tip_wrench", "rod": "rod", "force": [0.3, -0.2, 0.1]}
WIND = {"name": "wind", "kind": "distributed_wrench", "rod": "rod", "frame": "body", "force": [0.5, 0.0, 0.1]}

RODS = {
    "Kirchhoff, short, follower force per length": ("kirchhoff", 6, 15, True),
    "Kirchhoff, follower force per length": ("kirchhoff", 10, 40, True),
    "Reissner, follower force per length": ("reissner", 10, 33, True),
    "Kirchhoff, dead force": ("kirchhoff", 18, 56, False),
    "Reissner, dead force": ("reissner", 14, 46, False),
}
"""Strain model, modes of each strain, intervals, and whether a force per length follows, by what the table says."""


@dataclass(frozen=True)
class Limit:
    """A rod whose Jacobian is written in both ways; times in µs, of gcc in s."""

    rod: str
    modes: int
    intervals: int
    statements: int
    columns_us: float
    loops_us: float
    gcc_columns: float
    gcc_loops: float


def model_of(strain: str, modes: int, intervals: int, follows: bool) -> Model:
    """The rod of a line of RODS."""
    loads = [PUSH, WIND] if follows else [PUSH]
    scene = scene_from_dict({"schema": 1, "rods": [{**ROD, "strain": strain}], "loads": loads})
    return build(scene, discretise(scene, modes, intervals, "magnus6"))


def statements_of(model: Model) -> int:
    """Statements of the Jacobian by columns."""
    form = in_columns(on_path(model), "jacobian")
    assert form is not None, "rods that bend have such a form"
    return columns_in_fours(form, with_dense_results(model.path_jacobian, "jacobian")).n_instructions()


def compiled(model: Model, most: int) -> tuple[Program, float]:
    """The model under another limit of statements by columns, and processor time of the compiler, s."""
    with patch.object(kernels, "MOST_IN_COLUMNS", most):
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        program = Program(model, find_compiler())
    program.wait()
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return program, after.ru_utime - before.ru_utime


def best(programs: list[Program]) -> list[float]:
    """Times of residual and Jacobian of programs that are run in turn, µs."""
    found = [float("inf")] * len(programs)
    for _ in range(ROUNDS):
        for k, program in enumerate(programs):
            times = program.times()
            if not isinstance(times, Times):
                raise RuntimeError(times)
            found[k] = min(found[k], times.jacobian)
    return found


def measured(name: str) -> Limit:
    """A line of RODS, compiled and timed."""
    strain, modes, intervals, follows = RODS[name]
    model = model_of(strain, modes, intervals, follows)
    statements = statements_of(model)
    by_columns, gcc_columns = compiled(model, statements)
    loops, gcc_loops = compiled(model, 0)
    columns_us, loops_us = best([by_columns, loops])
    for program in (by_columns, loops):
        program.close()
    return Limit(name, modes, intervals, statements, columns_us, loops_us, gcc_columns, gcc_loops)


def cells(row: dict[str, str]) -> list[str]:
    """A row of the table, from a row of the file."""
    columns, loops = float(row["columns_us"]), float(row["loops_us"])
    model = model_of(*RODS[row["rod"]])
    name = ROD["name"]
    terms = terms_of(model.discrete.rods[name].properties, model.discretisation[name], spread_on(model.scene, name))
    foreseen = [time_in_columns(terms), time_in_loops(terms)]
    times = [f"{time:.3g} ({law:.3g})" for time, law in zip((columns, loops), foreseen, strict=True)]
    times.append(f"{loops / columns:.2f}")
    gcc = [f"{float(row[key]):.1f}" for key in ("gcc_columns", "gcc_loops")]
    return [row["rod"], row["modes"], row["intervals"], row["statements"], *times, *gcc]


def main(
    rods: Annotated[list[str] | None, typer.Argument(help="Names of rods; all where none is given.")] = None,
    write: Annotated[bool, typer.Option(help="Put the table into docs/accuracy.md.")] = False,
) -> None:
    """Measure rods on both sides of the limit."""
    for name in rods or RODS:
        if name not in {row["rod"] for row in read(FILE)}:
            append(FILE, [measured(name)])
    order = list(RODS)
    rows = sorted(read(FILE), key=lambda row: order.index(row["rod"]))
    text = table(HEAD, [cells(row) for row in rows])
    print(text)
    if write:
        put(PAGE, BEGIN, END, text)


if __name__ == "__main__":
    typer.run(main)
