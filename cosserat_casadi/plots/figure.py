"""Functions common to all figures: class, titles, and writing a file.

matplotlib is an extra and is imported inside functions only.
"""

from __future__ import annotations

import io
import textwrap
from math import ceil
from pathlib import Path
from typing import Any

from cosserat_casadi.errors import CosseratError, Problem, SceneError
from cosserat_casadi.files import write_atomically
from cosserat_casadi.plots.colours import FAILURE, PLAIN_TEXT

FORMATS = (".png", ".pdf", ".svg")
"""Suffixes that a figure may have."""

TITLE_LETTER = 0.14
"""Mean width of a letter in a title, inches."""

# Without date and version, the same figure gives the same file.
_METADATA: dict[str, dict[str, None]] = {
    "png": {"Software": None},
    "pdf": {"CreationDate": None, "Producer": None},
    "svg": {"Date": None},
}


class PlotUnavailableError(CosseratError):
    """Matplotlib is not installed."""

    def __init__(self) -> None:
        super().__init__("figures need matplotlib: install it with  pip install 'cosserat-casadi[plot]'")


def figure_class() -> Any:
    """The class of figures, matplotlib's, which draws without a display and without pyplot's global state.

    Raises:
        PlotUnavailableError: matplotlib is not installed.
    """
    try:
        from cosserat_casadi.plots.shown_figure import ShownFigure
    except ImportError as missing:
        raise PlotUnavailableError from missing
    return ShownFigure


def check_plot_path(path: str | Path, others: tuple[str, ...] = ()) -> None:
    """Refuse a figure that cannot be made, before any work is done for it.

    Args:
        path: path of the file.
        others: further accepted suffixes, of meshes, for the message.

    Raises:
        SceneError: the suffix is none of FORMATS.
        PlotUnavailableError: matplotlib is not installed.
    """
    if Path(path).suffix.lower() not in FORMATS:
        remedy = f"use one of {', '.join(FORMATS + others)}"
        raise SceneError(Problem("--plot", f"{path} has no suffix of a figure that can be drawn", remedy))
    figure_class()


def panel_grid(
    count: int, columns: int, panel: tuple[float, float], margin: tuple[float, float] = (0.0, 0.0), **shared: bool
) -> tuple[Any, list[Any]]:
    """A figure with panels in rows.

    Args:
        count: number of panels.
        columns: largest number of panels in a row.
        panel: width and height of a panel, inches.
        margin: margin beside and above all panels, inches.
        shared: shared axes, arguments of ``subplots``.
    """
    columns = max(1, min(columns, count))
    rows = max(1, ceil(count / columns))
    size = (margin[0] + panel[0] * columns, margin[1] + panel[1] * rows)
    figure = figure_class()(figsize=size, layout="constrained")
    panels = figure.subplots(rows, columns, squeeze=False, **shared).ravel().tolist()
    for unused in panels[count:]:
        unused.set_visible(False)
    return figure, panels[:count]


def write_figure(figure: Any, path: Path, dpi: int = 150) -> None:
    """Write a figure into a file of one of FORMATS, atomically; the same figure gives the same bytes."""
    import matplotlib as mpl

    suffix = path.suffix.lower()[1:]
    content = io.BytesIO()
    # Element ids in SVG are random without a salt.
    with mpl.rc_context({"svg.hashsalt": "cosserat"}):
        figure.savefig(content, format=suffix, dpi=dpi, metadata=_METADATA[suffix])
    write_atomically(path, content.getvalue())


def add_subtitle(axes: Any, words: str, *, good: bool) -> None:
    """Write the quality of a result above its axes, or in red the failure of its solve."""
    axes.set_title(words, fontsize=10, color=PLAIN_TEXT if good else FAILURE, wrap=True)


def add_title(figure: Any, title: str | None) -> None:
    """Write the title of a scene above its figure, wrapped to the figure's width."""
    text = textwrap.fill(title or "Untitled scene", int(figure.get_figwidth() / TITLE_LETTER))
    figure.suptitle(text, fontsize=14, fontweight="bold")
