"""The figure of an estimate: each unknown over the rows, with 95 % credible intervals.

matplotlib is an extra and is imported inside functions only.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from cosserat_casadi.estimation import Estimate
from cosserat_casadi.plots.colours import CATEGORIES
from cosserat_casadi.plots.figure import add_title, panel_grid

MOST_PANELS = 12
"""Largest number of unknowns with a panel, the first ones."""

COLUMNS = 3
"""Panels in a row."""

SECOND = {"linestyle": "", "marker": "o", "markerfacecolor": "none", "color": CATEGORIES[1], "label": "second best"}
"""Style of the second best minimum of a row."""


def plot_estimate(found: Estimate) -> Any:
    """Figure of an estimate; rows without an estimate are gaps, open markers are second-best minima."""
    shown = min(MOST_PANELS, len(found.labels))
    figure, panels = panel_grid(shown, COLUMNS, (4.4, 2.6), (0.0, 1.0), sharex=True)
    rows = np.arange(1, len(found.cases) + 1)
    for k, panel in enumerate(panels):
        half = (found.intervals[:, k, 1] - found.intervals[:, k, 0]) / 2
        panel.axhline(0.0, color="0.8", linewidth=0.8)
        panel.errorbar(rows, found.values[:, k], half, fmt=".", color=CATEGORIES[0], elinewidth=1.0, capsize=2.0)
        if found.second is not None and found.doubtful.any():
            panel.plot(rows, np.where(found.doubtful, found.second.values[:, k], np.nan), **SECOND)
        unit = found.units[k]
        panel.set_ylabel(found.labels[k] if unit == "1" else f"{found.labels[k]} ({unit})", fontsize=8)
        panel.grid(alpha=0.3)
    if found.doubtful.any():
        panels[0].legend(fontsize=8)
    for panel in panels[-COLUMNS:]:
        panel.set_xlabel("case")
        panel.tick_params(labelbottom=True)
    add_title(figure, found.model.scene.title)
    return figure
