"""Concentric tubes: what ``solve``, ``path``, ``export`` and ``check`` do with a scene of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import typer
from rich.console import Console

from cosserat_casadi.cli.exit_codes import NOT_FOUND
from cosserat_casadi.cli.options import given_files
from cosserat_casadi.cli.progress import solve_display
from cosserat_casadi.cli.reports.tubes import (
    print_equilibria,
    print_tube_path,
    print_tubes,
    print_tubes_check,
    print_tubes_export,
    print_tubes_unstable,
)
from cosserat_casadi.cli.terminal import binary_output
from cosserat_casadi.codegen.export import export
from cosserat_casadi.codegen.tubes.sources import tube_names
from cosserat_casadi.errors import Problem, SceneError
from cosserat_casadi.files import write_atomically, write_whole
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.results.json_text import json_text
from cosserat_casadi.results.tubes_file import (
    equilibria_result,
    tube_path_result,
    tube_path_table,
    tubes_result,
)
from cosserat_casadi.scene import Scene
from cosserat_casadi.tubes.equilibria import all_equilibria
from cosserat_casadi.tubes.path import follow_tubes
from cosserat_casadi.tubes.robot import robot_of
from cosserat_casadi.tubes.solution import TubeSolution
from cosserat_casadi.tubes.solve import solve_tubes


@dataclass(frozen=True)
class Outputs:
    """Where a command writes to.

    Attributes:
        output: file for the result, JSON.
        plot: file for the figure.
        table: file for the points of a path, CSV.
        as_json: whether the result goes to standard output, and nothing else.
    """

    output: Path | None
    plot: Path | None
    table: Path | None = None
    as_json: bool = False

    def write(self, data: dict[str, Any]) -> None:
        """Write the result where it was asked for."""
        text = json_text(data).encode()
        if self.output is not None:
            write_atomically(self.output, text)
        if self.as_json:
            write_whole(binary_output(), text)

    @property
    def files(self) -> list[Path]:
        """Files that were written."""
        return given_files(self.output, self.table, self.plot)


def solve_tube_scene(scene: Scene, outputs: Outputs, *, stable: bool) -> None:
    """``cosserat solve`` of tubes: one equilibrium.

    Raises:
        SceneError: with ``stable``, the loads have no energy.
        Exit: none was found; with ``stable``, no stable one.
    """
    if stable and not robot_of(scene).has_energy:
        problem = "the loads have no energy, which would tell what is stable"
        raise SceneError(Problem("--stable", problem, "leave it out"))
    solution = solve_tubes(scene)
    if stable and not solution.stable:
        of_least_energy = all_equilibria(scene).stable[:1]
        solution = next(iter(of_least_energy), solution)
    outputs.write(tubes_result(solution))
    _draw([solution], outputs.plot)
    if not outputs.as_json:
        print_tubes(Console(), solution, outputs.files)
    if solution.converged and solution.stable is False and not stable:
        print_tubes_unstable(Console(stderr=True))
    found = solution.converged and (solution.stable or not stable)
    if not found:
        raise typer.Exit(NOT_FOUND)


def solve_all_of_tubes(scene: Scene, outputs: Outputs) -> None:
    """``cosserat solve --all``: every equilibrium.

    Raises:
        Exit: some may be missing.
    """
    equilibria = all_equilibria(scene)
    outputs.write(equilibria_result(equilibria))
    if not equilibria.solutions:
        # There is nothing to draw.
        outputs = replace(outputs, plot=None)
    _draw(equilibria.solutions, outputs.plot)
    if not outputs.as_json:
        print_equilibria(Console(), equilibria, outputs.files)
    if not equilibria.complete:
        raise typer.Exit(NOT_FOUND)


def follow_tube_scene(scene: Scene, name: str, value: FloatArray, outputs: Outputs) -> None:
    """``cosserat path`` of tubes: from the scene's value of an input to another.

    Raises:
        SceneError: the input or its value is refused.
        Exit: the value was not reached.
    """
    if value.size != 1:
        raise SceneError(
            Problem("--to", f"must be one number, got {value.size}", "name one number of a load, such as push.force.z")
        )
    with solve_display("Following the path") as display:
        path = follow_tubes(scene, name, value.item(), progress=display.show_share)
    outputs.write(tube_path_result(path))
    if outputs.table is not None:
        write_atomically(outputs.table, tube_path_table(path).encode())
    if outputs.plot is not None:
        # Imported here, because matplotlib is an extra and takes long to load.
        from cosserat_casadi.plots.tubes_plot import save_tube_path_plot

        save_tube_path_plot(path, outputs.plot)
    print_tube_path(Console(), path, outputs.files)
    if not path.converged:
        raise typer.Exit(NOT_FOUND)


def export_tube_scene(scene: Scene, output: Path, name: str) -> None:
    """``cosserat export`` of tubes: C sources.

    Raises:
        ExportError: the name is refused.
        Exit: no equilibrium was found.
    """
    tube_names(name, robot_of(scene))
    solution = solve_tubes(scene)
    if not solution.converged:
        Console(stderr=True).print(f"[bold red]Nothing was written.[/] {solution.message}", highlight=False)
        raise typer.Exit(NOT_FOUND)
    export(solution.model, output, name, error_estimate=solution.error_estimate)
    print_tubes_export(Console(), solution, output)


def check_tube_scene(scene: Scene) -> None:
    """``cosserat check`` of tubes."""
    print_tubes_check(Console(), robot_of(scene))


def _draw(solutions: Sequence[TubeSolution], file: Path | None) -> None:
    if file is None:
        return
    # Imported here, because matplotlib is an extra and takes long to load.
    from cosserat_casadi.plots.tubes_plot import save_tubes_plot

    save_tubes_plot(solutions, file)
