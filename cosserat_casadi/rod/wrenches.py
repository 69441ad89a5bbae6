"""What acts on a rod: the records in which every effect speaks to the mechanics.

Coordinates are those of the rod's base frame for a dead wrench and those of the loaded section for a follower.
A part that does not exist is None and costs nothing.
"""

from __future__ import annotations

from dataclasses import dataclass

from cosserat_casadi.maths.grid import Indices
from cosserat_casadi.maths.typing import FloatArray, Matrix


@dataclass(frozen=True)
class PointWrench:
    """Force and moment on one section.

    Attributes:
        at: abscissa X of the section, a break of the rod's grid.
        force: 3×1, N, or None.
        moment: 3×1, N m, or None.
        follower: whether the wrench turns with the section.
    """

    at: float
    force: Matrix | None
    moment: Matrix | None
    follower: bool


@dataclass(frozen=True)
class LineWrench:
    """Force and moment per metre of undeformed length: coefficients times known profiles.

    Attributes:
        force: 3×k coefficients, N/m, or None.
        moment: 3×k coefficients, N, or None.
        profiles: values of the k profiles at the nodes, shape (k, M), without unit.
        follower: whether the wrench turns with the sections.
    """

    force: Matrix | None
    moment: Matrix | None
    profiles: FloatArray
    follower: bool


Wrench = PointWrench | LineWrench


@dataclass(frozen=True)
class ActuationStress:
    """Stress Λ_ad that an actuator adds to the elastic one, report (2.15), whatever the rod's strain.

    Attributes:
        stress: 6×k coefficients of [M; N] in the sections' frames, N m and N.
        profiles: values of the k profiles at the nodes, shape (k, M), without unit.
    """

    stress: Matrix
    profiles: FloatArray


@dataclass(frozen=True)
class Routing:
    """Where a cable runs through the sections, at the k nodes of the elements that it passes.

    Attributes:
        nodes: indices of the nodes, shape (k,).
        offset: D_x and D_y in the section, shape (2, k), m.
        slope: dD/dX, shape (2, k), m.
    """

    nodes: Indices
    offset: FloatArray
    slope: FloatArray


@dataclass(frozen=True)
class Cable:
    """A cable under one tension all along its routing: it slides without friction.

    Attributes:
        routing: where it runs.
        tension: 1×1, N.
    """

    routing: Routing
    tension: Matrix


Actuation = ActuationStress | Cable
Action = Wrench | Actuation
