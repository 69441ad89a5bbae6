"""Margins to states that no rod can be in: paths without length, joints out of a plane, laws that have ended.

A path at D(X) in the sections has the tangent T = Γ + K × D + D'/ℓ. With plane, rigid sections the determinant of the
deformation gradient is T_z there: where it vanishes matter is pressed to nothing, and beyond it is turned inside out.
A cable has no length along the rod there, which the equations, that know |T| alone, do not see.

Where rods stay in a plane their joints hold them in it alone. Parameters and inputs that move a joint out of the plane
would leave it open there, which the equations do not see.

A material that is not linear has a law for some strains, and is stable where every further strain costs energy: where
the pivots of its tangent stiffness are positive.
"""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import casadi as ca

from cosserat_casadi.constraints.section_constraint import HeldDirections
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.model.contact_depth import sections_lie_apart
from cosserat_casadi.model.discrete_scene import DiscreteScene
from cosserat_casadi.model.system import Arguments, System
from cosserat_casadi.rod.cable import RoutedCable
from cosserat_casadi.rod.material_functions import material_margin

VANISHED = 1e-3
"""Margin that counts as none: a path that is followed to zero ends short of it by a last step."""

APART = "sections"
"""Kind of the margin of sections at which contact is summed."""

BESIDE = 1e-6
"""Distance over the length, or angle, by which a joint may be out of the plane of its rods: rounding, of floats too."""


class StrainMargin(NamedTuple):
    """The actuator, the rod or the joint that has a margin.

    Attributes:
        kind: "path" of a tendon, "plane" of a joint or a support, "material" of a rod, the kind of an actuator whose
            law has an end, or "sections" of contact.
        name: name of the actuator or of the rod; of a joint or a support its two sides in words.
    """

    kind: str
    name: str


def strain_margins(system: System) -> dict[StrainMargin, Matrix]:
    """Margins where they are least, 1×1 each: first margins of paths, then of planes, then of laws, last of sections.

    Of a path its T_z, per length of the rod; tendons whose T_z no strain changes are left out. Of a joint in the plane
    of its rods one less the square of its distance from it, over BESIDE; none where neither inputs nor parameters move
    the places of constraints. Of a material the least pivot of its tangent stiffness relative to its Hooke tensor, or
    how far the strain is from the ends of its law. Of an actuator how far its inputs are from the end of its law.
    Of sections at which contact is summed, in motion, 0 where they lie too far apart to tell an error, else 1.
    """
    margins: dict[StrainMargin, Matrix] = {}
    for actuator in system.discrete.scene.actuators:
        _, conjugate = system.actuators.conjugate(actuator.name)
        if not isinstance(conjugate, RoutedCable):
            continue
        along = conjugate.stretch_along
        if along is not None and not along.is_constant():
            margins[StrainMargin("path", actuator.name)] = ca.mmin(along)
    margins |= _plane_margins(system)
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
    # At rest they tell of an error that is not known.
    apart = sections_lie_apart(system) if system.discrete.moving else None
    if apart is not None:
        margins[StrainMargin(APART, "contact")] = 1 - apart
    return margins


def _plane_margins(system: System) -> dict[StrainMargin, Matrix]:
    gaps = {}
    for placed in system.discrete.constraints:
        if placed.held_by_plane is not None:
            beside = replace(placed.constraint, held=placed.held_by_plane)
            gap = beside.residual(system.poses(placed))
            is_hinge = placed.constraint.held.rotations.shape[1] == 0
            gaps[placed.what] = _with_tilts_of_a_line(gap, placed.held_by_plane) if is_hinge else gap
    if not gaps:
        return {}
    # Floating frames follow what constraints hold them to: one that is moved may move them all.
    held = [placed.constraint.residual(system.poses(placed)) for placed in system.discrete.constraints]
    given = ca.symvar(ca.veccat(ca.MX(system.arguments.inputs), system.discrete.parameters.symbol))
    if not ca.depends_on(ca.veccat(*gaps.values(), *held), ca.veccat(*given)):
        return {}
    return {StrainMargin("plane", what): 1 - ca.sumsqr(gap) / BESIDE**2 for what, gap in gaps.items()}


def _with_tilts_of_a_line(gap: Matrix, held: HeldDirections) -> Matrix:
    """A gap whose rotations out of the plane tilt a hinge's axis: turned by half a turn the axis is the same line.

    The gap has 2 sin(θ/2) of the angle θ by which the axis is tilted: times cos(θ/2) it is sin θ.
    """
    if held.rotations.shape[1] == 0:
        return gap
    displacements = held.positions.shape[1]
    tilts = gap[displacements:]
    sines: Matrix = tilts * ca.sqrt(1 - ca.fmin(ca.sumsqr(tilts) / 4, 1))
    return ca.vertcat(gap[:displacements], sines)


def margins_of(discrete: DiscreteScene) -> list[StrainMargin]:
    """Tendons and rods with margins, in the order of the margins."""
    arguments = Arguments(ca.MX.sym("x", discrete.size), ca.MX.sym("inputs", discrete.layout.size))
    return list(strain_margins(System(discrete, arguments)))
