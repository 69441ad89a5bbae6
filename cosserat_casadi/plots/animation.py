"""Animations of motions and modes: rods, bodies and the paths of tips, in axes with limits of the whole motion.

matplotlib is an extra and is imported inside functions only.
"""

from __future__ import annotations

import tempfile
import textwrap
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from subprocess import CalledProcessError
from typing import Any

import numpy as np

from cosserat_casadi.equilibrium.contact.body_obstacles import in_axes_of
from cosserat_casadi.equilibrium.solution import SolvedPoses, rotations
from cosserat_casadi.errors import CosseratError, Problem, SceneError
from cosserat_casadi.files import MESHES, write_atomically, write_errors
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.motion.pose_series import poses_of, section_poses
from cosserat_casadi.motion.trajectory import Motion
from cosserat_casadi.plots.canvas import add_canvas
from cosserat_casadi.plots.colours import FAILURE, OBSTACLES, PLAIN_TEXT, actuator_colour, rod_colour, rod_style
from cosserat_casadi.plots.figure import figure_class
from cosserat_casadi.plots.moving_shapes import MovingShapes, moving_shapes
from cosserat_casadi.plots.obstacle_drawing import draw_surfaces, surface_lines
from cosserat_casadi.plots.scenery import draw_supports

FORMATS = (".gif", ".mp4")
"""Suffixes that an animation may have."""

FRAME_RATE = 25
"""Frames per second. A GIF gives frame times in hundredths of a second: a rate of 30 would play too fast."""

MOST_FRAMES = 500
"""Largest number of frames, all held in memory; a longer animation has a longer time between frames."""

SIZE = (9.6, 5.4)
"""Width and height of the picture, inches."""

DPI = {".gif": 80, ".mp4": 200}
"""Dots per inch: 1920 × 1080 dots in MP4, 768 × 432 in GIF, whose frames are not compressed against each other."""

SMOOTH = 300
"""Least number of line segments of the path of a tip."""

MARGIN = 0.08
"""Free room around the motion, relative to its extent."""

BELOW = 0.04
"""Room below the axes, whose labels reach out of the layout in space, relative to the picture."""

TURNING = np.linspace(0.0, 1.0, 11)
"""Abscissae of the sections whose axes are drawn."""

AXIS_LENGTH = 0.25
"""Length of a section's axis that is drawn, over the extent of the motion."""

TITLE_LETTERS = 100
"""Largest number of letters in one line of a title."""

TICKS = 5
"""Most intervals between the ticks of an axis."""


class AnimationFailedError(CosseratError):
    """Ffmpeg, which writes MP4, has failed."""

    def __init__(self, exit_code: int) -> None:
        super().__init__(f"ffmpeg could not write the animation and ended with exit code {exit_code}: write .gif")


class AnimationUnavailableError(CosseratError):
    """Ffmpeg, which writes MP4, is not installed."""

    def __init__(self) -> None:
        super().__init__(
            "MP4 needs the program ffmpeg, which is not on the PATH: install it with your system's package manager "
            "(apt install ffmpeg, brew install ffmpeg), or write .gif"
        )


def check_animation_path(path: str | Path, where: str = "path", others: tuple[str, ...] = ()) -> None:
    """Refuse an animation that cannot be made, before any work is done for it.

    Args:
        path: path of the file.
        where: name of the option or argument, for the message.
        others: further accepted suffixes, of meshes, for the message.

    Raises:
        SceneError: the suffix is none of FORMATS.
        AnimationUnavailableError: it is MP4, and ffmpeg is not installed.
    """
    suffix = Path(path).suffix.lower()
    if suffix not in FORMATS:
        problem = f"{path} has no suffix of an animation that can be made"
        raise SceneError(Problem(where, problem, f"use one of {', '.join(FORMATS + others)}"))
    figure_class()
    if suffix == ".mp4":
        from matplotlib.animation import FFMpegWriter

        if not FFMpegWriter.isAvailable():
            raise AnimationUnavailableError


