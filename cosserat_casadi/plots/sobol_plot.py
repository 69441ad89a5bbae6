"""The figure of Sobol indices: a panel for each result that varies, two bars with their intervals for each input.

matplotlib is an extra and is imported inside functions only.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from cosserat_casadi.plots.colours import CATEGORIES
from cosserat_casadi.plots.figure import add_title, panel_grid
from cosserat_casadi.sweeps.sobol import Estimates, SobolIndices

COLUMNS = 3
"""Panels in a row."""

HEIGHT = 0.38
"""Height of a bar, where inputs are 1 apart."""


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
