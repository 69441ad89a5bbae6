"""The figure of modes, one panel each, and the animation of one mode.

matplotlib is an extra and is imported inside functions only.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import ceil
from pathlib import Path
from typing import Any

import numpy as np

from cosserat_casadi.errors import Problem, SceneError
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.motion.eigenproblem import REAL
from cosserat_casadi.motion.vibration_modes import Mode, Modes
from cosserat_casadi.plots.animation import FRAME_RATE, AnimationFrames, save_frames
from cosserat_casadi.plots.canvas import WORLD, Canvas, add_canvas
from cosserat_casadi.plots.colours import FAILURE, PLAIN_TEXT, rod_colour
from cosserat_casadi.plots.figure import add_title, figure_class
from cosserat_casadi.plots.scene_view import View, view_of
from cosserat_casadi.plots.scenery import CLAMP

SECTIONS = np.linspace(0.0, 1.0, 101)
"""Abscissae of the drawn points of rods."""

MARKED = slice(None, None, 10)
"""Indices into SECTIONS of marked sections, which show motion along the rod and rotation."""

ENDS_MARKED = slice(None, None, len(SECTIONS) // 2)
"""Indices of marked sections in scenes with several rods: ends and middles; more dots would hide the shapes."""

SHARE = 0.2
"""Largest drawn displacement, relative to the scene's extent."""

TURNED = 1.0
"""Largest drawn rotation angle of a section, rad, in modes of pure rotation."""

ARM = 0.25
"""Length of the lines that show rotations of sections, relative to the scene's extent."""

STILL = 1e-6
"""Threshold of the displacement, relative to the extent, below which a mode counts as pure rotation."""

COLUMNS = 4
"""Panels in a row."""

TICKS = 4
"""Most intervals between the ticks of an axis."""

EQUILIBRIUM = "0.65"

PERIOD_FRAMES = 50
"""Frames of one period of an animation."""

BELOW = 0.2
"""Margin for the labels below the lowest panels in space, inches."""


def plot_modes(modes: Modes) -> Any:
    """Figure of modes: one panel each with the equilibrium in grey and both ends of the swing.

    Dots mark sections; in modes of pure rotation lines show their x axes. A panel shows the plane of the mode if it is
    planar, else space. All panels have the same scale and amplitude.
    """
    count = len(modes.modes)
    columns = max(1, min(COLUMNS, count))
    rows = max(1, ceil(count / columns))
    height = 3.5 * rows + 0.6 + BELOW
    figure = figure_class()(figsize=(3.6 * columns, height), layout="constrained")
    # Labels of axes in space extend beyond their panels.
    figure.get_layout_engine().set(wspace=0.08, hspace=0.08, rect=(0.0, BELOW / height, 1.0, 1.0 - BELOW / height))
    add_title(figure, modes.model.scene.title)
    if not count:
        figure.text(0.5, 0.5, modes.message, color=FAILURE, ha="center", wrap=True)
        return figure
    lines = _mode_lines(modes)
    for index, mode in enumerate(modes.modes):
        drawn = lines[index]
        canvas = add_canvas(figure, (rows, columns, index + 1), drawn.view, drawn.size, small=True)
        _draw_mode(canvas, modes, drawn)
        canvas.axes.set_title(mode_words(mode, index), fontsize=10, color=FAILURE if mode.grows else PLAIN_TEXT)
    return figure


def mode_words(mode: Mode, index: int) -> str:
    """Text with number, frequency and damping of a mode; the index begins with 0."""
    if mode.eigenvalue == 0.0:
        return f"{index + 1}: {mode.words}"
    if not mode.oscillates:
        return f"{index + 1}: {mode.words}, {abs(mode.eigenvalue.real):.4g} 1/s"
    words = f"{index + 1}: {mode.frequency:.4g} Hz"
    # Damping at the level of rounding is omitted.
    if abs(mode.damping_ratio) > REAL:
        words += f", ζ = {mode.damping_ratio:.3g}"
    return words


def animate_mode(
    modes: Modes, file: str | Path, *, mode: int = 1, progress: Callable[[float], None] | None = None
) -> None:
    """Draw one period of a mode into a file, atomically; a GIF repeats it.

    Args:
        modes: modes of a scene.
        file: path with a suffix of FORMATS of :mod:`cosserat_casadi.plots.animation`.
        mode: number of the mode, from 1.
        progress: called with the share of drawn frames, 0 to 1.

    Raises:
        SceneError: the suffix is none of FORMATS, or the mode does not exist.
        AnimationUnavailableError: it is MP4, and ffmpeg is not installed.
        WriteError: the file cannot be written, e.g. on a full disk.
    """
    count = len(modes.modes)
    if not 1 <= mode <= count:
        raise SceneError(Problem("mode", f"must be from 1 to {count}, the number of modes; got {mode}"))
    index = mode - 1
    shown = modes.modes[index]
    drawn = _mode_lines(modes)[index]
    phases = 2 * np.pi * np.arange(PERIOD_FRAMES) / PERIOD_FRAMES
    # The period starts at the equilibrium.
    swing = drawn.amplitude * np.imag(np.exp(1j * phases)[:, None] * shown.vector)
    frames = AnimationFrames(
        model=modes.model,
        x=modes.solution.x + swing,
        inputs=np.tile(modes.solution.inputs, (PERIOD_FRAMES, 1)),
        words=[f"mode {mode_words(shown, index)}"] * PERIOD_FRAMES,
        colour=FAILURE if shown.grows else PLAIN_TEXT,
        interval=1 / FRAME_RATE,
        section_axes=bool(drawn.arms),
    )
    save_frames(frames, file, progress=progress)


