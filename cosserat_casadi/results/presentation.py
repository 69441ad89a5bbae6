"""Presentation of each kind of result: plain data, files, figure, and lines of text.

The table names functions as ``module:function``, so that a result loads only the modules of its kind. A new kind of
result needs an entry only in this table, which :class:`cosserat_casadi.result.Result` reads.
"""

from __future__ import annotations

import base64
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from html import escape
from importlib import import_module
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from cosserat_casadi.errors import CosseratError, Problem, SceneError
from cosserat_casadi.files import MESHES, write_atomically
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.result import Result
from cosserat_casadi.results.json_text import SCHEMA, csv_text, json_text, plain

PICTURES = (".png", ".pdf", ".svg")
"""Suffixes of figures."""

MOST_LINES = 10
"""Largest number of lines of ``repr``."""


@dataclass(frozen=True)
class Presentation:
    """Presentation of one kind of result.

    Attributes:
        data: function of the result that returns its plain data, as ``module:function`` of ``cosserat_casadi``.
        facts: function of the result that returns the main facts as pairs of label and text.
        figure: function of the result that returns the matplotlib figure.
        table: function of the result that returns the header and the rows of its CSV file; empty without one.
        arrays: function of the result that returns its arrays with named axes; empty without any.
        film: function (result, path, options) that draws its film; empty without one.
        writers: functions (result, path) that write files of other formats, by suffix.
    """

    data: str
    facts: str
    figure: str
    table: str = ""
    arrays: str = ""
    film: str = ""
    writers: Mapping[str, str] = field(default_factory=dict)

    @property
    def suffixes(self) -> tuple[str, ...]:
        """Suffixes of all file formats of the result."""
        table = (".csv",) if self.table else ()
        return tuple(dict.fromkeys((".json", *table, *self.writers, *PICTURES)))


@dataclass(frozen=True)
class NamedArrays:
    """Arrays with named axes.

    Attributes:
        variables: axes, array and attributes such as ``units``, by name.
        coordinates: values along axes, by axis name.
        attributes: attributes of the dataset.
    """

    variables: dict[str, tuple[tuple[str, ...], Any, dict[str, str]]] = field(default_factory=dict)
    coordinates: dict[str, Any] = field(default_factory=dict)
    attributes: dict[str, Any] = field(default_factory=dict)

    def add(self, name: str, axes: tuple[str, ...], array: FloatArray, units: str = "") -> None:
        """Add an array, with one dimension per axis, under a new name; unknown units are left out."""
        self.variables.setdefault(name, (axes, array, {"units": units} if units else {}))


class FramesUnavailableError(CosseratError):
    """Pandas, for a DataFrame, or xarray, for a Dataset, is not installed."""

    page = "notebook"

    def __init__(self, method: str, package: str) -> None:
        super().__init__(f"{method} needs {package}: install it with  pip install 'cosserat-casadi[frames]'")


_FILM = "plots.film:write_film"
_SWEEP = "sweeps.outcome_file:write_sweep"

