"""What discretisations of random scenes cost once compiled, beside what the solver foresees without building them.

Rows go to build/dial/compiled.csv one by one: the same command goes on where it was stopped. How far the law is from
them is printed; its factors in accuracy/cost.py were fitted to these rows.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated

import numpy as np
import typer
from random_rods import ROD, scene_at
from rich.progress import Progress
from rows import append, read

from cosserat_casadi import build, solve_scene
from cosserat_casadi.accuracy.cost import STRAIGHT, foreseen_time, spread_on
from cosserat_casadi.bench.program import Program, Times
from cosserat_casadi.codegen.compiler import find_compiler
from cosserat_casadi.codegen.kernels import scalar
from cosserat_casadi.model.build import Model
from cosserat_casadi.rod.discretisation import Discretisation

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
    d, rod = model.discretisation[ROD], model.discrete.rods[ROD].properties
    program = Program(model, find_compiler())
    instructions = scalar(model.path_jacobian, "jacobian").n_instructions()
    program.wait()
    times = program.times()
    program.close()
    if not isinstance(times, Times):
        return None
    return Compiled(
        seed, tolerance, len(rod.turning_axes), " ".join(map(str, d.modes)), d.elements, d.nodes, d.transport,
        foreseen_time(rod, d, spread_on(model.scene, ROD)), model.operations(model.jacobian),
        instructions, instructions <= STRAIGHT,
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


def main(samples: Annotated[int, typer.Option(help="Discretisations.")] = 40) -> None:
    """Compile what is missing; print the law's factor and its scatter."""
    done = {int(row["seed"]) for row in read(FILE)}
    with Progress(transient=True) as bar:
        for seed in bar.track(range(FIRST, FIRST + samples), description="compiling"):
            row = None if seed in done else sample(seed)
            if row is not None:
                append(FILE, [row])
    report(read(FILE))


def report(rows: list[dict[str, str]]) -> None:
    """Compiled over foreseen time, for straight-line code and for loops."""
    for straight, name in (("True", "straight code"), ("False", "loops")):
        chosen = [row for row in rows if row["straight"] == straight]
        if chosen:
            ratio = np.log([float(row["residual_jacobian"]) / float(row["foreseen"]) for row in chosen])
            middle, spread = np.exp(np.mean(ratio)), np.exp(np.std(ratio))
            print(f"{name}: {len(chosen)} rows, compiled / foreseen {middle:.2f}, × or / {spread:.2f}")


if __name__ == "__main__":
    typer.run(main)
