"""Arrows of the loads of a scene.

A kind of load is drawn by its entry in ``LOAD_ARROWS``. A load of a kind that is not there is named in the legend and
not drawn.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from cosserat_casadi.equilibrium.solution import Pose, Solution
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.inputs import load_values
from cosserat_casadi.plots.canvas import FLAT, Canvas
from cosserat_casadi.plots.colours import FORCES, LINE_FORCES, MOMENTS
from cosserat_casadi.plots.shapes import in_world

ALONG_ROD = np.linspace(0.05, 0.95, 8)
"""Abscissae at which a load per length is drawn."""


@dataclass(frozen=True)
class Arrow:
    """A force or moment as it is drawn.

    Attributes:
        start: the point it acts on, world axes, shape (3,), m.
        vector: world axes, shape (3,), N, N m or N/m.
        label: for the legend; None for all arrows of a load but the first.
        style: a key of STYLES.
    """

    start: FloatArray
    vector: FloatArray
    label: str | None
    style: str

    def lies_in_plane(self, normal: int) -> bool:
        """Whether the plane across a world axis shows it: a force lies in the plane, a moment stands across it."""
        outside = self.vector[[normal]]
        if self.style == "moment":
            outside = np.delete(self.vector, normal)
        largest_outside = np.abs(outside).max()
        largest = np.abs(self.vector).max()
        return bool(largest_outside <= FLAT * largest)


@dataclass(frozen=True)
class ArrowStyle:
    """How arrows of one style are drawn.

    Attributes:
        share: length of the largest one, relative to the scene.
        colour: of all.
        width: of the shaft, points.
    """

    share: float
    colour: str
    width: float


STYLES = {
    "point": ArrowStyle(0.22, FORCES, 2.2),
    "moment": ArrowStyle(0.18, MOMENTS, 2.2),
    "line": ArrowStyle(0.09, LINE_FORCES, 1.0),
}
"""Forces at a point, moments, forces per length. Arrows are scaled within their own style."""

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


def draw_loads(canvas: Canvas, solution: Solution, arrows: Sequence[Arrow]) -> None:
    """Draw the arrows of all loads, and name loads that have none."""
    for name, style in STYLES.items():
        _draw_style(canvas, [arrow for arrow in arrows if arrow.style == name], style)
    if canvas.plane is not None:
        for arrow in arrows:
            if arrow.style == "moment":
                canvas.turning_sign(arrow.start, arrow.vector, MOMENTS)
    for load in solution.model.scene.loads:
        if load.kind not in LOAD_ARROWS:
            canvas.legend_entry(f"{load.name}: {load.kind}, not drawn", linestyle="none")


def _draw_style(canvas: Canvas, arrows: Sequence[Arrow], style: ArrowStyle) -> None:
    magnitudes = [float(np.linalg.norm(arrow.vector)) for arrow in arrows]
    largest = max(magnitudes, default=0.0)
    # The largest arrow of a style has the length that the style gives it, whatever its unit.
    for arrow in arrows:
        if arrow.style == "moment" and canvas.plane is not None:
            # Drawn as a turning sign; the legend still gives its value.
            canvas.legend_entry(arrow.label, color=style.colour, linewidth=style.width)
            continue
        scaled = arrow.vector * style.share * canvas.size / largest
        canvas.arrow(arrow.start, scaled, colour=style.colour, width=style.width, label=arrow.label)


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
    for field, unit, style in (("force", "N", "point"), ("moment", "N m", "moment")):
        vector = world_R_load @ values[field][:, 0]
        if np.any(vector):
            arrows.append(Arrow(start, vector, _magnitude_label(load.name, vector, unit), style))
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
            rod_arrows = [Arrow(arrow.start, arrow.vector, None, arrow.style) for arrow in rod_arrows]
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
            arrows.append(Arrow(start, weight, label, "point"))
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
    label: str | None = f"{name}: up to {np.linalg.norm(vectors, axis=1).max():.3g} N/m"
    arrows = []
    for position, vector in zip(positions, vectors, strict=True):
        if np.any(vector):
            arrows.append(Arrow(position, vector, label, "line"))
        label = None
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
