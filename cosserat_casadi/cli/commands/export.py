"""``cosserat export``."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.markup import escape

from cosserat_casadi.accuracy.fixing import fixed_by_rod
from cosserat_casadi.accuracy.models import build
from cosserat_casadi.cli.commands.choosing import solve_for_ranges
from cosserat_casadi.cli.exit_codes import NOT_FOUND
from cosserat_casadi.cli.options import Ranges, SceneFile, Settings, asked_ranges, check_inputs_stay
from cosserat_casadi.cli.reports.format import print_plain
from cosserat_casadi.cli.reports.model import print_choice, print_export, print_locking, print_missed
from cosserat_casadi.cli.reports.tubes import print_tubes_export
from cosserat_casadi.codegen.contact.checks import check_contact, check_load_cases
from cosserat_casadi.codegen.export import check_batches, check_export, check_period
from cosserat_casadi.codegen.export import export as export_model
from cosserat_casadi.codegen.fmu import check_fmu, write_fmu
from cosserat_casadi.codegen.motion_parts import check_motion
from cosserat_casadi.codegen.names import scene_names
from cosserat_casadi.codegen.stability import check_stability
from cosserat_casadi.codegen.tubes.sources import check_tubes
from cosserat_casadi.equilibrium.locking import locking_sentence
from cosserat_casadi.equilibrium.solution import Solution
from cosserat_casadi.errors import ExportError, Problem, SceneError
from cosserat_casadi.files import check_writable
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.mjcf.export import LINKS, check_mjcf, mjcf_of
from cosserat_casadi.model.discretise import discretise
from cosserat_casadi.model.load_cases import CaseLayout, case_layout, read_load_cases, spread
from cosserat_casadi.page.page import export_page
from cosserat_casadi.page.webassembly import find_wasm_compiler
from cosserat_casadi.scene import Scene, read_scene
from cosserat_casadi.tubes.tube_solution import TubeSolution
from cosserat_casadi.tubes.tube_solve import solve_tubes


def export(
    scene: SceneFile,
    output: Annotated[
        Path | None, typer.Option(help="Folder to write: new, empty, or of an earlier export.", show_default=False)
    ] = None,
    page: Annotated[
        Path | None,
        typer.Option(help="HTML file to write: the robot with sliders, solved in the browser.", show_default=False),
    ] = None,
    fmu: Annotated[
        Path | None,
        typer.Option(help="File to write for other simulators: the motion by FMI 3.0, .fmu.", show_default=False),
    ] = None,
    mjcf: Annotated[
        Path | None,
        typer.Option(help="File to write for MuJoCo: rods as chains of rigid links, .xml.", show_default=False),
    ] = None,
    links: Annotated[int, typer.Option(min=1, max=1000, help="Links of each rod in that file, about.")] = LINKS,
    name: Annotated[str | None, typer.Option(help="What every C symbol begins with; else the scene file's.")] = None,
    derivatives: Annotated[
        bool, typer.Option("--derivatives", help="With second derivatives, for CasADi: no controller needs them.")
    ] = False,
    dynamics: Annotated[
        bool, typer.Option("--dynamics", help="With motions: a step of fixed length with its derivatives.")
    ] = False,
    stability: Annotated[
        bool, typer.Option("--stability", help="With a function that says whether an equilibrium is stable.")
    ] = False,
    batches: Annotated[
        bool, typer.Option("--batches", help="With many load cases solved four at a time, in vectors of the processor.")
    ] = False,
    cuda: Annotated[
        bool,
        typer.Option("--cuda", help="With batches on a GPU: experimental, never run on one, of unmeasured speed."),
    ] = False,
    over: Annotated[
        Path | None, typer.Option(help="Load cases whose exact contacts the sources know: CSV, such as push.force.x.")
    ] = None,
    ranges: Ranges = None,
    samples: Annotated[int, typer.Option(min=1, max=10_000, help="Load cases spread over the ranges.")] = 32,
    period: Annotated[
        float | None,
        typer.Option(help="Seconds that the longest turn of a control loop may take.", show_default=False),
    ] = None,
    estimate_errors: Annotated[
        bool,
        typer.Option(
            "--error-estimate/--no-error-estimate", help="With the estimate of the error of every answer, or without."
        ),
    ] = True,
    settings: Settings = None,
) -> None:
    """Write a scene as C sources, a page for a browser, an FMU, or a model of MuJoCo.

    Exit codes: 0 written; 2 refused; 3 not solved and nothing written, or written with an error above the tolerance
    somewhere in the ranges, or on modes that constraints lock, as header, README and manifest say.

    The sources are equations, Jacobians and solver. The page is one file that needs no server and no network. The FMU
    is one file that other simulators step. The model of MuJoCo is written without a solve;
    a sentence names each thing of the scene that it lacks.

    Modes and nodes are chosen so that the tolerance is met over the ranges of the inputs, by --range, the scene's
    [ranges] or [[bounds]], or their scale, or at the load cases of --over. Modes and nodes that the scene fixes are
    verified there.
    """
    if name is None:
        name = re.sub(r"\W", "_", scene.stem)
    files = {"--page": page, "--fmu": fmu, "--mjcf": mjcf}
    parts = {"derivatives": derivatives, "dynamics": dynamics, "stability": stability, "batches": batches, "cuda": cuda}
    of_sources = {
        **{f"--{part}": wanted for part, wanted in parts.items()},
        "--over": over is not None,
        "--period": period is not None,
        "--no-error-estimate": not estimate_errors,
    }
    # All that can be refused is refused before the solve, which may take a minute.
    _check_files(output, files, name, of_sources)
    check_inputs_stay({**files, **_earlier_files(output)}, scene, settings, over)
    moves = dynamics or fmu is not None
    exported_scene = read_scene(scene, tuple(settings or ()))
    if exported_scene.tubes:
        of_files = {option: file is not None for option, file in files.items()}
        check_tubes({**of_sources, "--range": bool(ranges), **of_files})
        assert output is not None
        _export_tubes(exported_scene, output, name)
        return
    if mjcf is not None:
        _export_mjcf(exported_scene, mjcf, links)
        if output is None and page is None and fmu is None:
            return
    check_period(exported_scene, period)
    cases = None
    if output is not None:
        check_contact(exported_scene, parts)
    layout = case_layout(exported_scene)
    asked = asked_ranges(ranges, exported_scene)
    if over is not None or (ranges and exported_scene.touches_exactly):
        cases = _load_cases(over, ranges or [], samples, layout)
        check_load_cases(exported_scene, cases)
    chosen_cases = None
    if over is not None and cases is not None:
        # A library begins at the scene's own inputs.
        chosen_cases = [{}, *map(layout.unpack, cases)]
    if moves:
        exported_scene = exported_scene.with_motion_inputs()
        check_motion(build(exported_scene, discretise(exported_scene, 1, 2), moving=True))
    scene_names(name, exported_scene)
    if stability:
        check_stability(build(exported_scene, discretise(exported_scene, 1, 2)))
    if batches:
        check_batches(build(exported_scene, discretise(exported_scene, 1, 2)))
    if page is not None:
        # Last: a scene that has no page has none with a compiler either.
        find_wasm_compiler()

    # Bases that are free in a motion are held where the scene puts them: without that there is no equilibrium.
    solved_scene = exported_scene.held() if moves else exported_scene
    solution, choice = solve_for_ranges(solved_scene, asked, chosen_cases)
    verified = choice.verified
    exported_scene = fixed_by_rod(exported_scene, choice.model.discretisation, choice.ranges.described)
    _check_solved(solution)
    console = Console()
    model = solution.model
    if moves or exported_scene.parameters:
        model = build(exported_scene, model.discretisation, moving=moves)
    estimate = solution.error_estimate
    if output is not None:
        export_model(
            model,
            output,
            name,
            error_estimate=estimate,
            verified=verified,
            **parts,
            load_cases=cases,
            period=period,
            estimate_errors=estimate_errors,
        )
        print_export(console, solution, output)
    if fmu is not None:
        with Console(stderr=True).status("Compiling the FMU"):
            write_fmu(model, fmu, name, error_estimate=estimate, verified=verified)
        print_plain(console, f"wrote {escape(str(fmu))}; simulators open it that know FMI 3.0", soft_wrap=True)
    if page is not None:
        with Console(stderr=True).status("Compiling the page"):
            export_page(solution, page, asked)
        print_plain(console, f"wrote {escape(str(page))}; any browser opens it", soft_wrap=True)
    print_choice(console, choice)
    print_locking(Console(stderr=True), locking_sentence(choice.locked))
    missed = choice.within_tolerance is False
    if missed:
        print_missed(Console(stderr=True), fixed=solved_scene.accuracy.fixed)
    if missed or choice.locked:
        raise typer.Exit(NOT_FOUND)


def _export_mjcf(scene: Scene, path: Path, links: int) -> None:
    """Write a model of MuJoCo, and name the things of the scene that it lacks."""
    model = mjcf_of(scene, links)
    model.write(path)
    for sentence in model.left_out:
        print_plain(Console(stderr=True), escape(sentence), soft_wrap=True)
    print_plain(Console(), f"wrote {escape(str(path))}; MuJoCo opens it", soft_wrap=True)


def _load_cases(over: Path | None, ranges: list[str], samples: int, layout: CaseLayout) -> FloatArray:
    """Load cases of a file, or spread over ranges, shape (count, size of a case).

    Raises:
        SceneError: both or none stand in the command, or one of them is refused.
    """
    if over is not None and not ranges:
        return read_load_cases(over, layout)
    if over is None and ranges:
        return spread(ranges, samples, layout)
    raise SceneError(Problem("--over", "stands beside --range, or both are missing", "give one of them"))


def _check_solved(solution: Solution | TubeSolution) -> None:
    """Write nothing where there is no equilibrium, and say why."""
    if not solution.converged:
        Console(stderr=True).print(f"[bold red]Nothing was written.[/] {solution.message}", highlight=False)
        raise typer.Exit(NOT_FOUND)


def _export_tubes(scene: Scene, output: Path, name: str) -> None:
    """Write concentric tubes with the steps that the scene's own inputs need."""
    scene_names(name, scene)
    solution = solve_tubes(scene)
    _check_solved(solution)
    export_model(build(scene, solution.model.steps), output, name, error_estimate=solution.error_estimate)
    print_tubes_export(Console(), solution, output)


def _check_files(
    output: Path | None, files: Mapping[str, Path | None], name: str, of_sources: Mapping[str, bool]
) -> None:
    """Refuse an export without a file, files that cannot be written, and options of sources in C without a folder."""
    if output is None and not any(files.values()):
        remedy = "name a folder for the sources, or a file with --page, --fmu or --mjcf"
        raise ExportError(Problem("--output", "missing", remedy))
    if output is None:
        remedy = "name a folder for them with --output, or leave it out"
        lost = [Problem(option, "is for the sources in C", remedy) for option, asked in of_sources.items() if asked]
        if lost:
            raise ExportError(*lost)
    else:
        check_export(output, name)
    checks: dict[str, Callable[[Path], None]] = {
        "--page": partial(check_writable, option="--page"),
        "--fmu": check_fmu,
        "--mjcf": check_mjcf,
    }
    for option, file in files.items():
        if file is not None:
            checks[option](file)


def _earlier_files(output: Path | None) -> dict[str, Path]:
    """Files of an earlier export in the folder, which are written over."""
    # Names of files are no options: they tell the many of one folder apart.
    there = output.iterdir() if output is not None and output.is_dir() else ()
    return {f"--output, {file.name}": file for file in there}
