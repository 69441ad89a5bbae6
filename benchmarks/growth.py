"""What models cost as they grow: the ladder of strain models, sections and loads; the exponents in unknowns and nodes.

Counts of scalar operations, and times of the compiled kernels (gcc -O2). `--write` puts both tables into
docs/accuracy.md.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer

from cosserat_casadi import Model, build, discretise, scene_from_dict
from cosserat_casadi.codegen.timed_program import Program, Times
from cosserat_casadi.compiling.compiler import find_compiler

DOCS = Path(__file__).parents[1] / "docs" / "accuracy.md"
BEGIN, END = "<!-- growth: written by benchmarks/growth.py -->", "<!-- end of growth -->"
MATERIAL = {"youngs_modulus": 60e9, "poisson_ratio": 0.33, "density": 6450.0}
PUSH = {"name": "push", "kind": "tip_wrench", "rod": "rod", "force": [0.1, 0.0, 0.05]}
WEIGHT = {"name": "weight", "kind": "gravity", "acceleration": [0.0, 0.0, -9.81]}
WIND = {"name": "wind", "kind": "distributed_wrench", "rod": "rod", "force": [0.3, 0.0, 0.0]}
FOLLOWER = {**PUSH, "name": "follower", "frame": "body"}
LADDER: tuple[tuple[str, str, Any, list[dict[str, Any]]], ...] = (
    ("planar, tip force", "planar", 0.5e-3, [PUSH]),
    ("Kirchhoff, tip force", "kirchhoff", 0.5e-3, [PUSH]),
    ("Kirchhoff, tapered", "kirchhoff", [0.5e-3, 0.3e-3], [PUSH]),
    ("Kirchhoff, and weight", "kirchhoff", 0.5e-3, [PUSH, WEIGHT]),
    ("Kirchhoff, and wind", "kirchhoff", 0.5e-3, [PUSH, WEIGHT, WIND]),
    ("Kirchhoff, follower", "kirchhoff", 0.5e-3, [FOLLOWER]),
    ("Reissner, tip force", "reissner", 0.5e-3, [PUSH]),
)


def model_of(strain: str, radius: Any, loads: list[dict[str, Any]], modes: int, nodes: int) -> Model:
    rod = {"name": "rod", "length": 0.2, "strain": strain, "material": MATERIAL}
    rod["section"] = {"shape": "circle", "radius": radius}
    scene = scene_from_dict({"schema": 1, "rods": [rod], "loads": loads})
    return build(scene, discretise(scene, modes, nodes, "magnus6"))


def timed(models: list[Model]) -> list[Times | str]:
    """Compiled times of each; the compiler works on two at once, and nothing is timed while it does."""
    found: list[Times | str] = []
    for pair in range(0, len(models), 2):
        programs = [Program(model, find_compiler()) for model in models[pair : pair + 2]]
        for program in programs:
            program.wait()
        found += [program.times() for program in programs]
        for program in programs:
            program.close()
    return found


def ladder() -> str:
    models = [model_of(strain, radius, loads, 4, 10) for _, strain, radius, loads in LADDER]
    headings = (
        "4 modes, 10 intervals",
        "unknowns",
        "IGM, operations",
        "with Jacobian",
        "IGM, µs",
        "with Jacobian",
        "cold",
    )
    lines = [f"| {' | '.join(headings)} |", "|---" * len(headings) + "|"]
    for (name, *_), model, times in zip(LADDER, models, timed(models), strict=True):
        counts = [f"{model.operations(f):,}" for f in (model.igm["rod"], model.jacobian)]
        cells = (
            [f"{t:.2f}" for t in (times.igm, times.jacobian, times.cold)]
            if isinstance(times, Times)
            else [times, "", ""]
        )
        lines.append(f"| {' | '.join([name, str(model.size), *counts, *cells])} |")
    return "\n".join(lines)


def exponent(sizes: Sequence[float], costs: Sequence[float]) -> float:
    """Slope of the cost over the size, both in logarithms."""
    return float(np.polyfit(np.log(sizes), np.log(costs), 1)[0])


def growth() -> str:
    by_unknowns = [model_of("kirchhoff", 0.5e-3, [PUSH], modes, 32) for modes in (2, 4, 8, 16, 32)]
    by_nodes = [model_of("kirchhoff", 0.5e-3, [PUSH], 4, nodes) for nodes in (8, 16, 32, 64, 128)]
    lines = ["| operations | IGM | residual + Jacobian | solve: Jacobian and elimination |", "|---|---|---|---|"]
    for name, sizes, models in (
        ("unknowns 6 … 96, 32 intervals", [m.size for m in by_unknowns], by_unknowns),
        ("intervals 8 … 128, 12 unknowns", [8, 16, 32, 64, 128], by_nodes),
    ):
        igm = [model.operations(model.igm["rod"]) for model in models]
        jacobian = [model.operations(model.jacobian) for model in models]
        solve = [j + 2 * m.size**3 / 3 for j, m in zip(jacobian, models, strict=True)]
        cells = [
            f"{costs[0]:,.0f} … {costs[-1]:,.0f}, exponent {exponent(sizes, costs):.2f}"
            for costs in (igm, jacobian, solve)
        ]
        lines.append(f"| {name} | {' | '.join(cells)} |")
    return "\n".join(lines)


def main(write: Annotated[bool, typer.Option("--write", help="Put the tables into docs/accuracy.md.")] = False) -> None:
    """Print the ladder and the growth."""
    text = f"{ladder()}\n\n{growth()}"
    print(text)
    if write:
        before, rest = DOCS.read_text().split(BEGIN)
        DOCS.write_text(f"{before}{BEGIN}\n{text}\n{END}{rest.split(END)[1]}")


if __name__ == "__main__":
    typer.run(main)
