"""What parameters cost: scalar operations that each adds, and time in C. `--write` puts both into docs/parameters.md.

Times are ratios: the library with parameters and the one in which they are constants solve in turns, and of each the
best of many turns counts, so that a machine with other work to do gives the same ratio.
"""

from __future__ import annotations

import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer
from doc_tables import put, table

from cosserat_casadi import Compiled, Model, build, discretise, export, load, scene_from_dict
from cosserat_casadi.codegen.plain import pointer

PAGE = Path(__file__).parents[1] / "docs" / "parameters.md"
BEGIN, END = "<!-- price: written by benchmarks/parameters.py -->", "<!-- end of price -->"
BEGIN_TIMES, END_TIMES = "<!-- times: written by benchmarks/parameters.py -->", "<!-- end of times -->"
MODES, NODES = 4, 10
TURNS = 20000
TIMED = (
    "Young's modulus, uniform rod",
    "both radii, tapered rod",
    "one coefficient of the unloaded curvature",
    "offset of a tendon, linear along the rod",
)
"""Cases that are compiled."""

MATERIAL = {"youngs_modulus": 60e9, "poisson_ratio": 0.33, "density": 6450.0}
ROD: dict[str, Any] = {
    "name": "rod",
    "length": 0.2,
    "strain": "kirchhoff",
    "material": MATERIAL,
    "section": {"shape": "circle", "radius": 0.5e-3},
    "intrinsic": {"curvature": [0, [1.5, 0.2], 0]},
}
TAPERED = {**ROD, "section": {"shape": "circle", "radius": [0.5e-3, 0.3e-3]}}
LOADS = [
    {"name": "push", "kind": "tip_wrench", "rod": "rod", "force": [0.1, 0.0, 0.05]},
    {"name": "weight", "kind": "gravity", "acceleration": [0.0, 0.0, -9.81]},
]
CABLE = [{"name": "cable", "kind": "tendon", "rod": "rod", "tension": 1.0, "offset": [[4e-4, -1e-4], 0.0]}]
COIL = [{"name": "coil", "kind": "tendon", "rod": "rod", "tension": 1.0, "helix": {"radius": 4e-4, "turns": 1.0}}]

SHORT = [{**CABLE[0], "span": [0.0, 0.6]}]
POKE = [{"name": "poke", "kind": "point_wrench", "rod": "rod", "at": 0.5, "force": [0.05, 0.02, 0.0]}]

CASES: tuple[tuple[str, dict[str, Any], list[dict[str, Any]], tuple[str, ...]], ...] = (
    ("Young's modulus, uniform rod", ROD, [], ("rod.material.youngs_modulus",)),
    ("… and Poisson's ratio", ROD, [], ("rod.material.youngs_modulus", "rod.material.poisson_ratio")),
    ("Young's modulus, tapered rod", TAPERED, [], ("rod.material.youngs_modulus",)),
    ("density", ROD, [], ("rod.material.density",)),
    ("radius, uniform rod", ROD, [], ("rod.section.radius",)),
    ("both radii, tapered rod", TAPERED, [], ("rod.section.radius",)),
    ("one coefficient of the unloaded curvature", ROD, [], ("rod.intrinsic.curvature.y[0]",)),
    ("all six of them", ROD, [], ("rod.intrinsic.curvature",)),
    ("length", ROD, [], ("rod.length",)),
    ("position of the base", ROD, [], ("rod.base.position",)),
    ("offset of a tendon, linear along the rod", ROD, CABLE, ("cable.offset.x",)),
    ("radius and turns of a helical tendon", ROD, COIL, ("coil.helix.radius", "coil.helix.turns")),
    ("acceleration of a weight that is no input", ROD, [], ("weight.acceleration",)),
    ("end of a tendon", ROD, SHORT, ("cable.span.end",)),
    ("place of a force", ROD, [], ("poke.at",)),
    ("… on a tapered rod", TAPERED, [], ("poke.at",)),
)

FORCES: dict[tuple[str, ...], list[dict[str, Any]]] = {("poke.at",): [*LOADS, *POKE]}
"""Loads of those cases whose parameters are not of the others."""


