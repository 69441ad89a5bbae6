"""Margins to states that no rod can be in: paths of zero length, joints out of their plane, ends of laws.

A path at D(X) in the sections has the tangent T = Γ + K × D + D'/ℓ. With plane, rigid sections the determinant of the
deformation gradient is T_z there: where it vanishes matter is compressed to zero volume, and below zero it is turned
inside out. A cable has no length along the rod there, which the equations do not notice, since they contain |T| alone.

Joints of rods that stay in a plane hold them in the plane alone. Parameters and inputs that move a joint out of the
plane would leave it open, which the equations do not notice.

A nonlinear material has a law for a range of strains, and is stable if every further strain costs energy: if
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
"""Margin that counts as zero: a path that is followed to zero ends short of it by a last step."""

APART = "sections"
"""Kind of the margin of sections at which contact is summed."""

BESIDE = 1e-6
"""Distance over the length, or angle, by which rounding may take a joint out of its plane, also of floats."""


class StrainMargin(NamedTuple):
    """Owner of a margin: an actuator, a rod, a joint or a contact.

    Attributes:
        kind: "path" for a tendon, "plane" for a joint or a support, "material" for a rod, the kind of an actuator with
            an end of its law, or "sections" for contact.
        name: name of the actuator or of the rod; for a joint or a support its two sides in words.
    """

    kind: str
    name: str


def strain_margins(system: System) -> dict[StrainMargin, Matrix]:
    """Least value of each margin, 1×1: margins of paths first, then of planes, of laws, last of sections.

    A path has its T_z, per length of the rod; tendons whose T_z no strain changes are left out. A joint in the plane of
    its rods has one less the square of its distance from the plane over BESIDE; it is left out if neither inputs nor
    parameters move constraints. A material has the least pivot of its tangent stiffness relative to its Hooke tensor,
    or the distance of the strain from the ends of its law. An actuator has the distance of its inputs from the end of
    its law. Sections at which contact is summed have, in motion, 0 if they lie too far apart to show an error, else 1.
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
        # Shapes are costly: they are not computed for linear rods.
        margin = None if rod.properties.beyond_hooke is None else material_margin(system.shapes[name])
        if margin is not None:
            # A law ends at a margin of zero; margins of paths count as zero at VANISHED, so that is added.
            margins[StrainMargin("material", name)] = margin + VANISHED
    for actuator in system.discrete.scene.actuators:
        margin = system.actuators.margin(actuator)
        if margin is not None:
            margins[StrainMargin(actuator.kind, actuator.name)] = margin + VANISHED
    # At rest the error estimate itself says that the error is unknown.
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
    # Floating frames follow their constraints: moving one frame may move all.
    held = [placed.constraint.residual(system.poses(placed)) for placed in system.discrete.constraints]
    given = ca.symvar(ca.veccat(ca.MX(system.arguments.inputs), system.discrete.parameters.symbol))
    if not ca.depends_on(ca.veccat(*gaps.values(), *held), ca.veccat(*given)):
        return {}
    return {StrainMargin("plane", what): 1 - ca.sumsqr(gap) / BESIDE**2 for what, gap in gaps.items()}


def _with_tilts_of_a_line(gap: Matrix, held: HeldDirections) -> Matrix:
    """A gap with tilts of a hinge's axis out of the plane as those of a line, which half a turn maps to itself.

    The gap contains 2 sin(θ/2) for a tilt of the axis by θ: times cos(θ/2) it is sin θ.
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