@dataclass(frozen=True)
class _ModeLines:
    """Centre lines of all rods in one mode, world axes.

    Attributes:
        equilibrium: positions by rod in the equilibrium, shape (len(SECTIONS), 3), m.
        ends: positions by rod at both extremes of the oscillation, shape (2, len(SECTIONS), 3), m.
        arms: by rod, ends of the lines that show rotations of sections, in the equilibrium and at one extreme, shape
            (2, sections, 2, 3), m; empty except for modes of pure rotation.
        amplitude: scale factor of the mode.
        size: largest extent of the scene, m.
    """

    equilibrium: dict[str, FloatArray]
    ends: dict[str, FloatArray]
    arms: dict[str, FloatArray]
    amplitude: float
    size: float

    @property
    def points(self) -> FloatArray:
        """All points, shape (k, 3), m."""
        lines = [*self.equilibrium.values(), *self.ends.values(), *self.arms.values()]
        return np.concatenate([line.reshape(-1, 3) for line in lines])

    @property
    def view(self) -> View:
        """The plane of all points, or space if there are arms."""
        return (None, WORLD) if self.arms else view_of(self.points, STILL * self.size)


def _mode_lines(modes: Modes) -> list[_ModeLines]:
    """Lines of each mode."""
    names = list(modes.model.discrete.rods)
    poses = {name: modes.solution.pose(SECTIONS, name) for name in names}
    shapes = {name: modes.shape(SECTIONS, name) for name in names}
    equilibrium = {name: pose.position for name, pose in poses.items()}
    extents = np.ptp(np.concatenate(list(equilibrium.values())), axis=0)
    size = float(extents.max())
    drawn = []
    for index in range(len(modes.modes)):
        displacements = {name: np.real(shape.position[index]) for name, shape in shapes.items()}
        largest = max(float(np.abs(displacement).max()) for displacement in displacements.values())
        arms: dict[str, FloatArray] = {}
        if largest > STILL * size:
            amplitude = SHARE * size / largest
        else:
            # The largest rotation angle of the mode is scaled to one.
            amplitude = TURNED
            for name, pose in poses.items():
                turn = amplitude * np.real(shapes[name].rotation[index])
                arms[name] = _arms(pose.position, pose.rotation[:, :, 0], turn, ARM * size)
        ends = {}
        for name, displacement in displacements.items():
            moved = amplitude * displacement
            ends[name] = np.stack([equilibrium[name] + moved, equilibrium[name] - moved])
        drawn.append(_ModeLines(equilibrium, ends, arms, amplitude, size))
    return drawn


def _arms(positions: FloatArray, axes: FloatArray, turns: FloatArray, length: float) -> FloatArray:
    """Lines along the x axes of marked sections, before and after a small turn, shape (2, sections, 2, 3), m."""
    starts = positions[MARKED]
    directions = axes[MARKED]
    turned = directions + np.cross(turns[MARKED], directions)
    turned /= np.linalg.norm(turned, axis=1, keepdims=True)
    before = np.stack([starts, starts + length * directions], axis=1)
    after = np.stack([starts, starts + length * turned], axis=1)
    return np.stack([before, after])


def _draw_mode(canvas: Canvas, modes: Modes, drawn: _ModeLines) -> None:
    marked = MARKED if len(drawn.equilibrium) == 1 else ENDS_MARKED
    for index, (name, resting) in enumerate(drawn.equilibrium.items()):
        colour = rod_colour(index)
        canvas.line(resting, color=EQUILIBRIUM, linewidth=1.5)
        canvas.markers(resting[marked], color=EQUILIBRIUM, marker=".", markersize=5)
        there, back = drawn.ends[name]
        canvas.line(back, color=colour, linewidth=1.5, alpha=0.35)
        canvas.line(there, color=colour, linewidth=2.5)
        canvas.markers(there[marked], color=colour, marker=".", markersize=7)
        if modes.model.discrete.unloaded.floating_base(name) is None:
            canvas.markers(resting[:1], **CLAMP)
    for index, (before, after) in enumerate(drawn.arms.values()):
        for arm in before:
            canvas.line(arm, color=EQUILIBRIUM, linewidth=1.5)
        for arm in after:
            canvas.line(arm, color=rod_colour(index), linewidth=2.0)
    canvas.label_axes()
    canvas.axes.locator_params(nbins=TICKS)
    canvas.equalise(drawn.points)
