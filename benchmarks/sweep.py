"""How many rows a second a sweep solves: a spatial rod of 12 unknowns, on one core and on two, results written.

Left out is what does not grow with the rows: a second to generate the library and ten to compile it, the choice of the
discretisation before and the check of six rows after, some seconds each. A machine that does other work meanwhile gives
less by the clock; rows a second of processor time say what a core does.
"""

from __future__ import annotations

import argparse
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path
from unittest.mock import patch

import numpy as np
from rich.console import Console
from rich.table import Table

from cosserat_casadi import read_scene
from cosserat_casadi.codegen.rows import row_library
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import build
from cosserat_casadi.scene import Scene
from cosserat_casadi.sweeps import run
from cosserat_casadi.sweeps.run import plan_sweep, run_sweep
from cosserat_casadi.sweeps.table import table_of
from cosserat_casadi.sweeps.variants import variants_of

SCENE = Path(__file__).parents[1] / "examples" / "nitinol_wire.toml"
DISCRETISATION = ["accuracy.modes=[6,5,1]", "accuracy.nodes=8", 'accuracy.rotation="magnus6"']
"""What a tolerance of 1e-6 picks at the scene's own loads: 12 unknowns."""


@dataclass(frozen=True)
class Rate:
    """Rows a second by the clock, and a second of processor time."""

    clock: float
    processor: float


def pushes(count: int) -> dict[str, FloatArray]:
    """Pushes in all directions, N."""
    rng = np.random.default_rng(1)
    return {f"push.force.{axis}": rng.uniform(-0.25, 0.25, count) for axis in "xyz"}


def rate(scene: Scene, count: int, cores: int, suffix: str, repeats: int, *, errors: bool) -> Rate:
    """Best of several sweeps from the table to the file."""
    best = Rate(0.0, 0.0)
    for _ in range(repeats):
        with tempfile.TemporaryDirectory() as folder:
            output = Path(folder) / f"rows{suffix}"
            plan = plan_sweep(scene, table_of(pushes(count)), output, estimate_errors=errors)
            clock, processor = time.perf_counter(), time.process_time()
            found = run_sweep(plan, cores=cores)
            clock, processor = time.perf_counter() - clock, time.process_time() - processor
        if not found.converged.all():
            raise RuntimeError(f"outcomes {found.counts}")
        best = Rate(max(best.clock, count / clock), max(best.processor, count / processor))
    return best


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rows", type=int, default=100_000)
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--lanes", action="store_true", help="several rows side by side, as sweeps of many rows do")
    parser.add_argument("--errors", action="store_true", help="with the estimated error of every row")
    options = parser.parse_args()
    scene = read_scene(SCENE, DISCRETISATION)
    swept = variants_of(scene, table_of(pushes(1))).entries[0].scene
    library = row_library(build(swept), estimate_errors=options.errors, lanes=options.lanes)
    patch.object(run, "row_library", lambda model, **chosen: library).start()
    patch.object(run, "check", lambda *given: []).start()
    rate(scene, 1000, 1, ".csv", 1, errors=options.errors)
    table = Table(title=f"{options.rows:,} rows of a rod of {build(swept).size} unknowns, best of {options.repeats}")
    for heading in ("file", "cores", "rows a second", "beside one core", "rows a second of processor time"):
        table.add_column(heading, justify="left" if heading == "file" else "right")
    for suffix in (".csv", ".parquet"):
        one, two = (
            rate(scene, options.rows, cores, suffix, options.repeats, errors=options.errors) for cores in (1, 2)
        )
        for cores, found in ((1, one), (2, two)):
            ratio = f"{found.clock / one.clock:.2f}"
            table.add_row(suffix, str(cores), f"{found.clock:,.0f}", ratio, f"{found.processor:,.0f}")
    Console().print(table)


if __name__ == "__main__":
    main()
