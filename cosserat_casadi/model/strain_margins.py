"""Margins to states that no rod can be in: paths of tendons without length, materials and chambers beyond their laws.

A path at D(X) in the sections has the tangent T = Γ + K × D + D'/ℓ. With plane, rigid sections the determinant of the
deformation gradient is T_z there: where it vanishes matter is pressed to nothing, and beyond it is turned inside out.
A cable has no length along the rod there, which the equations, that know |T| alone, do not see.

A material that is not linear has a law for some strains, and is stable where every further strain costs energy: where
the pivots of its tangent stiffness are positive.
"""

from __future__ import annotations

from typing import NamedTuple

import casadi as ca

from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.model.discrete_scene import DiscreteScene
from cosserat_casadi.model.system import Arguments, System
from cosserat_casadi.rod.cable import RoutedCable
from cosserat_casadi.rod.material_functions import material_margin

VANISHED = 1e-3
"""Margin that counts as none: a path that is followed to zero ends short of it by a last step."""


class StrainMargin(NamedTuple):
    """The actuator or the rod that has a margin.

    Attributes:
        kind: "path" of a tendon, "material" of a rod, or the kind of an actuator whose law has an end.
        name: name of the actuator, or of the rod.
    """

    kind: str
    name: str


def strain_margins(system: System) -> dict[StrainMargin, Matrix]:
    """Margins where they are least, 1×1 each: first those of paths, then those of laws.

    Of a path its T_z, per length of the rod; tendons whose T_z no strain changes are left out. Of a material the least
    pivot of its tangent stiffness relative to its Hooke tensor, or how far the strain is from the ends of its law. Of
    an actuator how far its inputs are from the end of its law.
    """
    margins: dict[StrainMargin, Matrix] = {}
    for actuator in system.discrete.scene.actuators:
        _, conjugate = system.actuators.conjugate(actuator.name)
        if not isinstance(conjugate, RoutedCable):
            continue
        along = conjugate.stretch_along
        if along is not None and not along.is_constant():
            margins[StrainMargin("path", actuator.name)] = ca.mmin(along)
    for name, rod in system.discrete.rods.items():
        # Shapes take their time: those of linear rods are not asked for.
        margin = None if rod.properties.beyond_hooke is None else material_margin(system.shapes[name])
        if margin is not None:
            # A law ends where its margin is zero; what has one of paths' ends a little earlier.
            margins[StrainMargin("material", name)] = margin + VANISHED
    for actuator in system.discrete.scene.actuators:
        margin = system.actuators.margin(actuator)
        if margin is not None:
            margins[StrainMargin(actuator.kind, actuator.name)] = margin + VANISHED
    return margins


def margins_of(discrete: DiscreteScene) -> list[StrainMargin]:
    """Tendons and rods with margins, in the order of the margins."""
    arguments = Arguments(ca.MX.sym("x", discrete.size), ca.MX.sym("inputs", discrete.layout.size))
    return list(strain_margins(System(discrete, arguments)))
