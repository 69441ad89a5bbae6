"""A solve as commands run it: with a bar on standard error."""

from __future__ import annotations

from pathlib import Path

from cosserat_casadi.accuracy.refine import solve_scene
from cosserat_casadi.cli.progress import solve_display
from cosserat_casadi.equilibrium.solution import Solution
from cosserat_casadi.scene import Scene


def solve_with_progress(scene: Scene, *, stable: bool = False) -> Solution:
    """Solve a scene and show how far the solve is."""
    with solve_display("Solving") as display:
        return solve_scene(scene, stable=stable, progress=display.show_share, report=display.show_stage)


def draw_solution(solution: Solution, file: Path) -> None:
    """Draw a solution into a file."""
    # Imported here, because matplotlib is an extra and takes long to load.
    from cosserat_casadi.plots.scene_plot import save_plot

    save_plot(solution, file)
