"""The figure of a solved scene: deformed rods with loads, and strain and internal wrench along X.

Strain, internal moment and internal force are in section axes. matplotlib is an extra and is imported inside functions
only.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from cosserat_casadi.control.inverse_result import Inverse
from cosserat_casadi.equilibrium.solution import Solution
from cosserat_casadi.loads.load import Arrow, Poses
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.arrow_records import LoadArrows
from cosserat_casadi.plots.arrows import draw_arrows
from cosserat_casadi.plots.canvas import Canvas, add_canvas
from cosserat_casadi.plots.colours import AXES, rod_style
from cosserat_casadi.plots.figure import add_subtitle, add_title, figure_class
from cosserat_casadi.plots.obstacle_drawing import draw_obstacles
from cosserat_casadi.plots.scene_view import scene_view
from cosserat_casadi.plots.scenery import (
    body_outline,
    draw_actuators,
    draw_bodies,
    draw_disks,
    draw_rods,
    draw_supports,
    draw_targets,
)
from cosserat_casadi.plots.solved_shapes import SAMPLES, RodShapes, in_world, rod_shapes
from cosserat_casadi.results.facts import told_error
from cosserat_casadi.results.presentation import figure_of

STROKES = ("-", "--", "-.")
"""Line styles of the components x, y, z if colours denote rods."""

ZERO = 1e-9
"""Threshold of drawn components, over the largest component."""

ROUNDING = 1e-12
"""Threshold of rounding of components, over the scale of the rod, if all components are below it."""

LEVEL = 1e-3
"""Threshold of rounding of the variation of a curve, over its value."""


@dataclass(frozen=True)
class PanelQuantity:
    """Quantity of a panel.

    Attributes:
        name: strain, moment or force.
        labels: labels of its components; components after the third are linear strains.
        axis_label: label of the axis, with the unit.
    """

    name: str
    labels: tuple[str, ...]
    axis_label: str


QUANTITIES = (
    PanelQuantity("strain", ("K_x", "K_y", "K_z", "Γ_x", "Γ_y", "Γ_z − 1"), "curvature, 1/m"),
    PanelQuantity("moment", ("M_x", "M_y", "M_z"), "moment, N m"),
    PanelQuantity("force", ("N_x", "N_y", "N_z"), "force, N"),
)


def draw_panel(panel: Any, solution: Solution, quantity: PanelQuantity) -> None:
    """Draw the nonzero components of a quantity of all rods."""
    rods = solution.model.discrete.rods
    values = {name: _values(solution, name, quantity.name) for name in rods}
    scales = {name: _scale(solution, name, quantity.name) for name in rods}
    panel.set_ylabel(quantity.axis_label)
    shown = [panel]
    linear_axes = panel
    if quantity.name == "strain" and any(np.any(of_rod[:, 3:]) for of_rod in values.values()):
        # Shear and extension, dimensionless and small beside curvatures, have a separate axis on the right.
        linear_axes = panel.twinx()
        shown.append(linear_axes)

    labelled: set[str] = set()
    for index, (name, discrete_rod) in enumerate(rods.items()):
        for component, label in enumerate(quantity.labels):
            curve = values[name][:, component]
            # A component of pure rounding would take a colour and a legend entry.
            rounding = max(ZERO * np.abs(values[name]).max(), ROUNDING * scales[name])
            if np.abs(curve).max() <= rounding:
                continue
            axes = linear_axes if component >= 3 else panel
            style = _curve_style(len(rods), index, component)
            axes.plot(SAMPLES, curve, label=label if len(rods) == 1 else None, **style)
            if len(rods) > 1 and label not in labelled:
                # Line styles denote components, with one grey legend entry each; the legend of the picture names the
                # rods.
                axes.plot([], [], color="0.3", linestyle=style["linestyle"], label=label)
            labelled.add(label)
        # Fields may jump between elements.
        for element_end in discrete_rod.grid.known_places[1:-1]:
            panel.axvline(element_end, color="0.6", linewidth=0.8)

    panel.set_xlim(-0.01, 1.01)
    panel.grid(alpha=0.3)
    _finish_panel(shown)


def _curve_style(rod_count: int, rod_index: int, component: int) -> dict[str, Any]:
    """Style of a curve: colours denote components for one rod, else rods; then line styles denote components."""
    style: dict[str, Any] = {"color": AXES[component % 3], "linestyle": "-"}
    if rod_count > 1:
        style |= {**rod_style(rod_index), "markersize": 4, "linestyle": STROKES[component % 3]}
    if component >= 3:
        style["linestyle"] = ":"
    return style


def _finish_panel(shown: list[Any]) -> None:
    """Set the legend and limits of the axes of one panel; the axis on the right is last."""
    handles = [handle for axes in shown for handle in axes.get_legend_handles_labels()[0]]
    if not handles:
        panel = shown[0]
        panel.text(0.5, 0.5, "zero", ha="center", va="center", color="0.5", transform=panel.transAxes)
        panel.set_yticks([])
        return
    # The legend is above the panel, where it covers no curve.
    # The corner holds the power of ten of an axis.
    place = {"loc": "lower left", "bbox_to_anchor": (0.1, 1.0), "borderaxespad": 0.1}
    shown[-1].legend(handles=handles, fontsize=9, ncols=3, frameon=False, **place)
    for axes in shown:
        _hide_rounding(axes)
    if len(shown) > 1:
        shown[1].set_ylabel("shear, stretch (dotted)")


def _hide_rounding(axes: Any) -> None:
    """Widen the limits around a constant curve, so that rounding errors do not show."""
    low, high = axes.get_ylim()
    largest = max(abs(low), abs(high))
    if high - low >= LEVEL * largest:
        return
    middle = (low + high) / 2
    margin = 0.1 * largest
    axes.set_ylim(middle - margin, middle + margin)


def _scale(solution: Solution, name: str, quantity: str) -> float:
    """Scale of a quantity of a rod: 1/length, 1/m; or force times length, N m; or moment over length, N."""
    length = solution.model.length(name, solution.inputs)
    if quantity == "strain":
        return float(1 / length)
    wrench = solution.internal_wrench(SAMPLES, name)
    moment = max(np.abs(wrench[:, :3]).max(), length * np.abs(wrench[:, 3:]).max())
    return float(moment if quantity == "moment" else moment / length)


def _values(solution: Solution, name: str, quantity: str) -> FloatArray:
    """Components at SAMPLES, shape (len(SAMPLES), 6) for strains, else (len(SAMPLES), 3)."""
    if quantity == "strain":
        strain = solution.strain(SAMPLES, name)
        # Extension is stretch minus 1.
        strain[:, 5] -= 1.0
        return strain
    wrench = solution.internal_wrench(SAMPLES, name)
    # Angular part first: [M; N].
    return {"moment": wrench[:, :3], "force": wrench[:, 3:]}[quantity]


def plot_solution(solution: Solution) -> Any:
    """Figure of a solution.

    Left: the rods in space, or in the plane of a planar scene: deformed thick, unloaded dashed; section axes (x red, y
    green, z blue), tendons and chambers, filled bodies, joints, obstacles; arrows of loads and contact forces. Right,
    along X: the admitted strains, the internal moment and the internal force in section axes.
    """
    figure = figure_class()(figsize=(13.0, 6.6), layout="constrained")
    grid = figure.add_gridspec(3, 2, width_ratios=(1.5, 1.0))
    shapes = rod_shapes(solution)
    arrows = scene_arrows(solution)
    canvas = add_canvas(figure, (grid[:, 0],), scene_view(shapes, arrows), shapes.size)
    _draw_scene(canvas, solution, shapes, arrows)
    # The legend is below the axes, where it covers no rod.
    figure.legend(*canvas.axes.get_legend_handles_labels(), loc="outside lower left", ncols=5, fontsize=9)

    panels = [figure.add_subplot(grid[row, 1]) for row in range(len(QUANTITIES))]
    for panel, quantity in zip(panels, QUANTITIES, strict=True):
        draw_panel(panel, solution, quantity)
    panels[-1].set_xlabel("X = s/ℓ, base to tip")
    add_title(figure, solution.model.scene.title)
    add_subtitle(canvas.axes, _subtitle(solution), good=solution.converged and solution.within_tolerance is not False)
    return figure


def scene_arrows(solution: Solution) -> list[Arrow]:
    """Arrows of all loads of a solution, in world axes."""

    def rod_poses(name: str, X: FloatArray) -> Poses:
        pose = solution.pose(X, name)
        # Kernels take columns, (3, k); results hold a row for each section.
        return pose.position.T, pose.rotation

    def body_pose(name: str) -> Poses:
        pose = solution.body(name)
        return pose.position[:, None], pose.rotation[None]

    arrows = LoadArrows(solution.model.discrete, ca.DM(solution.inputs), rod_poses, body_pose)
    return arrows.all()


def plot_inverse(inverse: Inverse) -> Any:
    """Figure of an inverse problem: the equilibrium at the inputs found, with the targets."""
    return figure_of(inverse.solution)


def _draw_scene(canvas: Canvas, solution: Solution, shapes: RodShapes, arrows: Sequence[Arrow]) -> None:
    scene = solution.model.scene
    draw_obstacles(canvas, solution, shapes)
    draw_rods(canvas, solution, shapes)
    draw_supports(canvas, scene)
    draw_actuators(canvas, solution)
    draw_bodies(canvas, solution)
    draw_disks(canvas, solution)
    draw_arrows(canvas, arrows)
    draw_targets(canvas, scene)
    canvas.label_axes()
    bodies = [in_world(solution.body(body.name), body_outline(scene, body)) for body in scene.listed_bodies]
    canvas.equalise(np.concatenate([shapes.points, *bodies]))


def _subtitle(solution: Solution) -> str:
    if not solution.converged:
        return solution.message
    parts = [f"residual {solution.residual_norm:.0e}"]
    if solution.judged_error is not None:
        tolerance = solution.model.scene.accuracy.tolerance
        parts.append(f"estimated error {told_error(solution.judged_error, solution.within_tolerance, tolerance)}")
    if solution.stable is not None:
        parts.append({True: "stable", False: "unstable"}[solution.stable])
    return "; ".join(parts)
