"""The command line: solve, follow a path, find inputs, sweep, check, export, tune, bench."""

from __future__ import annotations

import re
import signal
import sys
import tomllib
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated

import numpy as np
import typer
from rich.console import Console
from rich.markup import escape
from rich.progress import (
    BarColumn,
    Progress,
    ProgressColumn,
    SpinnerColumn,
    Task,
    TaskProgressColumn,
    TextColumn,
    TimeElapsedColumn,
)
from rich.text import Text

from cosserat_casadi.accuracy.refine import Report, solve_scene
from cosserat_casadi.accuracy.tune import tune as tune_scene
from cosserat_casadi.bench.effects import effect_times
from cosserat_casadi.bench.grid import METHODS
from cosserat_casadi.bench.plan import make_plan, run_plan
from cosserat_casadi.bench.reference import NoReferenceError
from cosserat_casadi.bench.table import print_effects
from cosserat_casadi.cli import report
from cosserat_casadi.codegen.compiled import find_compiler
from cosserat_casadi.codegen.export import check_export
from cosserat_casadi.codegen.export import export as export_model
from cosserat_casadi.codegen.names import scene_names
from cosserat_casadi.control.inverse_accuracy import inverse_scene
from cosserat_casadi.equilibrium.solution import Solution
from cosserat_casadi.errors import CosseratError, ExportError, Problem, SceneError
from cosserat_casadi.files import check_writable, write_atomically
from cosserat_casadi.loads.load import coefficients
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import build
from cosserat_casadi.model.inputs import input_layout
from cosserat_casadi.model.load_cases import read_load_cases, spread
from cosserat_casadi.numerics.continuation import Progress as Told
from cosserat_casadi.paths.follow import EquilibriumPath
from cosserat_casadi.paths.refine import follow_scene_path
from cosserat_casadi.results.inverse_file import inverse_text
from cosserat_casadi.results.path_file import path_table, path_text
from cosserat_casadi.results.solution_file import result_text
from cosserat_casadi.scene import Scene, read_scene
from cosserat_casadi.scene.writing import scene_text
from cosserat_casadi.sweep.outcome_table import Sweep
from cosserat_casadi.sweep.run import SAMPLES, Plan, output_problems, plan_sweep, run_sweep
from cosserat_casadi.sweep.table import Table, read_table

REFUSED = 2
"""Exit code: the input is refused, nothing was written."""

NOT_FOUND = 3
"""Exit code: no equilibrium was found; the result file says so."""

INTERRUPTED = 130
"""Exit code: stopped by the user."""

app = typer.Typer(
    help="Cosserat rods: from a scene file to the deformed rod.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_show_locals=False,
)

SceneFile = Annotated[Path, typer.Argument(metavar="SCENE", help="Scene file (TOML).", show_default=False)]
Settings = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="KEY=VALUE", help="Change a value of the scene, such as push.force=[0.2,0,0]."),
]


@app.command()
def solve(
    scene: SceneFile,
    settings: Settings = None,
    output: Annotated[Path | None, typer.Option(help="Write the result file (JSON) here.")] = None,
    plot: Annotated[Path | None, typer.Option(help="Draw a figure here: .png, .pdf or .svg.")] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print the result as JSON, and nothing else.")] = False,
    stable: Annotated[
        bool, typer.Option("--stable", help="Find a stable equilibrium: where the rod is unstable, let it settle.")
    ] = False,
) -> None:
    """Find the equilibrium of a scene. Exit codes: 0 solved, 2 refused, 3 none found; with --stable: no stable one."""
    _check_outputs(output, plot)
    solution = _solve_with_progress(read_scene(scene, tuple(settings or ())), stable=stable)
    if output is not None:
        write_atomically(output, result_text(solution).encode())
    if plot is not None:
        _draw(solution, plot)
    if as_json:
        sys.stdout.write(result_text(solution))
    else:
        report.print_solution(Console(), solution, [p for p in (output, plot) if p is not None])
    if solution.converged and solution.stable is False and not stable:
        report.print_unstable(Console(stderr=True))
    if not solution.converged or (stable and not solution.stable):
        raise typer.Exit(NOT_FOUND)


