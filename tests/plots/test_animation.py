"""Animations: as long as the motion, in axes that hold it, whole or not at all."""

from __future__ import annotations

import os
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose
from PIL import Image

from cosserat_casadi import SceneError
from cosserat_casadi.motion.trajectory import Motion, MotionOutcome
from cosserat_casadi.plots import animation
from cosserat_casadi.plots.animation import (
    FRAME_RATE,
    MOST_FRAMES,
    AnimationFailedError,
    AnimationUnavailableError,
    animate_motion,
    check_animation_path,
    frame_times,
)
from tests.families import mostly_slow
from tests.motions import planar_swing, swinging_rod, two_rods_on_a_platform


@pytest.fixture(scope="module")
def short() -> Motion:
    return planar_swing(duration=0.4, frames=5)


def film(path: Path) -> tuple[int, float]:
    """Frames of a GIF, and how long it takes, s."""
    with Image.open(path) as image:
        milliseconds = 0
        for frame in range(image.n_frames):
            image.seek(frame)
            milliseconds += image.info["duration"]
        return image.n_frames, milliseconds / 1000


@pytest.mark.parametrize("speed", mostly_slow([1.0, 0.5], quick=[1.0]))
def test_gif_takes_as_long_as_the_motion(short: Motion, tmp_path: Path, speed: float) -> None:
    path = tmp_path / "swing.gif"
    animate_motion(short, path, speed=speed)
    frames, seconds = film(path)
    assert frames == FRAME_RATE * 0.4 / speed + 1
    # The last frame is shown as long as the others.
    assert_allclose(seconds - seconds / frames, 0.4 / speed, rtol=1e-12, atol=0)
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize(("duration", "frames"), [(1e-3, 2), (0.5, 13), (10.0, 251), (3600.0, MOST_FRAMES)])
def test_frames_are_evenly_spaced_and_not_too_many(duration: float, frames: int) -> None:
    motion = planar_swing(duration=duration, frames=2)
    times = frame_times(motion)
    assert len(times) == frames
    assert times[0] == 0.0
    assert times[-1] == duration
    assert_allclose(np.diff(times), duration / (frames - 1), rtol=1e-9, atol=0)


@pytest.mark.parametrize("hundredths", range(1, 60))
def test_rate_survives_the_writer_that_cuts_off(hundredths: int) -> None:
    rate = animation._rate_of_gif(hundredths / 100)
    assert int(1000 / rate) == 10 * hundredths


def test_frames_lie_on_the_dense_output_in_fixed_axes() -> None:
    motion = two_rods_on_a_platform(duration=0.4, frames=2)
    times = frame_times(motion)
    drawn = animation._Film(animation.motion_frames(motion, times, 1.0))
    axes = drawn.figure.axes[0]
    limits = [axes.get_xlim(), axes.get_ylim(), axes.get_zlim()]
    left = next(line for line in axes.get_lines() if line.get_label() == "left")
    for index in (0, 4, len(times) - 1):
        drawn.show(index)
        state = motion.at(times[index])
        tip = motion.model.tip["left"](state.x, state.inputs)[0].full()[:, 0]
        end = np.array(left.get_data_3d())[:, -1]
        assert_allclose(end, tip, rtol=0, atol=1e-12)
        assert all(low < coordinate < high for coordinate, (low, high) in zip(end, limits, strict=True))
        assert [axes.get_xlim(), axes.get_ylim(), axes.get_zlim()] == limits
        assert axes.get_title() == f"t = {times[index]:.2f} s"


def test_trails_grow_with_the_motion(short: Motion) -> None:
    times = frame_times(short)
    drawn = animation._Film(animation.motion_frames(short, times, 0.5))
    trail = drawn.figure.axes[0].get_lines()[0]
    for index in (0, 3, 10):
        drawn.show(index)
        assert len(trail.get_xdata()) == index * animation.SMOOTH / 10 + 1
    assert drawn.figure.axes[0].get_title() == "t = 0.40 s, at 0.5 of its speed"


