"""A solve as commands run it: with a bar on standard error."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from cosserat_casadi.accuracy.refine import solve, solve_rods
from cosserat_casadi.cli.progress import solve_display
from cosserat_casadi.equilibrium.solution import Solution
from cosserat_casadi.results.solution_file import Solved
from cosserat_casadi.scene import Scene

if TYPE_CHECKING:
    from cosserat_casadi.tubes.tube_solution import TubeSolution


def solve_with_progress(scene: Scene, *, stable: bool = False) -> Solution | TubeSolution:
    """Solve a scene and show how far the solve is."""
    with solve_display("Solving") as display:
        return solve(scene, stable=stable, progress=display.show_share, report=display.show_stage)


def solve_rods_with_progress(scene: Scene) -> Solution:
    """The same of a scene of rods alone."""
    with solve_display("Solving") as display:
        return solve_rods(scene, progress=display.show_share, report=display.show_stage)


def draw_solution(solution: Solved, file: Path) -> None:
    """Draw a solution into a file."""
    # Imported here, because matplotlib is an extra and takes long to load.
    if isinstance(solution, Solution):
        from cosserat_casadi.plots.scene_plot import save_plot

        save_plot(solution, file)
    else:
        from cosserat_casadi.plots.tubes_plot import save_tubes_plot

        save_tubes_plot(solution, file)
