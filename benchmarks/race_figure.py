"""Error against time of the race: exported C, shooting by hand, and packages from PyPI."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from peers import Peer

from cosserat_casadi.plots.figure import figure_class

if TYPE_CHECKING:
    from race import Raced

STYLES = {
    "cosserat, exported C": ("#cc3311", "*"),
    "plain shooting, C": ("#4477aa", "o"),
    "tuned shooting, C": ("#228833", "s"),
    "cosserat, Python": ("#ee8866", "P"),
    "SciPy solve_bvp": ("#aa3377", "^"),
    "PyElastica": ("#777777", "D"),
}
"""Colour and marker of every contestant."""

PANELS = {
    "B1": "B1: tip force across",
    "B2": "B2: tip force and torque, in space",
    "B3": "B3: three times the force",
}
"""Cases drawn, but for that of the peers."""

Point = tuple[float, float]


def race_figure(rows: Sequence[Raced], met: Sequence[Peer], last: str) -> Any:
    """A panel for each case: hand-written C, exported C; in the last one the peers too.

    Args:
        rows: of the race.
        met: all contestants of the last panel.
        last: name of its case.
    """
    figure = figure_class()(figsize=(9.6, 7.0), layout="constrained")
    panels = figure.subplots(2, 2).ravel()
    for axes, (name, title) in zip(panels, PANELS.items(), strict=False):
        _draw(axes, title, _contest([row for row in rows if row.name == name]))
    _draw(panels[-1], f"A {last} rod: packages from PyPI", _met(met))
    for axes in panels[:-1]:
        axes.legend(fontsize=7.5)
    panels[-1].set_ylim(top=1e3)
    panels[-1].legend(fontsize=7.5, ncols=2, loc="upper left")
    figure.suptitle("Cold solve on one core; lower and further left is better", fontsize=11)
    return figure


def _contest(rows: Sequence[Raced]) -> dict[str, list[Point]]:
    found = {"cosserat, exported C": [(row.ours.times["cold_us"], row.ours.error) for row in rows]}
    for program in ("plain", "tuned"):
        points = [row.shooting[program] for row in rows]
        found[f"{program} shooting, C"] = [(time, error) for error, time in points]
    return found


def _met(rows: Sequence[Peer]) -> dict[str, list[Point]]:
    """Points by package; of ours in Python what is built already."""
    found: dict[str, list[Point]] = {}
    for row in rows:
        if math.isfinite(row.error) and "building" not in row.setting:
            found.setdefault(row.package, []).append((row.microseconds, row.error))
    return found


def _draw(axes: Any, title: str, contestants: dict[str, list[Point]]) -> None:
    for name, points in contestants.items():
        colour, marker = STYLES[name]
        times, errors = zip(*sorted(points), strict=True)
        size = 10 if marker == "*" else 5
        axes.loglog(times, errors, marker=marker, markersize=size, color=colour, linewidth=1.4, label=name)
    axes.set_title(title, fontsize=10)
    axes.set_xlabel("time, µs")
    axes.set_ylabel("tip error / length")
    axes.grid(alpha=0.3)
