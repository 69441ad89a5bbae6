"""``cosserat inverse``."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer
from rich.markup import escape

from cosserat_casadi import control
from cosserat_casadi.cli.exit_codes import NOT_FOUND
from cosserat_casadi.cli.options import SceneFile, Settings, check_files
from cosserat_casadi.cli.progress import solve_display
from cosserat_casadi.cli.reports.format import print_warnings, print_written
from cosserat_casadi.cli.reports.model import error_words
from cosserat_casadi.cli.reports.solution import print_inverse
from cosserat_casadi.cli.terminal import Console
from cosserat_casadi.control.inverse_accuracy import inverse_rows
from cosserat_casadi.control.inverse_result import Inverse
from cosserat_casadi.control.target_table import TargetTable, read_targets
from cosserat_casadi.errors import Problem, SceneError, refuse
from cosserat_casadi.files import write_atomically
from cosserat_casadi.results.inverse_table import MET, row_outcome, table_text
from cosserat_casadi.results.presentation import write_all
from cosserat_casadi.scene import read_scene
from cosserat_casadi.spelling import counted

UNSTABLE = (
    "the equilibrium at these inputs is not stable: a real rod leaves it. Add --stable to look for a stable one, or "
    "--unstable to accept this one."
)
"""A warning with its remedy."""

MOST_TOLD = 20
"""Largest number of printed failed rows; the file has them all."""


def inverse(
    scene: SceneFile,
    settings: Settings = None,
    output: Annotated[Path | None, typer.Option(help="Write the resulting equilibrium (JSON) here.")] = None,
    table: Annotated[
        Path | None,
        typer.Option(help="A target in each row: CSV with x, y, z and qw, qx, qy, qz; --output is CSV then."),
    ] = None,
    plot: Annotated[Path | None, typer.Option(help="Draw a figure here: .png, .pdf or .svg.")] = None,
    stable: Annotated[
        bool, typer.Option("--stable", help="Find a stable equilibrium: from an unstable one let the rod settle.")
    ] = False,
    unstable: Annotated[
        bool, typer.Option("--unstable", help="Accept an unstable equilibrium: exit code 0 if the targets are met.")
    ] = False,
) -> None:
    """Find inputs that bring rods and bodies to the targets of a scene.

    Where the scene has [[bounds]], only the inputs that it bounds change; without bounds and inputs, all loads and
    actuators but gravity. Exit codes: 0 targets met, 2 refused, 3 not met, unstable, or no equilibrium found; the files
    show the closest pose then. With --table every row is a separate target, and 3 says that at least one target is not
    met.
    """
    if stable and unstable:
        raise SceneError(Problem("--unstable", "stands beside --stable", "leave one of them out"))
    problems: list[Problem] = []
    suffix = ".json" if table is None else ".csv"
    check_files({"--output": output, "--plot": plot}, scene, settings, problems, table, output_suffix=suffix)
    refuse(problems)
    if table is not None:
        _check_table(table, output, plot)
        _inverse_of_table(scene, settings, table, output, stable, unstable)
        return
    with solve_display("Finding inputs") as display:
        # The scene is read inside: the bar covers the build of the problem, and an interrupt may come in it.
        given_scene = read_scene(scene, tuple(settings or ()))
        solved = control.inverse(given_scene, stable=stable, report=display.show_stage)
    print_inverse(Console(), solved, write_all(solved, output, plot))
    if solved.unstable and not unstable and not stable:
        print_warnings(Console(stderr=True), [UNSTABLE])
    # In this case the files hold the closest pose.
    refused = solved.unstable and not unstable
    if refused or not solved.met:
        raise typer.Exit(NOT_FOUND)


def _check_table(table: Path, output: Path | None, plot: Path | None) -> None:
    """Refuse a table that does not exist, options that do not apply to a table, and missing ones that it needs."""
    problems = []
    if not table.exists():
        problems.append(Problem("--table", f"{table} does not exist", "name a CSV file with the columns x, y, z"))
    if output is None:
        problems.append(Problem("--output", "missing", "name the CSV file for the results of the table"))
    if plot is not None:
        problems.append(Problem("--plot", "stands beside --table", "a figure shows one target: leave out --table"))
    refuse(problems)


def _inverse_of_table(
    scene: Path,
    settings: list[str] | None,
    table: Path,
    output: Path | None,
    stable: bool,
    unstable: bool,
) -> None:
    """Find inputs for every row of a table of targets, and write them as a table."""
    assert output is not None
    with solve_display("Finding inputs") as display:
        given_scene = read_scene(scene, tuple(settings or ()))
        targets = read_targets(table, given_scene)

        def show_rows(done: int, total: int) -> None:
            display.show_stage(f"row {done + 1} of {total}")

        found = inverse_rows(given_scene, targets.rows, stable=stable, report=display.show_stage, progress=show_rows)
    write_atomically(output, table_text(targets, found, unstable).encode())
    outcomes = [row_outcome(inverse, unstable) for inverse in found]
    print_inverse_table(Console(), targets, found, outcomes, output)
    if any(outcome != MET for outcome in outcomes):
        raise typer.Exit(NOT_FOUND)


def print_inverse_table(
    console: Console,
    targets: TargetTable,
    found: Sequence[Inverse],
    outcomes: Sequence[str],
    output: Path,
) -> None:
    """Print the number of met rows; line, outcome and message of other rows; and the largest error."""
    failed = [row for row, outcome in enumerate(outcomes) if outcome != MET]
    rows = counted(len(outcomes), "row")
    if not failed:
        console.print(f"[bold green]The targets of {rows} are met.[/]")
    else:
        console.print(f"[bold red]{len(failed)} of {rows}: the target is not met.[/]")
    for row in failed[:MOST_TOLD]:
        message = escape(found[row].solution.message)
        console.print(f"line {targets.lines[row]}: {outcomes[row]}. {message}", soft_wrap=True)
    if len(failed) > MOST_TOLD:
        console.print(f"… and {len(failed) - MOST_TOLD} more; {escape(str(output))} names the outcome of each.")
    sentence = _error_sentence(targets, found)
    if sentence is not None:
        console.print(sentence, soft_wrap=True)
    print_written(console, [output])


def _error_sentence(targets: TargetTable, found: Sequence[Inverse]) -> str | None:
    """The largest estimated error of rows with an equilibrium, and the number of rows above the tolerance, if any."""
    errors = {
        row: inverse.solution.error_estimate
        for row, inverse in enumerate(found)
        if inverse.solution.converged and inverse.solution.error_estimate is not None
    }
    if not errors:
        return None
    worst = max(errors, key=lambda row: errors[row])
    solution = found[worst].solution
    tolerance = solution.model.scene.accuracy.tolerance
    error = error_words(errors[worst], solution.within_tolerance, tolerance)
    missed = sum(found[row].solution.within_tolerance is False for row in errors)
    sentence = f"Estimated error at most {error} (line {targets.lines[worst]})"
    if missed:
        return f"{sentence}, as in {counted(missed, 'row')}: {solution.remedy}"
    return f"{sentence}."
