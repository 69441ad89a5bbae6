"""What a row of a sweep costs in C on one core: processor time of the compiled function for rows, best of several.

Where memory happens to lie changes the time of a process by up to a third: every case is run in several processes.
*Without vectors* is the same C, row after row, compiled with FOURS_ONE_BY_ONE. Left out is all around it: reading and
writing tables, choosing the discretisation, generating and compiling.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer
from doc_tables import put, table

from cosserat_casadi import Model, build, read_scene, scene_from_dict
from cosserat_casadi.codegen.rows import RowLibrary, row_library
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.scene.writing import scene_tables

PAGE = Path("docs/sweeps.md")
BEGIN, END = "<!-- rows: written by benchmarks/row_cost.py -->", "<!-- end of rows -->"

ROWS = 4000
REPEATS = 7

PROCESSES = 4
SPREAD = 0.1
"""Relative width of what parameters are drawn from."""

FIXED = ["accuracy.modes=[6,5,1]", "accuracy.nodes=8", 'accuracy.rotation="magnus6"']
"""What a tolerance of 1e-6 picks for the wire at its own loads: 12 unknowns."""

TENDON = {"name": "east", "kind": "tendon", "rod": "wire", "tension": 0.5, "offset": [1.5e-3, 0.0]}
NUMBERS = ["wire.section.radius", "wire.material.youngs_modulus", "wire.intrinsic.curvature.y", "east.offset.x"]


def wire(**changes: Any) -> Model:
    """The nitinol wire of the examples, whose push is free."""
    tables = scene_tables(read_scene("examples/nitinol_wire.toml", FIXED))
    return build(scene_from_dict({**tables, "inputs": ["push.force"], **changes}))


def robot() -> Model:
    """The robot of two sections of the examples, on fixed modes and nodes."""
    return build(read_scene("examples/two_section_robot.toml", ["accuracy.modes=4", "accuracy.nodes=8"]))


def curved(**changes: Any) -> Model:
    """The wire with a tendon and a little pre-curvature."""
    rod = scene_tables(read_scene("examples/nitinol_wire.toml", FIXED))["rods"][0]
    return wire(rods=[{**rod, "intrinsic": {"curvature": [0.0, 0.5, 0.0]}}], actuators=[TENDON], **changes)


def drawn_inputs(model: Model) -> FloatArray:
    """Rows of inputs about those of the scene; tensions stay tensions."""
    rng = np.random.default_rng(1)
    own = model.pack()
    return own * rng.uniform(0.5, 1.5, (ROWS, len(own)))


def drawn_parameters(model: Model) -> FloatArray:
    """Rows of parameters about those of the scene."""
    rng = np.random.default_rng(2)
    own = model.parameters.pack()
    return own * rng.uniform(1 - SPREAD, 1 + SPREAD, (ROWS, len(own)))


def microseconds(model: Model, library: RowLibrary) -> float:
    """Processor time of a row."""
    given = drawn_inputs(model)
    if model.parameters.size:
        given = np.hstack([given, drawn_parameters(model)])
    results = library.solve(given)
    assert np.all(results[:, 0] == 0), "a row has no equilibrium"
    best = np.inf
    for _ in range(REPEATS):
        began = time.process_time()
        library.solve(given)
        best = min(best, time.process_time() - began)
    return 1e6 * best / ROWS


CASES: tuple[tuple[str, Callable[[], Model], dict[str, bool]], ...] = (
    ("nitinol wire, three forces", wire, {}),
    ("… with the error of every row", wire, {"estimate_errors": True}),
    ("… with `--stability`", wire, {"stability": True}),
    ("… rows side by side", wire, {"lanes": True}),
    ("with a tendon and pre-curvature", curved, {}),
    ("… radius, modulus, pre-curvature, offset as parameters", lambda: curved(parameters=NUMBERS), {}),
    ("… and rows side by side", lambda: curved(parameters=NUMBERS), {"lanes": True}),
    ("robot of two sections, tensions", robot, {}),
    ("… with the error of every row", robot, {"estimate_errors": True}),
    ("… rows side by side", robot, {"lanes": True}),
)


def without_vectors(library: RowLibrary) -> RowLibrary:
    """The same C, whose kernels compute one number after the other."""
    files = [
        (name, f"#define FOURS_ONE_BY_ONE\n{text}" if name.endswith(".c") else text) for name, text in library.files
    ]
    return replace(library, files=tuple(files))


def measure(index: int) -> tuple[int, float, float]:
    """Unknowns of a case, processor time of a row, and of one without vectors where the case is a plain one, µs."""
    _, model_of, chosen = CASES[index]
    model = model_of()
    plain = float("nan") if chosen else microseconds(model, without_vectors(row_library(model)))
    return model.size, microseconds(model, row_library(model, **chosen)), plain


HEADINGS = ("swept numbers", "unknowns", "µs a row", "rows a second of one core", "rows without vectors, µs", "×")


def main(
    write: Annotated[bool, typer.Option("--write", help="Put the table into docs/sweeps.md.")] = False,
) -> None:
    """Print what a row costs."""
    rows = []
    plain = 0.0
    with ProcessPoolExecutor(1, max_tasks_per_child=1) as processes:
        for index, (name, _, chosen) in enumerate(CASES):
            measured = list(processes.map(measure, [index] * PROCESSES))
            size, *_ = measured[0]
            spent = min(own for _, own, _ in measured)
            if not chosen:
                plain = min(own for _, _, own in measured)
            # Without vectors only the solve itself was timed.
            more = chosen.keys() - {"lanes"}
            cells = ["–", "–"] if more else [f"{plain:.1f}", f"{plain / spent:.1f}"]
            rows.append((name, str(size), f"{spent:.1f}", f"{1e6 / spent:,.0f}", *cells))
    text = table(HEADINGS, rows)
    print(text)
    if write:
        put(PAGE, BEGIN, END, text)


if __name__ == "__main__":
    typer.run(main)
