"""Force between two rods that touch at one section of each: energy −N d, with the distance d of the two centres.

The force N acts on each rod along the line of the centres, away from the other rod. Both forces, and their moments,
add up to zero. N is no input of the scene: it follows from the contact (equilibrium/contact).
No scene file names this load.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar, Literal, final

import casadi as ca

from cosserat_casadi.loads.load import Load
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.scene.input_fields import InputField
from cosserat_casadi.scene.load_records import LoadRecord


class RodsPoint(LoadRecord):
    """Two rods that touch: their names, and the abscissa of the touching section of each."""

    inputs: ClassVar[Mapping[str, InputField]] = {"force": InputField("N", 1, lower=0.0, nonlinear=True)}

    kind: Literal["rods_point"] = "rods_point"
    rods: tuple[str, str]
    places: tuple[Any, Any]
    force: float


@final
class RodsPointLoad(Load[RodsPoint]):
    """Mechanics of the force N between two rods; model/touching_rods.py adds it to the equations of both."""

    record = RodsPoint


def across(apart: Matrix) -> tuple[Matrix, Matrix]:
    """Gradient n = a/d and Hessian (1 − n nᵀ)/d of the distance d = |a| of two points, for a of 3×1; 3×1 and 3×3."""
    distance = ca.norm_2(apart)
    normal = apart / distance
    return normal, (ca.DM.eye(3) - normal @ normal.T) / distance
