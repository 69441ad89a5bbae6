"""What steps of a motion cost in C: instructions of the kernels, and µs, best of many, on one core."""

from __future__ import annotations

import json
import re
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.table import Table

from cosserat_casadi import Discretisation, Model, build, discretise, export, read_scene, scene_from_dict

ROOT = Path(__file__).parents[1]
FLAGS = ("-O2", "-std=c99")

ROD = {
    "name": "rod",
    "length": 0.8,
    "strain": "kirchhoff",
    "material": {"youngs_modulus": 8e6, "shear_modulus": 3e6, "density": 716.0},
    "section": {"shape": "circle", "radius": 0.02},
    "damping": {"retardation_time": 0.01},
}
LOADS = [
    {"name": "push", "kind": "tip_wrench", "rod": "rod", "force": [0.9, 0.5, -0.4]},
    {"name": "weight", "kind": "gravity", "acceleration": [0.3, -0.2, -2.0]},
]

KERNELS = {"inverse_dynamics": "motion_residual", "matrices": "motion_matrices"}
"""Kernels whose instructions are printed."""


def rod() -> Model:
    """A Kirchhoff rod of 12 unknowns."""
    scene = scene_from_dict({"schema": 1, "rods": [ROD], "loads": LOADS, "inputs": ["push.force"]})
    return build(scene, discretise(scene, 4, 10), moving=True)


def platform() -> Model:
    """The six-rod platform on the discretisation of its exported folder."""
    kept = json.loads((ROOT / "generated" / "six_rod_platform" / "manifest.json").read_text())["discretisation"]
    chosen = {
        name: Discretisation(**{**found, "modes": tuple(found["modes"]), "breaks": tuple(found["breaks"])})
        for name, found in kept.items()
    }
    scene = read_scene(ROOT / "generated" / "six_rod_platform" / "scene.toml")
    return build(scene, chosen, moving=True)


MODELS = {"kirchhoff": rod, "platform": platform}


def measured(name: str, model: Model, repeat: int, dt: float) -> tuple[dict[str, Any], dict[str, int]]:
    """Times of tasks, and instructions of kernels."""
    with tempfile.TemporaryDirectory() as scratch:
        folder = export(model, Path(scratch) / name, name, dynamics=True)
        described = json.loads((folder / "manifest.json").read_text())
        harness = Path(scratch) / "harness.c"
        words = {"name": name, "MACRO": name.upper()}
        text = (ROOT / "benchmarks" / "motion_step.c").read_text()
        harness.write_text(re.sub(r"@\{(\w+)\}", lambda match: words[match[1]], text))
        sources = [str(harness), f"{name}.c", f"{name}_kernels.c"]
        subprocess.run(["gcc", *FLAGS, "-I.", *sources, "-o", "harness", "-lm"], cwd=folder, check=True)
        command = ["./harness", str(repeat), repr(dt)]
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=True)
    counts = dict.fromkeys(KERNELS, 0)
    for task, kernel in KERNELS.items():
        for function in described["functions"]:
            if f"_k_{kernel}" in function["name"]:
                counts[task] += function["instructions"]
    times: dict[str, Any] = json.loads(done.stdout)
    return times, counts


def main() -> None:
    """Print a table for each model that is named, or for all."""
    for name in sys.argv[1:] or MODELS:
        model = MODELS[name]()
        times, counts = measured(name, model, 50, 1e-3)
        table = Table(title=f"{name}: {model.size} unknowns, steps of 1 ms")
        for heading in ("task", "µs", "instructions of its kernels", "iterations", "Jacobians"):
            table.add_column(heading, justify="left" if heading == "task" else "right")
        for task, found in times.items():
            instructions = f"{counts[task]:,}" if task in counts else ""
            counted = [f"{found[key]:.2f}" if key in found else "" for key in ("iterations", "jacobians")]
            table.add_row(task.replace("_", " "), f"{found['us']:.2f}", instructions, *counted)
        Console().print(table)


if __name__ == "__main__":
    main()
