"""Figures of concentric tubes: equilibria in space, angles along them, a path with its snaps, and its film.

matplotlib is an extra and is imported inside functions only.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy.interpolate import PchipInterpolator

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.paths.tube_path import TubeEvent, TubePath
from cosserat_casadi.plots.animation import SIZE, check_animation_path, save_film
from cosserat_casadi.plots.arrows import draw_arrows
from cosserat_casadi.plots.canvas import WORLD, Canvas, add_canvas
from cosserat_casadi.plots.colours import FAILURE, PLAIN_TEXT, category_style, rod_colour
from cosserat_casadi.plots.figure import add_subtitle, add_title, figure_class
from cosserat_casadi.plots.path_plot import path_interval, runs, shown_points
from cosserat_casadi.plots.scenery import draw_targets
from cosserat_casadi.tubes.tube_arrows import load_arrows
from cosserat_casadi.tubes.tube_equilibria import TubeEquilibria
from cosserat_casadi.tubes.tube_solution import TubeSolution

STROKES: dict[bool | None, str] = {True: "-", False: "--", None: "-"}
"""Line styles of stable and unstable equilibria, and of equilibria under nonconservative loads."""

VERDICTS: dict[bool | None, str] = {True: "stable", False: "unstable", None: "loads without energy"}
"""Labels of stable and unstable equilibria, and of equilibria under nonconservative loads."""

NANOMETRES = 9
"""Decimal places of a distance in metres."""

DRAWN = 12
"""Number of drawn points between adjacent stations."""

WIDEST = 6.0
"""Line width where all tubes overlap, points; a line is thinner beyond the end of each tube."""


def plot_tubes(solution: TubeSolution | TubeEquilibria) -> Any:
    """Figure of an equilibrium, or of all at the same inputs: left the shape, right the angles along the centre line.

    The line is thinner beyond the end of each tube. Unstable equilibria are dashed.
    """
    solutions = [solution] if isinstance(solution, TubeSolution) else solution.solutions
    figure = figure_class()(figsize=(13.0, 6.6), layout="constrained")
    grid = figure.add_gridspec(1, 2, width_ratios=(1.3, 1.0))
    points = np.concatenate([solution.shape.position for solution in solutions])
    size = float(np.ptp(points, axis=0).max())
    canvas = add_canvas(figure, (grid[0, 0],), (None, WORLD), size)
    panel = figure.add_subplot(grid[0, 1])
    for number, equilibrium in enumerate(solutions):
        _draw_robot(canvas, equilibrium, number, several=len(solutions) > 1)
        _draw_angles(panel, equilibrium, number, several=len(solutions) > 1)
    # Follower loads depend on the equilibrium: the figure shows the loads of the first one.
    draw_arrows(canvas, load_arrows(solutions[0]))
    draw_targets(canvas, solutions[0].model.scene)
    canvas.label_axes()
    canvas.equalise(points)
    panel.set_xlabel("distance from the plate along the centre line, m")
    panel.set_ylabel(f"angle of the tube less {solutions[0].robot.names[0]}.rotation, rad")
    panel.grid(alpha=0.3)
    panel.legend(fontsize=9)
    figure.legend(*canvas.axes.get_legend_handles_labels(), loc="outside lower left", ncols=5, fontsize=9)
    first = solutions[0]
    add_title(figure, first.robot.scene.title)
    add_subtitle(canvas.axes, _subtitle(solutions), good=len(solutions) > 1 or first.converged)
    return figure


def _subtitle(solutions: Sequence[TubeSolution]) -> str:
    first = solutions[0]
    if len(solutions) > 1:
        stable = sum(bool(solution.stable) for solution in solutions)
        return f"{len(solutions)} equilibria, {stable} of them stable"
    return f"energy {first.energy:.6g} J; {VERDICTS[first.stable]}" if first.converged else first.message


def _draw_robot(canvas: Canvas, solution: TubeSolution, number: int, *, several: bool) -> None:
    """Draw the centre line; colours denote tubes for one equilibrium, else equilibria.

    The line width is proportional to the number of tubes.
    """
    if not several:
        _draw_nested(canvas, solution)
        return
    reaches = solution.robot.translations(solution.inputs)
    colour = rod_colour(number)
    stroke = STROKES[solution.stable]
    label = f"{number + 1}: {VERDICTS[solution.stable]}, {solution.energy:.4g} J"
    ends = sorted({0.0, *(float(reach) for reach in reaches)})
    for start, end in pairwise(ends):
        tubes = int(np.sum(reaches >= end))
        width = WIDEST * tubes / len(reaches)
        line = _centre_line(solution, start, end)
        canvas.line(line, color=colour, linestyle=stroke, linewidth=width, label=label)


def _draw_nested(canvas: Canvas, solution: TubeSolution) -> dict[int, Any]:
    """Draw the tubes of an equilibrium, inner tubes over outer ones and thinner; returns their lines by index."""
    lines = {}
    reaches = solution.robot.translations(solution.inputs)
    stroke = STROKES[solution.stable]
    # An outer tube ends before the inner one.
    for rank, index in enumerate(np.argsort(reaches, kind="stable").tolist()):
        line = _centre_line(solution, 0.0, float(reaches[index]))
        width = WIDEST * (len(reaches) - rank) / len(reaches)
        name = solution.robot.names[index]
        lines[index] = canvas.line(line, color=rod_colour(index), linestyle=stroke, linewidth=width, label=name)
    return lines


def _centre_line(solution: TubeSolution, start: float, end: float) -> FloatArray:
    """Points of the centre line between two arc lengths, shape (k, 3), m."""
    shape = solution.shape
    stations = shape.distance[_between(shape.distance, start, end)]
    between = np.linspace(stations[:-1], stations[1:], DRAWN, axis=1).ravel()
    line, _ = shape.between(between)
    return np.asarray(line)


def _between(distance: FloatArray, start: float, end: float) -> npt.NDArray[np.bool_]:
    """Mask of the stations between two arc lengths, both included."""
    # Arc lengths are sums of steps: at the end of a tube they have rounding errors.
    slack = 1e-9 * float(distance.max())
    return (distance >= start - slack) & (distance <= end + slack)


def _draw_angles(panel: Any, solution: TubeSolution, number: int, *, several: bool) -> None:
    """Draw the angles of the tubes up to their tips, relative to the angle of the first drive."""
    shape = solution.shape
    first = solution.inputs[0]
    for index, name in enumerate(solution.robot.names):
        here = _between(shape.distance, 0.0, float(solution.inputs[2 * index + 1]))
        if several:
            colour = rod_colour(number)
            label = f"{name}, {number + 1}"
        else:
            colour = rod_colour(index)
            label = name
        style = {**category_style(index), "color": colour, "linestyle": STROKES[solution.stable], "markevery": 0.15}
        # The few steps need interpolation between them. Steps of zero length up to rounding are skipped.
        distance, rows = np.unique(np.round(shape.distance[here], NANOMETRES), return_index=True)
        angles = shape.angles[here, index][rows] - first
        # A tube that ends at the base plate has one station, and no curve.
        if len(distance) > 1:
            curve = PchipInterpolator(distance, angles)
            distance = np.linspace(distance[0], distance[-1], DRAWN * len(distance))
            angles = curve(distance)
        panel.plot(distance, angles, label=label, **style)


def plot_tube_path(path: TubePath) -> Any:
    """Figure of a path over the input: left the angles of the tips, right the energy; arrows are snaps."""
    figure = figure_class()(figsize=(13.0, 5.6), layout="constrained")
    left, right = figure.subplots(1, 2)
    if path.solutions:
        names = path.solutions[0].robot.names
        angles = np.array([solution.x for solution in path.solutions])
        for index, name in enumerate(names):
            _draw_curve(left, path, angles[:, index], rod_colour(index), name)
        for event in path.events:
            snap = event.snaps_to
            for index in range(len(names)):
                _draw_event(left, event, event.solution.x[index], None if snap is None else float(snap.x[index]))
            _draw_event(right, event, event.solution.energy, None if snap is None else snap.energy)
        _draw_curve(right, path, path.energy, rod_colour(len(names)), "energy")
    energy = "elastic energy, J"
    verdicts = {True: "stable", False: "unstable"}
    if path.stable is None:
        verdicts = {}
    elif path.solutions and path.solutions[0].robot.loads:
        energy = "elastic energy less the work of the loads, J"
    for axes, words in ((left, "angle at the tip, rad"), (right, energy)):
        axes.set_xlabel(f"{path.name}, {path.unit}")
        axes.set_ylabel(words)
        axes.grid(alpha=0.3)
        for stable, verdict in verdicts.items():
            axes.plot([], [], color="0.3", linestyle=STROKES[stable], label=verdict)
        axes.legend(fontsize=9)
    add_subtitle(left, _path_subtitle(path), good=path.converged)
    add_title(figure, path.model.scene.title)
    return figure


def animate_tube_path(path: TubePath, file: str | Path, *, progress: Callable[[float], None] | None = None) -> None:
    """Draw the equilibria of a path as :func:`cosserat_casadi.plots.path_plot.animate_path` does.

    Tubes of unstable equilibria are dashed.
    """
    shown = shown_points(len(path.solutions))
    check_animation_path(file)
    solutions = [path.solutions[index] for index in shown]
    points = np.concatenate([solution.shape.position for solution in solutions])
    figure = figure_class()(figsize=SIZE, layout="constrained")
    canvas = add_canvas(figure, (), (None, WORLD), float(np.ptp(points, axis=0).max()))
    tips = np.array([solution.tip().position for solution in solutions])
    trail = canvas.line(tips[:1], color="0.55", linewidth=1.2)
    tubes = _draw_nested(canvas, solutions[0])
    canvas.label_axes()
    canvas.equalise(points)
    figure.legend(handles=list(tubes.values()), loc="outside right center", fontsize=9)
    add_title(figure, path.model.scene.title)
    colour = PLAIN_TEXT if path.converged else FAILURE

    def show(frame: int) -> None:
        solution = solutions[frame]
        canvas.move(trail, tips[: frame + 1])
        for index, reach in enumerate(solution.robot.translations(solution.inputs)):
            canvas.move(tubes[index], _centre_line(solution, 0.0, float(reach)))
            tubes[index].set_linestyle(STROKES[solution.stable])
        words = f"{path.name} = {path.values[shown[frame]]:.4g} {path.unit}, {VERDICTS[solution.stable]}"
        canvas.axes.set_title(words, fontsize=10, color=colour)

    save_film(figure, show, len(shown), path_interval(shown), file, progress=progress)


def _path_subtitle(path: TubePath) -> str:
    if not path.converged:
        return path.message
    snaps = [event for event in path.events if event.snaps_to is not None]
    if not snaps:
        return "no snap"
    return "; ".join(f"snaps at {event.value:.6g} {path.unit}" for event in snaps)


def _draw_curve(axes: Any, path: TubePath, heights: FloatArray, colour: str, label: str) -> None:
    """Draw a quantity along the path, dashed for unstable equilibria."""
    stable = path.stable
    if stable is None:
        axes.plot(path.values, heights, color=colour, label=label)
        return
    for start, stop, is_stable in runs(stable):
        part = slice(start, stop)
        axes.plot(path.values[part], heights[part], color=colour, linestyle=STROKES[bool(is_stable)])
    axes.plot([], [], color=colour, label=label)


def _draw_event(axes: Any, event: TubeEvent, height: float, landing: float | None) -> None:
    """Draw a marker at an event, and the snap from it as an arrow."""
    axes.plot(event.value, height, marker="o", color="0.1", linestyle="none", markersize=6, zorder=5)
    if landing is not None:
        arrow = {"arrowstyle": "-|>", "color": "0.1", "mutation_scale": 14}
        axes.annotate("", xy=(event.value, landing), xytext=(event.value, height), arrowprops=arrow)
