"""``cosserat estimate``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer
from rich.markup import escape

from cosserat_casadi import estimation
from cosserat_casadi.cli.exit_codes import NOT_FOUND
from cosserat_casadi.cli.options import SceneFile, Settings, check_files, read_checked
from cosserat_casadi.cli.progress import RateColumn, count_display
from cosserat_casadi.cli.reports.format import print_written, table_of, title_line
from cosserat_casadi.cli.reports.model import error_words
from cosserat_casadi.cli.terminal import Console
from cosserat_casadi.equilibrium.answer_error import UNKNOWN
from cosserat_casadi.errors import Problem, collect_problems
from cosserat_casadi.estimation import Estimate
from cosserat_casadi.files import check_writable
from cosserat_casadi.results.presentation import write_all
from cosserat_casadi.spelling import counted

FORMATS = (".json", ".csv")


def estimate(
    scene: SceneFile,
    output: Annotated[Path, typer.Option(help="Write the estimates of all rows to this file: .json or .csv.")],
    plot: Annotated[
        Path | None,
        typer.Option(help="Draw the unknowns of all rows, with intervals, here: .png, .pdf or .svg."),
    ] = None,
    cores: Annotated[int | None, typer.Option(min=1, help="Number of cores to use; all by default.")] = None,
    settings: Settings = None,
) -> None:
    """Estimate the unknown inputs of every measured row, with their standard deviations.

    Exit codes: 0 each row has its outcome, 2 refused, 3 no row was found, or the tolerance is missed on rows checked.
    """
    problems: list[Problem] = []
    with collect_problems(problems):
        check_writable(output, "--output")
    check_files({"--output": output, "--plot": plot}, scene, settings, problems, output_suffix=None)
    if output.suffix.lower() not in FORMATS:
        problems.append(Problem("--output", f"{output} is neither JSON nor CSV", "use .json or .csv"))
    checked_scene = read_checked(scene, settings, problems)
    with count_display("Reading the table", RateColumn()) as show_count:
        found = estimation.estimate(checked_scene, cores=cores, progress=show_count)
    written = write_all(found, None, output, plot)
    _print(Console(), found, checked_scene.title)
    print_written(Console(), written, soft_wrap=True)
    for warning in found.warnings:
        Console(stderr=True).print(f"[bold yellow]{escape(warning)}[/]", soft_wrap=True)
    if not found.holds:
        raise typer.Exit(NOT_FOUND)


def _print(console: Console, found: Estimate, title: str | None) -> None:
    """Print the number of rows found, and the median standard deviation of each unknown."""
    console.print(title_line(title))
    endings = ", ".join(f"{word}: {counted(count, 'row')}" for word, count in found.counts.items())
    console.print(f"{endings}.", soft_wrap=True)
    headings = ("unknown", "unit")
    table = table_of(*headings, right=("least", "largest", "deviation"), unbroken=headings)
    rows = found.found
    if not rows.any():
        return
    values = found.values[rows]
    deviations = found.sigma[rows]
    for k, label in enumerate(found.labels):
        numbers = (values[:, k].min(), values[:, k].max(), sorted(deviations[:, k])[len(deviations) // 2])
        table.add_row(escape(label), found.units[k], *(f"{number:.4g}" for number in numbers))
    if found.shared is not None:
        shared = found.shared
        for label, unit, value, sigma in zip(shared.labels, shared.units, shared.values, shared.sigma, strict=True):
            table.add_row(escape(label), unit, f"{value:.4g}", f"{value:.4g}", f"{sigma:.4g}")
    console.print(table)
    if found.checked:
        console.print(_checked_sentence(found), soft_wrap=True)


def _checked_sentence(found: Estimate) -> str:
    """The largest error of the rows that were solved again, with the tolerance."""
    # The error of a row without an equilibrium on finer modes is unknown.
    largest = max(UNKNOWN if error is None else error for _, error in found.checked)
    error = error_words(largest, found.within_tolerance, found.model.scene.accuracy.tolerance)
    return f"{counted(len(found.checked), 'row')} solved again on finer modes: estimated error at most {error}."
