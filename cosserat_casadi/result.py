"""Methods of every result: plain data, files, a figure, a few lines for a terminal and a notebook."""

from __future__ import annotations

from importlib import import_module
from typing import Any


class Shown:
    """Base of scenes, models and all results: a few lines for a terminal and a notebook."""

    def __repr__(self) -> str:
        """The main facts, in at most ten lines."""
        text: str = _presentation().text_of(self)
        return text

    def __str__(self) -> str:
        """The short ``repr``: pydantic would print every field of a scene."""
        return repr(self)

    def _repr_html_(self) -> str:
        """The lines of ``repr`` as a table, and the figure of a result below, for a notebook."""
        page: str = _presentation().html_of(self)
        return page


class Result(Shown):
    """Base of solutions, paths, motions, modes, sweeps, fits and all other results.

    :mod:`cosserat_casadi.results.presentation` writes, draws and describes each kind of result. That module is above
    the rooms that compute, and is loaded for the first result that is shown.
    """

    def to_dict(self) -> dict[str, Any]:
        """The result as plain data, the content of its JSON file; a number that is not finite becomes None."""
        data: dict[str, Any] = _presentation().data_of(self)
        return data

    def to_dataframe(self) -> Any:
        """The table of a motion, a path, a sweep or an estimate, with the content of its CSV file.

        Returns:
            pandas.DataFrame with a row for each row of the CSV file.

        Raises:
            SceneError: this kind of result has no table.
            FramesUnavailableError: pandas is not installed.
        """
        return _presentation().frame_of(self)

    def to_xarray(self) -> Any:
        """The arrays of a motion over time, or of a sweep over its grid, with named axes and units.

        A motion has the axis ``time``; the sections of each rod have the axis ``<rod>.X``. A sweep over every
        combination of its columns has an axis for each column, any other sweep the axis ``row``.

        Returns:
            xarray.Dataset.

        Raises:
            SceneError: this kind of result has no such arrays.
            FramesUnavailableError: xarray is not installed.
        """
        return _presentation().dataset_of(self)

    def write(self, path: Any) -> None:
        """Write the result into a file atomically; the suffix decides on the format.

        Every result can be written as JSON (``.json``) and as a figure (``.png``, ``.pdf``, ``.svg``); some as a table
        too, solutions and motions of rods as meshes for Blender and the like (``.glb``, ``.usda``).

        Args:
            path: path of the file, a string or a Path.

        Raises:
            SceneError: this kind of result has no file with that suffix.
            CosseratError: the format needs a package that is not installed; the sentence names the extra.
            WriteError: the file cannot be written, as on a full disk.
        """
        _presentation().write(self, path)

    def plot(self, **options: Any) -> Any:
        """Figure of the result.

        Args:
            options: for a sweep ``colour``, the column that colours its points; for Sobol indices ``title``.

        Returns:
            matplotlib.figure.Figure.

        Raises:
            PlotUnavailableError: matplotlib is not installed.
        """
        return _presentation().figure_of(self, **options)

    def animate(self, path: Any, **options: Any) -> Any:
        """Draw a motion, a path or a mode as a film into a file atomically; the suffix decides on the format.

        Args:
            path: path of the file, a string or a Path: ``.gif`` or ``.mp4``; for a motion ``.glb`` or ``.usda`` too.
            options: ``speed`` of a motion, with 0.1 ten times slower; ``mode``, the number of a mode, from 1;
                ``progress``, a function that receives the share of drawn frames.

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
