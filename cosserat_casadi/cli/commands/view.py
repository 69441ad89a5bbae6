"""``cosserat view``."""

from __future__ import annotations

import webbrowser
from typing import Annotated, Any

import typer

from cosserat_casadi.cli.commands.solve import solve_with_progress
from cosserat_casadi.cli.commands.tune import choose_with_progress
from cosserat_casadi.cli.exit_codes import NOT_FOUND
from cosserat_casadi.cli.options import Ranges, SceneFile, Settings, asked_ranges
from cosserat_casadi.cli.progress import count_display
from cosserat_casadi.cli.reports.model import print_choice, print_locking
from cosserat_casadi.cli.signals import StoppedError
from cosserat_casadi.cli.terminal import Console
from cosserat_casadi.compiling.compiler import find_compiler
from cosserat_casadi.equilibrium.locking import locking_note, locking_sentence
from cosserat_casadi.equilibrium.solution import Equilibrium, Solution
from cosserat_casadi.equilibrium.solve import solve
from cosserat_casadi.scene import read_scene


def view(
    scene: SceneFile,
    port: Annotated[int, typer.Option(min=0, max=65535, help="Port of this machine; 0 takes a free one.")] = 0,
    browser: Annotated[bool, typer.Option(help="Open a browser.")] = True,
    ranges: Ranges = None,
    settings: Settings = None,
) -> None:
    """Move a scene in a browser, by sliders or by its tip; see vibrations and motions. Ctrl-C ends the command.

    Modes and nodes are chosen so that the tolerance is met wherever the sliders go. Their ends are taken from --range,
    the scene's [ranges] or [[bounds]], or the scale of the input. With --range, modes and nodes that the scene fixes
    are verified, and in exact contact they are chosen.

    Only this machine reaches the page, and only who knows its address. Exit codes: 2 refused, 3 not solved, 130 ended.
    """
    # Imported here, because motions and inverse problems are needed by few commands.
    from cosserat_casadi.view.server import RobotServer, check_port
    from cosserat_casadi.view.view_session import is_compiled, opened

    check_port(port)
    viewed_scene = read_scene(scene, tuple(settings or ()))
    asked = asked_ranges(ranges, viewed_scene)
    if is_compiled(viewed_scene):
        find_compiler()
    choice = None
    solution: Equilibrium[Any]
    # Every answer in the view has an error estimate: modes fixed by the scene need no verification before, and in exact
    # contact, where a choice takes up to minutes, modes are chosen for the scene's inputs.
    if viewed_scene.tubes or (not asked and (viewed_scene.accuracy.fixed or viewed_scene.touches_exactly)):
        solution = solve_with_progress(viewed_scene)
        if isinstance(solution, Solution):
            print_locking(Console(stderr=True), locking_note(solution))
    else:
        choice = choose_with_progress(viewed_scene, asked)
        solution = solve(choice.model)
    if not solution.converged:
        Console(stderr=True).print(f"[bold red]Nothing to view.[/] {solution.message}")
        raise typer.Exit(NOT_FOUND)
    with count_display("Writing the model in C") as show_count:
        session = opened(solution, show_count, asked)
    console = Console()
    if choice is not None:
        print_choice(console, choice)
        print_locking(Console(stderr=True), locking_sentence(choice.locked))
    with RobotServer(session, port) as server:
        console.print(f"The robot is at {server.address} until you press Ctrl-C.")
        if browser:
            webbrowser.open(server.address_for_once)
        try:
            server.serve_forever()
        except KeyboardInterrupt:
            console.print("Ended.")
            raise StoppedError from None
