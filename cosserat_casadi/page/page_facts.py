"""Facts of a scene for a page, besides its equations, as plain data."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.accuracy.ranges import Given
from cosserat_casadi.actuators.routing import offset_at
from cosserat_casadi.equilibrium.contact.body_obstacles import seen_positions
from cosserat_casadi.equilibrium.solution import Solution
from cosserat_casadi.equilibrium.stability import variations
from cosserat_casadi.loads.load import UNITS
from cosserat_casadi.maths.numbers import known
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.registry import EFFECTS
from cosserat_casadi.model.sections import half_widths_along
from cosserat_casadi.model.system_functions import SystemFunctions
from cosserat_casadi.obstacles.registry import SURFACES
from cosserat_casadi.page.drawn_model import SECTIONS, drawn_layout
from cosserat_casadi.page.slider_ranges import Slider, movable, sliders
from cosserat_casadi.plots.arrows import STYLES
from cosserat_casadi.plots.colours import BODIES, OBSTACLES, TARGETS, actuator_colour, rod_colour
from cosserat_casadi.plots.scenery import body_corners, places_in, target_points
from cosserat_casadi.plots.solved_shapes import RodShapes, rod_shapes

DIGITS = 6
"""Significant digits of numbers for drawing."""

IN_PLANE = {1, 3, 5}
"""Indices of planar strains, in the x–z plane: bending_y, shear_x, extension."""

STILL = 8
"""Stride of the kept points of an unloaded rod."""


def page_facts(solution: Solution, model: Model | None = None, asked: Given | None = None) -> dict[str, Any]:
    """Facts of a scene for its page.

    Args:
        solution: the equilibrium at the inputs of the scene.
        model: the model for the inputs of the page; by default that of the solution, which with contacts is a different
            one.
        asked: ranges of the sliders; by default those of the choice of modes.
    """
    model = solution.model if model is None else model
    scene = model.scene
    shapes = rod_shapes(solution)
    points = _extent_points(solution, shapes.points)
    return {
        **facts_of_every_page(model, sliders(model, asked), points),
        "layout": drawn_layout(model),
        "poses": [*({"rod": rod} for rod in model.discrete.rods), *map(_body_choice, scene.bodies)],
        "rods": {rod.name: _rod(scene, rod, i) for i, rod in enumerate(scene.rods)},
        "unloaded": [rounded(line[::STILL]) for line in shapes.unloaded.values()],
        "actuators": {actuator.name: _actuator(actuator, i) for i, actuator in enumerate(scene.actuators)},
        "bodies": {body.name: _body(scene, body) for body in scene.bodies},
        "held": [rounded(np.array(support.position)) for support in scene.supports],
        "derivatives": True,
        "obstacles": [_obstacle(obstacle, solution, shapes) for obstacle in scene.obstacles],
        "planar": all(set(rod.admitted) <= IN_PLANE for rod in scene.rods) and bool(np.ptp(points[:, 1]) == 0.0),
        "stability": _stability(model),
    }


def facts_of_every_page(model: SystemFunctions, of_inputs: Sequence[Slider], points: FloatArray) -> dict[str, Any]:
    """Facts of a page of rods or of concentric tubes.

    Args:
        model: model for the inputs of the page.
        of_inputs: sliders, one for each stacked input.
        points: points within the picture, shape (k, 3), m.
    """
    scene = model.scene
    by_hand = movable(model)
    return {
        "title": scene.title or "Cosserat rods",
        "unknowns": model.size,
        "sliders": [asdict(slider) for slider in of_inputs],
        "hand": [slider.index for slider in of_inputs if slider.input in by_hand],
        "targets": [rounded(np.array(point)) for point in target_points(scene)],
        "colours": _colours(),
        "arrow_lengths": {sort: style.share for sort, style in STYLES.items()},
        "arrow_units": dict(UNITS),
        "least": rounded(points.min(axis=0)),
        "most": rounded(points.max(axis=0)),
    }


def _body_choice(body: scenes.Body) -> dict[str, Any]:
    """A body as an entry of the list of displayed poses, for choice by the user."""
    return {"body": body.name} if body.listed else {"body": body.name, "unlisted": True}


def _extent_points(solution: Solution, points: FloatArray) -> FloatArray:
    """Points within the picture: rods, bodies and targets."""
    scene = solution.model.scene
    parts = [points]
    parts += [solution.body(body.name).position[None] for body in scene.bodies]
    parts += [np.array([point]) for point in target_points(scene)]
    return np.concatenate(parts)


def _rod(scene: scenes.Scene, rod: scenes.Rod, index: int) -> dict[str, Any]:
    """Colour, and half widths of the sections along x and y, m, along a rod."""
    described: dict[str, Any] = {"colour": rod_colour(index), "carried": rod.base.rod is not None}
    described |= _section(rod.section)
    # The middle of each disk, X, with its radius and thickness, m.
    rows = [row for row in scene.disks if row.rod == rod.name]
    described["disks"] = [rounded(np.array([at, row.radius, row.thickness])) for row in rows for at in row.places]
    inside = [
        actuator for actuator in scene.actuators if actuator.rod == rod.name and _runs_inside(actuator, described)
    ]
    # Rods with actuators inside are drawn transparent.
    return described | {"see_through": bool(inside)}


def _section(section: scenes.Section | None) -> dict[str, Any]:
    """Shape and half widths of the drawn sections; empty for a rod drawn as its centre line."""
    half_widths = half_widths_along(section, SECTIONS)
    if section is None or half_widths is None:
        return {}
    x, y = (rounded(half_width) for half_width in half_widths)
    return {"shape": "rectangle" if section.radius_key is None else "circle", "x": x, "y": y}


def _runs_inside(actuator: Any, rod: dict[str, Any]) -> bool:
    """Whether the routing of an actuator lies within the drawn sections."""
    if not hasattr(actuator, "offset") or "shape" not in rod:
        return False
    offset, _ = offset_at(actuator, SECTIONS)
    return bool(np.all(np.abs(known(offset)) < np.array([rod["x"], rod["y"]])))


def _actuator(actuator: Any, index: int) -> dict[str, Any]:
    member = EFFECTS[actuator.kind]
    return {"colour": actuator_colour(index), "drawn_as": member.drawn_as}


def _body(scene: scenes.Scene, body: Any) -> dict[str, Any]:
    """Corners of the polygon of a body, and its joints, in body axes, m."""
    return {"corners": rounded(body_corners(scene, body)), "joints": rounded(places_in(scene, body.name))}


def _obstacle(obstacle: scenes.ObstacleRecord, solution: Solution, shapes: RodShapes) -> dict[str, Any]:
    """A net of points on the surface of an obstacle, rows of points, m; an unbounded surface only near the rods.

    The net of an obstacle on a body is in the axes of the body.
    """
    (near,) = seen_positions(solution, obstacle, shapes.points.mean(axis=0)[None])
    mesh = SURFACES[obstacle.kind].mesh(obstacle, near, shapes.size)
    return {"name": obstacle.name, "body": obstacle.body, "net": rounded(mesh)}


def _colours() -> dict[str, str]:
    """Colours of bodies, targets and obstacles, and of the arrows of each sort."""
    of_arrows = {sort: style.colour for sort, style in STYLES.items()}
    return {"body": BODIES, "target": TARGETS, "obstacle": OBSTACLES, **of_arrows}


def _stability(model: Model) -> dict[str, Any] | None:
    """Variations of the second variation; None if it is undefined for some inputs of the sliders."""
    # Inputs are set to one, so that none is ignored as zero.
    if not model.has_potential(np.ones(model.inputs.size)):
        return None
    allowed = variations(model)
    return {"free": allowed.free.tolist(), "held": allowed.held.tolist(), "units": allowed.units.tolist()}


def rounded(values: FloatArray) -> Any:
    """Numbers with DIGITS significant digits, as nested lists."""
    return np.vectorize(lambda value: float(f"{value:.{DIGITS}g}"), otypes=[float])(values).tolist()
