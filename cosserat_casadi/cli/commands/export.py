"""``cosserat export``."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Annotated

import typer
from rich.markup import escape

from cosserat_casadi.accuracy.choose import SAMPLES, Choice
from cosserat_casadi.accuracy.fixing import fixed_by_rod
from cosserat_casadi.accuracy.models import build
from cosserat_casadi.accuracy.ranges import Given
from cosserat_casadi.cli.commands.tune import choose_with_progress
from cosserat_casadi.cli.exit_codes import NOT_FOUND
from cosserat_casadi.cli.options import Ranges, SceneFile, Settings, asked_cases, asked_ranges, check_inputs_stay
from cosserat_casadi.cli.reports.model import print_choice, print_export, print_locking, print_missed
from cosserat_casadi.cli.reports.tubes import print_tubes_export
from cosserat_casadi.cli.terminal import Console
from cosserat_casadi.codegen.contact.checks import check_contact, check_load_cases
from cosserat_casadi.codegen.export import check_export, check_period
from cosserat_casadi.codegen.export import export as export_model
from cosserat_casadi.codegen.fmu import check_fmu, write_fmu
from cosserat_casadi.codegen.motion_parts import check_motion
from cosserat_casadi.codegen.names import scene_names
from cosserat_casadi.codegen.stability import check_stability
from cosserat_casadi.codegen.tubes.sources import check_tubes
from cosserat_casadi.equilibrium.locking import locking_sentence
from cosserat_casadi.equilibrium.solution import Solution
from cosserat_casadi.equilibrium.solve import solve
from cosserat_casadi.errors import ExportError, Problem, SceneError, collect_problems, refuse
from cosserat_casadi.files import check_writable
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.mjcf.export import LINKS, Mjcf, check_mjcf, mjcf_of
from cosserat_casadi.model.discretise import discretise
from cosserat_casadi.model.load_cases import case_layout, spread
from cosserat_casadi.page.page import export_page
from cosserat_casadi.page.webassembly import find_wasm_compiler
from cosserat_casadi.scene import Scene, read_scene
from cosserat_casadi.tubes.tube_solution import TubeSolution
from cosserat_casadi.tubes.tube_solve import solve_tubes

APART = "Modes are chosen for rods that pass through each other: no equilibrium in which they touch was found."
"""A sentence on motions in C of rods that touch each other exactly, whose contacts at rest were not found."""

LOAD_CASES = 32
"""Number of load cases in the ranges, in exact contact."""


@dataclass(frozen=True)
class Asked:
    """Folder, files and options of an export; None for a folder or file that is not requested.

    Attributes:
        name: prefix of every C symbol.
        output: folder of the sources in C.
        page: file of the page for a browser.
        fmu: file of the FMU, for other simulators.
        mjcf: file of the MuJoCo model.
        parts: whether each part of the sources besides equations, Jacobians and solver is requested, by keyword of
            :func:`cosserat_casadi.export`.
        over: file of load cases, for the exact contacts in the sources.
        period: longest period of a control loop, s.
        estimate_errors: whether the sources return an error estimate with every answer.
    """

    name: str
    output: Path | None
    page: Path | None
    fmu: Path | None
    mjcf: Path | None
    parts: Mapping[str, bool]
    over: Path | None
    period: float | None
    estimate_errors: bool

    @property
    def source_options(self) -> dict[str, bool]:
        """Whether each option of the sources is given in the command."""
        return {
            **{f"--{part}": wanted for part, wanted in self.parts.items()},
            "--over": self.over is not None,
            "--period": self.period is not None,
            "--no-error-estimate": not self.estimate_errors,
        }

    @property
    def files(self) -> dict[str, Path]:
        """Files to write besides the folder, by option."""
        files = {"--page": self.page, "--fmu": self.fmu, "--mjcf": self.mjcf}
        return {option: file for option, file in files.items() if file is not None}

    @property
    def written(self) -> dict[str, Path | None]:
        """Files to write, by option, and files of an earlier export in the folder, which are overwritten."""
        # Files in the folder have their names as keys instead of options.
        there = self.output.iterdir() if self.output is not None and self.output.is_dir() else ()
        return {**self.files, **{f"--output, {file.name}": file for file in there}}

    @property
    def moves(self) -> bool:
        """Whether the model has motions."""
        return self.parts["dynamics"] or self.fmu is not None

    def check(self) -> None:
        """Refuse an empty export, files that cannot be written, and options of sources without a folder.

        Raises:
            ExportError: the export, a file or an option is refused.
        """
        if self.output is None and not self.files:
            remedy = "name a folder for the sources, or a file with --page, --fmu or --mjcf"
            raise ExportError(Problem("--output", "missing", remedy))
        problems: list[Problem] = []
        if self.output is None:
            remedy = "name a folder for them with --output, or leave it out"
            lost = [option for option, asked in self.source_options.items() if asked]
            problems += [Problem(option, "is for the sources in C", remedy) for option in lost]
        else:
            with collect_problems(problems):
                check_export(self.output, self.name)
        checks: dict[str, Callable[[Path], None]] = {
            "--page": partial(check_writable, option="--page"),
            "--fmu": check_fmu,
            "--mjcf": check_mjcf,
        }
        for option, file in self.files.items():
            with collect_problems(problems):
                checks[option](file)
        refuse(problems, ExportError)


def export(
    scene: SceneFile,
    output: Annotated[
        Path | None,
        typer.Option(help="Folder to write: new, empty, or of an earlier export.", show_default=False),
    ] = None,
    page: Annotated[
        Path | None,
        typer.Option(help="HTML page to write: sliders move the robot, the browser solves it.", show_default=False),
    ] = None,
    fmu: Annotated[
        Path | None,
        typer.Option(help="File to write for other simulators: an FMU (FMI 3.0) of the motion.", show_default=False),
    ] = None,
    mjcf: Annotated[
        Path | None,
        typer.Option(help="File to write for MuJoCo, .xml: each rod is a chain of links.", show_default=False),
    ] = None,
    links: Annotated[int, typer.Option(min=1, max=1000, help="Rough number of links of each rod.")] = LINKS,
    name: Annotated[str | None, typer.Option(help="Prefix of C symbols; by default that of the file.")] = None,
    derivatives: Annotated[
        bool, typer.Option("--derivatives", help="Add second derivatives for CasADi, which no controller needs.")
    ] = False,
    dynamics: Annotated[
        bool, typer.Option("--dynamics", help="Add motions: a step of fixed length with its derivatives.")
    ] = False,
    stability: Annotated[
        bool, typer.Option("--stability", help="Add a function that says whether an equilibrium is stable.")
    ] = False,
    batches: Annotated[
        bool,
        typer.Option(
            "--batches",
            help="Add a function for many load cases, solved four at a time in vectors of the processor if possible.",
        ),
    ] = False,
    cuda: Annotated[
        bool,
        typer.Option("--cuda", help="Add batches on a GPU: experimental, they never ran on a GPU and were not timed."),
    ] = False,
    over: Annotated[
        Path | None,
        typer.Option(help="Load cases whose exact contacts the sources hold: a grid (TOML), or rows (CSV)."),
    ] = None,
    ranges: Ranges = None,
    samples: Annotated[
        int | None,
        typer.Option(
            min=1,
            max=10_000,
            help=(
                f"Number of random corners and of random points at which modes are chosen: {SAMPLES}. In exact "
                f"contact, number of load cases in the ranges: {LOAD_CASES}."
            ),
            show_default=False,
        ),
    ] = None,
    period: Annotated[
        float | None,
        typer.Option(help="Most time of a turn of a control loop, s.", show_default=False),
    ] = None,
    estimate_errors: Annotated[
        bool,
        typer.Option(
            "--error-estimate/--no-error-estimate",
            help="Add or leave out the estimate of each answer's error.",
        ),
    ] = True,
    settings: Settings = None,
) -> None:
    """Write a scene as C sources, a page for a browser, an FMU, or a model of MuJoCo.

    Exit codes: 0 written; 2 refused; 3 not solved and nothing written, or written with an error above the tolerance
    somewhere in the ranges, or on modes that constraints lock, as header, README and manifest say.

    The sources are equations, Jacobians and solver. The page is one file that needs no server and no network. The FMU
    is one file that other simulators step. The model of MuJoCo is written without a solve
    where it has no loops; a sentence names each thing of the scene that it lacks.

    Modes and nodes are chosen so that the tolerance is met over the ranges of the inputs, by --range, the scene's
    [ranges] or [[bounds]], or their scale, or at the load cases of --over. Modes and nodes that the scene fixes are
    verified there.
    """
    name = name if name is not None else re.sub(r"\W", "_", scene.stem)
    parts = {"derivatives": derivatives, "dynamics": dynamics, "stability": stability, "batches": batches, "cuda": cuda}
    asked = Asked(name, output, page, fmu, mjcf, parts, over, period, estimate_errors)
    # All that can be refused is refused before the solve, which may take a minute.
    read, given_ranges, given_cases = _checked(asked, scene, settings, ranges)
    if read.tubes:
        assert output is not None
        _export_tubes(read, output, name, batches=batches)
        return
    of_links = None if mjcf is None else mjcf_of(read, links)
    # Sources, page and FMU need a model with modes and nodes chosen by a solve.
    if output is None and page is None and fmu is None:
        _write_mjcf(of_links, mjcf)
        return
    cases = given_cases
    if cases is None and ranges and read.touches_exactly:
        cases = spread(ranges, samples or LOAD_CASES, case_layout(read))
    exported_scene = _checked_scene(read, asked)

    # Bases that are free in a motion are held where the scene puts them: without that there is no equilibrium.
    solved_scene = exported_scene.held() if asked.moves else exported_scene
    chosen_cases = None
    if given_cases is not None:
        # The library starts at the inputs of the scene.
        chosen_cases = [{}, *map(case_layout(read).unpack, given_cases)]
    # In exact contact the samples are load cases: a choice of modes at all of them would take minutes.
    in_ranges = None if solved_scene.touches_exactly else samples
    chosen_ranges = given_ranges if given_cases is None else {}
    choice = choose_with_progress(solved_scene, chosen_ranges, in_ranges, chosen_cases)
    solution = solve(choice.model)
    apart = asked.moves and solved_scene.rods_touch_exactly and not solution.converged
    if apart:
        # A motion needs no equilibrium in contact: modes for rods that pass through each other are a guess for it.
        choice = choose_with_progress(solved_scene.without_exact_rods(), chosen_ranges, samples, chosen_cases)
        solution = solve(choice.model)
    _check_solved(solution)
    _write(asked, exported_scene, solution, choice, cases, given_ranges)
    _write_mjcf(of_links, mjcf)
    print_choice(Console(), choice)
    if apart:
        Console().print(APART)
    print_locking(Console(stderr=True), locking_sentence(choice.locked))
    missed = choice.within_tolerance is False
    if missed:
        print_missed(Console(stderr=True), fixed=solved_scene.accuracy.fixed)
    if missed or choice.locked:
        raise typer.Exit(NOT_FOUND)


def _checked(
    asked: Asked, scene_file: Path, settings: list[str] | None, ranges: list[str] | None
) -> tuple[Scene, Given, FloatArray | None]:
    """The scene of a file, the ranges that the command asks for, by column, and its load cases.

    Raises:
        ExportError: with every fault of options, files, scene and ranges, where an option or a file has one.
        SceneError: with every fault of the scene, its ranges and its load cases.
    """
    problems: list[Problem] = []
    with collect_problems(problems):
        asked.check()
    with collect_problems(problems):
        check_inputs_stay(asked.written, scene_file, settings, asked.over)
    scene: Scene | None = None
    given_ranges: Given = {}
    given_cases: FloatArray | None = None
    # A page of help on the scene is named where nothing else is wrong.
    kind = ExportError if problems or asked.over is not None else SceneError
    with collect_problems(problems):
        scene = read_scene(scene_file, tuple(settings or ()))
        if scene.tubes:
            check_tubes({**asked.source_options, "--range": bool(ranges), **dict.fromkeys(asked.files, True)})
        else:
            with collect_problems(problems):
                check_period(scene, asked.period)
            with collect_problems(problems):
                given_ranges = asked_ranges(ranges, scene)
            # Without exact contact a file is refused, and modes are chosen all over ranges with a count or without.
            if asked.over is not None:
                check_load_cases(scene, case_layout(scene).default[None])
            if scene.touches_exactly:
                given_cases = asked_cases(asked.over, ranges, scene)
    if problems or scene is None:
        # A range of an unknown input has one fault, as a range and as a grid.
        raise kind(*dict.fromkeys(problems))
    return scene, given_ranges, given_cases


def _checked_scene(scene: Scene, asked: Asked) -> Scene:
    """The scene with the inputs of its export.

    Raises:
        ExportError: the scene, the name or an option is refused.
    """
    if asked.output is not None:
        check_contact(scene, asked.parts)
    if asked.moves:
        scene = scene.with_motion_inputs()
        check_motion(build(scene, discretise(scene, 1, 2), moving=True))
    scene_names(asked.name, scene)
    if asked.parts["stability"]:
        check_stability(build(scene, discretise(scene, 1, 2)))
    if asked.page is not None:
        check_contact(scene, {})
        # Last, because a scene without support for pages has none with a compiler either.
        find_wasm_compiler()
    return scene


def _write(
    asked: Asked,
    scene: Scene,
    solution: Solution,
    choice: Choice,
    cases: FloatArray | None,
    ranges: Given,
) -> None:
    """Write sources, FMU and page of a scene with the chosen modes and nodes, and print their paths."""
    console = Console()
    model = solution.model
    if asked.moves or scene.parameters:
        fixed_scene = fixed_by_rod(scene, choice.model.discretisation, choice.ranges.described)
        model = build(fixed_scene, model.discretisation, moving=asked.moves)
    estimate = solution.error_estimate
    verified = choice.verified
    if asked.output is not None:
        export_model(
            model,
            asked.output,
            asked.name,
            error_estimate=estimate,
            verified=verified,
            **asked.parts,
            load_cases=cases,
            period=asked.period,
            estimate_errors=asked.estimate_errors,
        )
        print_export(console, solution, asked.output)
    if asked.fmu is not None:
        with Console(stderr=True).status("Compiling the FMU"):
            write_fmu(model, asked.fmu, asked.name, error_estimate=estimate, verified=verified)
        console.print(f"wrote {escape(str(asked.fmu))}; simulators that know FMI 3.0 open it", soft_wrap=True)
    if asked.page is not None:
        with Console(stderr=True).status("Compiling the page"):
            export_page(solution, asked.page, ranges, cases)
        console.print(f"wrote {escape(str(asked.page))}; any browser opens it", soft_wrap=True)


def _write_mjcf(model: Mjcf | None, path: Path | None) -> None:
    """Write a model of MuJoCo if requested, and print which objects of the scene it lacks."""
    if model is None or path is None:
        return
    model.write(path)
    for sentence in model.left_out:
        Console(stderr=True).print(escape(sentence), soft_wrap=True)
    Console().print(f"wrote {escape(str(path))}; MuJoCo opens it", soft_wrap=True)


def _check_solved(solution: Solution | TubeSolution) -> None:
    """End the command with a message if there is no equilibrium."""
    if not solution.converged:
        Console(stderr=True).print(f"[bold red]Nothing was written.[/] {solution.message}")
        raise typer.Exit(NOT_FOUND)


def _export_tubes(scene: Scene, output: Path, name: str, *, batches: bool) -> None:
    """Write concentric tubes with the steps for the inputs of the scene."""
    scene_names(name, scene)
    solution = solve_tubes(scene)
    _check_solved(solution)
    model = build(scene, solution.model.steps)
    export_model(model, output, name, error_estimate=solution.error_estimate, batches=batches)
    print_tubes_export(Console(), solution, output)
