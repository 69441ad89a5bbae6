"""The work–precision diagram: pose error against the time of a compiled cold solve.

matplotlib is an extra and is imported inside functions only.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from cosserat_casadi.plots.figure import figure_class, write_figure
from tests.fine_reference import Reference
from work_precision.grid import DIAL
from work_precision.measurement import Measurement, front

STYLES = {
    "magnus4": ("#4477aa", "o", "Magnus, 4th order"),
    "magnus6": ("#228833", "s", "Magnus, 6th order"),
    "magnus8": ("#aa3377", "^", "Magnus, 8th order"),
    "permuted": ("#ccbb44", "D", "permuted system (literal)"),
    DIAL: ("#cc3311", "*", "picked for a tolerance"),
}
"""Colour, marker and words of every method."""

FIGURES = ("figure.png", "figure.pdf")


def write_figures(folder: Path, title: str, reference: Reference, rows: Sequence[Measurement]) -> list[Path]:
    """Draw the diagram as PNG and PDF; nothing where no row was timed.

    Raises:
        PlotUnavailableError: matplotlib is not installed.
    """
    points = [row for row in rows if row.in_plane and not row.strain]
    if not points:
        return []
    figure = _diagram(title, reference, points)
    for name in FIGURES:
        write_figure(figure, folder / name, dpi=130)
    return [folder / name for name in FIGURES]


def _diagram(title: str, reference: Reference, rows: Sequence[Measurement]) -> Any:
    figure = figure_class()(figsize=(7.4, 5.4), layout="constrained")
    axes = figure.add_subplot()
    axes.set_xscale("log")
    axes.set_yscale("log")
    _draw_front(axes, rows)
    # The dial last, so that its points lie above those that it was to pick from.
    others = [method for method in STYLES if method != DIAL]
    for method in (*others, DIAL):
        of_method = [row for row in rows if row.method == method]
        _draw_method(axes, method, of_method)
    axes.set_xlabel("cold solve in compiled C, µs")
    axes.set_ylabel("pose error at the tip: position/ℓ or angle in rad, the larger")
    axes.margins(0.08)
    axes.grid(which="major", alpha=0.35)
    axes.grid(which="minor", axis="x", alpha=0.12)
    axes.legend(fontsize=9, framealpha=0.9, loc="best")
    figure.suptitle(title or "Untitled scene", fontsize=12, fontweight="bold")
    axes.set_title(f"Errors against {reference.method}", fontsize=8.5, color="0.3", wrap=True)
    return figure


def _draw_front(axes: Any, rows: Sequence[Measurement]) -> None:
    times, errors = _coordinates(front(rows))
    axes.step(
        times,
        errors,
        where="post",
        color="0.82",
        linewidth=6,
        solid_joinstyle="round",
        label="Pareto front",
        zorder=1,
    )


def _draw_method(axes: Any, method: str, rows: Sequence[Measurement]) -> None:
    """All points of a method, faint, and a line through the points that no other point of it beats."""
    if not rows:
        return
    colour, marker, words = STYLES[method]
    size = 11 if method == DIAL else 5
    axes.plot(
        *_coordinates(rows),
        marker,
        color=colour,
        markersize=size * 0.7,
        alpha=0.35,
        markeredgewidth=0,
        zorder=2,
    )
    axes.plot(
        *_coordinates(front(rows)),
        marker=marker,
        color=colour,
        markersize=size,
        linewidth=1.5,
        label=words,
        zorder=3,
    )
    if method == DIAL:
        _name_tolerances(axes, rows, colour)


def _name_tolerances(axes: Any, rows: Sequence[Measurement], colour: str) -> None:
    for row in rows:
        text = f"{row.tolerance:.0e}".replace("e-0", "e-")
        axes.annotate(
            text,
            (row.cold_us, row.pose_error),
            (7, 5),
            textcoords="offset points",
            fontsize=7.5,
            color=colour,
        )


def _coordinates(rows: Sequence[Measurement]) -> tuple[list[float], list[float]]:
    """Times (µs) and pose errors of rows."""
    times = [row.cold_us for row in rows]
    errors = [row.pose_error for row in rows]
    return times, errors
