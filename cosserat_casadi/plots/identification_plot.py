"""The figure of an identification: measured and modelled values, residuals by measurement, ellipses of the unknowns.

matplotlib is an extra and is imported inside functions only.
"""

from __future__ import annotations

from itertools import combinations
from typing import Any

import numpy as np

from cosserat_casadi.identification import Identification, Row
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.plots.figure import add_title, panel_grid

MOST_PANELS = 4
"""Largest number of panels of measured quantities."""

MOST_ELLIPSES = 6
"""Largest number of pairs of unknowns with an ellipse: the most strongly correlated pairs."""

WIDTH = 0.8
"""Width of the rows of one motion among the residuals, relative to the width of a case."""

CHI_SQUARE_95 = 5.991464547107979
"""95 % quantile of the squared Mahalanobis distance of a normal distribution in the plane."""

COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000")


def plot_identification(found: Identification) -> Any:
    """The matplotlib.figure.Figure of an identification."""
    numbers = sorted({row.measurement for row in found.rows})[:MOST_PANELS]
    pairs = _pairs(found)
    figure, panels = panel_grid(len(numbers) + 1 + len(pairs), 3, (4.6, 3.9))
    axes = iter(panels)
    for number in numbers:
        _draw_measurement(next(axes), found, number)
    _draw_residuals(next(axes), found)
    for first, second in pairs:
        _draw_ellipse(next(axes), found, first, second)
    add_title(figure, found.model.scene.title)
    return figure


def _draw_measurement(axes: Any, found: Identification, number: int) -> None:
    """Draw modelled over measured values, with the line of equality; for motions both over time."""
    measurement = found.model.scene.measurements[number]
    rows = [row for row in found.rows if row.measurement == number]
    if rows[0].time is not None:
        _draw_path(axes, measurement, rows)
        return
    for entry, name in enumerate(measurement.entries[: len(measurement.differences)]):
        for held_out in (False, True):
            chosen = [row for row in rows if row.entry == entry and row.held_out is held_out]
            if chosen:
                label = f"{name}, held out" if held_out else name
                style = {"marker": "x"} if held_out else {"marker": "o", "alpha": 0.6}
                colour = COLOURS[entry % len(COLOURS)]
                axes.scatter(*_values(chosen).T, s=14, color=colour, label=label, **style)
    values = _values(rows)
    ends = [float(values.min()), float(values.max())]
    axes.plot(ends, ends, color="0.5", linewidth=0.8, zorder=0)
    units = ", ".join(dict.fromkeys(measurement.differences))
    axes.set(xlabel=f"measured, {units}", ylabel=f"modelled, {units}", title=measurement.title)
    axes.legend(fontsize=8)


def _draw_path(axes: Any, measurement: Any, rows: list[Row]) -> None:
    """Draw measured and modelled values over time."""
    for entry, name in enumerate(measurement.entries[: len(measurement.differences)]):
        chosen = [row for row in rows if row.entry == entry]
        if not chosen:
            continue
        times = [row.time for row in chosen]
        measured, modelled = _values(chosen).T
        colour = COLOURS[entry % len(COLOURS)]
        axes.scatter(times, measured, s=14, color=colour, alpha=0.6, label=f"{name}, measured")
        axes.scatter(times, modelled, s=14, color=colour, marker="+", label=f"{name}, modelled")
    units = ", ".join(dict.fromkeys(measurement.differences))
    axes.set(xlabel="time, s", ylabel=units, title=measurement.title)
    axes.legend(fontsize=8)


def _values(rows: list[Row]) -> FloatArray:
    return np.array([[row.measured, row.modelled] for row in rows])


def _draw_residuals(axes: Any, found: Identification) -> None:
    """Draw the residuals of every measurement in standard deviations, case by case."""
    latest = max((row.time or 0.0 for row in found.rows), default=0.0)
    for number, measurement in enumerate(found.model.scene.measurements):
        for held_out in (False, True):
            rows = [row for row in found.rows if row.measurement == number and row.held_out is held_out]
            if not rows:
                continue
            # Held-out cases follow the fitted ones.
            shift = len(found.cases) if held_out else 0
            # Rows of a motion are side by side in the order of their times.
            places = [row.case + 1.0 + shift for row in rows]
            if rows[0].time is not None and latest > 0.0:
                places = [
                    place + WIDTH * ((row.time or 0.0) / latest - 0.5) for place, row in zip(places, rows, strict=True)
                ]
            label = f"{measurement.title}, held out" if held_out else measurement.title
            style = {"marker": "x"} if held_out else {"marker": "o", "alpha": 0.6}
            axes.scatter(places, [row.residual for row in rows], s=12, label=label, color=COLOURS[number % 7], **style)
    for level in (-2.0, 0.0, 2.0):
        axes.axhline(level, color="0.5", linewidth=0.8, linestyle="-" if level == 0.0 else ":", zorder=0)
    axes.set(xlabel="case", ylabel="residual, σ", title="Residuals")
    axes.legend(fontsize=8)


def _pairs(found: Identification) -> list[tuple[int, int]]:
    """Pairs of determined unknowns, in descending order of their correlation."""
    known = np.flatnonzero(np.nan_to_num(found.sigma) > 0.0).tolist()
    correlation = np.abs(found.statistics.correlation)
    pairs = sorted(combinations(known, 2), key=lambda pair: -correlation[pair])
    return pairs[:MOST_ELLIPSES]


def _draw_ellipse(axes: Any, found: Identification, first: int, second: int) -> None:
    """Draw the 95 % confidence ellipse of two unknowns."""
    chosen = [first, second]
    covariance = found.statistics.covariance[np.ix_(chosen, chosen)]
    sizes = np.sqrt(np.diagonal(covariance))
    # Scaled first: unknowns may differ by many orders of magnitude.
    root = np.linalg.cholesky(covariance / np.outer(sizes, sizes) + 1e-12 * np.eye(2))
    angles = np.linspace(0.0, 2 * np.pi, 200)
    circle = np.sqrt(CHI_SQUARE_95) * np.stack([np.cos(angles), np.sin(angles)])
    ellipse = found.shared[chosen, None] + sizes[:, None] * (root @ circle)
    axes.plot(*ellipse, color=COLOURS[0])
    axes.plot(*found.shared[chosen], marker="+", color=COLOURS[1], markersize=10)
    correlation = found.statistics.correlation[first, second]
    axes.set(xlabel=found.labels[first], ylabel=found.labels[second], title=f"95 %, correlation {correlation:.2f}")
