"""Figure of a sweep: where the tip can be, coloured by an input, a result or the outcome.

matplotlib is an extra and is imported inside functions only.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.plots.scene_plot import figure_class, save_figure
from cosserat_casadi.sweep.outcome_table import LABELS, Sweep

FLAT = 1e-6
"""Share of the largest extent below which a set of points lies in a coordinate plane."""

MOST_POINTS = 40_000
"""Points drawn; of more, every so many are left out."""

VECTORS = 5000
"""Points from which they are drawn as an image in a vector figure."""

MAP = "viridis"
COLOURS = ("#4477aa", "#ccbb44", "#aa3377", "#ee6677", "#cc3311", "#ee7733")
"""Colours of the outcomes, in the order of LABELS."""


def save_sweep_plot(sweep: Sweep, file: str | Path, colour: str | None = None) -> None:
    """Draw where the last rod or body of a sweep can be into a file, whole or not at all.

    The same sweep gives the same bytes.

    Args:
        sweep: results.
        file: its suffix is one of those of :mod:`cosserat_casadi.plots.scene_plot`.
        colour: column of the colour, or ``outcome``; by default the first swept column that varies.

    Raises:
        SceneError: the suffix is none that can be drawn.
        PlotUnavailableError: matplotlib is not installed.
        KeyError: there is no such column.
    """
    save_figure(lambda: plot_sweep(sweep, colour), file)


def plot_sweep(sweep: Sweep, colour: str | None = None) -> Any:
    """Figure of a sweep: one panel for points in a plane, else the points in space and their three projections.

    Where rows have no result and two columns were swept, one more panel shows which of these they are.

    Args:
        sweep: results.
        colour: as in :func:`save_sweep_plot`.

    Returns:
        matplotlib.figure.Figure.

    Raises:
        PlotUnavailableError: matplotlib is not installed.
        KeyError: there is no such column.
    """
    varying = [name for name in sweep.swept if np.ptp(sweep[name]) > 0]
    chosen = colour or (varying or ["outcome"])[0]
    failing = not sweep.converged.all() and len(varying) > 1
    points = sweep.positions(sweep.posed[-1])[_thinned(sweep.converged)]
    plane = _plane(points)
    figure, grid = _figure(rows=1 if plane else 2, columns=(1 if plane else 2) + failing)
    # From above, in space; from the front below the first, from the side beside that.
    views = [plane] if plane else [(0, 1), None, (0, 2), (1, 2)]
    places = [grid[0, 0]] if plane else [grid[0, 0], grid[0, 1], grid[1, 0], grid[1, 1]]
    shades = None if chosen == "outcome" else sweep[chosen][_thinned(sweep.converged)]
    panels = [_add_view(figure, place, view) for place, view in zip(places, views, strict=True)]
    drawn = [_scatter(panel, points, view, shades) for panel, view in zip(panels, views, strict=True)]
    if shades is not None:
        figure.colorbar(drawn[0], ax=panels, label=chosen, shrink=0.8, pad=0.02)
    if failing:
        _draw_inputs(figure.add_subplot(grid[:, -1]), sweep, varying[:2])
    panels[0].set_title(_subtitle(sweep), fontsize=10)
    figure.suptitle(sweep.record.get("title") or "Untitled scene", fontsize=14, fontweight="bold")
    return figure


def _figure(rows: int, columns: int) -> tuple[Any, Any]:
    size = (6.4 * columns, 5.4) if rows == 1 else (5.4 * columns, 9.0)
    figure = figure_class()(figsize=size, layout="constrained")
    return figure, figure.add_gridspec(rows, columns)


def _add_view(figure: Any, place: Any, view: tuple[int, int] | None) -> Any:
    """A panel that sees all of space, or two axes of it."""
    if view is None:
        panel = figure.add_subplot(place, projection="3d")
        panel.set(xlabel="x, m", ylabel="y, m", zlabel="z, m")
        panel.locator_params(nbins=4)
        return panel
    panel = figure.add_subplot(place)
    panel.set(xlabel=f"{'xyz'[view[0]]}, m", ylabel=f"{'xyz'[view[1]]}, m")
    panel.grid(alpha=0.3)
    return panel


def _scatter(panel: Any, points: FloatArray, view: tuple[int, int] | None, shades: FloatArray | None) -> Any:
    size = float(np.clip(4e4 / max(len(points), 1), 1.5, 16.0))
    style: dict[str, Any] = {"s": size, "linewidths": 0.0, "rasterized": len(points) > VECTORS}
    style |= {"color": COLOURS[0]} if shades is None else {"c": shades, "cmap": MAP}
    found = panel.scatter(*(points.T if view is None else points[:, list(view)].T), **style)
    if view is None:
        # A little smaller than its place, for the label of the third axis.
        panel.set_box_aspect(np.ptp(points, axis=0) if len(points) else None, zoom=0.85)
    else:
        panel.set_aspect("equal", adjustable="datalim")
    return found


def _draw_inputs(panel: Any, sweep: Sweep, columns: list[str]) -> None:
    """How rows ended, over the first two swept columns."""
    for number, label in enumerate(LABELS):
        rows = _thinned(sweep.outcomes == number)
        if rows.size:
            one, other = (sweep[name][rows] for name in columns)
            named = label.replace("_", " ")
            panel.scatter(one, other, s=9.0, linewidths=0.0, color=COLOURS[number], label=named, zorder=2 + number)
    panel.set(xlabel=columns[0], ylabel=columns[1])
    panel.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=3, frameon=False, fontsize=9, markerscale=2.0)
    panel.grid(alpha=0.3)


def _plane(points: FloatArray) -> tuple[int, int] | None:
    """The two axes of the coordinate plane that all points lie in; None where they fill space, or there are none."""
    extents = np.ptp(points, axis=0) if len(points) else np.ones(3)
    flat = [axis for axis in range(3) if extents[axis] <= FLAT * extents.max()]
    if not flat:
        return None
    seen = [axis for axis in range(3) if axis != flat[-1]]
    return seen[0], seen[1]


def _thinned(chosen: npt.NDArray[np.bool_]) -> npt.NDArray[np.int64]:
    """Places of the chosen rows; of very many every so many."""
    rows = np.flatnonzero(chosen)
    return rows[:: max(1, -(-len(rows) // MOST_POINTS))]


def _subtitle(sweep: Sweep) -> str:
    count, found = len(sweep.outcomes), int(sweep.converged.sum())
    rest = "" if found == count else f", {count - found:,} without a result"
    return f"{sweep.posed[-1]}: {found:,} of {count:,} rows{rest}"
