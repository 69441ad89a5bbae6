"""The figure of a motion: shapes and paths of tips over time, inputs, energies and their balance.

matplotlib is an extra and is imported inside functions only.
"""

from __future__ import annotations

from dataclasses import fields
from typing import Any

import numpy as np

from cosserat_casadi.equilibrium.solution import SolvedPoses, rotations
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.load_cases import column_indices
from cosserat_casadi.motion.contact_record import MotionContact
from cosserat_casadi.motion.trajectory import Motion
from cosserat_casadi.plots.canvas import Canvas, add_canvas
from cosserat_casadi.plots.colours import CATEGORIES, FAILURE, rod_style
from cosserat_casadi.plots.figure import add_subtitle, add_title, figure_class
from cosserat_casadi.plots.moving_shapes import MovingShapes, moving_shapes
from cosserat_casadi.plots.obstacle_drawing import draw_surfaces
from cosserat_casadi.plots.scenery import draw_supports
from cosserat_casadi.results.facts import told_error

SHAPES = 12
"""Number of drawn shapes of a motion, evenly spaced in time from start to end."""

PALEST = 0.18
"""Colour strength of the first shape; the last shape has strength 1."""

TIME_MAP = "viridis_r"
"""Colour map of time along a path: light at the start, dark at the end, also for colour-blind readers."""

LIGHTEST = 0.12
"""Omitted share of that map at its light end, which is invisible on white."""

TICKS = 6
"""Most intervals between the ticks of an axis in space."""

COLUMN_SPACE = 0.06
"""Space between the columns, over their width: the layout ignores labels of axes in space."""

STROKES = ("-", "--", ":")
"""Line styles of the curves of a panel; the style changes after all colours are used."""

LEGEND_ROWS = 8
"""Largest number of entries in one column of a legend."""

MOST_NAMED = 2 * LEGEND_ROWS
"""Largest number of curves that are all in the legend; beyond it one column lists the most varying curves."""

REST = "0.6"
"""Grey of curves without a legend entry."""

NOTHING = 1e-12
"""Threshold of zero curves, relative to the largest value."""


ROUNDING = 1e-16
"""Lower limit of the axis of the imbalance, for motions without imbalance."""


def plot_motion(motion: Motion) -> Any:
    """Figure of a motion.

    Left: the rods at SHAPES times, with colours stronger later, and the outlines of bodies; a planar motion is drawn in
    its plane. Paths of tips and bodies are coloured by time, their ends are marked. Right, over time: the varying
    inputs, one panel per field and unit; the energies; the energy imbalance.
    """
    moving = _moving_inputs(motion)
    panel_count = len(moving) + 2
    figure = figure_class()(figsize=(13.5, max(6.8, 1.9 * panel_count)), layout="constrained")
    add_title(figure, motion.model.scene.title)
    # The figure of a motion without states has only the message.
    if len(motion.times) == 0:
        figure.text(0.5, 0.5, motion.message, color=FAILURE, ha="center", wrap=True)
        return figure

    figure.get_layout_engine().set(wspace=COLUMN_SPACE)
    grid = figure.add_gridspec(panel_count, 2, width_ratios=(1.25, 1.0))
    shapes = moving_shapes(motion.model, motion.times, motion.x, motion.inputs)
    canvas = add_canvas(figure, (grid[:, 0],), shapes.view, shapes.size)
    _draw_shapes(canvas, motion, shapes)
    _draw_paths(figure, canvas, shapes)
    canvas.label_axes()
    canvas.axes.locator_params(nbins=TICKS)
    canvas.equalise(shapes.points)
    add_subtitle(canvas.axes, _subtitle(motion), good=motion.converged and motion.within_tolerance is not False)
    # The legend is below the axes, where it covers no shape.
    figure.legend(*canvas.axes.get_legend_handles_labels(), loc="outside lower left", ncols=4, fontsize=9)

    panels = [figure.add_subplot(grid[row, 1]) for row in range(panel_count)]
    # The last panels show the energies and the imbalance.
    for panel, (quantity, curves) in zip(panels[:-2], moving.items(), strict=True):
        _draw_curves(panel, motion.times, curves)
        panel.set_ylabel(quantity)
    energies = {field.name: getattr(motion.energy, field.name) for field in fields(motion.energy)}
    del energies["imbalance"]
    # Energies that are not identically zero.
    least = NOTHING * max(np.abs(values).max() for values in energies.values())
    energies = {name: values for name, values in energies.items() if np.abs(values).max() > least}
    _draw_curves(panels[-2], motion.times, energies)
    panels[-2].set_ylabel("energy, J")
    _draw_imbalance(panels[-1], motion)
    first, last = motion.times[[0, -1]]
    # Limits need two different times; a motion that failed at its start has one.
    margin = 0.02 * (last - first) or 1.0
    for panel in panels:
        panel.set_xlim(first - margin, last + margin)
    for panel in panels[:-1]:
        panel.tick_params(labelbottom=False)
    panels[-1].set_xlabel("time, s")
    return figure


