"""The force between two rods that touch at one section of either: energy −N d with d the distance of their centres.

So the force N is along the line of the centres, on the first rod away from the second and on the second the opposite:
neither a sum nor, without friction, a moment of them remains. N is no input of the scene but follows from the contact,
see equilibrium/contact; no scene file names this load.
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
    """Two rods that touch: their names, and the abscissa of the section of either."""

    inputs: ClassVar[Mapping[str, InputField]] = {"force": InputField("N", 1, lower=0.0, nonlinear=True)}

    kind: Literal["rods_point"] = "rods_point"
    rods: tuple[str, str]
    places: tuple[Any, Any]
    force: float


@final
class RodsPointLoad(Load[RodsPoint]):
    """N along the line of the centres: it acts on no rod alone, but between two, see model/touching_rods.py."""

    record = RodsPoint


def across(apart: Matrix) -> tuple[Matrix, Matrix]:
    """Normal n = a/d and curvature (1 − n nᵀ)/d of the distance d of two points that are a apart, 3×1 and 3×3."""
    distance = ca.norm_2(apart)
    normal = apart / distance
    return normal, (ca.DM.eye(3) - normal @ normal.T) / distance