def frame_times(motion: Motion, speed: float = 1.0) -> FloatArray:
    """Times of the frames of an animation, evenly spaced over the motion, both ends among them.

    Args:
        motion: motion with at least one computed time.
        speed: playing speed over real time: 1 is real time, 0.1 is ten times slower.

    Returns:
        times, shape (frames,), s; at most FRAME_RATE per second, and at most MOST_FRAMES.
    """
    first = motion.times[0]
    last = motion.times[-1]
    shown_seconds = (last - first) / speed
    intervals = int(np.clip(np.floor(FRAME_RATE * shown_seconds), 1, MOST_FRAMES - 1))
    return np.linspace(first, last, intervals + 1)


def animate_motion(
    motion: Motion, file: str | Path, *, speed: float = 1.0, progress: Callable[[float], None] | None = None
) -> None:
    """Draw the animation of a motion into a file. The file is written atomically.

    Args:
        motion: the motion.
        file: path with a suffix of FORMATS or MESHES.
        speed: playing speed over real time: 1 is real time, 0.1 is ten times slower.
        progress: called with the share of drawn frames, 0 to 1; not for meshes.

    Raises:
        SceneError: the suffix is none of these, the speed is not positive, or the motion has no state.
        AnimationUnavailableError: it is MP4, and ffmpeg is not installed.
        AnimationFailedError: ffmpeg fails, e.g. a build without H.264.
        WriteError: the file cannot be written, e.g. on a full disk.
    """
    if not speed > 0.0:
        raise SceneError(Problem("speed", f"must be > 0, got {speed:g}", "0.1 shows the motion ten times slower"))
    if Path(file).suffix.lower() in MESHES:
        # Imported here, because few films are meshes.
        from cosserat_casadi.plots.film import write_film

        write_film(motion, file, speed)
        return
    check_animation_path(file)
    if not len(motion.times):
        raise SceneError(Problem("path", "the motion has no state: it was not started"))
    save_frames(motion_frames(motion, frame_times(motion, speed), speed), file, progress=progress)


@dataclass(frozen=True)
class AnimationFrames:
    """Frames of an animation.

    Attributes:
        model: the model.
        x: unknowns, shape (rows, model.size), with ``finer`` rows from frame to frame.
        inputs: stacked inputs, shape (rows, model.inputs.size).
        words: title of each frame.
        colour: colour of the titles.
        interval: time from frame to frame, s.
        section_axes: whether lines show the x axes of sections, e.g. for a rod in pure torsion.
        finer: number of rows per frame; more than 1 for smooth paths between distant frames.
    """

    model: Model
    x: FloatArray
    inputs: FloatArray
    words: Sequence[str]
    colour: str
    interval: float
    section_axes: bool = False
    finer: int = 1


def save_frames(frames: AnimationFrames, file: str | Path, *, progress: Callable[[float], None] | None = None) -> None:
    """Draw an animation into a file, atomically; arguments and errors of :func:`animate_motion`."""
    check_animation_path(file)
    film = _Film(frames)
    save_film(film.figure, film.show, len(frames.words), frames.interval, file, progress=progress)


def save_film(
    figure: Any,
    show: Callable[[int], None],
    count: int,
    interval: float,
    file: str | Path,
    *,
    progress: Callable[[float], None] | None = None,
) -> None:
    """Draw the frames of a figure into a file, atomically; errors of :func:`animate_motion`.

    Args:
        figure: matplotlib figure.
        show: function (frame index from 0) that updates the figure.
        count: number of frames.
        interval: time from frame to frame, s.
        file: path with a suffix of FORMATS.
        progress: called with the share of drawn frames, 0 to 1.
    """
    check_animation_path(file)
    path = Path(file)
    # Laid out once: a layout for every frame would let the axes jump about.
    show(0)
    figure.get_layout_engine().set(rect=(0.0, BELOW, 1.0, 1.0 - BELOW))
    figure.draw_without_rendering()
    figure.set_layout_engine("none")
    with write_errors(path), _writer_of(figure, path.suffix.lower(), interval) as (writer, drawn):
        for index in range(count):
            show(index)
            writer.grab_frame()
            if progress is not None:
                progress((index + 1) / count)
        try:
            writer.finish()
        except CalledProcessError as failure:
            raise AnimationFailedError(failure.returncode) from failure
        write_atomically(path, drawn.read_bytes())


