"""Options that several commands share, and the checks that run before a command spends time."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated

import typer

from cosserat_casadi.errors import Problem, SceneError
from cosserat_casadi.files import check_writable

SceneFile = Annotated[Path, typer.Argument(metavar="SCENE", help="Scene file (TOML).", show_default=False)]

Settings = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="KEY=VALUE", help="Change a value of the scene, such as push.force=[0.2,0,0]."),
]


def check_outputs(output: Path | None, plot: Path | None, suffix: str = ".json") -> None:
    """Refuse files that cannot be written, before time is spent on a solve.

    Args:
        output: file of the result.
        plot: file of the figure.
        suffix: of the format that the result is written in.

    Raises:
        SceneError: a file cannot be written, the result has the suffix of another format, or the figure has no suffix
            that can be drawn.
        PlotUnavailableError: a figure is asked for and matplotlib is not installed.
    """
    problems: list[Problem] = []
    with collect_problems(problems):
        check_file(output, "--output", suffix)
    with collect_problems(problems):
        _check_plot(plot)
    if problems:
        raise SceneError(*problems)


def check_file(file: Path | None, option: str, suffix: str) -> None:
    """Refuse a file that cannot be written, or whose suffix promises another format than the one it would have.

    A file without suffix promises nothing.

    Args:
        file: that is asked for; None where none is.
        option: by which it is asked for.
        suffix: of the only format that is written there, such as ``.json``.

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


def _check_plot(plot: Path | None) -> None:
    if plot is None:
        return
    # Imported here, because matplotlib is an extra and takes long to load.
    from cosserat_casadi.plots.figure import check_plot_path

    check_writable(plot, "--plot")
    check_plot_path(plot)


@contextmanager
def collect_problems(problems: list[Problem]) -> Iterator[None]:
    """Keep the problems of what is refused inside, and let the checks go on.

    A user sees every fault of a command line at once.
    """
    try:
        yield
    except SceneError as error:
        problems.extend(error.problems)


def given_files(*files: Path | None) -> list[Path]:
    """Files that were asked for, in their order."""
    return [file for file in files if file is not None]
