"""Rods that touch each other exactly, in C: what compilers take for stages of two rods, and for steps of more.

Printed are the bytes of C, the processor time of the compiler, and for stages the times of the equations and of their
Jacobian in C and in CasADi's virtual machine; for steps of two, three and four rods, each of which touches all others.

    python benchmarks/rods_in_c.py
"""

from __future__ import annotations

import os
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import casadi as ca
import numpy as np
from doc_tables import table

from cosserat_casadi import Model, build, export, load, scene_from_dict
from cosserat_casadi.codegen.motion_stage import equations_functions
from cosserat_casadi.compiling.compiler import compiled_texts, find_compiler
from cosserat_casadi.compiling.printed_files import external_sources
from cosserat_casadi.control import MotionStage, StageEquations, motion_stage

Result = TypeVar("Result")

RADIUS = 5e-3
"""m."""

STRETCHES = (2, 8)
"""Numbers of stretches of a rod in a stage."""

CALLS = 20
"""Number of calls whose mean time is printed."""


def rods(count: int, modes: int) -> Model:
    """Free rods that cross, one above the other, each with friction against all others."""
    material = {"youngs_modulus": 2e7, "poisson_ratio": 0.45, "density": 1100.0}
    section = {"shape": "circle", "radius": RADIUS}
    records: list[dict[str, Any]] = []
    for number in range(count):
        angle = np.pi * number / count
        tangent = np.array([np.cos(angle), np.sin(angle), 0.0])
        start = -0.15 * tangent + [0.0, 0.0, 0.02 * number]
        base = {"free": True, "position": start.tolist(), "tangent": tangent.tolist()}
        own = {"name": f"rod{number}", "length": 0.3, "strain": "kirchhoff", "material": material}
        records.append(own | {"section": section, "base": base})
    contact = {"exact": True, "friction": 0.3}
    tables = {"schema": 1, "accuracy": {"modes": modes, "nodes": 2 * modes + 2}, "rods": records}
    return build(scene_from_dict(tables | {"rod_contacts": [contact]}).with_motion_inputs(), moving=True)


def timed(compiled: Callable[[], Result]) -> tuple[Result, float]:
    """A result, and processor seconds of the compiler that makes it."""
    before = os.times()
    result = compiled()
    after = os.times()
    return result, after.children_user + after.children_system - before.children_user - before.children_system


def microseconds(function: ca.Function, arguments: list[Any]) -> float:
    """Mean processor time of a call."""
    function.call(arguments)
    start = time.process_time()
    for _ in range(CALLS):
        function.call(arguments)
    return (time.process_time() - start) / CALLS * 1e6


def times(equations: StageEquations, stage: MotionStage) -> list[float]:
    """Times of the equations of a stage and of their Jacobian, µs."""
    random = np.random.default_rng(0)
    function = equations.function
    inputs, smoothing = stage.model.pack(), [1e-2]
    state, unknowns = (0.05 * random.normal(size=size) for size in (stage.state_size, stage.unknowns_size))
    at = [ca.DM(each) for each in (state, unknowns, inputs, smoothing, 0.0 * inputs)]
    output = ca.DM(*function.size_out(0))
    return [microseconds(function, at), microseconds(function.jacobian(), [*at, output])]


def stage_row(stretches: int) -> tuple[str, ...]:
    """Facts of the stage of two free rods."""
    stage = motion_stage(rods(2, 2), 1e-3, sections=stretches)
    texts: dict[str, str] = {}
    for function in equations_functions(stage, "equations", curvature=False):
        texts |= external_sources([function], function.name(), "long long int")
    library, seconds = timed(lambda: os.fspath(compiled_texts("rods", texts, find_compiler(None))))
    in_c = times(StageEquations(ca.external("equations", library)), stage)
    plain = times(stage.equations, stage)
    speeds = [f"{own:.0f} µs, {other:.0f} µs" for own, other in zip(in_c, plain, strict=True)]
    size = sum(map(len, texts.values()))
    return str(stretches), str(stage.unknowns_size), f"{size / 1e6:.2f} MB", f"{seconds:.0f} s", *speeds


def steps_row(count: int) -> tuple[str, ...]:
    """Facts of the exported steps of some free rods."""
    model = rods(count, 1)
    with tempfile.TemporaryDirectory() as folder:
        written = export(model, folder, "rods", dynamics=True)
        size = sum(file.stat().st_size for file in Path(folder).rglob("*") if file.suffix in (".c", ".h"))
        _, seconds = timed(lambda: load(written))
    return str(count), str(count * (count - 1) // 2), str(model.size), f"{size / 1e6:.2f} MB", f"{seconds:.0f} s"


def main() -> None:
    """Print both tables."""
    with tempfile.TemporaryDirectory() as folder:
        # A cache of its own: what was compiled before is compiled again.
        os.environ["COSSERAT_CASADI_CACHE"] = folder
        headings = ("stretches", "unknowns", "C", "compiler", "equations in C, CasADi", "Jacobian in C, CasADi")
        print(table(headings, [stage_row(stretches) for stretches in STRETCHES]))
        print()
        steps = [steps_row(count) for count in (2, 3, 4)]
        print(table(("rods", "pairs", "unknowns", "C of steps", "compiler"), steps))


if __name__ == "__main__":
    main()
