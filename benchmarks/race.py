"""The exported C raced against shooting solvers written by hand, at equal tip error, in one run.

For every steel rod and error: the scene is exported at that tolerance, compiled with the flags that the hand-written
programs get, and solved from cold. `--write` puts the table into the README.
"""

from __future__ import annotations

import json
import subprocess
import tempfile
import time
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.progress import Progress
from shooting_reference import CASES, Case, race, steps_for

from cosserat_casadi import Model, build, export, scene_from_dict, solve_scene

README = Path(__file__).parents[1] / "README.md"
BEGIN, END = "<!-- race: written by benchmarks/race.py -->", "<!-- end of race -->"
ERRORS = (1e-5, 1e-8, 1e-11)
FLAGS = ("-O2", "-std=c99")


@dataclass(frozen=True)
class Exported:
    """A model as a compiled demo program, and what it measured of itself.

    Attributes:
        kilobytes: size of the sources that a controller compiles.
        compile_s: time that gcc -O2 took for them.
        error: distance of the tip from the true one, relative to length.
        times: cold_us, warm_us, igm_us, jacobian_us.
    """

    kilobytes: float
    compile_s: float
    error: float
    times: dict[str, float]


def scene_of(case: Case, tolerance: float) -> dict[str, Any]:
    """The case as the tables of a scene file."""
    stiffness = {
        "bending_x": case.bending,
        "bending_y": case.bending,
        "torsion": case.torsion,
    }
    if case.kind == "reissner":
        stiffness |= {"shear_x": case.shear, "shear_y": case.shear, "extension": case.extension}
    rod = {"name": "rod", "length": case.length, "strain": case.kind, "stiffness": stiffness}
    load = {"name": "tip", "kind": "tip_wrench", "rod": "rod", "force": list(case.force), "moment": list(case.moment)}
    return {"schema": 1, "accuracy": {"tolerance": tolerance}, "rods": [rod], "loads": [load]}


def model_of(case: Case, error: float) -> Model:
    """The cheapest model within the error, as the dial finds it."""
    solution = solve_scene(scene_from_dict(scene_of(case, error)))
    if not solution.converged:
        raise RuntimeError(solution.message)
    return solution.model


def measured(model: Model, case: Case, repeat: int = 2000) -> Exported:
    """Export, compile and run a model."""
    with tempfile.TemporaryDirectory() as name:
        folder = export(model, Path(name) / "raced")
        sources = ["raced_demo.c", "raced.c", "raced_kernels.c"]
        start = time.perf_counter()
        subprocess.run(["gcc", *FLAGS, *sources, "-lm", "-o", "demo"], cwd=folder, check=True)
        took = time.perf_counter() - start
        command = ["./demo", "--repeat", str(repeat)]
        found = json.loads(subprocess.run(command, cwd=folder, capture_output=True, text=True, check=True).stdout)
        size = sum((folder / source).stat().st_size for source in sources[1:]) / 1000
    times = {key: value for key, value in found.items() if key.endswith("_us")}
    return Exported(size, took, case.tip_error(tuple(found["tip"])), times)


def literal(model: Model) -> Model:
    """The same modes and nodes with the rotation from the literal linear system."""
    chosen = {name: replace(d, transport="permuted") for name, d in model.discretisation.items()}
    return build(model.scene, chosen)


def row_of(name: str, case: Case, error: float) -> list[str]:
    model = model_of(case, error)
    ours = measured(model, case)
    cells = [
        name,
        f"{error:.0e}",
        str(model.size),
        f"{ours.error:.0e}",
        f"{ours.kilobytes:.0f}",
        f"{ours.compile_s:.1f}",
    ]
    cells += [f"{ours.times[key]:.1f}" for key in ("igm_us", "jacobian_us", "warm_us", "cold_us")]
    for program in ("plain", "tuned"):
        theirs = race(case, steps_for(case, error, program), repeat=2000, program=program)["cold_us"]
        cells.append(f"{theirs:.0f} ({theirs / ours.times['cold_us']:.1f} ×)")
    return cells


HEADINGS = (
    "rod", "error / L", "unknowns", "reached", "C, kB", "gcc, s", "IGM", "residual + Jacobian", "warm", "cold",
    "plain shooting", "tuned shooting",
)  # fmt: skip


def markdown(rows: list[list[str]]) -> str:
    lines = [HEADINGS, ("---",) * len(HEADINGS), *rows]
    return "\n".join(f"| {' | '.join(cells)} |" for cells in lines)


def literal_line(case: Case) -> str:
    model = model_of(case, 1e-8)
    ours, theirs = measured(model, case).times, measured(literal(model), case, repeat=20).times
    cold, jacobian = (theirs[key] / ours[key] for key in ("cold_us", "jacobian_us"))
    return (
        "The literal permuted system with the same modes and nodes (B1 Kirchhoff at 1e-8): "
        f"{theirs['cold_us']:.0f} µs cold, {cold:.0f} × as long; residual and Jacobian {theirs['jacobian_us']:.0f} µs, "
        f"{jacobian:.0f} × as long."
    )


def main(
    write: Annotated[bool, typer.Option("--write", help="Put the table into README.md.")] = False,
    only: Annotated[str, typer.Option(help="Rods whose name begins so.")] = "",
) -> None:
    """Print the table of the race."""
    cases = {name: case for name, case in CASES.items() if name.startswith(only)}
    jobs = [(name, case, error) for name, case in cases.items() for error in ERRORS]
    rows = []
    with Progress(transient=True) as bar:
        for name, case, error in bar.track(jobs, description="racing"):
            rows.append(row_of(name, case, error))
    text = markdown(rows) + "\n\n" + literal_line(CASES["B1 Kirchhoff"])
    print(text)
    if write:
        readme = README.read_text()
        before, rest = readme.split(BEGIN)
        README.write_text(before + BEGIN + "\n" + text + "\n" + END + rest.split(END)[1])


if __name__ == "__main__":
    typer.run(main)
