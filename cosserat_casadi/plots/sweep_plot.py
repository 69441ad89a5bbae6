"""Figures of a sweep: positions of the tip, coloured by an input, a result or the outcome; and Sobol indices.

The figure of Sobol indices has a panel for each varying result, with two bars and their intervals for each input.
matplotlib is an extra and is imported inside functions only.
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
"""Height of a bar; inputs are at distance 1."""

FLAT = 1e-6
"""Threshold of the extent normal to a coordinate plane for planar points, over the largest extent."""

MOST_POINTS = 40_000
"""Largest number of drawn points; more points are thinned."""

RASTERISED = 5000
"""Least number of points that are drawn as an image in a vector figure."""

DOT_AREA = 4e4
"""Total area of all dots, points²; the area of a dot is limited to DOT_LIMITS."""

DOT_LIMITS = (1.5, 16.0)

MAP = "viridis"

OUTCOME = "outcome"
"""Colour of the dots without a colour column."""


def plot_sweep(sweep: Sweep, colour: str | None = None) -> Any:
    """Figure of a sweep: one panel for planar points, else the points in space and their three projections.

    With failed rows and two swept columns, a further panel shows the outcomes over both columns.

    Args:
        sweep: results of the sweep.
        colour: column for the colours, or ``outcome``; by default the first varying swept column.

    Raises:
        KeyError: the column does not exist.
    """
    # A constant column would give all points the same colour.
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
"""The two world axes of each panel, by its row and column in the grid; None for space."""

SPACE_VIEWS: Views = {(0, 0): (0, 1), (0, 1): None, (1, 0): (0, 2), (1, 1): (1, 2)}
"""Top row: views from above and in space; bottom row: views from the front and from the side."""


def _figure(views: Views, show_inputs: bool) -> tuple[Any, Any]:
    """A figure and its grid of panels, with a further column for inputs."""
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
    # Tick labels such as 0.1425 need the width of two ticks.
    panel.locator_params(axis="x", nbins=5)
    panel.grid(alpha=0.3)
    return panel


def _scatter(panel: Any, points: FloatArray, plane: Plane | None, shades: FloatArray | None) -> Any:
    """Draw the dots of a panel, coloured by shades or in a single colour.

    Args:
        panel: axes of the panel.
        points: points, shape (k, 3), m.
        plane: indices of the displayed axes; None for space.
        shades: values for the colour map, shape (k,), or None.
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
    """Draw the outcomes of rows over two swept columns; each outcome has a colour and a marker."""
    for index, label in enumerate(LABELS):
        rows = _thinned(sweep.outcomes == index)
        if not rows.size:
            continue
        words = label.replace("_", " ")
        # Failed rows are few and important: they are drawn over converged rows.
        style = {"s": 9.0, "linewidths": 0.0, "zorder": 2 + index, **category_style(index)}
        panel.scatter(sweep[right][rows], sweep[up][rows], label=words, **style)
    panel.set(xlabel=right, ylabel=up)
    panel.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=3, frameon=False, fontsize=9, markerscale=2.0)
    panel.grid(alpha=0.3)


def _plane(points: FloatArray) -> Plane | None:
    """The two axes of the coordinate plane of all points; None for points in space, or no points."""
    if not len(points):
        return None
    extents = np.ptp(points, axis=0)
    flat = np.flatnonzero(extents <= FLAT * extents.max())
    if not flat.size:
        return None
    # Collinear points lie in two planes; the plane normal to the last axis is drawn.
    right, up = np.delete(np.arange(3), flat[-1]).tolist()
    return right, up


def _thinned(chosen: npt.NDArray[np.bool_]) -> npt.NDArray[np.int64]:
    """Indices of the chosen rows, thinned to at most MOST_POINTS."""
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
        indices: Sobol indices of the results; constant results are left out.
        title: title of the scene.
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
        # Rounding may put a percentile on the wrong side of its estimate.
        whiskers = np.maximum(np.vstack([values - intervals[:, 0], intervals[:, 1] - values]), 0.0)
        style = {"height": HEIGHT, "color": colour, "label": label, "error_kw": {"elinewidth": 1.0, "capsize": 2.0}}
        panel.barh(places + shift, values, xerr=whiskers, **style)
    panel.set_yticks(places, factors)
    panel.set_ylim(len(factors) - 0.4, -0.6)
    panel.set_xlabel(f"share of the variance of {name}")
    panel.grid(axis="x", alpha=0.3)
