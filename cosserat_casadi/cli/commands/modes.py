"""``cosserat modes``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from cosserat_casadi.cli.exit_codes import NOT_FOUND
from cosserat_casadi.cli.options import SceneFile, Settings, check_files, read_checked
from cosserat_casadi.cli.progress import solve_display
from cosserat_casadi.cli.reports.motion import print_modes
from cosserat_casadi.cli.terminal import Console
from cosserat_casadi.errors import Problem, SceneError
from cosserat_casadi.motion.vibration_modes import DEFAULT_COUNT, Modes, modes_of
from cosserat_casadi.results.presentation import write_all


def modes(
    scene: SceneFile,
    count: Annotated[int, typer.Option(help="Number of modes, from the lowest frequency on.")] = DEFAULT_COUNT,
    settings: Settings = None,
    output: Annotated[Path | None, typer.Option(help="Write the modes (JSON) here.")] = None,
    plot: Annotated[Path | None, typer.Option(help="Draw the modes here: .png, .pdf or .svg.")] = None,
    animation: Annotated[Path | None, typer.Option(help="Draw one swinging mode here: .gif or .mp4.")] = None,
    mode: Annotated[int, typer.Option(metavar="NUMBER", help="Mode that --animation shows.")] = 1,
) -> None:
    """Find frequencies, damping and shapes of small vibrations about the equilibrium, and whether it is stable.

    Exit codes: 0 found to the tolerance, 2 refused, 3 no equilibrium, or frequencies not to the tolerance.
    """
    problems: list[Problem] = []
    if count < 1:
        problems.append(Problem("--count", f"must be 1 or more, got {count}"))
    elif not 1 <= mode <= count:
        problems.append(Problem("--mode", f"must be from 1 to {count}, got {mode}", "ask for more modes with --count"))
    check_files({"--output": output, "--plot": plot, "--animation": animation}, scene, settings, problems)
    checked_scene = read_checked(scene, settings, problems)

    with solve_display("Finding modes") as display:
        found = modes_of(checked_scene, count=count, progress=display.show_share, report=display.show_stage)
    _check_mode_is_there(found, animation, mode)
    written = write_all(found, output, plot)
    # Without an equilibrium there are no modes.
    if animation is not None and found.modes:
        written.append(found.animate(animation, mode=mode))
    print_modes(Console(), found, written)
    if not found.converged:
        raise typer.Exit(NOT_FOUND)


def _check_mode_is_there(found: Modes, animation: Path | None, number: int) -> None:
    """Refuse to draw a mode that does not exist: a scene with few masses has fewer modes than requested.

    Raises:
        SceneError: there are modes, but not this one.
    """
    count = len(found.modes)
    if animation is not None and 0 < count < number:
        raise SceneError(Problem("--mode", f"must be from 1 to {count}: the scene has no more modes; got {number}"))