def _draw_shapes(canvas: Canvas, motion: Motion, shapes: MovingShapes) -> None:
    """Draw rods and bodies at a few times, with the marks of clamps and joints."""
    rows = shown_rows(motion.times)
    for order, row in enumerate(rows):
        share = _share_of_colour(order, len(rows))
        last = order == len(rows) - 1
        for index, (name, lines) in enumerate(shapes.rods.items()):
            label = name if last else None
            style = rod_style(index)
            style["color"] = _faded(style["color"], share)
            canvas.line(lines[row], linewidth=2.5, label=label, **style)
        for name, outlines in shapes.outlines.items():
            label = name if last else None
            style = shapes.outline_style(name)
            style["color"] = _faded(style["color"], share)
            canvas.line(outlines[row], linewidth=1.8, label=label, **style)
    for style, places in shapes.marks:
        canvas.markers(places[-1], **style)
    draw_supports(canvas, motion.model.scene)
    _draw_obstacles(canvas, motion, shapes, rows)
    _mark_contacts(canvas, motion, rows)


def _draw_obstacles(canvas: Canvas, motion: Motion, shapes: MovingShapes, rows: list[int]) -> None:
    """Draw obstacles; obstacles on bodies in each drawn shape."""
    obstacles = motion.model.scene.obstacles
    draw_surfaces(canvas, [one for one in obstacles if one.body is None], shapes.points, {})
    moving = [one for one in obstacles if one.body is not None]
    for order, row in enumerate(rows):
        share = _share_of_colour(order, len(rows))
        bodies = {}
        for name in {str(one.body) for one in moving}:
            poses = motion.body(name)
            at_row = poses.quaternion[row]
            bodies[name] = SolvedPoses(poses.position[row], rotations(at_row), at_row)
        draw_surfaces(canvas, moving, shapes.points, bodies, strength=share, named=row == rows[-1])


def _mark_contacts(canvas: Canvas, motion: Motion, rows: list[int]) -> None:
    """Mark contacts with obstacles without a width in the drawn shapes."""
    for row in rows:
        for contact in motion.contacts[row] if motion.contacts else ():
            point = _touching_point(motion, contact, row)
            canvas.markers(point, marker="o", markersize=5, color="black", zorder=9, label="contact")


def _touching_point(motion: Motion, contact: MotionContact, row: int) -> FloatArray:
    """Centre of the touching section, or contact point of the ball of a body, shape (1, 3), m."""
    if not contact.of_body:
        return np.asarray(motion.section(contact.owner, [contact.at]).position[row])
    (body,) = [body for body in motion.model.scene.bodies if body.name == contact.owner]
    normal = contact.force / np.linalg.norm(contact.force)
    centre: FloatArray = motion.body(body.name).position[row : row + 1]
    return centre - body.ball_radius * normal


def shown_rows(times: FloatArray) -> list[int]:
    """Rows of the drawn shapes: the nearest ones to evenly spaced times."""
    wanted = np.linspace(times[0], times[-1], SHAPES)
    nearest = np.abs(times - wanted[:, None]).argmin(axis=1)
    return sorted(set(nearest.tolist()))


def _share_of_colour(order: int, count: int) -> float:
    """Colour strength of a shape by its order, 0 for the first shape; 1 for the last shape."""
    # With the quotient first the last share is exactly one, and no component becomes negative by rounding.
    return PALEST + (1 - PALEST) * ((order + 1) / count)


def _faded(colour: str, share: float) -> tuple[float, float, float]:
    """Mixture of a colour, with this share, and white; it is opaque, so that crossings do not darken."""
    from matplotlib.colors import to_rgb

    red, green, blue = (1 - share * (1 - component) for component in to_rgb(colour))
    return red, green, blue


