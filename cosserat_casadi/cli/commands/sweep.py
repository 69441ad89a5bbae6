"""``cosserat sweep``."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated

import typer

from cosserat_casadi.cli.exit_codes import NOT_FOUND
from cosserat_casadi.cli.options import SceneFile, Settings, check_files
from cosserat_casadi.cli.progress import RateColumn, count_display
from cosserat_casadi.cli.reports.format import print_written
from cosserat_casadi.cli.reports.sweep import print_shard, print_sobol, print_stopped_sweep, print_sweep
from cosserat_casadi.cli.signals import StoppedError
from cosserat_casadi.cli.terminal import Console
from cosserat_casadi.errors import Problem, SceneError, collect_problems
from cosserat_casadi.numerics.progress import StageProgress
from cosserat_casadi.results.presentation import write, write_all
from cosserat_casadi.scene import Scene, read_scene
from cosserat_casadi.sweeps.outcome_file import record_file
from cosserat_casadi.sweeps.outcome_table import Sweep
from cosserat_casadi.sweeps.run import SAMPLES, Plan, merge_shards, output_problems, plan_sweep, run_shard, run_sweep
from cosserat_casadi.sweeps.scratch import Scratch
from cosserat_casadi.sweeps.sobol import sobol_indices
from cosserat_casadi.sweeps.table import Table, asked_table
from cosserat_casadi.sweeps.work import Shard


def sweep(
    scene: SceneFile,
    output: Annotated[
        Path, typer.Option(help="Write a row for each solve here: .csv, .parquet, or .dataset, a folder of parts.")
    ],
    over: Annotated[
        Path | None, typer.Option(help="Values to solve for: a grid (TOML), or a row for each solve (CSV).")
    ] = None,
    ranges: Annotated[
        list[str] | None,
        typer.Option(
            "--range",
            metavar="COLUMN=FROM:TO:COUNT",
            help="Values of an input or a parameter; several ranges make a grid, also with the rows of --over.",
        ),
    ] = None,
    scheduler: Annotated[
        str | None, typer.Option(metavar="ADDRESS", help="Solve on this dask.distributed cluster: tcp://host:8786.")
    ] = None,
    cores: Annotated[int | None, typer.Option(min=1, help="Number of cores to use; all by default.")] = None,
    device: Annotated[
        str | None,
        typer.Option(metavar="cuda", help="Solve on a GPU: experimental, it never ran on a GPU and was not timed."),
    ] = None,
    samples: Annotated[
        int, typer.Option(min=1, max=10_000, help="Number of rows to choose the discretisation on.")
    ] = SAMPLES,
    stability: Annotated[
        bool, typer.Option("--stability", help="Say whether the equilibrium of each row is stable.")
    ] = False,
    estimate_errors: Annotated[
        bool,
        typer.Option(
            "--error-estimate/--no-error-estimate", help="Estimate the error of every row, or leave the columns out."
        ),
    ] = True,
    sobol: Annotated[
        Path | None,
        typer.Option(help="Draw the random columns for sensitivity indices, and write the indices here: .json."),
    ] = None,
    plot: Annotated[
        Path | None, typer.Option(help="Draw the workspace, or with --sobol the indices, here: .png, .pdf or .svg.")
    ] = None,
    colour: Annotated[
        str | None, typer.Option(metavar="COLUMN", help="Column that colours the figure, or 'outcome'.")
    ] = None,
    shard: Annotated[
        str | None, typer.Option(metavar="K/N", help="Solve the K-th of N parts of the rows; --merge joins them.")
    ] = None,
    merge: Annotated[bool, typer.Option("--merge", help="Write --output from the shards beside it.")] = False,
    settings: Settings = None,
) -> None:
    """Solve a scene for every row of a grid or a table of inputs and parameters.

    What a stopped or killed run has done is not done again. Exit codes: 0 every row has its outcome, 2 refused,
    3 rows miss the tolerance, or no row has an equilibrium, 130 interrupted.
    """
    problems: list[Problem] = []
    outputs = {"--output": output, "the record of --output": record_file(output), "--sobol": sobol, "--plot": plot}
    check_files(outputs, scene, settings, problems, over, output_suffix=None)
    if sobol is not None and colour is not None:
        problems.append(Problem("--colour", "is for the workspace", "leave it out beside --sobol"))
    part = _check_shard(shard, merge, plot, problems)
    swept_scene: Scene | None = None
    table: Table | None = None
    plan: Plan | None = None
    with collect_problems(problems):
        swept_scene = read_scene(scene, tuple(settings or ()))
    with collect_problems(problems):
        table = _asked_table(over, ranges or [], output, sobol=sobol is not None)
    if swept_scene is None or table is None:
        # Only the output can be checked without scene and table.
        problems.extend(output_problems(output, None))
    else:
        with collect_problems(problems):
            plan = plan_sweep(
                swept_scene,
                table,
                output,
                samples,
                stability=stability,
                estimate_errors=estimate_errors,
                device=device,
            )
    _check_colour(colour, plot, plan, problems)
    if problems or plan is None:
        # Faults beside a sound scene are those of the table.
        raise SceneError(*problems, page="scene" if swept_scene is None else "sweeps")

    # Evaluated now: after the run the sweep is always finished.
    finished_before = plan.finished
    if part is not None:
        with _stoppable(part.file(output)) as show_count:
            rows = run_shard(plan, part, scheduler=scheduler, cores=cores, progress=show_count)
        print_shard(Console(), part, rows, output, finished=finished_before)
        return
    with _stoppable(plan.part) as show_count:
        if merge:
            swept = merge_shards(plan, progress=show_count)
        else:
            swept = run_sweep(plan, scheduler=scheduler, cores=cores, progress=show_count)

    if sobol is not None:
        print_sweep(Console(), swept, output, None, finished=finished_before)
        _write_sobol(swept, sobol, plot)
    else:
        if plot is not None:
            write(swept, plot, colour=colour)
        print_sweep(Console(), swept, output, plot, finished=finished_before)
    # The rows are always written; the exit code reports missed tolerances.
    if not swept.holds:
        raise typer.Exit(NOT_FOUND)


@contextmanager
def _stoppable(kept: Path | None) -> Iterator[StageProgress]:
    """Show the progress of a sweep; after a stop print the file with the finished rows."""
    try:
        with count_display("Reading the table", RateColumn()) as show_count:
            yield show_count
    except KeyboardInterrupt:
        print_stopped_sweep(Console(stderr=True), kept)
        raise StoppedError from None


def _check_shard(shard: str | None, merge: bool, plot: Path | None, problems: list[Problem]) -> Shard | None:
    """The requested shard, or None."""
    if shard is None:
        return None
    if merge:
        problems.append(Problem("--merge", "needs all shards together", "leave it out beside --shard"))
    if plot is not None:
        problems.append(Problem("--plot", "shows all rows", "give it with --merge"))
    with collect_problems(problems):
        return Shard.read(shard)
    return None


def _asked_table(over: Path | None, ranges: list[str], output: Path, *, sobol: bool) -> Table:
    """The rows of a file, of ranges, or of both.

    Raises:
        SceneError: with every fault of table and grid; or neither is asked for.
    """
    if over is None and not ranges:
        remedy = "give a file, or ranges such as --range push.force.x=-1:1:21"
        raise SceneError(Problem("--over", "and --range are missing: there is nothing to solve for", remedy))
    if over is None and sobol:
        raise SceneError(Problem("--sobol", "needs random columns, and --over is missing", "name a grid that has some"))
    return asked_table(over, ranges, sobol=sobol, scratch=Scratch.beside(output))


def _check_colour(colour: str | None, plot: Path | None, plan: Plan | None, problems: list[Problem]) -> None:
    if colour is None:
        return
    if plot is None:
        problems.append(Problem("--colour", "is for a figure", "name its file with --plot"))
    if plan is None:
        # The columns are unknown.
        return
    columns = ("outcome", *plan.columns)
    if colour not in columns:
        problems.append(Problem("--colour", f"{colour!r} is no column", f"there are {', '.join(columns)}"))


def _write_sobol(swept: Sweep, file: Path, plot: Path | None) -> None:
    """Write, draw and print the Sobol indices of a sweep with rows sampled for them."""
    indices = sobol_indices(swept)
    written = write_all(indices, file)
    if plot is not None:
        write(indices, plot, title=swept.record["title"])
        written.append(plot)
    print_sobol(Console(), indices)
    print_written(Console(), written, soft_wrap=True)
