"""Arrows of the loads of a scene.

A kind of load is drawn by its entry in ``LOAD_ARROWS``. A load of a kind that is not there is named in the legend and
not drawn.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from cosserat_casadi.equilibrium.solution import Pose, Solution
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.inputs import load_values
from cosserat_casadi.plots.shapes import in_world

ALONG_ROD = np.linspace(0.05, 0.95, 8)
"""Abscissae at which a load per length is drawn."""


@dataclass(frozen=True)
class Arrow:
    """A force or moment as it is drawn.

    Attributes:
        start: the point it acts on, world axes, shape (3,), m.
        vector: world axes, shape (3,), N, N m or N/m.
        sort: "point" for a force, "moment", or "line" for a force per length.
        label: for the legend; empty for all arrows of a load but the first.
    """

    start: FloatArray
    vector: FloatArray
    sort: str
    label: str


Values = Mapping[str, FloatArray]
"""Magnitudes of a load by field, shape (3, k) with k Legendre coefficients."""


def scene_arrows(solution: Solution) -> list[Arrow]:
    """Arrows of all loads of a solution."""
    model = solution.model
    values = load_values(model.scene, model.inputs, solution.inputs)
    arrows = []
    for load in model.scene.loads:
        arrows += load_arrows(solution, load, values[load.name])
    return arrows


def undrawn_loads(solution: Solution) -> list[str]:
    """Words for the legend on loads that have no arrows because their kind is not known here."""
    loads = solution.model.scene.loads
    return [f"{load.name}: {load.kind}, not drawn" for load in loads if load.kind not in LOAD_ARROWS]


def load_arrows(solution: Solution, load: Any, values: Values) -> list[Arrow]:
    """Arrows of one load; none for a kind that this module does not know.

    Args:
        solution: where rods and bodies are.
        load: its record in the scene.
        values: its magnitudes.
    """
    draw = LOAD_ARROWS.get(load.kind)
    if draw is None:
        return []
    return draw(solution, load, values)


def _rod_wrench(solution: Solution, load: Any, values: Values) -> list[Arrow]:
    """Force and moment on a section, of the tip where no abscissa is given."""
    abscissa = getattr(load, "at", 1.0)
    pose = solution.pose(np.array([abscissa]), load.rod)
    return _wrench(load, values, pose, pose.position[0])


def _body_wrench(solution: Solution, load: Any, values: Values) -> list[Arrow]:
    pose = solution.body(load.body)
    start = in_world(pose, np.array([load.position]))[0]
    return _wrench(load, values, pose, start)


def _wrench(load: Any, values: Values, pose: Pose, start: FloatArray) -> list[Arrow]:
    """Force and moment at a point of what has the pose."""
    # A dead load is given in world axes, a follower in those of what it acts on.
    world_R_load = np.eye(3)
    if load.frame == "body":
        world_R_load = pose.rotation[0]
    arrows = []
    for field, unit, sort in (("force", "N", "point"), ("moment", "N m", "moment")):
        vector = world_R_load @ values[field][:, 0]
        if np.any(vector):
            arrows.append(Arrow(start, vector, sort, _magnitude_label(load.name, vector, unit)))
    return arrows


def _gravity(solution: Solution, load: Any, values: Values) -> list[Arrow]:
    acceleration = values["acceleration"][:, 0]
    return [
        *_rod_weights(solution, load, acceleration),
        *_body_weights(solution, load, acceleration),
    ]


def _rod_weights(solution: Solution, load: Any, acceleration: FloatArray) -> list[Arrow]:
    arrows: list[Arrow] = []
    for name, discrete_rod in solution.model.discrete.rods.items():
        linear_density = discrete_rod.properties.linear_density
        if linear_density is None or not load.acts_on_rod(name):
            continue
        weights = linear_density(ALONG_ROD)[:, None] * acceleration
        rod_arrows = _line_arrows(load.name, solution.pose(ALONG_ROD, name).position, weights)
        if arrows:
            # The legend names a load once, whatever the number of rods.
            rod_arrows = [replace(arrow, label="") for arrow in rod_arrows]
        arrows += rod_arrows
    return arrows


def _body_weights(solution: Solution, load: Any, acceleration: FloatArray) -> list[Arrow]:
    arrows = []
    for body in solution.model.scene.bodies:
        if not body.mass or not load.acts_on_body(body.name):
            continue
        start = in_world(solution.body(body.name), np.array([body.centre_of_mass]))[0]
        weight = body.mass * acceleration
        if np.any(weight):
            label = _magnitude_label(f"{load.name} of {body.name}", weight, "N")
            arrows.append(Arrow(start, weight, "point", label))
    return arrows


def _distributed_wrench(solution: Solution, load: Any, values: Values) -> list[Arrow]:
    """Force per length of a load given by Legendre coefficients in 2X - 1; moments per length are not drawn."""
    pose = solution.pose(ALONG_ROD, load.rod)
    argument = 2 * ALONG_ROD - 1
    series = np.polynomial.legendre.legval(argument, values["force"].T)
    vectors = np.asarray(series.T, dtype=float)
    if load.frame == "body":
        vectors = np.einsum("kij,kj->ki", pose.rotation, vectors)
    return _line_arrows(load.name, pose.position, vectors)


def _line_arrows(name: str, positions: FloatArray, vectors: FloatArray) -> list[Arrow]:
    """Arrows of a load per length; the first section carries the label.

    Args:
        name: of the load.
        positions: of the sections, shape (k, 3), m.
        vectors: shape (k, 3), N/m.
    """
    label = f"{name}: up to {np.linalg.norm(vectors, axis=1).max():.3g} N/m"
    arrows = []
    for position, vector in zip(positions, vectors, strict=True):
        if np.any(vector):
            arrows.append(Arrow(position, vector, "line", label))
        label = ""
    return arrows


def _magnitude_label(name: str, vector: FloatArray, unit: str) -> str:
    magnitude = np.linalg.norm(vector)
    return f"{name}: {magnitude:.3g} {unit}"


LOAD_ARROWS: dict[str, Callable[[Solution, Any, Values], list[Arrow]]] = {
    "gravity": _gravity,
    "tip_wrench": _rod_wrench,
    "point_wrench": _rod_wrench,
    "distributed_wrench": _distributed_wrench,
    "body_wrench": _body_wrench,
}
"""How each kind of load is drawn."""
