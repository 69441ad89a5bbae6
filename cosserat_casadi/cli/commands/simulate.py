"""``cosserat simulate``."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Annotated

import typer

from cosserat_casadi.cli.exit_codes import NOT_FOUND
from cosserat_casadi.cli.options import SceneFile, Settings, check_files, given_files
from cosserat_casadi.cli.progress import motion_display, share_display
from cosserat_casadi.cli.reports.format import print_warnings
from cosserat_casadi.cli.reports.motion import print_hasty_animation, print_motion
from cosserat_casadi.cli.signals import StoppedError
from cosserat_casadi.cli.terminal import Console
from cosserat_casadi.errors import Problem, SceneError, collect_problems
from cosserat_casadi.files import MESHES, check_writable
from cosserat_casadi.model.tube_checks import refuse_tubes
from cosserat_casadi.motion.going_on import StartOfMotion
from cosserat_casadi.motion.parts import check_parts
from cosserat_casadi.motion.trajectory import Motion, MotionOutcome
from cosserat_casadi.results.motion_file import check_motion_path
from cosserat_casadi.results.start_file import read_start
from cosserat_casadi.scene import Scene, read_scene

HASTY_FRAMES = 10
"""Least number of frames of a useful animation."""

UNHURRIED = 5.0
"""Duration of an animation at the speed proposed for one with few frames, s."""


def simulate(
    scene: SceneFile,
    output: Annotated[Path | None, typer.Option(help="Write the motion here: .json, .csv, .parquet or .npz.")] = None,
    plot: Annotated[Path | None, typer.Option(help="Draw a figure here: .png, .pdf or .svg.")] = None,
    animation: Annotated[
        Path | None, typer.Option(help="Draw an animation here: .gif or .mp4; moving meshes: .glb or .usda.")
    ] = None,
    speed: Annotated[
        float,
        typer.Option(metavar="FACTOR", help="Speed of the animation: 1 is that of the motion, 0.1 ten times slower."),
    ] = 1.0,
    start: Annotated[
        Path | None,
        typer.Option(
            "--from", metavar="RESULT", help="Start at rest from this result file of solve, or go on with this motion."
        ),
    ] = None,
    step: Annotated[float | None, typer.Option(help="Fixed time step, s; by default the tolerance decides.")] = None,
    duration: Annotated[float | None, typer.Option(help="Time to simulate, s.")] = None,
    frames: Annotated[int | None, typer.Option(help="Number of rows of the result, evenly in time.")] = None,
    tolerance: Annotated[
        float | None, typer.Option(help="Most error of the tip's path, over the rod's length.")
    ] = None,
    compiled: Annotated[
        bool | None,
        typer.Option(
            "--compiled/--interpreted",
            help="Compile the equations, for later motions too; by default if it saves time.",
            show_default=False,
        ),
    ] = None,
    part: Annotated[
        float | None,
        typer.Option(metavar="SECONDS", help="Write parts of this duration, s, to OUTPUT-0001 and so on."),
    ] = None,
    settings: Settings = None,
) -> None:
    """Simulate the motion of a scene over time.

    Exit codes: 0 computed to its end, 2 refused, 3 ended early, 130 interrupted. The motion is written as far as
    it was computed, in any case but 2.
    """
    # Options for keys of the scene come last: they override --set.
    keys = {"step": step, "duration": duration, "frames": frames, "tolerance": tolerance}
    overrides = (f"simulation.{key}={value!r}" for key, value in keys.items() if value is not None)
    # Faults of an override name its option.
    options = {f"--set simulation.{key}": f"--{key}" for key, value in keys.items() if value is not None}
    problems: list[Problem] = []
    if output is not None:
        with collect_problems(problems):
            check_writable(output, "--output")
        with collect_problems(problems):
            check_motion_path(output)
    if not speed > 0.0:
        problems.append(Problem("--speed", f"must be > 0, got {speed:g}", "0.1 shows the motion ten times slower"))
    files = {"--output": output, "--plot": plot, "--animation": animation}
    check_files(files, scene, settings, problems, start, output_suffix=None, meshes="--animation")
    if part is not None:
        with collect_problems(problems):
            check_parts(output, part)
    checked_scene, start_solution = _check_scene(scene, (*(settings or ()), *overrides), options, start, problems)

    motion = _simulate_with_progress(checked_scene, start_solution, compiled, output, part)
    if output is not None and part is None:
        motion.write(output)
    if output is not None and part is not None:
        output = output.with_stem(f"{output.stem}-*")
    if motion.outcome is MotionOutcome.INTERRUPTED:
        # After an interrupt no pictures are drawn, which would take time.
        print_motion(Console(), motion, given_files(output))
        raise StoppedError
    # A motion without states has no picture.
    if not len(motion.times):
        plot = None
        animation = None
    if plot is not None:
        motion.write(plot)
    if animation is not None:
        _animate(motion, animation, speed)
    print_motion(Console(), motion, given_files(output, plot, animation))
    print_warnings(Console(stderr=True), motion.warnings)
    if not motion.converged:
        raise typer.Exit(NOT_FOUND)


def _check_scene(
    scene_file: Path,
    overrides: tuple[str, ...],
    options: Mapping[str, str],
    start: Path | None,
    problems: list[Problem],
) -> tuple[Scene, StartOfMotion]:
    """The scene, and the start of the motion if a file gives one.

    Raises:
        SceneError: with those problems and every fault of the scene and the result file.
    """
    scene: Scene | None = None
    solution: StartOfMotion = None
    with collect_problems(problems):
        scene = read_scene(scene_file, overrides)
        refuse_tubes(scene)
        if scene.simulation is None:
            remedy = "add a table [simulation] with duration = 1.0 (s), or give --duration"
            problems.append(Problem("simulation", "missing: it says how long to simulate", remedy))
        if start is not None:
            solution = read_start(start, scene)
    if problems or scene is None:
        raise SceneError(*(replace(found, where=options.get(found.where, found.where)) for found in problems))
    return scene, solution


def _simulate_with_progress(
    scene: Scene, start: StartOfMotion, compiled: bool | None, output: Path | None, part: float | None
) -> Motion:
    """Simulate a scene with a progress bar."""
    # Imported here, because the integrator is needed by this command alone.
    from cosserat_casadi.motion.motion_refinement import simulate

    with motion_display() as show_motion:
        return simulate(
            scene, start=start, progress=show_motion, compiled=compiled, output=output if part else None, part=part
        )


def _animate(motion: Motion, file: Path, speed: float) -> None:
    """Draw an animation, and print how to slow it down if it has very few frames."""
    with share_display("Drawing the animation") as show_share:
        motion.animate(file, speed=speed, progress=show_share)
    if file.suffix.lower() in MESHES:
        return
    from cosserat_casadi.plots.animation import frame_times

    frames = len(frame_times(motion, speed))
    computed_time = float(motion.times[-1] - motion.times[0])
    if frames < HASTY_FRAMES and computed_time > 0.0:
        # One digit is enough for a proposed factor.
        proposed = float(f"{computed_time / UNHURRIED:.1g}")
        print_hasty_animation(Console(stderr=True), frames, proposed)
