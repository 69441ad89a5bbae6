"""The figure of a path: load over displacement of the tips, or of an inner section of a rod with a held tip.

matplotlib is an extra and is imported inside functions only.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from cosserat_casadi.errors import Problem, SceneError
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.paths.equilibrium_path import CONTACT_WORDS, EquilibriumPath
from cosserat_casadi.plots.animation import FRAME_RATE, MOST_FRAMES, AnimationFrames, save_frames
from cosserat_casadi.plots.canvas import AXIS_NAMES
from cosserat_casadi.plots.colours import AXES, FAILURE, PLAIN_TEXT
from cosserat_casadi.plots.figure import add_subtitle, add_title, figure_class

MARKERS = {
    "limit": "o",
    "bifurcation": "D",
    "touch": "v",
    "lift_off": "^",
    "point_to_line": "s",
    "line_to_point": "P",
    "slide_to_tip": ">",
    "slide_from_tip": "<",
    "slide_over_joint": "X",
    "slip": "*",
    "stick": "p",
}
"""Marker of each kind of event."""

WORDS = {"limit": "limit point", "bifurcation": "bifurcation", **CONTACT_WORDS}
"""Words for each kind of event."""

STABLE = 0
UNSTABLE = 1
NEUTRAL = 2
NOT_JUDGED = 3

STYLES = (("-", "stable"), ("--", "unstable"), ("-.", "neutral"), ("-", "stability not judged"))
"""Line style and label of each stability, in the order above."""

SMALLEST_DISPLACEMENT = 1e-9
"""Threshold of drawn components: displacement over length."""


SHOWN_SECONDS = 6.0
"""Duration of the film of a path, s; a path of many points takes longer."""

COLUMNS = 3
"""Largest number of panels in a row."""


def plot_path(path: EquilibriumPath) -> Any:
    """Figure of a path: one panel per rod, load factor over displacement / length.

    Stable parts are solid, unstable dashed, neutral dash-dotted; events are marked.
    """
    names = list(path.model.discrete.rods)
    columns = min(len(names), COLUMNS)
    rows = -(-len(names) // columns)
    figure = figure_class()(figsize=(7.5 * columns, 5.6 * rows), layout="constrained")
    for index, name in enumerate(names):
        axes = figure.add_subplot(rows, columns, index + 1)
        _draw_rod(axes, path, _followed_section(path, name))
        add_subtitle(axes, _subtitle(path) if len(names) == 1 else name, good=path.converged)
    add_title(figure, path.model.scene.title)
    return figure


def animate_path(path: EquilibriumPath, file: str | Path, *, progress: Callable[[float], None] | None = None) -> None:
    """Draw the equilibria of a path one by one into a film, written atomically.

    Each frame is a point of the path, without interpolation. More than MOST_FRAMES points are thinned.

    Args:
        path: the path.
        file: file name with a suffix of FORMATS of :mod:`cosserat_casadi.plots.animation`.
        progress: called with the share of drawn frames, 0 to 1.

    Raises:
        SceneError: the suffix is none of FORMATS, or the path has no point.
        AnimationUnavailableError: it is MP4, and ffmpeg is not installed.
        WriteError: the file cannot be written, e.g. on a full disk.
    """
    shown = shown_points(len(path.factor))
    stability = _stability(path)[shown]
    frames = AnimationFrames(
        model=path.model,
        x=path.x[shown],
        inputs=path.all_inputs[shown],
        words=[
            f"{_way_words(path)}: {factor:.4f}, {STYLES[style][1]}"
            for factor, style in zip(path.factor[shown], stability, strict=True)
        ],
        colour=PLAIN_TEXT if path.converged else FAILURE,
        interval=path_interval(shown),
    )
    save_frames(frames, file, progress=progress)


def shown_points(count: int) -> npt.NDArray[np.int64]:
    """Indices of the points of a path in its film, at most MOST_FRAMES.

    Raises:
        SceneError: the path has no point.
    """
    if not count:
        raise SceneError(Problem("path", "the path has no point: it was not started"))
    return np.unique(np.linspace(0, count - 1, min(count, MOST_FRAMES)).astype(np.int64))


def path_interval(shown: npt.NDArray[np.int64]) -> float:
    """Time per frame of the film of a path, s."""
    return max(1 / FRAME_RATE, SHOWN_SECONDS / len(shown))


@dataclass(frozen=True)
class _Section:
    """Section of a rod with a drawn displacement.

    Attributes:
        rod: name of the rod.
        X: abscissa of the section.
        length: length of the rod, m.
        unloaded: position of the section in the unloaded rod, shape (3,), m.
    """

    rod: str
    X: float
    length: float
    unloaded: FloatArray

    @property
    def words(self) -> str:
        """Name of the section for axes and legend."""
        return "the tip" if self.X == 1.0 else f"the section at X = {self.X:.3g}"

    def displacement(self, positions: FloatArray) -> FloatArray:
        """Displacement from the unloaded rod over the length, with the shape of the positions."""
        displacement = (positions - self.unloaded) / self.length
        return np.asarray(displacement)


def _followed_section(path: EquilibriumPath, name: str) -> _Section:
    model = path.model
    X = path.section(name)
    position, _ = model.shape[name](model.unloaded(), path.base, X)
    length = model.discrete.rods[name].properties.length
    unloaded = position.full()[:, 0]
    return _Section(name, X, length, np.asarray(unloaded))


def _draw_rod(axes: Any, path: EquilibriumPath, section: _Section) -> None:
    displacement = section.displacement(path.position(section.X, section.rod))
    stability = _stability(path)
    # The components with a displacement, or x without any.
    moving = np.flatnonzero(np.abs(displacement).max(axis=0, initial=0.0) > SMALLEST_DISPLACEMENT)
    for component in moving.tolist() or [0]:
        for start, stop, style in runs(stability):
            part = slice(start, stop)
            stroke = STYLES[style][0]
            axes.plot(displacement[part, component], path.factor[part], color=AXES[component], linestyle=stroke)
        _mark_events(axes, path, section, component)
        axes.plot([], [], color=AXES[component], label=f"{AXIS_NAMES[component]} of {section.words}")
    # Empty grey lines explain the line styles in the legend, for all components.
    for style in sorted(set(stability.tolist())):
        stroke, words = STYLES[style]
        axes.plot([], [], color="0.3", linestyle=stroke, label=words)
    axes.axhline(0.0, color="0.7", linewidth=0.8)
    axes.set_xlabel(f"displacement of {section.words} / length")
    axes.set_ylabel(_way_words(path))
    axes.grid(alpha=0.3)
    # The legend is below the panel, where it covers no curve.
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.12), ncols=3, fontsize=9, frameon=False)


def _mark_events(axes: Any, path: EquilibriumPath, section: _Section, component: int) -> None:
    """Mark every event by a point; the legend has one entry for each kind."""
    labels = axes.get_legend_handles_labels()[1]
    for event in path.events:
        label = WORDS[event.kind]
        position = path.event_position(event, section.X, section.rod)
        displacement = section.displacement(position)
        style = {"marker": MARKERS[event.kind], "color": "0.1", "linestyle": "none", "markersize": 7, "zorder": 5}
        legend_label = label
        if label in labels:
            # Matplotlib omits labels that begin with an underscore from the legend.
            legend_label = "_repeated"
        axes.plot(displacement[component], event.factor, label=legend_label, **style)
        labels.append(label)


def _stability(path: EquilibriumPath) -> FloatArray:
    """Index into STYLES of every point, shape (k,)."""
    if path.stable is None or path.neutral is None:
        return np.full(len(path.factor), NOT_JUDGED)
    # Neutral is tested before stable: neutral points are flagged as stable too.
    judged = np.where(path.stable, STABLE, UNSTABLE)
    styles = np.where(path.neutral, NEUTRAL, judged)
    # A point at an event is neutral; it is drawn in the style of the points before it.
    neutral = styles == NEUTRAL
    alone = 1 + np.flatnonzero(neutral[1:-1] & ~neutral[:-2] & ~neutral[2:])
    styles[alone] = styles[alone - 1]
    return styles


def runs(styles: npt.NDArray[Any]) -> list[tuple[int, int, int]]:
    """Pieces of equal style as (start, stop, style); adjacent pieces share a point, without a gap."""
    count = len(styles)
    cuts = [0, *(np.flatnonzero(np.diff(styles)) + 1).tolist(), count]
    return [(start, min(stop + 1, count), int(styles[start])) for start, stop in pairwise(cuts) if stop > start]


def _way_words(path: EquilibriumPath) -> str:
    (unit,) = [entry.declared.unit for entry in path.model.scene.free_inputs() if entry.name == path.name]
    suffix = "" if unit == "1" else f" {unit}"
    start = path.value_at(0.0)
    value = _numbers(path.value)
    if not start.any():
        return f"factor × {path.name} {value}{suffix}"
    return f"factor, {path.name} {_numbers(start)} to {value}{suffix}"


def _numbers(value: FloatArray) -> str:
    numbers = np.ravel(value, order="F")
    components = ", ".join(f"{number:.4g}" for number in numbers)
    return f"[{components}]" if len(numbers) > 1 else components


def _subtitle(path: EquilibriumPath) -> str:
    if not path.converged:
        return path.message
    if path.model.inputs.memory is not None:
        return "with friction: limits and bifurcations are not looked for"
    events = [f"{CONTACT_WORDS.get(event.kind, event.kind)} at {event.factor:.6g}" for event in path.events[:3]]
    return "; ".join(events) or "no limit, no bifurcation"
