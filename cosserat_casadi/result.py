"""The methods that every result has: plain data, files, a figure, a few lines for a terminal and for a notebook."""

from __future__ import annotations

from importlib import import_module
from typing import Any


class Shown:
    """Base of scenes, models and all results: a few lines for a terminal and a notebook."""

    def __repr__(self) -> str:
        """The facts that matter, in at most ten lines."""
        text: str = _presentation().text_of(self)
        return text

    def __str__(self) -> str:
        """The short ``repr``: pydantic would print every field of a scene."""
        return repr(self)

    def _repr_html_(self) -> str:
        """The lines of ``repr`` as a table, below them the figure of a result: what a notebook shows."""
        page: str = _presentation().html_of(self)
        return page


class Result(Shown):
    """Base of solutions, paths, motions, modes, sweeps, fits and all other results.

    How a kind of result is written, drawn and described is in :mod:`cosserat_casadi.results.presentation`. That module
    stands above the rooms that compute, and loads when the first result is shown.
    """

    def to_dict(self) -> dict[str, Any]:
        """The result as plain data, as its JSON file holds it; a number that is not finite becomes None."""
        data: dict[str, Any] = _presentation().data_of(self)
        return data

    def to_dataframe(self) -> Any:
        """The table of a motion, a path, a sweep or an estimate, as its CSV file holds it.

        Returns:
            pandas.DataFrame, a row each of the CSV file.

        Raises:
            SceneError: this kind of result has no table.
            FramesUnavailableError: pandas is not installed.
        """
        return _presentation().frame_of(self)

    def to_xarray(self) -> Any:
        """The arrays of a motion over time, or of a sweep over its grid, with named axes and units.

        A motion has the axis ``time``; of each rod its sections have the axis ``<rod>.X``. A sweep over every
        combination of its columns has an axis for each column, any other sweep the axis ``row``.

        Returns:
            xarray.Dataset.

        Raises:
            SceneError: this kind of result has no such arrays.
            FramesUnavailableError: xarray is not installed.
        """
        return _presentation().dataset_of(self)

    def write(self, path: Any) -> None:
        """Write the result into a file, whole or not at all; the suffix says in which format.

        Every result can be written as JSON (``.json``) and as a figure (``.png``, ``.pdf``, ``.svg``); some as a table
        too, solutions and motions of rods as meshes for Blender and the like (``.glb``, ``.usda``).

        Args:
            path: of the file, a string or a Path.

        Raises:
            SceneError: this kind of result has no file with that suffix.
            CosseratError: the format needs a package that is not installed; the sentence names the extra.
            WriteError: the file cannot be written, as on a full disk.
        """
        _presentation().write(self, path)

    def plot(self, **options: Any) -> Any:
        """Figure of the result.

        Args:
            options: ``colour`` of a sweep, the column that colours its points; ``title`` of Sobol indices.

        Returns:
            matplotlib.figure.Figure.

        Raises:
            PlotUnavailableError: matplotlib is not installed.
        """
        return _presentation().figure_of(self, **options)

    def animate(self, path: Any, **options: Any) -> Any:
        """Draw a motion, a path or a mode as a film into a file, whole or not at all; the suffix says which.

        Args:
            path: of the file, a string or a Path: ``.gif`` or ``.mp4``; of a motion ``.glb`` or ``.usda`` too.
            options: ``speed`` of a motion, 0.1 shows it ten times slower; ``mode``, the number of a mode, from 1;
                ``progress``, a function that receives the share of the frames that are drawn.

        Returns:
            pathlib.Path of the file.

        Raises:
            SceneError: this kind of result has no film, none with that suffix, or no state to show.
            CosseratError: the film needs a package or a program that is not installed; the sentence names it.
            WriteError: the file cannot be written, as on a full disk.
        """
        return _presentation().animate(self, path, **options)


def _presentation() -> Any:
    """The module that presents results, loaded when the first result is shown."""
    return import_module("cosserat_casadi.results.presentation")
