"""What a row of a table of targets takes: inputs for places that the finger reaches, drawn over its tensions.

    python benchmarks/target_table.py [--rows 200] [--write]

Processor time of reading nothing and writing nothing: `inverse_rows` on tables of one row and of many, the first with
all that is built. `--write` puts the table into docs/control.md.
"""

from __future__ import annotations

import time
from pathlib import Path
from typing import Annotated

import numpy as np
import typer
from doc_tables import put, table
from rich.progress import track

from cosserat_casadi import Scene, build, discretise, read_scene, solve
from cosserat_casadi.control.inverse_accuracy import inverse_rows
from cosserat_casadi.scene.target_records import PositionTarget

ROOT = Path(__file__).parents[1]
PAGE = ROOT / "docs" / "control.md"
BEGIN, END = "<!-- rows: written by benchmarks/target_table.py -->", "<!-- end of rows -->"

LARGEST = 6.0
"""The largest tension that is drawn, N."""

MODES, NODES = 9, 16
"""On which the places are computed: more than the tolerance asks for, so that all of them are in reach."""


def reachable(scene: Scene, count: int) -> list[tuple[PositionTarget, ...]]:
    """Targets where the tip is under tensions drawn at random."""
    (target,) = scene.targets
    assert isinstance(target, PositionTarget)
    model = build(scene, discretise(scene, MODES, NODES))
    rng = np.random.default_rng(5)
    rows: list[tuple[PositionTarget, ...]] = []
    for _ in track(range(count), "places", transient=True):
        flexor, abductor = rng.uniform(0.0, LARGEST, 2)
        placed = solve(model, {"flexor.tension": flexor, "abductor.tension": abductor})
        if not placed.converged:
            raise RuntimeError(placed.message)
        rows.append((target.model_copy(update={"position": tuple(placed.tip().position)}),))
    return rows


def main(
    rows: Annotated[int, typer.Option(help="Rows of the longer table.")] = 200,
    write: Annotated[bool, typer.Option("--write", help="Put the table into docs/control.md.")] = False,
) -> None:
    """Print what a row takes."""
    scene = read_scene(ROOT / "examples" / "finger_to_point.toml")
    every = reachable(scene, rows)
    cells = []
    for count in (1, rows):
        begin = time.process_time()
        found = inverse_rows(scene, every[:count])
        took = time.process_time() - begin
        met = sum(row.met for row in found)
        by_newton = sum(row.rounds == 0 for row in found)
        cells.append([str(count), str(met), str(by_newton), f"{took:.1f}", f"{1e3 * took / count:.0f}"])
    text = table(["rows", "met", "by Newton's method alone", "processor, s", "ms a row"], cells)
    print(text)
    if write:
        put(PAGE, BEGIN, END, text)


if __name__ == "__main__":
    typer.run(main)
