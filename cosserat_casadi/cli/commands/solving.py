"""A solve as commands run it: with a bar on standard error."""

from __future__ import annotations

from typing import TYPE_CHECKING

from cosserat_casadi.accuracy.refine import solve, solve_rods
from cosserat_casadi.cli.progress import solve_display
from cosserat_casadi.equilibrium.solution import Solution
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
