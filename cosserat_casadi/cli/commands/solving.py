"""A solve as commands run it: with a bar on standard error."""

from __future__ import annotations

from pathlib import Path

from cosserat_casadi.accuracy.refine import solve_rods, solve_scene
from cosserat_casadi.cli.progress import solve_display
from cosserat_casadi.equilibrium.solution import Solution
from cosserat_casadi.results.solution_file import Solved
from cosserat_casadi.scene import Scene
from cosserat_casadi.tubes.equilibria import TubeEquilibria
from cosserat_casadi.tubes.solution import TubeSolution


def solve_with_progress(scene: Scene, *, stable: bool = False) -> Solution | TubeSolution:
    """Solve a scene and show how far the solve is."""
    with solve_display("Solving") as display:
        return solve_scene(scene, stable=stable, progress=display.show_share, report=display.show_stage)


def solve_rods_with_progress(scene: Scene) -> Solution:
    """The same of a scene of rods alone."""
    with solve_display("Solving") as display:
        return solve_rods(scene, progress=display.show_share, report=display.show_stage)


def draw_solution(solution: Solved, file: Path) -> None:
    """Draw a solution into a file."""
    # Imported here, because matplotlib is an extra and takes long to load.
    from cosserat_casadi.plots.scene_plot import save_plot
    from cosserat_casadi.plots.tubes_plot import save_tubes_plot

    if isinstance(solution, Solution):
        save_plot(solution, file)
    elif isinstance(solution, TubeEquilibria):
        save_tubes_plot(solution.solutions, file)
    else:
        save_tubes_plot([solution], file)
