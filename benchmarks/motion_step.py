"""What steps of a motion cost in C: µs, best of many, on one core, `gcc -O2`.

    python benchmarks/motion_step.py [--page] [NAME …]

With --page the table of all models goes to docs/c-interface.md.
"""

from __future__ import annotations

import json
import re
import subprocess
import tempfile
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Annotated, Any

import typer
from doc_tables import put, table
from rich.progress import track

from cosserat_casadi import Discretisation, Model, build, discretise, export, read_scene, scene_from_dict

ROOT = Path(__file__).parents[1]
FLAGS = ("-O2", "-std=c99")

ROD = {
    "name": "rod",
    "length": 0.8,
    "strain": "kirchhoff",
    "material": {"youngs_modulus": 8e6, "shear_modulus": 3e6, "density": 716.0},
    "section": {"shape": "circle", "radius": 0.02},
}
LOADS = [
    {"name": "push", "kind": "tip_wrench", "rod": "rod", "force": [0.9, 0.5, -0.4]},
    {"name": "weight", "kind": "gravity", "acceleration": [0.3, -0.2, -2.0]},
]

THIN = {
    "name": "rod",
    "length": 0.8,
    "strain": "kirchhoff",
    "stiffness": {"bending_x": 1.0, "bending_y": 1.0, "torsion": 0.75},
    "linear_density": 0.9,
}
"""A rod without rotary inertia and damping."""

PAGE = ROOT / "docs" / "c-interface.md"
BEGIN, END = "<!-- cost of a step -->", "<!-- end of the cost of a step -->"

COLUMNS = {
    "inverse_dynamics": "inverse dynamics",
    "matrices": "K, C, M",
    "step": "step",
    "step_with_new_jacobian": "with a new Jacobian",
    "step_sensitivity": "with sensitivities",
}


BRANCHES = [{"share": 0.2, "time": 0.03}, {"share": 0.15, "time": 0.4}, {"share": 0.1, "time": 3.0}]


def rod(branches: int = 0) -> Model:
    """A Kirchhoff rod of 12 unknowns, and as many flows for each branch of its relaxing stress."""
    damping = {"retardation_time": 0.01, "prony": BRANCHES[:branches]}
    rods = [{**ROD, "damping": damping}]
    scene = scene_from_dict({"schema": 1, "rods": rods, "loads": LOADS, "inputs": ["push.force"]})
    return build(scene, discretise(scene, 4, 10, "magnus4"), moving=True)


def thin_rod() -> Model:
    """The same under a tip force alone."""
    scene = scene_from_dict({"schema": 1, "rods": [THIN], "loads": LOADS[:1], "inputs": ["push.force"]})
    return build(scene, discretise(scene, 4, 10, "magnus4"), moving=True)


def platform() -> Model:
    """The six-rod platform on the discretisation of its exported folder."""
    kept = json.loads((ROOT / "generated" / "six_rod_platform" / "manifest.json").read_text())["discretisation"]
    chosen = {
        name: Discretisation(**{**found, "modes": tuple(found["modes"]), "breaks": tuple(found["breaks"])})
        for name, found in kept.items()
    }
    scene = read_scene(ROOT / "generated" / "six_rod_platform" / "scene.toml")
    return build(scene, chosen, moving=True)


MODELS: dict[str, Callable[[], Model]] = {
    "Kirchhoff rod, tip force": thin_rod,
    "with rotary inertia, damping and weight": rod,
    "and a Maxwell branch": partial(rod, 1),
    "and three of them": partial(rod, 3),
    "six-rod platform": platform,
}


def measured(model: Model, repeat: int, dt: float) -> dict[str, Any]:
    """Times of tasks, and what steps took."""
    name = "timed"
    with tempfile.TemporaryDirectory() as scratch:
        folder = export(model, Path(scratch) / name, name, dynamics=True, estimate_errors=False)
        harness = Path(scratch) / "harness.c"
        words = {"name": name, "MACRO": name.upper()}
        text = (ROOT / "benchmarks" / "motion_step.c").read_text()
        harness.write_text(re.sub(r"@\{(\w+)\}", lambda match: words[match[1]], text))
        sources = [str(harness), f"{name}.c", f"{name}_kernels.c"]
        subprocess.run(["gcc", *FLAGS, "-I.", *sources, "-o", "harness", "-lm"], cwd=folder, check=True)
        command = ["./harness", str(repeat), repr(dt)]
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=True)
    times: dict[str, Any] = json.loads(done.stdout)
    return times


def row(name: str, model: Model) -> list[str]:
    """Cells of a model: unknowns, µs of each task, Newton iterations of a step."""
    times = measured(model, 100, 1e-3)
    found = [f"{times[task]['us']:.3g}" for task in COLUMNS]
    return [name, str(model.size), *found, f"{times['step']['iterations']:.1f}"]


def main(
    names: Annotated[list[str] | None, typer.Argument(help="Models; all by default.")] = None,
    page: Annotated[bool, typer.Option("--page", help="Write the table to the page on C.")] = False,
) -> None:
    """Print the table."""
    headings = ["µs, steps of 1 ms", "unknowns", *COLUMNS.values(), "iterations"]
    rows = [row(name, MODELS[name]()) for name in track(names or list(MODELS), transient=True)]
    text = table(headings, rows)
    print(text)
    if page:
        put(PAGE, BEGIN, END, text)


if __name__ == "__main__":
    typer.run(main)
