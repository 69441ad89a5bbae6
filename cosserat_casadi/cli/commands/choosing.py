"""The choice of a discretisation with a progress bar."""

from __future__ import annotations

from collections.abc import Sequence

from cosserat_casadi.accuracy.choose import Choice, choose
from cosserat_casadi.accuracy.common_modes import Values
from cosserat_casadi.accuracy.ranges import Given
from cosserat_casadi.cli.progress import count_display
from cosserat_casadi.equilibrium.solution import Solution
from cosserat_casadi.equilibrium.solve import solve
from cosserat_casadi.scene import Scene


def choose_with_progress(
    scene: Scene,
    ranges: Given | None = None,
    samples: int | None = None,
    cases: Sequence[Values] | None = None,
) -> Choice:
    """One discretisation for ranges or for load cases; see :func:`cosserat_casadi.accuracy.choose.choose`."""
    with count_display("Choosing modes and nodes") as show_count:
        return choose(scene, ranges, progress=show_count, samples=samples, cases=cases)


def solve_for_ranges(
    scene: Scene,
    ranges: Given | None = None,
    cases: Sequence[Values] | None = None,
    samples: int | None = None,
) -> tuple[Solution, Choice]:
    """The equilibrium at the scene's own inputs, on modes that are chosen for ranges or for load cases."""
    choice = choose_with_progress(scene, ranges, samples, cases)
    return solve(choice.model), choice
