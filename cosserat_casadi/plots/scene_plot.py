"""The figure of a solved scene: the deformed rods with their loads, strain and internal wrench along X.

matplotlib is an extra and is imported inside functions only.
"""

from __future__ import annotations

from collections.abc import Sequence
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
from cosserat_casadi.plots.figure import add_subtitle, add_title, figure_class
from cosserat_casadi.plots.obstacle_drawing import draw_obstacles
from cosserat_casadi.plots.panels import QUANTITIES, draw_panel
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
from cosserat_casadi.plots.solved_shapes import RodShapes, in_world, rod_shapes
from cosserat_casadi.results.facts import told_error
from cosserat_casadi.results.presentation import figure_of


def plot_solution(solution: Solution) -> Any:
    """Figure of a solution.

    Left the rods in space, or in the plane that holds all of the scene: deformed thick, unloaded
    dashed, section axes (x red, y green, z blue), tendons and chambers, bodies filled, joints, obstacles, loads and
    forces of contact as arrows.
    Right, along X: the strains that are admitted, the internal moment and the internal force in section axes.
    """
    figure = figure_class()(figsize=(13.0, 6.6), layout="constrained")
    grid = figure.add_gridspec(3, 2, width_ratios=(1.5, 1.0))
    shapes = rod_shapes(solution)
    arrows = scene_arrows(solution)
    canvas = add_canvas(figure, (grid[:, 0],), scene_view(shapes, arrows), shapes.size)
    _draw_scene(canvas, solution, shapes, arrows)
    # Below the axes, where it covers no rod.
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
    """Figure of an inverse problem: the equilibrium at its inputs, with the targets."""
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
