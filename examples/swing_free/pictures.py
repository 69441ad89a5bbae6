"""The figure and the animation of both moves."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from swing_free.robot import Run
from swing_free.task import STEP, TENDONS

COLOURS = {"equilibria": "#ee6677", "motion": "#4477aa"}


def draw(runs: dict[str, Run], file: Path) -> None:
    """Path of the tip, how far it is along the move, and the tensions under both controllers."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(11.0, 7.0), layout="constrained")
    path, along, *pulls = figure.subplots(2, 2).ravel()
    for name, run in runs.items():
        path.plot(*1e3 * run.tips[:, 1:].T, color=COLOURS[name], label=f"planned with {name}")
        along.plot(run.seconds, 1e3 * run.tips[:, 1], color=COLOURS[name], label=f"planned with {name}")
    any_run = runs["motion"]
    along.plot(any_run.seconds, 1e3 * any_run.wanted[:, 1], color="0.6", linestyle=":", label="wanted")
    path.plot(*1e3 * any_run.wanted[[0, -1], 1:].T, color="black", marker="o", markersize=4, linestyle="")
    path.set(xlabel="y, mm", ylabel="z, mm", aspect="equal", title="path of the tip")
    along.set(xlabel="time, s", ylabel="y, mm", title="tip along the move")
    along.legend()
    for axes, (name, run) in zip(pulls, runs.items(), strict=True):
        axes.plot(run.seconds, run.tensions)
        axes.set(xlabel="time, s", ylabel="tension, N", title=f"planned with {name}")
    pulls[-1].legend([tendon.replace("_", " ") for tendon in TENDONS])
    figure.savefig(file, dpi=130)


def animate(runs: dict[str, Run], file: Path) -> None:
    """Both robots side by side, at a fifth of their speed."""
    from matplotlib.animation import FuncAnimation, PillowWriter
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7.6, 4.2), layout="constrained")
    pictures = []
    for number, (name, run) in enumerate(runs.items()):
        space = figure.add_subplot(1, 2, number + 1, projection="3d", title=f"planned with {name}")
        (line,) = space.plot([], [], [], color=COLOURS[name], linewidth=3)
        (trail,) = space.plot([], [], [], color="0.5", linewidth=1)
        space.plot(*run.wanted[[0, -1]].T, color="black", marker="o", markersize=3, linestyle="")
        space.set(xlim=(-0.2, 0.2), ylim=(-0.2, 0.2), zlim=(0.0, 0.4))
        space.view_init(elev=12, azim=15)
        space.set_aspect("equal")
        space.locator_params(nbins=4)
        pictures.append((run, line, trail))

    def frame(k: int) -> list[object]:
        for run, line, trail in pictures:
            line.set_data_3d(*run.lines[k].T)
            trail.set_data_3d(*run.tips[: k + 1].T)
        return [artist for _, line, trail in pictures for artist in (line, trail)]

    first = int(np.searchsorted(runs["motion"].seconds, -STEP))
    frames = range(first, len(runs["motion"].seconds))
    FuncAnimation(figure, frame, frames).save(file, PillowWriter(fps=round(0.2 / STEP)), dpi=72)
