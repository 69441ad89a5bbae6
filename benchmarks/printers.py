"""What the printers of C are worth: functions of matrices by them and by CasADi's own code generator.

`gcc -O2`, one core, best of many runs. `--write` puts the table into docs/theory.md.
"""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import Annotated

import casadi as ca
import typer
from doc_tables import put, table
from growth import PUSH, WEIGHT, model_of
from loops import Compiled, compiled, compiled_sources

from cosserat_casadi import Model, build, discretise, read_scene
from cosserat_casadi.maths.calls import with_dense_results

ROOT = Path(__file__).parents[1]
BEGIN, END = "<!-- printers: written by benchmarks/printers.py -->", "<!-- end of printers -->"
HEADINGS = ("function", "this package, µs", "CasADi's C, µs", "this package, kB", "CasADi's C, kB")


def robot() -> Model:
    """The robot of two sections."""
    scene = read_scene(ROOT / "examples" / "two_section_robot.toml")
    return build(scene, discretise(scene, 4, 8))


def functions() -> dict[str, ca.Function]:
    """The functions by what they are."""
    slender = model_of("kirchhoff", 0.5e-3, [PUSH, WEIGHT], 4, 8)
    fine = model_of("kirchhoff", 0.5e-3, [PUSH, WEIGHT], 10, 40)
    return {
        "Kirchhoff rod, 12 unknowns: inverse dynamics": slender.inverse_dynamics,
        "the same: stiffness, damping and mass": slender.dynamics_jacobian,
        "two-section robot: stiffness, damping and mass": robot().dynamics_jacobian,
        "Kirchhoff rod, 10 modes, 40 intervals: residual": fine.residual,
        "the same: Jacobian": fine.path_jacobian,
    }


def by_casadi(function: ca.Function) -> Compiled:
    """A function called ``timed`` by CasADi's code generator."""
    with tempfile.TemporaryDirectory() as folder:
        generator = ca.CodeGenerator("timed.c", {"with_header": True, "casadi_int": "int"})
        generator.add(function)
        generator.generate(f"{folder}/")
        return compiled_sources({file.name: file.read_text() for file in Path(folder).iterdir()})


def row(words: str, function: ca.Function) -> list[str]:
    """A row of the table."""
    here = compiled(with_dense_results(function, "timed"))
    there = by_casadi(with_dense_results(function, "timed"))
    sizes = [f"{one.kilobytes:.0f}" for one in (here, there)]
    return [words, *(f"{one.us:.3g}" for one in (here, there)), *sizes]


def main(write: Annotated[bool, typer.Option("--write", help="Put the table into docs.")] = False) -> None:
    """Print the table."""
    text = table(HEADINGS, [row(words, function) for words, function in functions().items()])
    print(text)
    if write:
        put(ROOT / "docs" / "theory.md", BEGIN, END, text)


if __name__ == "__main__":
    typer.run(main)
