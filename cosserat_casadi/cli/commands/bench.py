"""``cosserat bench``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from cosserat_casadi.bench.grid import METHODS
from cosserat_casadi.bench.plan import make_plan, run_plan
from cosserat_casadi.bench.record import CSV, JSON
from cosserat_casadi.cli.options import SceneFile, Settings, check_inputs_stay
from cosserat_casadi.cli.progress import count_reporter, progress_bar
from cosserat_casadi.cli.signals import StoppedError
from cosserat_casadi.scene import read_scene


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
    with progress_bar() as bar:
        interrupted = run_plan(plan, Console(), count_reporter(bar, "Finding the reference"))
    if interrupted:
        raise StoppedError