def _draw_paths(figure: Any, canvas: Canvas, shapes: MovingShapes) -> None:
    """Draw the paths of tips and bodies, coloured by time, with marked ends."""
    style = {
        "cmap": _time_colours(),
        "linewidths": 2.2,
        "zorder": 4,
        "clim": (shapes.times[0], shapes.times[-1]),
    }
    drawn = None
    for path in shapes.followed.values():
        if len(path) > 1:
            drawn = canvas.shaded_line(path, shapes.times, **style)
        start_style = {"marker": "o", "markersize": 7, "markerfacecolor": "white", "markeredgecolor": "0.1"}
        canvas.markers(path[:1], zorder=5, label="start of a path", **start_style)
        canvas.markers(path[-1:], zorder=5, label="its end", marker="D", markersize=6, color="0.1")
    if drawn is not None:
        figure.colorbar(drawn, ax=canvas.axes, label="time, s", location="left", shrink=0.6, pad=0.04)


def _time_colours() -> Any:
    """The colour map of time."""
    from matplotlib import colormaps
    from matplotlib.colors import ListedColormap

    return ListedColormap(colormaps[TIME_MAP](np.linspace(LIGHTEST, 1.0, 256)))


def _subtitle(motion: Motion) -> str:
    if not motion.converged:
        return motion.message
    parts = [f"{motion.statistics.steps:,} steps"]
    if np.isfinite(motion.error_estimate):
        error = told_error(motion.error_estimate, motion.within_tolerance, motion.tolerance)
        parts.append(f"estimated error of the paths {error}")
    return "; ".join(parts)


def _moving_inputs(motion: Motion) -> dict[str, dict[str, FloatArray]]:
    """Varying inputs by axis label, such as "force, N", and by column, each of shape (T,)."""
    moving: dict[str, dict[str, FloatArray]] = {}
    if len(motion.times) == 0:
        return moving
    layout = motion.model.inputs
    entries = {index: entry for entry, span in layout for index in range(span.start, span.stop)}
    for column, index in column_indices(layout).items():
        values = motion.inputs[:, index]
        if np.ptp(values) > NOTHING * np.abs(values).max():
            # Forces and tensions have separate axes: same unit, but seldom the same magnitude.
            entry = entries[index]
            axis = entry.field if entry.unit == "1" else f"{entry.field}, {entry.unit}"
            moving.setdefault(axis, {})[column] = values
    return moving


def _draw_curves(panel: Any, times: FloatArray, curves: dict[str, FloatArray]) -> None:
    """Draw curves over time with a legend beside the panel."""
    panel.grid(alpha=0.3)
    named = set(curves)
    if len(curves) > MOST_NAMED:
        by_change = sorted(curves, key=lambda name: float(np.ptp(curves[name])), reverse=True)
        named = set(by_change[: LEGEND_ROWS - 1])
        rest = [curves[name] for name in by_change[LEGEND_ROWS - 1 :]]
        panel.plot(times, rest[0], color=REST, linewidth=0.8, label=f"{len(rest)} more")
        for values in rest[1:]:
            panel.plot(times, values, color=REST, linewidth=0.8)
    for index, name in enumerate(name for name in curves if name in named):
        stroke = STROKES[index // len(CATEGORIES) % len(STROKES)]
        colour = CATEGORIES[index % len(CATEGORIES)]
        panel.plot(times, curves[name], color=colour, linestyle=stroke, linewidth=1.6, label=name)
    if not curves:
        _say(panel, "zero")
        return
    columns = -(-len(named) // LEGEND_ROWS)
    # The legend is beside the panel, where it covers no curve.
    panel.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), ncols=columns, fontsize=9, frameon=False)


def _draw_imbalance(panel: Any, motion: Motion) -> None:
    """Draw the magnitude of the imbalance on a logarithmic axis: a line where nonzero, a dot for an isolated value."""
    panel.grid(alpha=0.3)
    panel.set_ylabel("imbalance /\nlargest energy")
    magnitude = np.abs(motion.energy.imbalance)
    positive = magnitude > 0
    if not positive.any():
        _say(panel, "zero")
        return
    alone = positive & ~np.append(False, positive[:-1]) & ~np.append(positive[1:], False)
    panel.semilogy(motion.times, np.where(positive, magnitude, np.nan), ".-", color="0.2", lw=1.4, markevery=alone)
    lowest, highest = panel.get_ylim()
    lowest = ROUNDING if lowest < ROUNDING < highest else lowest
    if highest < 10 * lowest:
        # Ranges within one power of ten would get tick labels such as 1.3 × 10⁻¹³.
        lowest, highest = 10.0 ** np.floor(np.log10([lowest, 10 * highest]))
    panel.set_ylim(lowest, highest)


def _say(panel: Any, word: str) -> None:
    panel.text(0.5, 0.5, word, ha="center", va="center", color="0.5", transform=panel.transAxes)
    panel.set_yticks([])