def test_planar_axes_hold_the_motion(short: Motion) -> None:
    drawn = animation._Film(animation.motion_frames(short, frame_times(short), 1.0))
    axes = drawn.figure.axes[0]
    points = short.section(None, np.linspace(0, 1, 21)).position.reshape(-1, 3)
    for limits, axis in ((axes.get_xlim(), 0), (axes.get_ylim(), 2)):
        assert limits[0] < points[:, axis].min()
        assert limits[1] > points[:, axis].max()


def test_a_motion_that_ended_early_says_so(short: Motion) -> None:
    drawn = animation._Film(
        animation.motion_frames(replace(short, outcome=MotionOutcome.NOT_FINITE), frame_times(short), 1.0)
    )
    drawn.show(0)
    assert drawn.figure.axes[0].get_title() == "t = 0.00 s, not converged"


def test_a_motion_of_one_time_is_a_picture(tmp_path: Path) -> None:
    path = tmp_path / "one.gif"
    animate_motion(swinging_rod(frames=1), path)
    assert film(path)[0] >= 1


def test_progress_goes_to_one(short: Motion, tmp_path: Path) -> None:
    shares: list[float] = []
    animate_motion(short, tmp_path / "swing.gif", progress=shares.append)
    assert_allclose(shares, np.arange(1, 12) / 11, rtol=1e-14, atol=0)


def test_an_interrupt_leaves_no_file(short: Motion, tmp_path: Path) -> None:
    path = tmp_path / "swing.gif"
    path.write_bytes(b"what was there before")

    def interrupt(share: float) -> None:
        if share > 0.5:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        animate_motion(short, path, progress=interrupt)
    assert path.read_bytes() == b"what was there before"
    assert list(tmp_path.iterdir()) == [path]


def test_unknown_suffix_is_refused_with_the_known_ones() -> None:
    with pytest.raises(SceneError, match=r"path: .*use one of \.gif, \.mp4"):
        check_animation_path("swing.avi")


def test_mp4_without_ffmpeg_is_a_sentence(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(shutil, "which", lambda _: None)
    with pytest.raises(AnimationUnavailableError, match=r"ffmpeg.*or write \.gif"):
        check_animation_path("swing.mp4")
    check_animation_path("swing.gif")


def put_ffmpeg(folder: Path, script: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """A program in the place of ffmpeg: frames come in by standard input, the file is the last argument."""
    program = folder / "ffmpeg"
    program.write_text(f'#!/bin/sh\nfor file in "$@"; do :; done\n{script}\n')
    program.chmod(0o755)
    monkeypatch.setenv("PATH", f"{folder}:{os.environ['PATH']}")


def test_mp4_gets_every_frame(short: Motion, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    put_ffmpeg(tmp_path, 'cat > "$file"', monkeypatch)
    path = tmp_path / "swing.mp4"
    animate_motion(short, path)
    assert path.stat().st_size == 11 * 1920 * 1080 * 4


def test_ffmpeg_that_gives_up_is_a_sentence(short: Motion, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    put_ffmpeg(tmp_path, "cat > /dev/null; exit 3", monkeypatch)
    with pytest.raises(AnimationFailedError, match=r"exit code 3: write \.gif"):
        animate_motion(short, tmp_path / "swing.mp4")
    assert [file.name for file in tmp_path.iterdir()] == ["ffmpeg"]


def test_an_interrupt_ends_ffmpeg(short: Motion, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    put_ffmpeg(tmp_path, f'cat > "$file"; touch {tmp_path}/ended', monkeypatch)

    def interrupt(share: float) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        animate_motion(short, tmp_path / "swing.mp4", progress=interrupt)
    assert sorted(file.name for file in tmp_path.iterdir()) == ["ended", "ffmpeg"]


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("ffmpeg") is None, reason="needs ffmpeg")
def test_mp4(short: Motion, tmp_path: Path) -> None:
    path = tmp_path / "swing.mp4"
    animate_motion(short, path)
    assert path.read_bytes()[4:8] == b"ftyp"
