"""The figure of materials: stress resultant at the base of each rod over each strain with a nonlinear law.

matplotlib is an extra and is imported inside functions only.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from cosserat_casadi import scene as scenes
from cosserat_casadi.errors import Problem, SceneError
from cosserat_casadi.maths.numbers import known
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.scene_rods import rod_properties
from cosserat_casadi.plots.colours import CATEGORIES, PLAIN_TEXT
from cosserat_casadi.plots.figure import add_title, panel_grid
from cosserat_casadi.rod.material_functions import section_margins, stress_beyond_hooke
from cosserat_casadi.rod.properties import RodProperties

COLUMNS = 3
"""Panels in a row."""

POINTS = 241
"""Points of a curve."""

FIBRE_STRAIN = 0.15
"""Largest drawn strain of the outermost fibre, and of extension, within the range of the law."""

HARDLY_BENT = 0.1
"""Deviation from the linear law, over the largest stress, below which the drawn range is doubled."""

PAST_THE_END = 1.3
"""Drawn range of a curve over the range of its law."""

SMALL = 1e-6
"""Step of the difference quotient at zero strain, over the largest drawn strain."""

AXES = (
    *(("bending_x", "curvature $K_x$, 1/m", "moment, N m"), ("bending_y", "curvature $K_y$, 1/m", "moment, N m")),
    *(("torsion", "twist $K_z$, 1/m", "moment, N m"), ("shear_x", "shear $\\Gamma_x$", "force, N")),
    *(("shear_y", "shear $\\Gamma_y$", "force, N"), ("extension", "stretch $\\Gamma_z - 1$", "force, N")),
)
"""Names of the strains with the labels of their panels."""


class StressCurve(NamedTuple):
    """Stress over the change of one strain, with all other strains fixed.

    Attributes:
        component: index of the strain.
        change: change of the strain, shape (k,).
        stress: stress resultant, shape (k,), N m or N.
        linear: stress resultant of the linearised law, shape (k,), N m or N.
        inside: whether the strain is in the range of the law, shape (k,).
    """

    component: int
    change: FloatArray
    stress: FloatArray
    linear: FloatArray
    inside: npt.NDArray[np.bool_]


def plot_materials(scene: scenes.Scene) -> Any:
    """Figure of the materials of a scene: a panel for each strain of each rod with a nonlinear law.

    Raises:
        SceneError: all rods are linear.
    """
    curves = [(rod.name, curve) for rod in scene.baked().rods for curve in stress_curves(rod_properties(rod))]
    if not curves:
        raise SceneError(
            Problem("--plot", "draws materials that are not linear, and the scene has none", "leave it out")
        )
    # Four panels are arranged two by two.
    figure, panels = panel_grid(len(curves), 2 if len(curves) == 4 else COLUMNS, (3.6, 3.0), (1.0, 0.8))
    labels: dict[str, Any] = {}
    for panel, (rod, curve) in zip(panels, curves, strict=True):
        _draw(panel, rod, curve)
        lines, words = panel.get_legend_handles_labels()
        labels |= dict(zip(words, lines, strict=True))
    panels[0].legend(labels.values(), labels, fontsize=8, frameon=False, loc="upper left")
    add_title(figure, scene.title)
    return figure


def stress_curves(rod: RodProperties) -> list[StressCurve]:
    """Curves of the section at the base of a rod for each admitted strain with a nonlinear law."""
    law = rod.beyond_hooke
    if law is None:
        return []
    base = np.zeros(1)
    data = known(law.data(base)).T
    hooke = known(rod.hooke(base))[0]
    beyond_hooke = stress_beyond_hooke(law, len(data))
    margins = section_margins(law, rod.admitted, len(data))
    shares = np.linspace(-1, 1, POINTS)
    stiffness = hooke[list(rod.admitted), None]
    curves = []
    for component in rod.admitted:
        direction = np.eye(6)[:, [component]]
        largest = _largest_change(rod, component)
        small = SMALL * largest
        slope = hooke[component] + float(beyond_hooke(small * direction, data)[component]) / small
        end = np.array([largest, -largest])
        away = beyond_hooke(direction * end, data).full()[component] + (hooke[component] - slope) * end
        if np.abs(away).max() < HARDLY_BENT * slope * largest:
            largest *= 2.0
        inside = margins(largest * direction * shares, data, stiffness).full()[0] > 0.0
        if not np.all(inside):
            largest *= min(1.0, PAST_THE_END * float(np.abs(shares[inside]).max()))
            inside = margins(largest * direction * shares, data, stiffness).full()[0] > 0.0
        change = largest * shares
        beyond = beyond_hooke(direction * change, data).full()[component]
        stress = hooke[component] * change + beyond
        if np.allclose(beyond, 0.0, rtol=0, atol=1e-9 * np.abs(stress).max()):
            continue
        curves.append(StressCurve(component, change, stress, slope * change, inside))
    return curves


def _largest_change(rod: RodProperties, component: int) -> float:
    """Largest drawn change of a strain."""
    if component >= 3:
        return FIBRE_STRAIN
    # The radius of gyration of the section, by its stiffnesses: EI = EA r²/4 of a circle.
    hooke = known(rod.hooke(np.zeros(1)))[0]
    if np.isfinite(hooke[5]):
        return float(FIBRE_STRAIN / (2 * np.sqrt(hooke[component] / hooke[5])))
    return float(2 * np.pi / rod.length)


def _draw(panel: Any, rod: str, curve: StressCurve) -> None:
    """Draw one panel: the law within its range, and the linearised law."""
    name, abscissa, ordinate = AXES[curve.component]
    panel.plot(curve.change, curve.linear, color=PLAIN_TEXT, linewidth=1.0, linestyle="--", label="small strains")
    law = np.where(curve.inside, curve.stress, np.nan)
    panel.plot(curve.change, law, color=CATEGORIES[0], linewidth=2.0, label="material")
    if not np.all(curve.inside):
        beyond = np.where(curve.inside, np.nan, curve.stress)
        panel.plot(curve.change, beyond, color=CATEGORIES[4], linewidth=1.5, linestyle=":", label="beyond its law")
    largest = 1.1 * np.abs(curve.stress).max()
    panel.set_ylim(-largest, largest)
    panel.set_xlabel(abscissa)
    panel.set_ylabel(ordinate)
    panel.locator_params(axis="x", nbins=6)
    panel.set_title(f"{rod}: {name.replace('_', ' ')}", fontsize=10)
    panel.grid(alpha=0.3)
