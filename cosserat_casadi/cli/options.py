"""Options that several commands share, and the checks that run before a command spends time."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from cosserat_casadi.errors import Problem, SceneError, collect_problems, refuse
from cosserat_casadi.files import MESHES, are_one_file, check_writable
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.load_cases import case_layout, ends_by_column, no_column, read_range
from cosserat_casadi.scene import Scene, read_scene
from cosserat_casadi.scene.reading import files_read

SceneFile = Annotated[Path, typer.Argument(metavar="SCENE", help="Scene file (TOML).", show_default=False)]

Settings = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="KEY=VALUE", help="Change a value of the scene, such as push.force=[0.2,0,0]."),
]

Ranges = Annotated[
    list[str] | None,
    typer.Option(
        "--range",
        metavar="COLUMN=LOW:HIGH[:COUNT]",
        help="Range of an input or a parameter for which modes are chosen. Its load cases are COUNT values in it.",
    ),
]


def asked_ranges(ranges: list[str] | None, scene: Scene) -> dict[str, tuple[float, float]]:
    """Lower and upper end by column of what ``--range`` asks for; in exact contact counted ranges are grids.

    Raises:
        SceneError: with every fault: a name that is unknown or stands twice; a range without two finite ends, the lower
            one first.
    """
    return ends_by_column(ranges, case_layout(scene), grids=scene.touches_exactly) if ranges else {}


def asked_cases(over: Path | None, ranges: list[str] | None, scene: Scene) -> FloatArray | None:
    """Load cases of ``--over`` and of ``--range`` with counts, shape (count, size of a case).

    Several ranges form a grid, which is combined with every row of a file.

    Args:
        over: file of rows, or of a grid.
        ranges: texts of ``--range``.
        scene: scene with the columns.

    Returns:
        the load cases; None without a file and without counts in ranges, which are then continuous.

    Raises:
        SceneError: with every fault, e.g. a range without a count together with a file or with counted ranges.
    """
    ranges = ranges or []
    if over is None and all(read_range(text).count is None for text in ranges):
        return None
    # Imported here: few commands have a grid.
    from cosserat_casadi.sweeps.table import asked_table

    table = asked_table(over, ranges)
    layout = case_layout(scene)
    problems = [
        no_column(table.where, column, layout.columns) for column in table.columns if column not in layout.columns
    ]
    refuse(problems)
    cases = np.tile(layout.default, (len(table.values), 1))
    cases[:, [layout.columns[column] for column in table.columns]] = table.values
    return cases


SUFFIXES = {"--csv": ".csv", "--sobol": ".json", "--write": ".toml"}
"""Suffixes of the options that write the same format in all commands."""


def check_files(
    files: Mapping[str, Path | None],
    scene: Path,
    settings: list[str] | None,
    problems: list[Problem],
    *others: Path | None,
    output_suffix: str | None = ".json",
    meshes: str = "",
) -> None:
    """Add the faults of files that cannot be written, before time is spent on a solve.

    Args:
        files: files to be written, by option; None for a missing option.
        scene: file of the scene, which may refer to tables.
        settings: changes of the scene, which may refer to other tables.
        problems: list that the faults are added to: a file cannot be written, would be written over one that is read,
            or has the suffix of another format.
        others: files that the command reads beside the scene.
        output_suffix: suffix of the result file; None if the command checks that file.
        meshes: option of a figure or an animation that also accepts a file of meshes.

    Raises:
        PlotUnavailableError: a figure is requested, and matplotlib is not installed.
    """
    for option, file in files.items():
        if option in ("--plot", "--animation"):
            check_figure(file, option, problems, meshes=meshes == option)
        elif suffix := SUFFIXES.get(option, output_suffix):
            with collect_problems(problems):
                check_file(file, option, suffix)
    with collect_problems(problems):
        check_inputs_stay(files, scene, settings, *others)


def read_checked(scene: Path, settings: list[str] | None, problems: list[Problem]) -> Scene:
    """The scene of a file.

    Args:
        scene: the file.
        settings: changes of the scene.
        problems: faults of other options.

    Raises:
        SceneError: with these problems and every fault of the scene.
    """
    checked: Scene | None = None
    with collect_problems(problems):
        checked = read_scene(scene, tuple(settings or ()))
    if problems or checked is None:
        raise SceneError(*problems)
    return checked


def check_figure(file: Path | None, option: str, problems: list[Problem], *, meshes: bool = False) -> None:
    """Add the faults of the file of a figure or an animation.

    Args:
        file: the file; None without the option.
        option: ``--plot`` or ``--animation``.
        problems: list that the faults are added to: the file cannot be written, or has no suffix that can be drawn.
        meshes: whether a file of meshes is accepted.

    Raises:
        PlotUnavailableError: a figure is requested, and matplotlib is not installed.
    """
    if file is None:
        return
    others = MESHES if meshes else ()
    with collect_problems(problems):
        check_writable(file, option)
    if file.suffix.lower() in others:
        return
    # Imported here, because matplotlib is an extra and takes long to load.
    with collect_problems(problems):
        if option == "--animation":
            from cosserat_casadi.plots.animation import check_animation_path

            check_animation_path(file, option, others)
        else:
            from cosserat_casadi.plots.figure import check_plot_path

            check_plot_path(file, others)


def check_file(file: Path | None, option: str, suffix: str) -> None:
    """Refuse a file that cannot be written, or that has the suffix of another format.

    A file without a suffix is accepted.

    Args:
        file: the file; None without the option.
        option: the option of the file.
        suffix: suffix of its format, such as ``.json``.

    Raises:
        SceneError: the file cannot be written, or has another suffix.
    """
    if file is None:
        return
    check_writable(file, option)
    if file.suffix.lower() not in ("", suffix):
        written = suffix.removeprefix(".").upper()
        problem = f"writes {written} only, and {file} has the suffix {file.suffix}"
        raise SceneError(Problem(option, problem, f"name it {file.with_suffix(suffix)}"))


def check_inputs_stay(
    outputs: Mapping[str, Path | None], scene: Path, settings: list[str] | None, *others: Path | None
) -> None:
    """Refuse to overwrite input files, and to write two results into one; arguments of :func:`check_files`.

    Raises:
        SceneError: with a problem for each such file.
    """
    inputs = [*files_read(scene, settings or ()), *given_files(*others)]
    asked = [(option, output) for option, output in outputs.items() if output is not None]
    problems = []
    for index, (option, output) in enumerate(asked):
        if any(are_one_file(output, read) for read in inputs):
            problem = f"this command reads {output}, and would overwrite it"
            problems.append(Problem(option, problem, "name another file"))
        for earlier_option, earlier in asked[:index]:
            if are_one_file(output, earlier):
                problems.append(Problem(option, f"{output} is also the file of {earlier_option}", "name another file"))
    refuse(problems)


def given_files(*files: Path | None) -> list[Path]:
    """The given files, in their order."""
    return [file for file in files if file is not None]
