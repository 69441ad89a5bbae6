"""What discretisations of random scenes cost once compiled, beside what the solver foresees without building them.

Rows go to build/dial/compiled.csv one by one: the same command goes on where it was stopped. The factor between
foreseen cost and microseconds, and how far single rows are from it, are printed.
"""

from __future__ import annotations

import csv
from dataclasses import asdict, dataclass, fields, replace
from pathlib import Path
from typing import Annotated

import numpy as np
import typer
from random_rods import ROD, scene_at
from rich.progress import Progress

from cosserat_casadi import build, solve_scene
from cosserat_casadi.bench.program import Program, Times
from cosserat_casadi.codegen.compiled import find_compiler
from cosserat_casadi.codegen.kernels import STRAIGHT, scalar
from cosserat_casadi.model.build import Model
from cosserat_casadi.rod.discretisation import Discretisation
from cosserat_casadi.solver.cost import foreseen_operations

FILE = Path(__file__).parents[1] / "build" / "dial" / "compiled.csv"
FIRST = 3000
"""Seed of the first scene; none of those that judge the dial."""

CHOICES = (1e-3, 1e-5, 1e-7, 1e-9)
INTEGRATORS = ((None, 1.0), ("magnus4", 1.4), ("magnus8", 0.8))
"""Integrators in turn, that of the pick first, with the share of its intervals."""


@dataclass(frozen=True)
class Compiled:
    """A discretisation, counted, compiled and timed; times in µs."""

    seed: int
    tolerance: float
    turning_axes: int
    modes: str
    elements: int
    nodes: int
    transport: str
    foreseen: float
    operations: float
    instructions: float
    straight: bool
    residual_jacobian: float
    igm: float
    warm: float
    cold: float


def compiled(model: Model, seed: int, tolerance: float) -> Compiled | None:
    """None where the program does not converge."""
    d, rod = model.discretisation[ROD], model.frame.bases[ROD].rod
    program = Program(model, find_compiler())
    instructions = scalar(model.path_jacobian, "jacobian").n_instructions()
    program.wait()
    times = program.times()
    program.close()
    if not isinstance(times, Times):
        return None
    return Compiled(
        seed, tolerance, len(rod.turning_axes), " ".join(map(str, d.modes)), d.elements, d.nodes, d.transport,
        foreseen_operations(rod, d), model.operations(model.jacobian), instructions, instructions <= STRAIGHT,
        times.jacobian, times.igm, times.warm, times.cold,
    )  # fmt: skip


def sample(seed: int) -> Compiled | None:
    """The scene's pick at one of the tolerances, or the same with another integrator."""
    tolerance = CHOICES[seed % len(CHOICES)]
    solution = solve_scene(scene_at(seed, tolerance))
    if not solution.converged:
        return None
    picked = solution.model.discretisation[ROD]
    return compiled(build(solution.model.scene, {ROD: varied(picked, seed)}), seed, tolerance)


def varied(picked: Discretisation, seed: int) -> Discretisation:
    transport, share = INTEGRATORS[seed // len(CHOICES) % len(INTEGRATORS)]
    nodes = max(2, round(share * picked.nodes))
    return replace(picked, nodes=nodes, transport=transport or picked.transport)


def read(file: Path = FILE) -> list[dict[str, str]]:
    if not file.exists():
        return []
    with file.open(newline="") as lines:
        return list(csv.DictReader(lines))


def append(file: Path, row: object) -> None:
    """One row more; the head first where the file is new."""
    new = not file.exists()
    file.parent.mkdir(parents=True, exist_ok=True)
    with file.open("a", newline="") as lines:
        writer = csv.DictWriter(lines, [f.name for f in fields(row)])  # type: ignore[arg-type]
        if new:
            writer.writeheader()
        writer.writerow(asdict(row))  # type: ignore[call-overload]


def main(samples: Annotated[int, typer.Option(help="Discretisations.")] = 40) -> None:
    """Compile what is missing; print the law's factor and its scatter."""
    done = {int(row["seed"]) for row in read()}
    with Progress(transient=True) as bar:
        for seed in bar.track(range(FIRST, FIRST + samples), description="compiling"):
            row = None if seed in done else sample(seed)
            if row is not None:
                append(FILE, row)
    report(read())


def report(rows: list[dict[str, str]]) -> None:
    for kind in ("True", "False"):
        chosen = [row for row in rows if row["straight"] == kind]
        if len(chosen) < 2:
            continue
        ratio = np.array([float(row["residual_jacobian"]) / float(row["foreseen"]) for row in chosen])
        spread = np.exp(np.std(np.log(ratio)))
        words = "straight code" if kind == "True" else "loops"
        print(f"{words}: {len(ratio)} rows, {1e3 * np.exp(np.log(ratio).mean()):.3f} ns an operation, × or / {spread:.2f}")


if __name__ == "__main__":
    typer.run(main)
