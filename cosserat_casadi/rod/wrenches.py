"""Wrenches on a rod: the records by which every load acts on the mechanics.

Coordinates are in the axes of the rod's base for a dead wrench and in the axes of the loaded section for a follower.
A missing part is None and costs nothing.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from cosserat_casadi.maths.numbers import Numbers, Scalar
from cosserat_casadi.maths.typing import Matrix, check_shape
from cosserat_casadi.rod.placed_sections import SummedSections
from cosserat_casadi.rod.rod_motion import RodMotion
from cosserat_casadi.rod.section_kernel import SectionKernel


@dataclass(frozen=True)
class WrenchAt:
    """Force and moment on one section.

    Attributes:
        at: abscissa X of the section, an element end of the rod's grid.
        force: 3×1, N, or None.
        moment: 3×1, N m, or None.
        follower: whether the wrench turns with the section.
    """

    at: Scalar
    force: Matrix | None
    moment: Matrix | None
    follower: bool

    def __post_init__(self) -> None:
        _check_vectors(self.force, self.moment, 1)


@dataclass(frozen=True)
class LineWrench:
    """Force and moment per metre of undeformed length: coefficients times known profiles.

    Attributes:
        force: 3×k coefficients, N/m, or None.
        moment: 3×k coefficients, N, or None.
        profiles: dimensionless values of the k profiles at the nodes, shape (k, M), or expressions, of which one column
            may stand for all nodes; None if the coefficients are the values at the M nodes.
        follower: whether the wrench turns with the sections.
    """

    force: Matrix | None
    moment: Matrix | None
    profiles: Numbers | None
    follower: bool

    def __post_init__(self) -> None:
        _check_vectors(self.force, self.moment, None if self.profiles is None else self.profiles.shape[0])


Wrench = WrenchAt | LineWrench
"""A wrench that does not depend on the position of its section: a dead wrench or a follower."""


@dataclass(frozen=True)
class SeenMotion:
    """Motion of the sections of a rod relative to a body, in the axes of the rod's base.

    Attributes:
        velocity: 3×M, m/s.
        angular_velocity: 3×M, rad/s.
    """

    velocity: Matrix
    angular_velocity: Matrix

    def undamped(self, rate: str) -> Matrix:
        """A rate of the nodes, 3×M, see :meth:`RodMotion.undamped`: damping by mass does not change velocities."""
        field: Matrix = getattr(self, rate)
        return field


@dataclass(frozen=True)
class PoseWrench:
    """A wrench that depends on the position or the rotation of its section otherwise than as a follower.

    Attributes:
        at: abscissa X of the section, an element end of the grid; None for a wrench per metre of undeformed length.
        span: abscissae X between which a wrench per metre acts, element ends of the grid.
        kernel: force and moment as a function of a section's pose.
        base_position: position of the rod's base in the axes of the kernel, which are those of the world or of the body
            that bears the reaction, 3×1, m.
        base_rotation: rotation from the base into these axes, 3×3.
        parameters: run-time parameters of the kernel, p×1.
        data: numbers of the load at its sections, such as values of profiles, shape (d, k).
        scale: factor on force, moment and energy.
        motion: motion of the rod, or relative to a body; None at rest, and for a kernel without rates.
        growth: function that returns the power of the load factor by which it grows on the load path; None is 1.
        borne_by: name of the body that bears the reaction; None for the world.
        sections: sections at which a wrench per metre is summed, None for the nodes; with sections it must be a force
            that depends on the position and velocity of its section alone.
    """

    at: Scalar | None
    span: tuple[Scalar, Scalar]
    kernel: SectionKernel
    base_position: Matrix
    base_rotation: Matrix
    parameters: Matrix
    data: Numbers
    scale: Matrix | float
    motion: RodMotion | SeenMotion | None = None
    growth: Callable[[], int] | None = None
    borne_by: str | None = None
    sections: SummedSections | None = None

    def __post_init__(self) -> None:
        check_shape("base_position", self.base_position, 3, 1)
        check_shape("base_rotation", self.base_rotation, 3, 3)


RodLoad = Wrench | PoseWrench


def _check_vectors(force: Matrix | None, moment: Matrix | None, columns: int | None) -> None:
    """Refuse vectors of another shape, which CasADi would broadcast silently."""
    if force is not None:
        check_shape("force", force, 3, columns)
    if moment is not None:
        check_shape("moment", moment, 3, columns)
