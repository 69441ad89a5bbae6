"""Figure of a path: load against the displacement of the tips, of a held rod that of a section between.

matplotlib is an extra and is imported inside functions only.
"""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.paths.follow import EquilibriumPath
from cosserat_casadi.plots.scene_plot import AXES, figure_class, save_figure

MARKERS = {"limit": ("o", "limit point"), "bifurcation": ("D", "bifurcation")}
STYLES = (("-", "stable"), ("--", "unstable"), ("-.", "neutral"), ("-", "stability not judged"))
COMPONENTS = ("x", "y", "z")

LEVEL = 1e-9
"""Displacement relative to the length below which a component is not drawn."""


def save_path_plot(path: EquilibriumPath, file: str | Path) -> None:
    """Draw a path into a file, whole or not at all; the same path gives the same bytes.

    Raises:
        SceneError: the suffix is none of FORMATS.
        PlotUnavailableError: matplotlib is not installed.
    """
    save_figure(lambda: plot_path(path), file)


def plot_path(path: EquilibriumPath) -> Any:
    """Figure of a path: one panel a rod, displacement over length to the right, factor upwards.

    Stable parts are solid, unstable dashed, neutral dash-dotted; events are marked.

    Returns:
        matplotlib.figure.Figure.

    Raises:
        PlotUnavailableError: matplotlib is not installed.
    """
    names = list(path.model.discrete.rods)
    figure = figure_class()(figsize=(7.5 * len(names), 5.4), layout="constrained")
    for i, name in enumerate(names):
        axes = figure.add_subplot(1, len(names), i + 1)
        _draw_rod(axes, path, name)
        axes.set_title(name if len(names) > 1 else _subtitle(path), fontsize=10, color=_colour(path), wrap=True)
    figure.suptitle(path.model.scene.title or "Untitled scene", fontsize=14, fontweight="bold")
    return figure


def _draw_rod(axes: Any, path: EquilibriumPath, name: str) -> None:
    moved, kinds = _displacement(path, name), _kinds(path)
    place = "the tip" if path.section(name) == 1.0 else f"the section at X = {path.section(name):.3g}"
    shown = [c for c in range(3) if np.abs(moved[:, c]).max(initial=0.0) > LEVEL] or [0]
    for c in shown:
        for first, last, kind in _runs(kinds):
            axes.plot(moved[first:last, c], path.factor[first:last], color=AXES[c], linestyle=STYLES[kind][0])
        _mark(axes, path, name, c)
        axes.plot([], [], color=AXES[c], label=f"{COMPONENTS[c]} of {place}")
    for kind in sorted(set(kinds.tolist())):
        axes.plot([], [], color="0.3", linestyle=STYLES[kind][0], label=STYLES[kind][1])
    axes.axhline(0.0, color="0.7", linewidth=0.8)
    axes.set_xlabel(f"displacement of {place} / length")
    axes.set_ylabel(f"factor × {_value(path)}")
    axes.grid(alpha=0.3)
    axes.legend(loc="best", fontsize=9, framealpha=0.9)


def _mark(axes: Any, path: EquilibriumPath, name: str, component: int) -> None:
    """Every event as a point, named once."""
    named = axes.get_legend_handles_labels()[1]
    for event in path.events:
        marker, label = MARKERS[event.kind]
        place = path.event_position(event, path.section(name), name)
        moved = (place - _rest(path, name)) / path.model.discrete.rods[name].properties.length
        style = {"marker": marker, "color": "0.1", "linestyle": "none", "markersize": 7, "zorder": 5}
        axes.plot(moved[component], event.factor, label=None if label in named else label, **style)
        named.append(label)


def _displacement(path: EquilibriumPath, name: str) -> FloatArray:
    """Displacement of the section from the unloaded rod over the length, shape (k, 3)."""
    moved = path.position(path.section(name), name) - _rest(path, name)
    return np.asarray(moved / path.model.discrete.rods[name].properties.length)


def _rest(path: EquilibriumPath, name: str) -> FloatArray:
    unloaded = path.model.shape[name](path.model.unloaded(), path.base, path.section(name))
    return np.asarray(unloaded[0].full()[:, 0])


def _kinds(path: EquilibriumPath) -> FloatArray:
    """Index into STYLES of every point, shape (k,)."""
    stable, neutral = path.stable, path.neutral
    if stable is None or neutral is None:
        return np.full(len(path.factor), 3)
    kinds = np.where(neutral, 2, np.where(stable, 0, 1))
    # A point that lies on an event is neutral by itself; it is drawn as what leads to it.
    alone = 1 + np.flatnonzero((kinds[1:-1] == 2) & (kinds[:-2] != 2) & (kinds[2:] != 2))
    kinds[alone] = kinds[alone - 1]
    return kinds


def _runs(kinds: FloatArray) -> list[tuple[int, int, int]]:
    """Pieces of one kind as (first, last, kind) with last exclusive; neighbours share a point so that no gap shows."""
    cuts = [0, *(np.flatnonzero(np.diff(kinds)) + 1).tolist(), len(kinds)]
    return [(a, min(b + 1, len(kinds)), int(kinds[a])) for a, b in pairwise(cuts) if b > a]


def _value(path: EquilibriumPath) -> str:
    numbers = ", ".join(f"{number:.4g}" for number in np.ravel(path.value, order="F"))
    return f"{path.name} [{numbers}]"


def _subtitle(path: EquilibriumPath) -> str:
    if not path.converged:
        return path.message
    return "; ".join(f"{event.kind} at {event.factor:.6g}" for event in path.events[:3]) or "no limit, no bifurcation"


def _colour(path: EquilibriumPath) -> str:
    return "0.3" if path.converged else "#cc3311"
