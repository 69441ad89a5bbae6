"""Facts of a scene that a page needs besides its equations, as plain data."""

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
"""Significant digits of numbers that are only drawn."""

IN_PLANE = {1, 3, 5}
"""Strains that keep a rod in the plane of its x and z: bending_y, shear_x, extension."""

STILL = 8
"""Every so many of the sampled points of an unloaded rod are kept."""


def page_facts(solution: Solution, model: Model | None = None, asked: Given | None = None) -> dict[str, Any]:
    """Facts of a scene for its page.

    Args:
        solution: the equilibrium at the scene's own inputs.
        model: the model whose inputs are moved; by default the solution's, which is another model where contacts were
            found for it.
        asked: ranges of the sliders; by default the ranges that modes are chosen for.
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
        model: whose inputs are moved.
        of_inputs: a slider for each number of the inputs.
        points: points that the picture must hold, shape (k, 3), m.
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
    """A body as one of the things whose pose is shown, which a user may choose where results list it."""
    return {"body": body.name} if body.listed else {"body": body.name, "unlisted": True}


def _extent_points(solution: Solution, points: FloatArray) -> FloatArray:
    """Points that a picture must hold: rods, bodies and targets."""
    scene = solution.model.scene
    parts = [points]
    parts += [solution.body(body.name).position[None] for body in scene.bodies]
    parts += [np.array([point]) for point in target_points(scene)]
    return np.concatenate(parts)


def _rod(scene: scenes.Scene, rod: scenes.Rod, index: int) -> dict[str, Any]:
    """Colour, and the size of the sections along the rod: half widths along the section's x and y, m."""
    described: dict[str, Any] = {"colour": rod_colour(index), "carried": rod.base.rod is not None}
    described |= _section(rod.section)
    # The middle of each disk, X, with its radius and thickness, m.
    rows = [row for row in scene.disks if row.rod == rod.name]
    described["disks"] = [rounded(np.array([at, row.radius, row.thickness])) for row in rows for at in row.places]
    inside = [
        actuator for actuator in scene.actuators if actuator.rod == rod.name and _runs_inside(actuator, described)
    ]
    # What runs inside is seen through the rod.
    return described | {"see_through": bool(inside)}


def _section(section: scenes.Section | None) -> dict[str, Any]:
    """Shape and half widths of the sections that are drawn; nothing of a rod that is drawn by its centre line."""
    half_widths = half_widths_along(section, SECTIONS)
    if section is None or half_widths is None:
        return {}
    x, y = (rounded(half_width) for half_width in half_widths)
    return {"shape": "rectangle" if section.radius_key is None else "circle", "x": x, "y": y}


def _runs_inside(actuator: Any, rod: dict[str, Any]) -> bool:
    """Whether the routing of an actuator lies within the sections that are drawn."""
    if not hasattr(actuator, "offset") or "shape" not in rod:
        return False
    offset, _ = offset_at(actuator, SECTIONS)
    return bool(np.all(np.abs(known(offset)) < np.array([rod["x"], rod["y"]])))


def _actuator(actuator: Any, index: int) -> dict[str, Any]:
    member = EFFECTS[actuator.kind]
    return {"colour": actuator_colour(index), "drawn_as": member.drawn_as}


def _body(scene: scenes.Scene, body: Any) -> dict[str, Any]:
    """Corners of the polygon that stands for a body, and its joints, in its own axes, m."""
    return {"corners": rounded(body_corners(scene, body)), "joints": rounded(places_in(scene, body.name))}


def _obstacle(obstacle: scenes.ObstacleRecord, solution: Solution, shapes: RodShapes) -> dict[str, Any]:
    """A net of points on the surface of an obstacle, rows of points, m; an endless surface is shown about the rods.

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
    """Variations of the second variation; None where it has no meaning for all inputs that sliders can give."""
    # Ones: no input is left out for being zero at the moment.
    if not model.has_potential(np.ones(model.inputs.size)):
        return None
    allowed = variations(model)
    return {"free": allowed.free.tolist(), "held": allowed.held.tolist(), "units": allowed.units.tolist()}


def rounded(values: FloatArray) -> Any:
    """Numbers with few digits, as nested lists."""
    return np.vectorize(lambda value: float(f"{value:.{DIGITS}g}"), otypes=[float])(values).tolist()
