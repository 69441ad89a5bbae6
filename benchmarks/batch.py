"""What a load case takes in ``NAME_solve_batch`` of exported folders, on one core: processor time, best of several.

Cases are drawn about the scene's own inputs. *Without vectors* is the same C compiled with -DFOURS_ONE_BY_ONE.
"""

from __future__ import annotations

import ctypes
import tempfile
import time
from pathlib import Path
from typing import Annotated

import numpy as np
import typer
from doc_tables import put, table
from row_cost import drawn_inputs, robot, wire

from cosserat_casadi import Model, build, export, read_scene
from cosserat_casadi.codegen.compiled_results import AnswerInfo
from cosserat_casadi.codegen.load import load
from cosserat_casadi.codegen.loaded_library import room
from cosserat_casadi.codegen.plain import pointer
from cosserat_casadi.compiling import compiler

PAGE = Path("docs/c-interface.md")
BEGIN, END = "<!-- batches: written by benchmarks/batch.py -->", "<!-- end of batches -->"

CASES = 2000
REPEATS = 7

LEANS = [
    'rod.strain="planar"',
    "rod.stiffness={bending_y=0.5}",
    "bar.to=[0.4,0.5,-0.12]",
    "bar.width=0.04",
    "accuracy.modes=4",
    "accuracy.nodes=8",
]
"""What makes the rod over a bar planar, and its contact smooth."""


def leaning() -> Model:
    """A planar rod that is pushed over a bar with a width."""
    return build(read_scene("examples/rod_over_bar.toml", LEANS))


SCENES = (
    ("nitinol wire, three forces", wire),
    ("robot of two sections, tensions", robot),
    ("planar rod over a bar with a width, three forces", leaning),
)


def microseconds(model: Model, *, batches: bool) -> float:
    """Processor time of a case."""
    inputs = drawn_inputs(model)[:CASES]
    x = np.zeros((CASES, model.size))
    infos = (AnswerInfo * CASES)()
    with tempfile.TemporaryDirectory() as folder:
        library = ctypes.CDLL(
            str(load(export(model, Path(folder) / "batch", "batch", batches=batches, estimate_errors=False)).library)
        )
    size = library.batch_batch_workspace_size() if batches else library.batch_workspace_size()
    work = room(size)
    best = np.inf
    for _ in range(REPEATS):
        began = time.process_time()
        converged = library.batch_solve_batch(CASES, pointer(inputs), pointer(x), work, 1, infos)
        best = min(best, time.process_time() - began)
        assert converged == CASES, "a case has no equilibrium"
    return 1e6 * best / CASES


def main(
    write: Annotated[bool, typer.Option("--write", help="Put the table into docs/c-interface.md.")] = False,
) -> None:
    """Print what a case takes."""
    flags = compiler.FLAGS
    rows: list[tuple[str, ...]] = []
    for name, model_of in SCENES:
        model = model_of()
        apart = microseconds(model, batches=False)
        together = microseconds(model, batches=True)
        compiler.FLAGS = (*flags, "-DFOURS_ONE_BY_ONE")
        plain = microseconds(model, batches=False)
        compiler.FLAGS = flags
        cells = [f"{value:.1f}" for value in (together, apart, plain, apart / together, plain / together)]
        rows.append((name, str(model.size), *cells))
    headings = (
        "scene", "unknowns", "`--batches`, µs a case", "without it", "without vectors", "gain", "gain over no vectors",
    )  # fmt: skip
    text = table(headings, rows)
    print(text)
    if write:
        put(PAGE, BEGIN, END, text)


if __name__ == "__main__":
    typer.run(main)
