"""Error against time: the work-precision curve of a scene.

Usage: ``python benchmarks/bench.py SCENE [--output FOLDER] [--methods LIST] [--points N] [--quick] [--set KEY=VALUE]``.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))


from work_precision.grid import METHODS
from work_precision.plan import make_plan, run_plan
from work_precision.record import CSV, JSON

from cosserat_casadi.cli.exit_codes import NOT_FOUND
from cosserat_casadi.cli.main import run
from cosserat_casadi.cli.options import SceneFile, Settings, check_inputs_stay
from cosserat_casadi.cli.progress import count_display
from cosserat_casadi.cli.signals import StoppedError
from cosserat_casadi.scene import read_scene
from tests.fine_reference import NoReferenceError


def bench(
    scene: SceneFile,
    output: Annotated[
        Path | None, typer.Option(help="Folder for bench.csv, bench.json and the figure; what it holds is not redone.")
    ] = None,
    methods: Annotated[
        str | None, typer.Option(help=f"Methods, separated by commas, out of {', '.join(METHODS)}; all by default.")
    ] = None,
    points: Annotated[int | None, typer.Option(help="Most points for each method.")] = None,
    quick: Annotated[bool, typer.Option("--quick", help="A coarse grid without the literal system.")] = False,
    settings: Settings = None,
) -> None:
    """Measure error against time: the work-precision curve of a scene.

    Errors are against a far finer discretisation, solved in the same run. Exit codes: 0 measured, 2 refused,
    3 no reference found, 130 interrupted; bench.csv has the points that were measured until then.
    """
    if output is not None:
        check_inputs_stay({"--output": output / CSV, "the record of --output": output / JSON}, scene, settings)
    plan = make_plan(read_scene(scene, tuple(settings or ())), output, methods, points, quick)
    try:
        with count_display("Finding the reference") as show_count:
            interrupted = run_plan(plan, Console(), show_count)
    except NoReferenceError as error:
        Console(stderr=True).print(str(error))
        raise typer.Exit(NOT_FOUND) from error
    if interrupted:
        raise StoppedError


if __name__ == "__main__":
    app = typer.Typer(pretty_exceptions_show_locals=False)
    app.command()(bench)
    sys.exit(run(app))