PRESENTATIONS = {
    "Solution": Presentation(
        data="results.solution_file:solution_result",
        facts="results.facts:solution_facts",
        figure="plots.scene_plot:plot_solution",
        writers=dict.fromkeys(MESHES, _FILM),
    ),
    "EquilibriumPath": Presentation(
        data="results.path_file:path_result",
        facts="results.facts:path_facts",
        figure="plots.path_plot:plot_path",
        table="results.path_file:path_table",
        film="plots.path_plot:animate_path",
    ),
    "Motion": Presentation(
        data="results.motion_file:motion_result",
        facts="results.facts:motion_facts",
        figure="plots.motion_plot:plot_motion",
        table="results.motion_file:motion_table",
        arrays="results.motion_file:motion_arrays",
        film="plots.animation:animate_motion",
        writers={
            ".parquet": "results.motion_file:write_parquet",
            ".npz": "results.motion_file:write_npz",
            **dict.fromkeys(MESHES, _FILM),
        },
    ),
    "Modes": Presentation(
        data="results.modes_file:modes_result",
        facts="results.facts:modes_facts",
        figure="plots.modes_plot:plot_modes",
        film="plots.modes_plot:animate_mode",
    ),
    "Inverse": Presentation(
        data="results.solution_file:inverse_result",
        facts="results.facts:inverse_facts",
        figure="plots.scene_plot:plot_inverse",
    ),
    "Identification": Presentation(
        data="results.identification_file:identification_result",
        facts="results.facts:identification_facts",
        figure="plots.identification_plot:plot_identification",
    ),
    "Estimate": Presentation(
        data="results.estimate_file:estimate_result",
        facts="results.facts:estimate_facts",
        figure="plots.estimate_plot:plot_estimate",
        table="results.estimate_file:estimate_table",
    ),
    "Sweep": Presentation(
        data="results.sweep_data:sweep_result",
        facts="results.facts:sweep_facts",
        figure="plots.sweep_plot:plot_sweep",
        arrays="results.sweep_data:sweep_arrays",
        writers={".csv": _SWEEP, ".parquet": _SWEEP, ".dataset": _SWEEP},
    ),
    "SobolIndices": Presentation(
        data="results.sweep_data:sobol_result",
        facts="results.facts:sobol_facts",
        figure="plots.sweep_plot:plot_sobol",
    ),
    "TubeSolution": Presentation(
        data="results.tubes_file:tubes_result",
        facts="results.facts:tube_facts",
        figure="plots.tubes_plot:plot_tubes",
    ),
    "TubeEquilibria": Presentation(
        data="results.tubes_file:tubes_result",
        facts="results.facts:tube_equilibria_facts",
        figure="plots.tubes_plot:plot_tubes",
    ),
    "TubePath": Presentation(
        data="results.tubes_file:tube_path_result",
        facts="results.facts:tube_path_facts",
        figure="plots.tubes_plot:plot_tube_path",
        table="results.tubes_file:tube_path_table",
        film="plots.tubes_plot:animate_tube_path",
    ),
}
"""Presentations by the class of the result; a class without an entry is presented as its base."""

SHOWN = {
    "Scene": "results.facts:scene_facts",
    "Model": "results.facts:model_facts",
    "TubeFunctions": "results.facts:tube_model_facts",
    "LinearModel": "results.facts:linear_model_facts",
    "Choice": "results.facts:choice_facts",
}
"""Facts of scenes and models by class: functions like :attr:`Presentation.facts`."""


def presentation_of(result: Any) -> Presentation:
    """The presentation of a result.

    Raises:
        TypeError: neither its class nor a base class is in the table.
    """
    for kind in type(result).__mro__:
        if kind.__name__ in PRESENTATIONS:
            return PRESENTATIONS[kind.__name__]
    raise TypeError(f"{type(result).__name__} has no entry in PRESENTATIONS of {__name__}")


def data_of(result: Any) -> dict[str, Any]:
    """Plain data of a result, as in its JSON file; a number that is not finite becomes None."""
    data: dict[str, Any] = plain({"schema": SCHEMA, **_function(presentation_of(result).data)(result)})
    return data


def csv_of(result: Any) -> str:
    """The text of the CSV file of a result with a table."""
    return csv_text(*_function(presentation_of(result).table)(result))


def frame_of(result: Any) -> Any:
    """The table of a result as a pandas.DataFrame, with the digits of its CSV file.

    Raises:
        SceneError: this kind of result has no table.
        FramesUnavailableError: pandas is not installed.
    """
    if ".csv" not in presentation_of(result).suffixes:
        problem = f"{type(result).__name__} has no table"
        raise SceneError(Problem("to_dataframe", problem, "take to_dict(), or what its attributes hold"))
    try:
        import pandas
    except ImportError as error:
        raise FramesUnavailableError("to_dataframe", "pandas") from error
    with TemporaryDirectory() as folder:
        table = Path(folder) / "table.csv"
        write(result, table)
        return pandas.read_csv(table)


def dataset_of(result: Any) -> Any:
    """The arrays of a result as an xarray.Dataset.

    Raises:
        SceneError: this kind of result has no arrays with named axes.
        FramesUnavailableError: xarray is not installed.
    """
    arrays = presentation_of(result).arrays
    if not arrays:
        problem = f"{type(result).__name__} has no arrays over time or over a grid"
        raise SceneError(Problem("to_xarray", problem, "take to_dict(), or what its attributes hold"))
    try:
        import xarray
    except ImportError as error:
        raise FramesUnavailableError("to_xarray", "xarray") from error
    named: NamedArrays = _function(arrays)(result)
    return xarray.Dataset(named.variables, named.coordinates, named.attributes)


def figure_of(result: Any, **options: Any) -> Any:
    """Matplotlib figure of a result.

    Raises:
        PlotUnavailableError: matplotlib is not installed.
    """
    return _function(presentation_of(result).figure)(result, **options)


