"""``cosserat export``."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from cosserat_casadi.cli.commands.solving import solve_with_progress
from cosserat_casadi.cli.exit_codes import NOT_FOUND
from cosserat_casadi.cli.options import SceneFile, Settings
from cosserat_casadi.cli.reports.model import print_export
from cosserat_casadi.codegen.export import check_export
from cosserat_casadi.codegen.export import export as export_model
from cosserat_casadi.codegen.motion_parts import check_motion
from cosserat_casadi.codegen.names import scene_names
from cosserat_casadi.codegen.parameters import refuse_parameters
from cosserat_casadi.model.build import build
from cosserat_casadi.model.discretise import discretise
from cosserat_casadi.scene import read_scene


def export(
    scene: SceneFile,
    output: Annotated[Path, typer.Option(help="Folder to write: new, empty, or of an earlier export.")],
    name: Annotated[str | None, typer.Option(help="What every C symbol begins with; else the scene file's.")] = None,
    derivatives: Annotated[
        bool, typer.Option("--derivatives", help="With second derivatives, for CasADi: no controller needs them.")
    ] = False,
    dynamics: Annotated[
        bool, typer.Option("--dynamics", help="With motions: a step of fixed length with its derivatives.")
    ] = False,
    settings: Settings = None,
) -> None:
    """Write a scene as C sources: equations, Jacobians, solver. Exit codes: 0 written, 2 refused, 3 not solved.

    Modes and nodes are chosen so that the tolerance is met at the scene's own loads, unless the scene fixes them.
    """
    if name is None:
        name = re.sub(r"\W", "_", scene.stem)
    # All that can be refused is refused before the solve, which may take a minute.
    check_export(output, name)
    exported_scene = read_scene(scene, tuple(settings or ()))
    refuse_parameters(exported_scene)
    if dynamics:
        exported_scene = exported_scene.with_motion_inputs()
        check_motion(build(exported_scene, discretise(exported_scene, 1, 2), moving=True))
    scene_names(name, exported_scene)

    # Bases that are free in a motion are held where the scene puts them: without that there is no equilibrium.
    solution = solve_with_progress(exported_scene.held() if dynamics else exported_scene)
    if not solution.converged:
        Console(stderr=True).print(f"[bold red]Nothing was written.[/] {solution.message}", highlight=False)
        raise typer.Exit(NOT_FOUND)
    model = solution.model
    if dynamics:
        model = build(exported_scene, model.discretisation, moving=True)
    # The folder keeps the estimate, which is for these inputs; tune gives one for a range of them.
    export_model(
        model, output, name, error_estimate=solution.error_estimate, derivatives=derivatives, dynamics=dynamics
    )
    print_export(Console(), solution, output)
