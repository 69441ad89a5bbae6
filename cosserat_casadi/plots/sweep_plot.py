"""The figures of a sweep: where the tip can be, coloured by an input, a result or the outcome; and Sobol indices.

These have a panel for each result that varies, with two bars and their intervals for each input. matplotlib is an extra
and is imported inside functions only.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import numpy.typing as npt

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.plots.canvas import AXIS_NAMES, Canvas, Plane
from cosserat_casadi.plots.colours import CATEGORIES, category_style
from cosserat_casadi.plots.figure import add_title, figure_class, panel_grid
from cosserat_casadi.sweeps.outcome_table import LABELS, Sweep
from cosserat_casadi.sweeps.sobol import Estimates, SobolIndices

COLUMNS = 3
"""Panels in a row."""

HEIGHT = 0.38
"""Height of a bar, where inputs are 1 apart."""

FLAT = 1e-6
"""Share of the largest extent below which a set of points lies in a coordinate plane."""

MOST_POINTS = 40_000
"""Points that are drawn; of more, every so many are left out."""

RASTERISED = 5000
"""Number of points from which on they are drawn as an image in a vector figure."""

DOT_AREA = 4e4
"""Area of all dots together, points²; each takes its share within DOT_LIMITS."""

DOT_LIMITS = (1.5, 16.0)

MAP = "viridis"

OUTCOME = "outcome"
"""Colouring of a figure that no column colours."""


def plot_sweep(sweep: Sweep, colour: str | None = None) -> Any:
    """Figure of a sweep: one panel for points in a plane, else the points in space and their three projections.

    Where rows have no result and two columns were swept, one more panel shows which of these they are.

    Args:
        sweep: results.
        colour: column of the colour, or ``outcome``; by default the first swept column that varies.

    Raises:
        KeyError: there is no such column.
    """
    # A column of one value would colour all points alike.
    varying = [name for name in sweep.swept if np.ptp(sweep[name]) > 0]
    coloured_by = colour or (varying or [OUTCOME])[0]
    rows = _thinned(sweep.converged)
    points = sweep.positions(sweep.posed[-1])[rows]
    shades = None if coloured_by == OUTCOME else sweep[coloured_by][rows]
    show_inputs = not sweep.converged.all() and len(varying) > 1

    plane = _plane(points)
    views: Views = SPACE_VIEWS if plane is None else {(0, 0): plane}
    figure, grid = _figure(views, show_inputs)
    panels = [_add_view(figure, grid[cell], view) for cell, view in views.items()]
    scatters = [_scatter(panel, points, view, shades) for panel, view in zip(panels, views.values(), strict=True)]
    if shades is not None:
        unit = sweep.record.get("units", {}).get(coloured_by, "1")
        label = coloured_by if unit == "1" else f"{coloured_by}, {unit}"
        figure.colorbar(scatters[0], ax=panels, label=label, shrink=0.8, pad=0.02)
    if show_inputs:
        _draw_inputs(figure.add_subplot(grid[:, -1]), sweep, varying[0], varying[1])
    panels[0].set_title(_subtitle(sweep), fontsize=10)
    add_title(figure, sweep.record.get("title"))
    return figure


Views = dict[tuple[int, int], Plane | None]
"""The two world axes that a panel shows, by its row and column in the grid; None shows space."""

SPACE_VIEWS: Views = {(0, 0): (0, 1), (0, 1): None, (1, 0): (0, 2), (1, 1): (1, 2)}
"""Panels from above and in space; below these, panels from the front and from the side."""


def _figure(views: Views, show_inputs: bool) -> tuple[Any, Any]:
    """A figure and its grid of panels, one column wider where inputs are shown."""
    rows = max(row for row, _ in views) + 1
    columns = max(column for _, column in views) + 1 + show_inputs
    size = (5.4 * columns, 9.0) if rows > 1 else (6.4 * columns, 5.4)
    figure = figure_class()(figsize=size, layout="constrained")
    return figure, figure.add_gridspec(rows, columns)


def _add_view(figure: Any, cell: Any, plane: Plane | None) -> Any:
    if plane is None:
        return figure.add_subplot(cell, projection="3d")
    right, up = plane
    panel = figure.add_subplot(cell)
    panel.set(xlabel=f"{AXIS_NAMES[right]}, m", ylabel=f"{AXIS_NAMES[up]}, m")
    # Numbers such as 0.1425 need the room of two.
    panel.locator_params(axis="x", nbins=5)
    panel.grid(alpha=0.3)
    return panel


def _scatter(panel: Any, points: FloatArray, plane: Plane | None, shades: FloatArray | None) -> Any:
    """Dots of a panel, coloured by the shades or all alike.

    Args:
        panel: the axes.
        points: shape (k, 3), m.
        plane: the axes that the panel shows of the points; None for space.
        shades: shape (k,), or None.
    """
    share = DOT_AREA / max(len(points), 1)
    area = float(np.clip(share, *DOT_LIMITS))
    style: dict[str, Any] = {"s": area, "linewidths": 0.0, "rasterized": len(points) > RASTERISED}
    if shades is None:
        style["color"] = category_style(0)["color"]
    else:
        style |= {"c": shades, "cmap": MAP}
    if plane is not None:
        panel.set_aspect("equal", adjustable="datalim")
        return panel.scatter(*points[:, plane].T, **style)
    dots = panel.scatter(*points.T, **style)
    if len(points):
        canvas = Canvas(panel, None, float(np.ptp(points, axis=0).max()))
        canvas.label_axes()
        canvas.equalise(points)
    return dots


def _draw_inputs(panel: Any, sweep: Sweep, right: str, up: str) -> None:
    """Outcomes of the rows over two swept columns; every outcome has one colour and one marker."""
    for index, label in enumerate(LABELS):
        rows = _thinned(sweep.outcomes == index)
        if not rows.size:
            continue
        words = label.replace("_", " ")
        # Later outcomes are drawn over converged rows: they are the few that are looked for.
        style = {"s": 9.0, "linewidths": 0.0, "zorder": 2 + index, **category_style(index)}
        panel.scatter(sweep[right][rows], sweep[up][rows], label=words, **style)
    panel.set(xlabel=right, ylabel=up)
    panel.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=3, frameon=False, fontsize=9, markerscale=2.0)
    panel.grid(alpha=0.3)


def _plane(points: FloatArray) -> Plane | None:
    """The two axes of the coordinate plane that all points lie in; None where they fill space, or there are none."""
    if not len(points):
        return None
    extents = np.ptp(points, axis=0)
    flat = np.flatnonzero(extents <= FLAT * extents.max())
    if not flat.size:
        return None
    # Of points on a line two planes hold them all; the one across the last axis is shown.
    right, up = np.delete(np.arange(3), flat[-1]).tolist()
    return right, up


def _thinned(chosen: npt.NDArray[np.bool_]) -> npt.NDArray[np.int64]:
    """Indices of the chosen rows; of more than MOST_POINTS every so many."""
    rows = np.flatnonzero(chosen)
    stride = math.ceil(len(rows) / MOST_POINTS)
    return rows[:: max(1, stride)]


def _subtitle(sweep: Sweep) -> str:
    count = len(sweep.outcomes)
    converged = int(sweep.converged.sum())
    sentence = f"{sweep.posed[-1]}: {converged:,} of {count:,} rows"
    if converged < count:
        sentence += f", {count - converged:,} without a result"
    return sentence


def plot_sobol(indices: SobolIndices, title: str | None = None) -> Any:
    """Figure of Sobol indices.

    Args:
        indices: of the results; a result that does not vary is left out.
        title: of the scene.
    """
    shown = {name: found for name, found in indices.results.items() if np.all(np.isfinite(found.first))}
    size = (3.4, 0.8 + 0.45 * len(indices.factors))
    figure, panels = panel_grid(len(shown), COLUMNS, size, (1.6, 1.2), sharex=True, sharey=True)
    for panel, (name, found) in zip(panels, shown.items(), strict=True):
        _draw(panel, name, found, indices.factors)
    if shown:
        panels[0].legend(fontsize=8, frameon=False, loc="upper right")
    add_title(figure, title)
    return figure


def _draw(panel: Any, name: str, found: Estimates, factors: tuple[str, ...]) -> None:
    places = np.arange(len(factors))
    bars = (
        (found.first, found.first_interval, -HEIGHT / 2, CATEGORIES[0], "first order"),
        (found.total, found.total_interval, HEIGHT / 2, CATEGORIES[1], "total"),
    )
    for values, intervals, shift, colour, label in bars:
        # A percentile may lie on the wrong side of an estimate by rounding.
        whiskers = np.maximum(np.vstack([values - intervals[:, 0], intervals[:, 1] - values]), 0.0)
        style = {"height": HEIGHT, "color": colour, "label": label, "error_kw": {"elinewidth": 1.0, "capsize": 2.0}}
        panel.barh(places + shift, values, xerr=whiskers, **style)
    panel.set_yticks(places, factors)
    panel.set_ylim(len(factors) - 0.4, -0.6)
    panel.set_xlabel(f"share of the variance of {name}")
    panel.grid(axis="x", alpha=0.3)