def animate(result: Any, path: str | Path, **options: Any) -> Path:
    """Draw the film of a result into a file, atomically; returns the path of the file.

    Raises:
        SceneError: this kind of result has no film, or none with that suffix.
        CosseratError: the film needs a package or a program that is not installed.
        WriteError: the file cannot be written.
    """
    film = presentation_of(result).film
    if not film:
        problem = f"{type(result).__name__} has no film: it holds no shapes one after the other"
        raise SceneError(Problem("animate", problem, "motions, modes and paths have one; plot() is a figure"))
    _function(film)(result, path, **options)
    return Path(path)


def facts_of(shown: Any) -> tuple[str | None, list[tuple[str, str]]]:
    """Title of the scene of a result or a model, or None, and its main facts: labels and texts."""
    if isinstance(shown, Result):
        place = presentation_of(shown).facts
    else:
        place = next(SHOWN[kind.__name__] for kind in type(shown).__mro__ if kind.__name__ in SHOWN)
    title, facts = _function(place)(shown)
    return title, facts


def write(result: Any, path: str | Path, **options: Any) -> None:
    """Write a result into a file, atomically, in the format of the suffix.

    Args:
        result: the result.
        path: path of the file.
        options: options of the figure, for a file with a figure.

    Raises:
        SceneError: this kind of result has no file with that suffix.
        CosseratError: the format needs a package that is not installed.
        WriteError: the file cannot be written.
    """
    file = Path(path)
    suffix = file.suffix.lower()
    presentation = presentation_of(result)
    if suffix in presentation.writers:
        _function(presentation.writers[suffix])(result, file)
    elif suffix == ".csv" and presentation.table:
        write_atomically(file, csv_of(result).encode())
    elif suffix == ".json":
        write_all(result, file)
    elif suffix in PICTURES:
        _function("plots.figure:write_figure")(figure_of(result, **options), file)
    else:
        problem = f"{type(result).__name__} cannot be written to {file}"
        raise SceneError(Problem("path", problem, f"use one of {', '.join(presentation.suffixes)}"))


def write_all(result: Any, output: Path | None, *others: Path | None) -> list[Path]:
    """Write a result as JSON into ``output``, whatever its suffix, and into others by suffix; returns the files."""
    if output is not None:
        write_atomically(output, json_text(data_of(result)).encode())
    for other in others:
        if other is not None:
            write(result, other)
    return [file for file in (output, *others) if file is not None]


def text_of(shown: Any) -> str:
    """Lines for a terminal: class and title, then the main facts; at most MOST_LINES."""
    heading, facts = _facts(shown)
    width = max(len(label) for label, _ in facts)
    lines = [heading, *(f"  {label:<{width}}  {words}" for label, words in facts)]
    if len(lines) > MOST_LINES:
        left_out = len(lines) - MOST_LINES + 1
        lines = [*lines[: MOST_LINES - 1], f"  and {left_out} more lines"]
    return "\n".join(lines)


def html_of(shown: Any) -> str:
    """HTML for a notebook: a table of the facts, and for a result the figure, or the reason of its absence."""
    heading, facts = _facts(shown)
    rows = [f"<tr><th>{escape(label)}</th><td>{escape(words)}</td></tr>" for label, words in facts]
    picture = _picture(shown) if isinstance(shown, Result) else ""
    return f"<table><caption>{escape(heading)}</caption>{''.join(rows)}</table>{picture}"


def _picture(result: Any) -> str:
    """The figure as an embedded image, or a sentence if it cannot be drawn."""
    try:
        figure = figure_of(result)
    except CosseratError as error:
        return f"<p>{escape(str(error))}</p>"
    encoded = base64.b64encode(figure._repr_png_()).decode()
    return f'<img alt="figure" src="data:image/png;base64,{encoded}"/>'


def _facts(shown: Any) -> tuple[str, list[tuple[str, str]]]:
    """Heading with the class and the title of the scene, if any; and labels with texts."""
    title, facts = facts_of(shown)
    kind = type(shown).__name__
    heading = f"{kind}: {title}" if title else kind
    return heading, facts


def _function(place: str) -> Callable[..., Any]:
    """A function of the package, given as ``module:function``."""
    module, name = place.split(":")
    function: Callable[..., Any] = getattr(import_module(f"cosserat_casadi.{module}"), name)
    return function
