"""Reports of concentric tubes."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.markup import escape
from rich.table import Table

from cosserat_casadi.cli.reports.format import print_outcome, print_written, table_of, title_line
from cosserat_casadi.equilibrium.solution import Equilibrium
from cosserat_casadi.paths.tube_path import TubePath
from cosserat_casadi.results.facts import digits
from cosserat_casadi.spelling import counted
from cosserat_casadi.tubes.robot import Robot
from cosserat_casadi.tubes.tube_equilibria import TubeEquilibria
from cosserat_casadi.tubes.tube_solution import TubeSolution
from cosserat_casadi.tubes.tube_solve import FEWEST_STEPS, model_of


def print_tubes(console: Console, solution: Equilibrium[Any] | TubeEquilibria, written: Sequence[Path]) -> None:
    """Print an equilibrium, or all at the same inputs, and the written files."""
    if isinstance(solution, TubeEquilibria):
        _print_equilibria(console, solution)
    else:
        print_outcome(console, solution.model.scene.title, solution.message, good=solution.converged)
        print_tubes_and_merit(console, solution)
    print_written(console, written)


def print_tubes_and_merit(console: Console, solution: Equilibrium[Any]) -> None:
    """Print the tubes, and the figures of merit."""
    assert isinstance(solution, TubeSolution)
    table = table_of("tube", "rotation, rad", "translation, m", "tip position, m", "angle at the tip, rad")
    for index, (name, tip) in enumerate(solution.tips.items()):
        rotation, translation = solution.inputs[2 * index : 2 * index + 2]
        position = ", ".join(digits(tip.position))
        table.add_row(escape(name), f"{rotation:.6g}", f"{translation:.6g}", position, f"{solution.x[index]:.6g}")
    console.print(table)
    parts = [f"residual {solution.residual_norm:.1e} rad"]
    if solution.error_estimate is not None:
        parts.append(f"estimated error of the tips {solution.error_estimate:.1e}")
    parts += [
        _verdict(solution),
        f"determinant {solution.stability.determinant:.6g}",
        f"energy {solution.energy:.6g} J",
    ]
    console.print("; ".join(parts))


def print_tubes_export(console: Console, solution: TubeSolution, folder: Path) -> None:
    """Print the files, their accuracy, and how to try them."""
    robot = solution.robot
    console.print(title_line(robot.scene.title))
    sizes = f"{solution.model.size} unknowns, {robot.inputs.size} inputs, {solution.model.steps} steps a piece"
    console.print(f"{sizes}; estimated error of the tips at the scene's own inputs: {solution.error_estimate:.1e}.")
    console.print(f"wrote {escape(str(folder))}; its README.md says how to compile and call it")


def _print_equilibria(console: Console, equilibria: TubeEquilibria) -> None:
    """Print the outcome of the search, and a line for each equilibrium."""
    print_outcome(console, equilibria.robot.scene.title, equilibria.message, good=equilibria.complete)
    table = table_of("", "stable", "energy, J", "determinant", "angles at the tips, rad", "tip position, m")
    for number, solution in enumerate(equilibria.solutions, 1):
        table.add_row(
            str(number),
            _verdict(solution),
            f"{solution.energy:.6g}",
            f"{solution.stability.determinant:.6g}",
            ", ".join(digits(solution.angles)),
            ", ".join(digits(solution.tip().position)),
        )
    console.print(table)
    count = len(equilibria.solutions)
    noun = "equilibrium" if count == 1 else "equilibria"
    console.print(f"{count} {noun}, {len(equilibria.stable)} of them stable")


def print_tube_path(console: Console, path: TubePath, written: Sequence[Path]) -> None:
    """Print the outcome, the events and the end of a path, and the files that were written."""
    print_outcome(console, path.model.scene.title, path.message, good=path.converged)
    if path.solutions:
        console.print(_path_table(path))
    parts = [counted(len(path.values), "point"), counted(len(path.events), "event")]
    if path.error_estimate is not None:
        parts.append(f"estimated error of events and end {path.error_estimate:.1e}")
    console.print("; ".join(parts))
    print_written(console, written)


def print_tubes_check(console: Console, robot: Robot) -> None:
    """Print the contents of a valid scene of tubes."""
    console.print(f"{title_line(robot.scene.title)}: the scene is valid.")
    table = table_of("tube", "EI, N m²", "GJ, N m²", "curvature, 1/m", "straight, m", "curved, m")
    for index, name in enumerate(robot.names):
        columns = (robot.bending, robot.torsion, robot.curvature, robot.straight, robot.curved)
        table.add_row(escape(name), *(f"{column[index]:.6g}" for column in columns))
    console.print(table)
    unknowns = model_of(robot, FEWEST_STEPS).size
    console.print(f"{counted(unknowns, 'unknown')}; inputs: {', '.join(robot.columns)}")


def _path_table(path: TubePath) -> Table:
    table = table_of("point", f"{escape(path.name)}, {path.unit}", "after it", "snaps to, m", "energy released, J")
    last = len(path.solutions) - 1
    table.add_row("start", f"{path.values[0]:.10g}", _verdict(path.solutions[0]), "", "")
    for event in path.events:
        beyond = path.solutions[min(event.position, last)]
        cells = ["", ""]
        if event.snaps_to is not None:
            cells = [", ".join(digits(event.snaps_to.tip().position)), f"{event.released_energy:.6g}"]
        table.add_row(event.kind, f"{event.value:.10g}", _verdict(beyond), *cells)
    table.add_row("end", f"{path.values[-1]:.10g}", _verdict(path.solutions[-1]), "", "")
    return table


def _verdict(solution: TubeSolution) -> str:
    if solution.stability.neutral:
        return "neutral"
    if solution.stable is None:
        return "loads without energy: stability has no meaning"
    if solution.stable:
        return "stable"
    return "unstable"