@app.command()
def path(
    scene: SceneFile,
    name: Annotated[str, typer.Option("--input", metavar="LOAD.FIELD", help="The input to follow: push.force.")],
    to: Annotated[str, typer.Option("--to", metavar="VALUE", help="Its value at factor 1, such as [0,0,-5].")],
    branch: Annotated[bool, typer.Option("--branch", help="Leave along the branch of the first bifurcation.")] = False,
    bifurcation: Annotated[
        int, typer.Option("--bifurcation", help="With --branch: leave at this one; below zero the branch's other half.")
    ] = 1,
    settings: Settings = None,
    output: Annotated[Path | None, typer.Option(help="Write the path (JSON) here.")] = None,
    plot: Annotated[Path | None, typer.Option(help="Draw load against displacement here: .png, .pdf or .svg.")] = None,
    table: Annotated[Path | None, typer.Option("--csv", help="Write the points (CSV) here.")] = None,
) -> None:
    """Follow equilibria while an input grows from zero, through folds. Exit codes: 0, 2 refused, 3 not at factor 1."""
    files = {"--output": output, "--csv": table}
    read, value = _check_path(scene, tuple(settings or ()), name, to, bifurcation, files, plot)
    with _told("Following the path") as (told, said):
        leave = bifurcation if branch else 0
        found = follow_scene_path(read, name, value, branch=leave, progress=told, report=said)
    if output is not None:
        write_atomically(output, path_text(found).encode())
    if table is not None:
        write_atomically(table, path_table(found).encode())
    if plot is not None:
        _draw_path(found, plot)
    report.print_path(Console(), found, [p for p in (output, table, plot) if p is not None])
    if not found.converged:
        raise typer.Exit(NOT_FOUND)


@app.command()
def inverse(
    scene: SceneFile,
    settings: Settings = None,
    output: Annotated[Path | None, typer.Option(help="Write the result at the inputs found (JSON) here.")] = None,
    plot: Annotated[Path | None, typer.Option(help="Draw a figure here: .png, .pdf or .svg.")] = None,
    stable: Annotated[bool, typer.Option("--stable", help="Accept a stable equilibrium only.")] = False,
) -> None:
    """Find inputs that bring rods and bodies to the targets of a scene.

    Exit codes: 0 targets met, 2 refused, 3 not met, or no equilibrium found; the files show the closest pose then.
    """
    _check_outputs(output, plot)
    with _told("Finding inputs") as (_, said):
        found = inverse_scene(read_scene(scene, tuple(settings or ())), stable=stable, report=said)
    if output is not None:
        write_atomically(output, inverse_text(found).encode())
    if plot is not None:
        _draw(found.solution, plot)
    report.print_inverse(Console(), found, [p for p in (output, plot) if p is not None])
    if not found.met:
        raise typer.Exit(NOT_FOUND)


@app.command()
def sweep(
    scene: SceneFile,
    over: Annotated[Path, typer.Option(help="What to solve for: a grid (TOML), or a row for each solve (CSV).")],
    output: Annotated[Path, typer.Option(help="Write a row for each solve here: .csv or .parquet.")],
    scheduler: Annotated[
        str | None, typer.Option(metavar="ADDRESS", help="Run on this dask.distributed cluster: tcp://host:8786.")
    ] = None,
    cores: Annotated[int | None, typer.Option(min=1, help="Cores of this machine to use; all by default.")] = None,
    samples: Annotated[
        int, typer.Option(min=1, max=10_000, help="Rows that the discretisation is chosen on.")
    ] = SAMPLES,
    plot: Annotated[Path | None, typer.Option(help="Draw the workspace here: .png, .pdf or .svg.")] = None,
    colour: Annotated[
        str | None, typer.Option(metavar="COLUMN", help="Colour the figure by this column, or by 'outcome'.")
    ] = None,
    settings: Settings = None,
) -> None:
    """Solve a scene for every row of a grid or a table of inputs and parameters.

    What a stopped or killed run has done is not done again. Exit codes: 0 every row has its outcome, 2 refused,
    3 the tolerance is missed on rows that were checked, or no row has an equilibrium, 130 interrupted.
    """
    plan = _check_sweep(scene, tuple(settings or ()), over, output, samples, plot, colour)
    finished = plan.finished
    try:
        with _progress(Rate()) as bar, _interrupts() as stop:
            found = run_sweep(plan, scheduler=scheduler, cores=cores, progress=_stages(bar, stop))
    except KeyboardInterrupt:
        report.print_stopped_sweep(Console(stderr=True), plan)
        raise typer.Exit(INTERRUPTED) from None
    if plot is not None:
        _draw_sweep(found, plot, colour)
    report.print_sweep(Console(), found, output, plot, finished=finished)
    if not found.holds:
        raise typer.Exit(NOT_FOUND)


