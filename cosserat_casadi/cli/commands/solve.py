"""``cosserat solve``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from cosserat_casadi.accuracy.refine import solve as solve_scene
from cosserat_casadi.cli.exit_codes import NOT_FOUND
from cosserat_casadi.cli.options import SceneFile, Settings, check_files
from cosserat_casadi.cli.progress import solve_display
from cosserat_casadi.cli.reports.format import print_warnings
from cosserat_casadi.cli.reports.solution import print_solution
from cosserat_casadi.cli.terminal import Console, binary_output
from cosserat_casadi.equilibrium.solution import Equilibrium, Solution
from cosserat_casadi.errors import Problem, collect_problems, refuse
from cosserat_casadi.files import MESHES, write_whole
from cosserat_casadi.results.json_text import json_text
from cosserat_casadi.results.presentation import write_all
from cosserat_casadi.scene import Scene, read_scene, with_exact_contact

if TYPE_CHECKING:
    from cosserat_casadi.tubes.tube_equilibria import TubeEquilibria
    from cosserat_casadi.tubes.tube_solution import TubeSolution

UNSTABLE = "this equilibrium is not stable: a real rod leaves it. Add --stable to find one that it keeps."
"""A warning with its remedy."""


def solve(
    scene: SceneFile,
    settings: Settings = None,
    output: Annotated[Path | None, typer.Option(help="Write the result file (JSON) here.")] = None,
    plot: Annotated[
        Path | None, typer.Option(help="Draw a figure here: .png, .pdf or .svg; meshes: .glb or .usda.")
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print the result as JSON, and nothing else.")] = False,
    stable: Annotated[
        bool, typer.Option("--stable", help="Find a stable equilibrium: an unstable rod settles to one.")
    ] = False,
    every: Annotated[
        bool, typer.Option("--all", help="Concentric tubes: find all equilibria, and say which are stable.")
    ] = False,
    exact: Annotated[
        bool,
        typer.Option("--exact-contact", help="Ignore the widths of obstacles: rods touch them exactly."),
    ] = False,
) -> None:
    """Find the equilibrium of a scene.

    Exit codes: 0 solved; 2 refused; 3 none found, or with --stable no stable one, or modes that the scene fixes leave
    an error above the tolerance that it gives.
    """
    # A file that cannot be written is refused before the solve, not after it.
    problems: list[Problem] = []
    check_files({"--output": output, "--plot": plot}, scene, settings, problems, meshes="--plot")
    with collect_problems(problems):
        read = read_scene(scene, tuple(settings or ()))
        if every and not read.tubes:
            problems.append(Problem("--all", "needs a scene of concentric tubes", "leave it out"))
        if every and stable:
            problem = "cannot go with --all, which says of each equilibrium whether it is stable"
            problems.append(Problem("--stable", problem, "leave one of them out"))
        if read.tubes and plot is not None and plot.suffix.lower() in MESHES:
            problems.append(Problem("--plot", "tubes have no file of meshes", "use .png, .pdf or .svg"))
        if exact and read.tubes:
            problems.append(Problem("--exact-contact", "needs a scene of rods, which touch obstacles", "leave it out"))
        elif exact:
            read = with_exact_contact(read)
    refuse(problems)
    if every:
        # Imported here, because no scene of rods needs the modules of tubes.
        from cosserat_casadi.tubes.tube_equilibria import all_equilibria

        equilibria = all_equilibria(read)
        # Without an equilibrium there is no figure.
        _give(equilibria, output, plot if equilibria.solutions else None, as_json=as_json)
        if not equilibria.complete:
            raise typer.Exit(NOT_FOUND)
        return
    solution = solve_with_progress(read, stable=stable)
    _give(solution, output, plot, as_json=as_json)
    # The warning goes to standard error, so that standard output holds only JSON; None is no verdict.
    if solution.converged and solution.stable is False and not stable:
        print_warnings(Console(stderr=True), [UNSTABLE])
    # If stability is undefined, --stable fails.
    found = solution.converged and (solution.stable or not stable)
    # None, without a requested tolerance, is no failure.
    missed = solution.within_tolerance is False
    if not found or missed:
        raise typer.Exit(NOT_FOUND)


def solve_with_progress(scene: Scene, *, stable: bool = False) -> Solution | TubeSolution:
    """Solve a scene with a progress bar."""
    with solve_display("Solving") as display:
        return solve_scene(scene, stable=stable, progress=display.show_share, report=display.show_stage)


def _give(
    solution: Equilibrium[Any] | TubeEquilibria, output: Path | None, plot: Path | None, *, as_json: bool
) -> None:
    """Write, draw and print the solution."""
    written = write_all(solution, output, plot)
    if as_json:
        # JSON is UTF-8, whatever the encoding of the terminal.
        write_whole(binary_output(), json_text(solution.to_dict()).encode())
    elif isinstance(solution, Solution):
        print_solution(Console(), solution, written)
    else:
        from cosserat_casadi.cli.reports.tubes import print_tubes

        print_tubes(Console(), solution, written)
