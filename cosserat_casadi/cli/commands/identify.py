"""``cosserat identify``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from cosserat_casadi import identification
from cosserat_casadi.cli.exit_codes import NOT_FOUND
from cosserat_casadi.cli.options import SceneFile, Settings, check_files, read_checked
from cosserat_casadi.cli.progress import solve_display
from cosserat_casadi.cli.reports.format import print_warnings
from cosserat_casadi.cli.reports.identification import print_identification, print_refused_scene
from cosserat_casadi.cli.terminal import Console
from cosserat_casadi.errors import Problem, SceneError
from cosserat_casadi.files import write_atomically
from cosserat_casadi.identification.fitted_scene import beside
from cosserat_casadi.results.presentation import write_all
from cosserat_casadi.scene.unknown_records import MOST_STARTS
from cosserat_casadi.scene.writing import scene_text

ENDED_EARLY = "The numbers are those at which the search ended."
"""The warning in a scene that is written after a failed identification."""


def identify(
    scene: SceneFile,
    settings: Settings = None,
    output: Annotated[Path | None, typer.Option(help="Write the result (JSON) here.")] = None,
    plot: Annotated[
        Path | None, typer.Option(help="Draw measurements, residuals and ellipses here: .png, .pdf or .svg.")
    ] = None,
    hold_out: Annotated[
        float | None, typer.Option(metavar="SHARE", help="Share of the cases to predict and not to fit.")
    ] = None,
    starts: Annotated[int | None, typer.Option(metavar="N", help="Number of points to search from.")] = None,
    write: Annotated[Path | None, typer.Option(help="Write the scene with the fitted numbers (TOML) here.")] = None,
) -> None:
    """Find numbers of a scene from measurements, and say which stay open.

    Exit codes: 0 found, 2 refused, 3 not found, not determined by the data, or found and no scene with --write.
    """
    problems: list[Problem] = []
    check_files({"--output": output, "--plot": plot, "--write": write}, scene, settings, problems)
    if starts is not None and not 1 <= starts <= MOST_STARTS:
        problems.append(Problem("--starts", f"must be from 1 to {MOST_STARTS}, got {starts}"))
    if hold_out is not None and not 0.0 <= hold_out < 1.0:
        problems.append(Problem("--hold-out", f"must be >= 0 and < 1, got {hold_out:g}"))
    checked_scene = read_checked(scene, settings, problems)

    with solve_display("Identifying") as display:

        def show_step(step: int, cost: float) -> None:
            display.show_share(step / (step + 10))

        found = identification.identify(
            checked_scene, hold_out=hold_out, starts=starts, report=display.show_stage, progress=show_step
        )
    written = write_all(found, output, plot)
    refusal: SceneError | None = None
    if write is not None and (found.converged or found.ended_early):
        try:
            fitted = found.fitted_scene(checked_scene, early=True)
        except SceneError as error:
            refusal = error
        else:
            text = scene_text(beside(fitted, write.parent))
            if not found.converged:
                # A scene with the numbers of a failed search would look like an identified one.
                text = f"# {found.message} {ENDED_EARLY}\n\n{text}"
            write_atomically(write, text.encode())
            written.append(write)
    print_identification(Console(), found, written)
    print_warnings(Console(stderr=True), found.warnings)
    if refusal is not None:
        print_refused_scene(Console(stderr=True), refusal)
    if not found.converged or refusal is not None:
        raise typer.Exit(NOT_FOUND)