@app.command()
def check(
    scene: SceneFile,
    settings: Settings = None,
    timed: Annotated[bool, typer.Option("--time", help="Price each effect in compiled microseconds too.")] = False,
) -> None:
    """Validate a scene, say which effects were chosen and what the model and each effect will cost."""
    read = read_scene(scene, tuple(settings or ()))
    compiler = find_compiler() if timed else None
    report.print_check(Console(), build(read))
    if compiler is not None:
        with Console(stderr=True).status("Compiling the scene with and without each effect"):
            whole, parts = effect_times(read, compiler)
        print_effects(Console(), whole, parts)


@app.command()
def export(
    scene: SceneFile,
    output: Annotated[Path, typer.Option(help="Folder to write: new, empty, or of an earlier export.")],
    name: Annotated[str | None, typer.Option(help="What every C symbol begins with; else the scene file's.")] = None,
    derivatives: Annotated[
        bool, typer.Option("--derivatives", help="With second derivatives, for CasADi: no controller needs them.")
    ] = False,
    settings: Settings = None,
) -> None:
    """Write a scene as C sources: equations, Jacobians, solver. Exit codes: 0 written, 2 refused, 3 not solved.

    Modes and nodes are chosen so that the tolerance is met at the scene's own loads, unless the scene fixes them.
    """
    chosen = re.sub(r"\W", "_", scene.stem) if name is None else name
    check_export(output, chosen)
    read = read_scene(scene, tuple(settings or ()))
    scene_names(chosen, read)
    solution = _solve_with_progress(read)
    if not solution.converged:
        Console(stderr=True).print(f"[bold red]Nothing was written.[/] {solution.message}", highlight=False)
        raise typer.Exit(NOT_FOUND)
    export_model(solution.model, output, chosen, error_estimate=solution.error_estimate, derivatives=derivatives)
    report.print_export(Console(), solution, output)


@app.command()
def tune(
    scene: SceneFile,
    output: Annotated[Path, typer.Option(help="Write the scene with its discretisation fixed here (TOML).")],
    tolerance: Annotated[float | None, typer.Option(help="Wanted error of the tip poses; else the scene's.")] = None,
    over: Annotated[Path | None, typer.Option(help="Load cases: CSV with columns such as push.force.x.")] = None,
    ranges: Annotated[
        list[str] | None, typer.Option("--range", metavar="COLUMN=LOW:HIGH", help="Range of an input.")
    ] = None,
    samples: Annotated[int, typer.Option(min=1, max=100_000, help="Load cases spread over the ranges.")] = 32,
    settings: Settings = None,
) -> None:
    """Find the smallest discretisation for many load cases. Exit codes: 0 written, 2 refused, 3 tolerance not met."""
    read = read_scene(scene, tuple(settings or ()))
    layout = input_layout(read)
    check_writable(output, "--output")
    if (over is None) == (not ranges):
        raise SceneError(Problem("--over", "stands beside --range, or both are missing", "give one of them"))
    cases = spread(ranges or [], samples, layout) if over is None else read_load_cases(over, layout)
    with _progress() as bar:
        task = bar.add_task("Tuning", total=None)
        tuning = tune_scene(
            read,
            [layout.unpack(case) for case in cases],
            tolerance,
            lambda done, total: bar.update(task, completed=done, total=total),
        )
    report.print_tuning(Console(), tuning, layout, cases)
    if not tuning.met:
        raise typer.Exit(NOT_FOUND)
    write_atomically(output, scene_text(tuning.scene).encode())
    Console().print(f"wrote {output}", highlight=False)


