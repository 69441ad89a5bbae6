"""Reach of a rod: whether its length and its plane allow its tip to be where a support holds it."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any

import casadi as ca

from cosserat_casadi.maths.rotation import quaternion_conjugate, quaternion_from_tangent, quaternion_product, rotate
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.scene.faults import Fault, SceneTables
from cosserat_casadi.scene.records import sound
from cosserat_casadi.scene.rod_records import IN_PLANE, SHEAR_AND_EXTENSION, Base, Rod
from cosserat_casadi.scene.values import NORM_SLACK, Quadruple, Triple

LENGTH_SLACK = 1e-9
"""Distance, relative to the length of a rod, that may be rounding."""


def named_rod(name: Any, scene: SceneTables) -> Rod | None:
    """The rod of a name among the tables of a scene; None for an unknown name, or for a rod with faults."""
    rods = scene.named("rods")
    if not isinstance(name, str) or name not in rods:
        return None
    _, table = rods[name]
    return sound(Rod, table)


def out_of_reach(rod: Rod, position: Triple, orientation: Quadruple | None) -> Iterator[Fault]:
    """Reasons why the tip of a rod cannot have a pose.

    Args:
        rod: the rod, whose base is in the world.
        position: prescribed position of the tip, world axes, m.
        orientation: prescribed orientation of the tip, w, x, y, z; None if the tip may turn.

    Yields:
        faults with the key of the unreachable position or orientation as path.
    """
    # A straight line is the shortest connection of two points: bending cannot take the tip farther than the length.
    distance = math.dist(position, rod.base.position)
    reach = rod.length * (1 + LENGTH_SLACK)
    if _keeps_its_length(rod) and distance > reach:
        problem = f"{distance:.9g} m from the base of a rod of {rod.length:.9g} m"
        yield Fault(("position",), problem, "admit extension, or move the support")
    if _stays_in_its_plane(rod):
        yield from _out_of_plane(rod, position, orientation)


def _keeps_its_length(rod: Rod) -> bool:
    """Whether neither the admitted strains nor the unloaded shape shear or stretch the rod."""
    changing = set(rod.admitted) & SHEAR_AND_EXTENSION
    unit_tangent = _is_constant(rod.intrinsic.tangent, (0.0, 0.0, 1.0))
    return not changing and unit_tangent


def _stays_in_its_plane(rod: Rod) -> bool:
    """Whether neither strains nor unloaded shape take the rod out of the local x–z plane of its base."""
    if not set(rod.admitted) <= IN_PLANE:
        return False
    # Strains that the rod does not admit keep their unloaded values.
    bending_x, _, torsion = rod.intrinsic.curvature
    _, shear_y, _ = rod.intrinsic.tangent
    return _is_constant((bending_x, torsion, shear_y), (0.0, 0.0, 0.0))


def _is_constant(components: Sequence[float | tuple[float, ...]], values: Sequence[float]) -> bool:
    """Whether components that may be polynomials are these values along the whole rod."""
    for component, value in zip(components, values, strict=True):
        coefficients = component
        if not isinstance(coefficients, tuple):
            coefficients = (coefficients,)
        # The Legendre polynomial of degree 0 is 1; a constant has no higher degrees.
        constant, *higher = coefficients
        if constant != value or any(higher):
            return False
    return True


def _out_of_plane(rod: Rod, position: Triple, orientation: Quadruple | None) -> Iterator[Fault]:
    base_Q_world = quaternion_conjugate(_base_orientation(rod.base))
    remedy = "a planar rod stays in the local x–z plane of its base"
    from_base = ca.DM(position) - ca.DM(rod.base.position)
    in_base = rotate(base_Q_world, from_base)
    offset = abs(float(in_base[1]))
    # The format does not bound positions: an offset that is NaN has overflowed, far out of the plane.
    if not offset <= LENGTH_SLACK * rod.length:
        yield Fault(("position",), f"{offset:.3g} m outside the plane of the rod", remedy)
    if orientation is None:
        return
    tip_in_base = quaternion_product(base_Q_world, ca.DM(orientation))
    _, x, _, z = (float(component) for component in ca.vertsplit(tip_in_base))
    # Turns within the plane are about the local y axis: their quaternions have neither an x nor a z component.
    if not math.hypot(x, z) <= NORM_SLACK:
        yield Fault(("quaternion",), "turned out of the plane of the rod", remedy)


def _base_orientation(base: Base) -> Matrix:
    """World orientation of the base: its quaternion, or the shortest rotation of z to its tangent."""
    if base.tangent is None:
        return ca.DM(base.quaternion)
    return ca.DM(quaternion_from_tangent(base.tangent))
