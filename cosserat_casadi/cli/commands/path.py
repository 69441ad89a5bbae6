"""``cosserat path``."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from cosserat_casadi.cli.exit_codes import NOT_FOUND
from cosserat_casadi.cli.options import SceneFile, Settings, check_files
from cosserat_casadi.cli.progress import share_display, solve_display
from cosserat_casadi.cli.reports.path import print_path
from cosserat_casadi.cli.reports.tubes import print_tube_path
from cosserat_casadi.cli.terminal import Console
from cosserat_casadi.errors import Problem, SceneError, collect_problems
from cosserat_casadi.loads.load import coefficients
from cosserat_casadi.maths.numbers import known
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import build
from cosserat_casadi.model.load_cases import AskedRange, column_indices, read_range
from cosserat_casadi.numerics.arclength import ArcSettings
from cosserat_casadi.paths.path_refinement import follow
from cosserat_casadi.paths.tube_path import TubePath, usual_limits
from cosserat_casadi.results.presentation import write_all
from cosserat_casadi.scene import Scene, read_scene
from cosserat_casadi.spelling import closest, counted
from cosserat_casadi.tubes.robot import robot_of

MOST_POINTS = 1000
"""Largest number of points in a range: half of the largest number of steps."""


@dataclass(frozen=True)
class _Way:
    """The values of the input along a path.

    Attributes:
        name: the input.
        value: its value at the end.
        start: value at the start of the path, by name of the input; empty for the default.
        limits: limits of the path; None for the default.
    """

    name: str
    value: FloatArray
    start: dict[str, FloatArray] = field(default_factory=dict)
    limits: ArcSettings | None = None


def path(
    scene: SceneFile,
    name: Annotated[
        str | None, typer.Option("--input", metavar="LOAD.FIELD", help="The input to follow from zero: push.force.")
    ] = None,
    to: Annotated[
        str | None, typer.Option("--to", metavar="VALUE", help="Its value at factor 1, such as [0,0,-5].")
    ] = None,
    ranges: Annotated[
        list[str] | None,
        typer.Option(
            "--range",
            metavar="COLUMN=FROM:TO:COUNT",
            help="One number of an input, from a value to another, in COUNT points or more; instead of --input.",
        ),
    ] = None,
    branch: Annotated[bool, typer.Option("--branch", help="Follow the branch of the first bifurcation.")] = False,
    bifurcation: Annotated[
        int, typer.Option("--bifurcation", help="Bifurcation of --branch; below zero, the other half of its branch.")
    ] = 1,
    settings: Settings = None,
    output: Annotated[Path | None, typer.Option(help="Write the path (JSON) here.")] = None,
    plot: Annotated[Path | None, typer.Option(help="Draw load against displacement here: .png, .pdf or .svg.")] = None,
    table: Annotated[Path | None, typer.Option("--csv", help="Write the points (CSV) here.")] = None,
    animation: Annotated[Path | None, typer.Option(help="Draw the moving shapes here: .gif or .mp4.")] = None,
) -> None:
    """Follow equilibria while an input moves, through folds. Exit codes: 0, 2 refused, 3 not at factor 1."""
    # Every check adds to the list, and the last one raises, so that all faults are reported at once.
    problems: list[Problem] = []
    if bifurcation == 0:
        problems.append(Problem("--bifurcation", "must not be 0", "count from 1; -1 is the other half of that branch"))
    files = {"--output": output, "--plot": plot, "--csv": table, "--animation": animation}
    check_files(files, scene, settings, problems)
    checked_scene, way = _check_way(scene, tuple(settings or ()), name, to, ranges or [], problems)
    # The branch that follow leaves along is a number; 0 stays on the path.
    branch_number = bifurcation if branch else 0
    with solve_display("Following the path") as display:
        followed = follow(
            checked_scene,
            way.name,
            way.value,
            way.start,
            branch=branch_number,
            settings=way.limits,
            progress=display.show_share,
            report=display.show_stage,
        )

    written = write_all(followed, output, table, plot)
    # A path without points has no figure.
    if animation is not None and len(followed.factor):
        with share_display("Drawing the animation") as show_share:
            written.append(followed.animate(animation, progress=show_share))
    if isinstance(followed, TubePath):
        print_tube_path(Console(), followed, written)
    else:
        print_path(Console(), followed, written)
    if not followed.converged:
        raise typer.Exit(NOT_FOUND)


def _check_way(
    scene_file: Path,
    settings: tuple[str, ...],
    name: str | None,
    text: str | None,
    ranges: list[str],
    problems: list[Problem],
) -> tuple[Scene, _Way]:
    """The scene, and the values of its input along the path.

    Args:
        scene_file: file of the scene.
        settings: changed values of the scene.
        name: the input.
        text: its value, as TOML.
        ranges: texts of --range.
        problems: the refusals so far.

    Raises:
        SceneError: with those problems and every fault of the scene, the input and its value.
    """
    value: FloatArray | None = None
    asked: AskedRange | None = None
    scene: Scene | None = None
    way: _Way | None = None
    with collect_problems(problems):
        _check_spelling(name, text, ranges)
    with collect_problems(problems):
        value = None if text is None else _vector(text)
    with collect_problems(problems):
        asked = _asked_range(ranges[0]) if ranges else None
    with collect_problems(problems):
        scene = read_scene(scene_file, settings)
        if name is not None:
            _check_name_and_size(scene, name, value)
            way = None if value is None else _Way(name, value)
        elif asked is not None:
            way = _way_of(scene, asked)
    if problems or scene is None or way is None:
        raise SceneError(*problems)
    return scene, way


def _check_spelling(name: str | None, text: str | None, ranges: list[str]) -> None:
    """Refuse options that are neither --input with --to nor one --range."""
    if ranges and (name is not None or text is not None):
        raise SceneError(Problem("--range", "stands beside --input or --to", "give one of them"))
    if len(ranges) > 1:
        raise SceneError(Problem("--range", "stands more than once: a path follows one input", "or use cosserat sweep"))
    if ranges:
        return
    example = "or write --range push.force.z=0:-5:21"
    if name is None:
        raise SceneError(Problem("--input", "is missing: the input to follow", example))
    if text is None:
        raise SceneError(Problem("--to", f"is missing: the value that {name} goes to", example))


def _asked_range(text: str) -> AskedRange:
    asked = read_range(text)
    if asked.low == asked.high:
        raise SceneError(Problem("--range", f"{text!r} ends where it begins", "give another value to go to"))
    if asked.count is not None and not 2 <= asked.count <= MOST_POINTS:
        remedy = f"a path has 2 to {MOST_POINTS} points; leave the count out for as many as it needs"
        raise SceneError(Problem("--range", f"{text!r} asks for {counted(asked.count, 'point')}", remedy))
    return asked


def _way_of(scene: Scene, asked: AskedRange) -> _Way:
    """The values of an input with one number going from a value to another; other numbers keep the values of the scene.

    Raises:
        SceneError: the scene has no such number.
    """
    robot = robot_of(scene) if scene.tubes else None
    layout = build(scene).inputs if robot is None else robot.layout
    columns = column_indices(layout)
    if asked.column not in columns:
        names = ", ".join(columns) or "none"
        raise SceneError(Problem("--range", f"{asked.column!r} is no number of an input", f"its columns are {names}"))
    limits = ArcSettings() if robot is None else usual_limits(robot, asked.column)
    if asked.count is not None:
        limits = replace(limits, load_factor_change=min(limits.load_factor_change, 1 / (asked.count - 1)))
    if robot is not None:
        return _Way(asked.column, np.array([asked.high]), {asked.column: np.array([asked.low])}, limits)
    index = columns[asked.column]
    (name,) = [name for name, span in layout.slices.items() if span.start <= index < span.stop]
    ends = []
    for number in (asked.low, asked.high):
        inputs = layout.pack()
        inputs[index] = number
        ends.append(layout.unpack(inputs)[name])
    return _Way(name, ends[1], {name: ends[0]}, limits)


def _check_name_and_size(scene: Scene, name: str, value: FloatArray | None) -> None:
    """Refuse an input that the scene does not have, or a value of another size.

    Args:
        scene: the scene.
        name: the input.
        value: its value; None where it is refused already.
    """
    # Building also refuses overconstraining inputs, which reading cannot detect.
    layout = None if scene.tubes else build(scene).inputs
    names = list(robot_of(scene).columns) if layout is None else layout.names
    if name not in names:
        raise SceneError(Problem("--input", f"{name!r} is no input of this scene", closest(name, names)))
    if layout is not None and value is not None:
        layout.pack({name: value})


def _vector(text: str) -> FloatArray:
    """A number, or components that are numbers or lists of Legendre coefficients, written as TOML.

    Raises:
        SceneError: the text is none of these, or a number is not finite.
    """
    try:
        # Inside a list the text must be one value: otherwise "1], b = [2" would be two keys, and "1,5" the number 1.
        (value,) = tomllib.loads(f"value = [{text}]")["value"]
        array = _array(value)
    except (tomllib.TOMLDecodeError, TypeError, ValueError):
        fault = f"must be a number or a list of numbers, got {text}"
        raise SceneError(Problem("--to", fault, "write it as in TOML: [0, 0, -5.0]")) from None
    if not np.all(np.isfinite(array)):
        raise SceneError(Problem("--to", f"must be finite, got {text}"))
    return array


def _array(value: object) -> FloatArray:
    if isinstance(value, list):
        return known(coefficients(tuple(value)))
    return np.array([value], dtype=float)