@app.command()
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

    Errors are against an independent reference found in the same run. Exit codes: 0 measured, 2 refused,
    3 no reference found, 130 interrupted; what was measured until then is in bench.csv.
    """
    plan = make_plan(read_scene(scene, tuple(settings or ())), output, methods, points, quick)
    with _progress() as bar:
        interrupted = run_plan(plan, Console(), _reporter(bar))
    if interrupted:
        raise typer.Exit(INTERRUPTED)


def main() -> None:
    """Entry point: errors become sentences and exit codes."""
    sys.exit(run(app))


def run(command: Callable[..., object]) -> int:
    """Run a command; 2 for refused input with the reasons on standard error."""
    console = Console(stderr=True)
    try:
        outcome = command(standalone_mode=False)
    except (SceneError, ExportError) as error:
        report.print_refusal(console, error)
        return REFUSED
    except NoReferenceError as error:
        console.print(f"[bold red]Error:[/] {escape(str(error))}", highlight=False)
        return NOT_FOUND
    except CosseratError as error:
        console.print(f"[bold red]Error:[/] {escape(str(error))}", highlight=False)
        return REFUSED
    except KeyboardInterrupt:
        console.print("Stopped. Files that were not finished were not written.")
        return INTERRUPTED
    except typer.Exit as stop:
        return stop.exit_code
    except typer.Abort:
        return INTERRUPTED
    except Exception as error:
        if hasattr(error, "format_message") and hasattr(error, "exit_code"):
            console.print(f"[bold red]Error:[/] {escape(error.format_message())}", highlight=False)
            return int(error.exit_code)
        raise
    return outcome if isinstance(outcome, int) else 0


def _check_outputs(output: Path | None, plot: Path | None) -> None:
    """Refuse what cannot be written before spending time on the solve."""
    if output is not None:
        check_writable(output, "--output")
    if plot is not None:
        from cosserat_casadi.plots.scene_plot import check_plot_path

        check_writable(plot, "--plot")
        check_plot_path(plot)


def _check_path(
    scene: Path,
    settings: tuple[str, ...],
    name: str,
    to: str,
    bifurcation: int,
    outputs: dict[str, Path | None],
    plot: Path | None,
) -> tuple[Scene, FloatArray]:
    """The scene and the value of the followed input.

    Raises:
        SceneError: with every fault of the scene, the options and the places to write to.
    """
    problems: list[Problem] = []
    if bifurcation == 0:
        problems.append(Problem("--bifurcation", "must not be 0", "count from 1; -1 is the other half of that branch"))
    for option, file in outputs.items():
        with _collected(problems):
            if file is not None:
                check_writable(file, option)
    value: FloatArray | None = None
    read: Scene | None = None
    with _collected(problems):
        _check_outputs(None, plot)
    with _collected(problems):
        value = _vector(to)
    with _collected(problems):
        read = read_scene(scene, settings)
        _check_input(read, name, value)
    if problems or read is None:
        raise SceneError(*problems)
    return read, np.asarray(value)


def _check_sweep(
    scene: Path,
    settings: tuple[str, ...],
    over: Path,
    output: Path,
    samples: int,
    plot: Path | None,
    colour: str | None,
) -> Plan:
    """The sweep that is asked for.

    Raises:
        SceneError: with every fault of the scene, the table, the options and the places to write to.
    """
    problems: list[Problem] = []
    read: Scene | None = None
    table: Table | None = None
    plan: Plan | None = None
    with _collected(problems):
        _check_outputs(None, plot)
    with _collected(problems):
        read = read_scene(scene, settings)
    with _collected(problems):
        table = read_table(over)
    with _collected(problems):
        if read is None or table is None:
            # Without them the output is all that can still be looked at.
            problems += output_problems(output, None)
        else:
            plan = plan_sweep(read, table, output, samples)
    problems += _colour_problems(colour, plot, plan)
    if problems or plan is None:
        raise SceneError(*problems)
    return plan


def _colour_problems(colour: str | None, plot: Path | None, plan: Plan | None) -> Iterator[Problem]:
    """Why a figure cannot be coloured so."""
    if colour is not None and plot is None:
        yield Problem("--colour", "is for a figure", "name its file with --plot")
    known = () if plan is None else ("outcome", *plan.columns)
    if colour is not None and known and colour not in known:
        yield Problem("--colour", f"{colour!r} is no column", f"there are {', '.join(known)}")


@contextmanager
def _collected(problems: list[Problem]) -> Iterator[None]:
    """Faults that are told together with others: what is refused inside is kept, and the check goes on."""
    try:
        yield
    except SceneError as error:
        problems.extend(error.problems)


def _check_input(scene: Scene, name: str, value: object) -> None:
    """Refuse an input that the scene does not have, or a value of another size; of a value refused already, None."""
    inputs = build(scene).inputs
    default = dict(zip(inputs.names, inputs.defaults, strict=True)).get(name, np.zeros(0))
    inputs.pack({name: default if value is None else np.asarray(value)})


def _vector(text: str) -> FloatArray:
    """A number, or components that are numbers or lists of Legendre coefficients, written as TOML."""
    wrong = Problem("--to", f"must be a number or a list of numbers, got {text}", "write it as in TOML: [0, 0, -5.0]")
    try:
        value = tomllib.loads(f"value = [{text}]")["value"][0]
        array = coefficients(tuple(value)) if isinstance(value, list) else np.array([value], dtype=float)
    except (tomllib.TOMLDecodeError, LookupError, TypeError, ValueError):
        raise SceneError(wrong) from None
    if not np.all(np.isfinite(array)):
        raise SceneError(Problem("--to", f"must be finite, got {text}"))
    return array


def _draw(solution: Solution, path: Path) -> None:
    from cosserat_casadi.plots.scene_plot import save_plot

    save_plot(solution, path)


def _draw_path(found: EquilibriumPath, file: Path) -> None:
    from cosserat_casadi.plots.path_plot import save_path_plot

    save_path_plot(found, file)


def _draw_sweep(found: Sweep, file: Path, colour: str | None) -> None:
    from cosserat_casadi.plots.sweep_plot import save_sweep_plot

    save_sweep_plot(found, file, colour)


def _solve_with_progress(scene: Scene, *, stable: bool = False) -> Solution:
    with _told("Solving") as (told, said):
        return solve_scene(scene, stable=stable, progress=told, report=said)


def _progress(*more: ProgressColumn) -> Progress:
    columns = (
        SpinnerColumn(),
        TextColumn("{task.description}"),
        BarColumn(),
        TaskProgressColumn(),
        TimeElapsedColumn(),
        *more,
    )
    return Progress(*columns, console=Console(stderr=True), transient=True)


class Rate(ProgressColumn):
    """How many are done in a second, once that is known."""

    def render(self, task: Task) -> Text:
        """The rate as text."""
        return Text(f"{task.speed:,.0f}/s" if task.speed else "")


@contextmanager
def _interrupts() -> Iterator[Callable[[], None]]:
    """What raises an interrupt again that has been lost.

    CasADi calls Python to look at its arguments, and takes whatever that raises for a refusal of the argument.
    """
    seen: list[int] = []

    def interrupt(number: int, frame: object) -> None:
        seen.append(number)
        raise KeyboardInterrupt

    def stop() -> None:
        if seen:
            raise KeyboardInterrupt

    before = signal.signal(signal.SIGINT, interrupt)
    try:
        yield stop
    finally:
        signal.signal(signal.SIGINT, before)


def _stages(bar: Progress, stop: Callable[[], None]) -> Callable[[str, int, int], None]:
    """Shows one stage after the other, each with its own rate, unless all is to stop."""
    task = bar.add_task("Reading the table", total=None)
    doing = ""

    def told(stage: str, done: int, total: int) -> None:
        nonlocal doing
        stop()
        if stage == doing:
            bar.update(task, completed=done, total=total or None)
        else:
            bar.reset(task, description=stage, completed=done, total=total or None)
        doing = stage

    return told


def _reporter(bar: Progress) -> Callable[[str, int, int], None]:
    """Shows what is being done, how many points are done, and of how many."""
    task = bar.add_task("Finding the reference", total=None)
    return lambda doing, done, total: bar.update(task, description=doing, completed=done, total=total or None)


@contextmanager
def _told(doing: str) -> Iterator[tuple[Told, Report]]:
    """A bar on standard error: who is told the share that is done, and who is told the stage."""
    with _progress() as bar, _interrupts() as stop:
        task = bar.add_task("Building the model", total=1.0)

        def told(share: float) -> None:
            stop()
            bar.update(task, completed=share)

        def said(stage: str) -> None:
            stop()
            bar.update(task, description=f"{doing}: {stage}", completed=0.0)

        try:
            yield told, said
        except KeyboardInterrupt:
            # Typer would end without a word.
            bar.console.print("Stopped. Nothing was written.")
            raise typer.Exit(INTERRUPTED) from None
