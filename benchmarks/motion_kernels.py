"""What the equations of motion cost in C: inverse dynamics, and stiffness, damping and mass together.

    python benchmarks/motion_kernels.py [NAME …]

Operations, kilobytes of C and microseconds of a call, `gcc -O2`, best of many runs on one core. Of an assembly the
time is the sum over its parts, and the kilobytes hold the constants of the parts.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated

import casadi as ca
import typer
from growth import PUSH
from loops import compiled
from rich.progress import track

from cosserat_casadi import Model, build, discretise, read_scene, scene_from_dict
from cosserat_casadi.codegen.motion_parts import motion_in_c
from cosserat_casadi.codegen.names import model_names
from cosserat_casadi.codegen.parts import Parted
from cosserat_casadi.compiling.printed_files import external_sources

EXAMPLES = Path(__file__).parents[1] / "examples"
MATERIAL = {"youngs_modulus": 60e9, "poisson_ratio": 0.33, "density": 6450.0}


def rod(strain: str, modes: int | list[int], nodes: int) -> Model:
    """One rod with a tip force."""
    record = {"name": "rod", "length": 0.2, "strain": strain, "material": MATERIAL}
    record["section"] = {"shape": "circle", "radius": 0.5e-3}
    scene = scene_from_dict({"schema": 1, "rods": [record], "loads": [PUSH]})
    return build(scene, discretise(scene, modes, nodes, "magnus4"), moving=True)


def example(file: str, modes: tuple[int, ...], nodes: int) -> Model:
    """An example with a discretisation of its tolerance, not searched for anew."""
    scene = read_scene(EXAMPLES / file)
    chosen = discretise(scene, None, nodes, "magnus4")
    return build(scene, {name: replace(of_rod, modes=modes) for name, of_rod in chosen.items()}, moving=True)


MODELS = {
    "Kirchhoff, 8 unknowns": lambda: rod("kirchhoff", [3, 3, 2], 8),
    "Kirchhoff, 12 unknowns": lambda: rod("kirchhoff", 4, 8),
    "Kirchhoff, 12 unknowns, 10 intervals": lambda: rod("kirchhoff", 4, 10),
    "Reissner, 12 unknowns": lambda: rod("reissner", 2, 8),
    "two-section robot": lambda: example("two_section_robot.toml", (4, 4, 2), 6),
    "six-rod platform": lambda: example("six_rod_platform.toml", (6, 6, 1, 1, 1, 1), 10),
}


@dataclass(frozen=True)
class Cost:
    """Kilobytes of C and microseconds."""

    kilobytes: float
    us: float


def cost(split: Parted) -> Cost:
    """What the parts of a function cost."""
    calls = [sum(part.kernel == number for part in split.parts) for number in range(len(split.kernels))]
    us = sum(count * compiled(named(kernel)).us for count, kernel in zip(calls, split.kernels, strict=True))
    code = len(external_sources(split.kernels, "motion", "int")["motion.c"])
    constants = sum(len(str(part.constants)) for part in split.parts)
    return Cost((code + constants) / 1000, us)


def named(kernel: ca.Function) -> ca.Function:
    """A kernel under the name that the timer calls."""
    symbols = kernel.sx_in() if kernel.is_a("SXFunction") else kernel.mx_in()
    return ca.Function("timed", symbols, kernel.call(symbols, True, False))


def equations(model: Model) -> tuple[Parted, Parted]:
    """Inverse dynamics and the motion's Jacobian in parts, as an exported folder has them."""
    motion = motion_in_c(model, model_names("moving", model, dynamics=True))
    return motion.residual, motion.matrices


def main(names: Annotated[list[str] | None, typer.Argument(help="Models; all by default.")] = None) -> None:
    """Print the table."""
    headings = ("", "unknowns", "inverse dynamics, operations", "kB", "µs", "Jacobian, operations", "kB", "µs")
    print(f"| {' | '.join(headings)} |")
    print("|---" * len(headings) + "|")
    for name in track(names or list(MODELS), transient=True):
        model = MODELS[name]()
        cells = [name, str(model.size)]
        functions = (model.inverse_dynamics, model.dynamics_jacobian)
        for function, split in zip(functions, equations(model), strict=True):
            found = cost(split)
            cells += [f"{model.operations(function):,}", f"{found.kilobytes:.0f}", f"{found.us:.1f}"]
        print(f"| {' | '.join(cells)} |")


if __name__ == "__main__":
    typer.run(main)