def model_of(
    rod: dict[str, Any], loads: list[dict[str, Any]], actuators: list[dict[str, Any]], parameters: tuple[str, ...]
) -> Model:
    """The model with these parameters; the force at the tip alone is an input."""
    tables = {"schema": 1, "rods": [rod], "loads": loads, "actuators": actuators, "inputs": ["push.force"]}
    scene = scene_from_dict({**tables, "parameters": list(parameters)})
    return build(scene, discretise(scene, MODES, NODES, "magnus6"))


def operations(model: Model) -> tuple[int, int]:
    """Of the residual, and of the residual with its Jacobian."""
    return model.operations(model.residual), model.operations(model.jacobian)


def price() -> str:
    """The table."""
    rows = []
    for name, rod, actuators, parameters in CASES:
        loads = FORCES.get(parameters, LOADS)
        bare_residual, bare_jacobian = operations(model_of(rod, loads, actuators, ()))
        model = model_of(rod, loads, actuators, parameters)
        residual, jacobian = operations(model)
        count = model.parameters.size
        cells = (
            f"+{residual - bare_residual:,} on {bare_residual:,}",
            f"+{jacobian - bare_jacobian:,} on {bare_jacobian:,}",
        )
        rows.append((name, str(count), *cells))
    headings = (f"Kirchhoff rod, {MODES} modes, {NODES} intervals", "numbers", "residual, operations", "with Jacobian")
    return table(headings, rows)


def best_times(*tasks: Callable[[], object]) -> list[float]:
    """Best time of each of several tasks that take turns, s."""
    best = [np.inf] * len(tasks)
    for _ in range(TURNS):
        for i, task in enumerate(tasks):
            start = time.perf_counter()
            task()
            best[i] = min(best[i], time.perf_counter() - start)
    return best


def tasks_of(library: Compiled) -> list[Callable[[], object]]:
    """A solve from the unloaded rod, and from a solution near by; derivatives of a solution: calls of C alone."""
    inputs = library.defaults
    near_inputs = 0.98 * inputs
    found = library.solve().x
    x = found.copy()
    kinds = 2 if library.parameters.size else 1
    results = [np.zeros((7 + library.size) * (inputs.size + library.parameters.size)) for _ in range(2 * kinds)]
    p = library.parameters.passed()
    work = library._workspace()
    solve = library._function("solve")
    sensitivity = library._function("solve_sensitivity")

    def cold() -> None:
        x[:] = 0.0
        solve(pointer(inputs), *p, pointer(x), work, None)

    def warm() -> None:
        x[:] = found
        solve(pointer(near_inputs), *p, pointer(x), work, None)

    def derivatives() -> None:
        sensitivity(pointer(inputs), *p, pointer(found), *map(pointer, results), work)

    return [cold, warm, derivatives]


def times() -> str:
    """The table of ratios."""
    rows = []
    for name, rod, actuators, parameters in CASES:
        if name not in TIMED:
            continue
        model = model_of(rod, LOADS, actuators, parameters)
        with tempfile.TemporaryDirectory() as folder:
            bare = load(export(model.at(), Path(folder) / "bare"))
            named = load(export(model, Path(folder) / "named"))
        assert isinstance(bare, Compiled)
        assert isinstance(named, Compiled)
        ratios = []
        for with_constants, with_parameters in zip(tasks_of(bare), tasks_of(named), strict=True):
            bare_time, named_time = best_times(with_constants, with_parameters)
            ratios.append(f"{named_time / bare_time:.2f}")
        rows.append((name, str(model.parameters.size), *ratios))
    solves = ("solve from the unloaded rod", "solve from near by")
    headings = ("time in C, with constants = 1", "numbers", *solves, "derivatives")
    return table(headings, rows)


def main(
    write: Annotated[bool, typer.Option("--write", help="Put the tables into docs/parameters.md.")] = False,
) -> None:
    """Print what parameters cost."""
    text = price()
    print(text)
    ratios = times()
    print(ratios)
    if write:
        put(PAGE, BEGIN, END, text)
        put(PAGE, BEGIN_TIMES, END_TIMES, ratios)


if __name__ == "__main__":
    typer.run(main)
