"""``cosserat path``."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Annotated

import numpy as np
import typer
from rich.console import Console

from cosserat_casadi.cli.exit_codes import NOT_FOUND
from cosserat_casadi.cli.options import (
    SceneFile,
    Settings,
    check_file,
    check_inputs_stay,
    check_outputs,
    collect_problems,
)
from cosserat_casadi.cli.progress import solve_display
from cosserat_casadi.cli.reports.path import print_path
from cosserat_casadi.cli.reports.tubes import print_tube_path
from cosserat_casadi.errors import Problem, SceneError
from cosserat_casadi.loads.load import coefficients
from cosserat_casadi.maths.numbers import known
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import build
from cosserat_casadi.paths.path_refinement import follow
from cosserat_casadi.paths.tube_path import TubePath
from cosserat_casadi.results.presentation import write_all
from cosserat_casadi.scene import Scene, read_scene
from cosserat_casadi.tubes.robot import robot_of


def path(
    scene: SceneFile,
    name: Annotated[str, typer.Option("--input", metavar="LOAD.FIELD", help="The input to follow: push.force.")],
    to: Annotated[str, typer.Option("--to", metavar="VALUE", help="Its value at factor 1, such as [0,0,-5].")],
    branch: Annotated[bool, typer.Option("--branch", help="Leave along the branch of the first bifurcation.")] = False,
    bifurcation: Annotated[
        int, typer.Option("--bifurcation", help="With --branch: leave at this one; below zero the branch's other half.")
    ] = 1,
    settings: Settings = None,
    output: Annotated[Path | None, typer.Option(help="Write the path (JSON) here.")] = None,
    plot: Annotated[Path | None, typer.Option(help="Draw load against displacement here: .png, .pdf or .svg.")] = None,
    table: Annotated[Path | None, typer.Option("--csv", help="Write the points (CSV) here.")] = None,
) -> None:
    """Follow equilibria while an input grows from zero, through folds. Exit codes: 0, 2 refused, 3 not at factor 1."""
    # Every check adds to the list; the last one raises, so that all faults are seen at once.
    problems: list[Problem] = []
    if bifurcation == 0:
        problems.append(Problem("--bifurcation", "must not be 0", "count from 1; -1 is the other half of that branch"))
    with collect_problems(problems):
        check_outputs(output, plot)
    with collect_problems(problems):
        check_file(table, "--csv", ".csv")
    with collect_problems(problems):
        check_inputs_stay({"--output": output, "--plot": plot, "--csv": table}, scene, settings)
    checked_scene, value = _check_input(scene, tuple(settings or ()), name, to, problems)
    # The branch that follow leaves along is a number; 0 stays on the path.
    branch_number = bifurcation if branch else 0
    with solve_display("Following the path") as display:
        followed = follow(
            checked_scene,
            name,
            value,
            branch=branch_number,
            progress=display.show_share,
            report=display.show_stage,
        )

    written = write_all(followed, output, table, plot)
    if isinstance(followed, TubePath):
        print_tube_path(Console(), followed, written)
    else:
        print_path(Console(), followed, written)
    if not followed.converged:
        raise typer.Exit(NOT_FOUND)


def _check_input(
    scene_file: Path, settings: tuple[str, ...], name: str, text: str, problems: list[Problem]
) -> tuple[Scene, FloatArray]:
    """The scene, and the value of the input that is followed.

    Args:
        scene_file: the scene.
        settings: values of it to change.
        name: the input.
        text: its value, as TOML.
        problems: the refusals so far.

    Raises:
        SceneError: with those problems and every fault of the scene, the input and its value.
    """
    value: FloatArray | None = None
    scene: Scene | None = None
    with collect_problems(problems):
        value = _vector(text)
    with collect_problems(problems):
        scene = read_scene(scene_file, settings)
        _check_name_and_size(scene, name, value)
    if problems or scene is None:
        raise SceneError(*problems)
    return scene, np.asarray(value)


def _check_name_and_size(scene: Scene, name: str, value: FloatArray | None) -> None:
    """Refuse an input that the scene does not have, or a value of another size.

    Args:
        scene: the scene.
        name: the input.
        value: its value; None where it is refused already, and the name alone is left to check.
    """
    if scene.tubes:
        robot_of(scene).input_index(name)
        return
    # Building also refuses what reading cannot see: inputs that over-constrain.
    layout = build(scene).inputs
    if value is None:
        defaults = dict(zip(layout.names, layout.defaults, strict=True))
        value = defaults.get(name, np.zeros(0))
    layout.pack({name: value})


def _vector(text: str) -> FloatArray:
    """A number, or components that are numbers or lists of Legendre coefficients, written as TOML.

    Raises:
        SceneError: the text is none of these, or a number is not finite.
    """
    try:
        # Inside a list the text must be one value: "1], b = [2" would be two keys otherwise.
        value = tomllib.loads(f"value = [{text}]")["value"][0]
        array = _array(value)
    except (tomllib.TOMLDecodeError, LookupError, TypeError, ValueError):
        fault = f"must be a number or a list of numbers, got {text}"
        raise SceneError(Problem("--to", fault, "write it as in TOML: [0, 0, -5.0]")) from None
    if not np.all(np.isfinite(array)):
        raise SceneError(Problem("--to", f"must be finite, got {text}"))
    return array


def _array(value: object) -> FloatArray:
    if isinstance(value, list):
        return known(coefficients(tuple(value)))
    return np.array([value], dtype=float)
