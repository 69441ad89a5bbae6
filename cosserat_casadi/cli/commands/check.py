"""``cosserat check``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from cosserat_casadi.accuracy.ranges import input_ranges
from cosserat_casadi.cli.effect_times import effect_times, motion_costs, print_effects, print_motion_times
from cosserat_casadi.cli.options import Ranges, SceneFile, Settings, asked_ranges, check_figure, check_inputs_stay
from cosserat_casadi.cli.progress import count_display
from cosserat_casadi.cli.reports.format import print_written
from cosserat_casadi.cli.reports.model import print_check, print_locking, print_ranges
from cosserat_casadi.cli.reports.tubes import print_tubes_check
from cosserat_casadi.cli.terminal import Console
from cosserat_casadi.compiling.compiler import find_compiler
from cosserat_casadi.equilibrium.locking import NOT_KNOWN, locking_note, may_be_locked
from cosserat_casadi.equilibrium.solve import solve
from cosserat_casadi.errors import Problem, SceneError, refuse
from cosserat_casadi.model.build import Model, build
from cosserat_casadi.model.operation_cost import is_damped, price, prices_of_effects, without_damping
from cosserat_casadi.motion.motion_checks import check_simulation
from cosserat_casadi.scene import Scene, read_scene
from cosserat_casadi.scene.reading import written_tables
from cosserat_casadi.scene.varying import VaryingValue, varying_values
from cosserat_casadi.tubes.robot import robot_of


def check(
    scene: SceneFile,
    ranges: Ranges = None,
    settings: Settings = None,
    plot: Annotated[
        Path | None,
        typer.Option(help="Draw stress against strain of materials that are not linear here: .png, .pdf or .svg."),
    ] = None,
    timed: Annotated[
        bool,
        typer.Option("--time", help="Time each effect in compiled code too, and a motion without compiling it."),
    ] = False,
) -> None:
    """Validate a scene, and list its effects with the cost of the model and of each effect."""
    overrides = tuple(settings or ())
    problems: list[Problem] = []
    check_figure(plot, "--plot", problems)
    refuse(problems)
    checked_scene = read_scene(scene, overrides)
    check_inputs_stay({"--plot": plot}, scene, settings)
    if checked_scene.tubes:
        if ranges:
            raise SceneError(Problem("--range", "needs a scene of rods, and this scene has tubes", "leave it out"))
        if timed:
            raise SceneError(Problem("--time", "times the effects of rods, and this scene has tubes", "leave it out"))
        print_tubes_check(Console(), robot_of(checked_scene))
        return
    asked = asked_ranges(ranges, checked_scene)
    if timed:
        # A missing compiler is reported before any output.
        find_compiler()
    varying: list[VaryingValue] = []
    # A pipe can be read only once.
    if scene.is_file():
        varying = varying_values(checked_scene, written_tables(scene, overrides))
    with count_display("Building the model") as show_count:
        model = build(checked_scene)
        of_effects = prices_of_effects(checked_scene, show_count)
        show_count("Counting the operations of residual and Jacobian", 0, 0)
        cost = price(model)
        show_count("Choosing the ranges of inputs", 0, 0)
        of_inputs = input_ranges(checked_scene, asked)
        show_count("Looking for constraints that lock", 0, 0)
        locking = _locking(model)
    print_check(Console(), model, varying, cost, of_effects)
    print_ranges(Console(), of_inputs)
    print_locking(Console(), locking)
    if plot is not None:
        _draw(checked_scene, plot)
    if timed:
        _print_times(checked_scene)
    if timed and checked_scene.simulation is not None:
        _print_motion_times(checked_scene)


def _locking(model: Model) -> str:
    """The sentence on locking, from an equilibrium; empty without locking."""
    if not may_be_locked(model):
        return ""
    solution = solve(model, estimate_error=False)
    return locking_note(solution) if solution.converged else NOT_KNOWN


def _draw(scene: Scene, file: Path) -> None:
    # Imported here, because matplotlib is an extra and takes long to load.
    from cosserat_casadi.plots.figure import write_figure
    from cosserat_casadi.plots.material_plot import plot_materials

    write_figure(plot_materials(scene), file)
    print_written(Console(), [file])


def _print_times(scene: Scene) -> None:
    with count_display("Building the scene without each effect") as show_count:
        whole, parts = effect_times(scene, find_compiler(), show_count)
    rods = [rod.name for rod in scene.rods]
    print_effects(Console(), rods, whole, parts)


def _print_motion_times(scene: Scene) -> None:
    with Console(stderr=True).status("Counting and timing the equations of motion"):
        model = build(scene.with_motion_inputs(), moving=True)
        check_simulation(model, scene.simulation)
        models = [model]
        if is_damped(scene):
            models.append(build(without_damping(scene.with_motion_inputs()), moving=True))
        motion, *undamped = motion_costs(*models)
    print_motion_times(Console(), model.size, motion, *undamped)