def motion_frames(motion: Motion, times: FloatArray, speed: float) -> AnimationFrames:
    """Frames of a motion at times, shape (frames,), s, shown at a speed relative to real time."""
    intervals = len(times) - 1
    finer = -(-SMOOTH // intervals) if intervals else 1
    rows = np.arange(intervals * finer + 1) / finer
    states = [motion.at(float(time)) for time in np.interp(rows, np.arange(len(times)), times)]
    shown_seconds = (times[-1] - times[0]) / speed
    colour = PLAIN_TEXT if motion.converged else FAILURE
    return AnimationFrames(
        model=motion.model,
        x=np.array([state.x for state in states]),
        inputs=np.array([state.inputs for state in states]),
        words=_time_words(motion, times, speed),
        colour=colour,
        # A motion that stopped at its start is one picture, for any time.
        interval=shown_seconds / max(1, intervals) or 1 / FRAME_RATE,
        finer=finer,
    )


def _time_words(motion: Motion, times: FloatArray, speed: float) -> list[str]:
    """Titles with the time of each frame, distinct from frame to frame, and the speed if it is not 1."""
    interval = times[-1] / max(1, len(times) - 1)
    digits = max(1, int(np.ceil(-np.log10(interval)))) if interval > 0 else 1
    remark = ""
    if speed != 1.0:
        remark += f", at {speed:g} of its speed"
    if not motion.converged:
        remark += ", not converged"
    return [f"t = {time:.{digits}f} s{remark}" for time in times]


@contextmanager
def _writer_of(figure: Any, suffix: str, seconds_a_frame: float) -> Iterator[tuple[Any, Path]]:
    """A frame writer and the path of its file in a temporary folder; the folder is removed at exit."""
    from matplotlib.animation import FFMpegWriter, PillowWriter

    with tempfile.TemporaryDirectory() as folder:
        # Writers take the format from the suffix, which a temporary file of an atomic write does not have.
        drawn = Path(folder) / f"motion{suffix}"
        if suffix == ".gif":
            writer = PillowWriter(fps=_rate_of_gif(seconds_a_frame))
        else:
            writer = FFMpegWriter(fps=1 / seconds_a_frame)
        writer.setup(figure, str(drawn), dpi=DPI[suffix])
        try:
            yield writer, drawn
        except BaseException:
            # Ffmpeg waits for further frames until its input is closed.
            if isinstance(writer, FFMpegWriter):
                with suppress(CalledProcessError, OSError):
                    writer.finish()
            raise


def _rate_of_gif(seconds_a_frame: float) -> float:
    """Frames per second, chosen so that the writer, which truncates to milliseconds, gives whole hundredths."""
    hundredths = max(1, round(100 * seconds_a_frame))
    thousandths = 10 * hundredths + 0.5
    return 1000 / thousandths


@dataclass(frozen=True)
class _Moving:
    """A line with different points in each frame.

    Attributes:
        line: matplotlib line.
        points: points of each row, shape (rows, k, 3), m; for a trail the newest point, shape (rows, 3), m.
    """

    line: Any
    points: FloatArray

    def at(self, index: int) -> FloatArray:
        """Points of a row, shape (k, 3), m."""
        if self.points.ndim == 3:
            return np.asarray(self.points[index])
        return self.points[: index + 1]


class _Film:
    """A figure that shows the frames of a motion one by one."""

    def __init__(self, frames: AnimationFrames) -> None:
        shapes = moving_shapes(frames.model, np.arange(len(frames.x), dtype=float), frames.x, frames.inputs)
        plane, view_axes = shapes.view
        if frames.section_axes:
            plane = None
        self.figure = figure_class()(figsize=SIZE, layout="constrained")
        title = textwrap.fill(frames.model.scene.title or "Untitled scene", TITLE_LETTERS)
        self.figure.suptitle(title, fontsize=11, fontweight="bold")
        self._frames = frames
        self._canvas = add_canvas(self.figure, (), (plane, view_axes), shapes.size)
        self._lines = self._draw(shapes) + self._draw_obstacles(frames, shapes)
        if frames.section_axes:
            self._lines += self._draw_section_axes(frames, shapes)
        standing = [obstacle for obstacle in frames.model.scene.obstacles if obstacle.body is None]
        draw_surfaces(self._canvas, standing, shapes.points, {})
        draw_supports(self._canvas, frames.model.scene)
        self._set_limits(shapes)
        handles, labels = self._canvas.axes.get_legend_handles_labels()
        # A single rod has no legend entry.
        if len(handles) > 1:
            self.figure.legend(handles, labels, loc="outside right center", fontsize=9)

    def show(self, index: int) -> None:
        """Move all lines to a frame, and set its title."""
        for moving in self._lines:
            self._canvas.move(moving.line, moving.at(index * self._frames.finer))
        words = self._frames.words[index]
        self._canvas.axes.set_title(words, fontsize=10, color=self._frames.colour)

    def _draw(self, shapes: MovingShapes) -> list[_Moving]:
        """Draw all moving lines, and return them."""
        canvas = self._canvas
        followed = shapes.followed.values()
        lines = [_Moving(canvas.line(path[:1], color="0.55", linewidth=1.2), path) for path in followed]
        for name, outlines in shapes.outlines.items():
            body = canvas.line(outlines[0], linewidth=2.0, label=name, **shapes.outline_style(name))
            lines.append(_Moving(body, outlines))
        for index, (name, course) in enumerate(shapes.courses.items()):
            cable = canvas.line(course[0], color=actuator_colour(index), linewidth=1.2, label=name)
            lines.append(_Moving(cable, course))
        for index, (name, centre_lines) in enumerate(shapes.rods.items()):
            rod = canvas.line(centre_lines[0], linewidth=3.5, label=name, **rod_style(index))
            lines.append(_Moving(rod, centre_lines))
        lines += [_Moving(canvas.markers(places[0], **style), places) for style, places in shapes.marks]
        return lines

    def _draw_obstacles(self, frames: AnimationFrames, shapes: MovingShapes) -> list[_Moving]:
        """Draw the obstacles on moving bodies, and return them."""
        lines = []
        for obstacle in frames.model.scene.obstacles:
            if obstacle.body is None:
                continue
            poses = poses_of(frames.model.body[obstacle.body], frames.x, frames.inputs)
            world_R_body = rotations(poses.quaternion)
            first = SolvedPoses(poses.position[0], world_R_body[0], poses.quaternion[0])
            for outline in surface_lines(self._canvas, obstacle, shapes.points, first):
                in_body = in_axes_of(first, outline)
                moved = poses.position[:, None, :] + np.einsum("tij,kj->tki", world_R_body, in_body)
                line = self._canvas.line(moved[0], color=OBSTACLES, linewidth=1.2, label=obstacle.name)
                lines.append(_Moving(line, moved))
        return lines

    def _draw_section_axes(self, frames: AnimationFrames, shapes: MovingShapes) -> list[_Moving]:
        """Draw the x axes of a few sections of each rod, and return them."""
        lines = []
        for index, name in enumerate(shapes.rods):
            poses = section_poses(frames.model, name, TURNING, frames.x, frames.inputs)
            for starts, quaternions in zip(
                np.moveaxis(poses.position, 1, 0), np.moveaxis(poses.quaternion, 1, 0), strict=True
            ):
                ends = starts + AXIS_LENGTH * shapes.size * rotations(quaternions)[:, :, 0]
                axes = np.stack([starts, ends], axis=1)
                line = self._canvas.line(axes[0], color=rod_colour(index), linewidth=2.0)
                lines.append(_Moving(line, axes))
        return lines

    def _set_limits(self, shapes: MovingShapes) -> None:
        """Set limits of the axes for the whole motion, with equal scales."""
        canvas = self._canvas
        canvas.label_axes()
        canvas.axes.locator_params(nbins=TICKS)
        if canvas.plane is None:
            canvas.equalise(shapes.points)
            return
        points = canvas.projected(shapes.points)
        highest = points.max(axis=0)
        lowest = points.min(axis=0)
        centre = (highest + lowest) / 2
        half_width = (0.5 + MARGIN) * shapes.size
        limits = np.stack([centre - half_width, centre + half_width], axis=1)
        canvas.axes.set(xlim=limits[0], ylim=limits[1])
        canvas.axes.set_aspect("equal", adjustable="box")
        canvas.axes.grid(alpha=0.3)
