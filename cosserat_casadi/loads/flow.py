"""A fluid round a rod: drag, buoyancy and added mass per length.

Drag is Taylor's for long bodies in a stream at any angle, −½ ρ d (C_n |v_n| v_n + π C_t |v| v_t) with the velocity v of
the section relative to the stream and its parts across and along the tangent: G. I. Taylor, Proc. R. Soc. A 214 (1952)
158. A speed is √(v·v + ε²), so that its derivatives are finite at rest. Slow flow of viscous fluids adds
−ζ_n v_n − ζ_t v_t, resistive force theory: J. Gray and G. J. Hancock, J. Exp. Biol. 32 (1955) 802.

Fluid that moves along has the kinetic energy ½ m_a |ṙ − (t·ṙ) t|² per length, as along slender bodies in a fluid at
rest: H. Lamb, *Hydrodynamics*, 6th ed., § 124. Its force and moment follow by Lagrange's equations, so that the
energy of a motion is kept: with P = 1 − t tᵀ

    f = −m_a d(P ṙ)/dt = −m_a (P r̈ − (ṫ·ṙ) t − (t·ṙ) ṫ),    c = −m_a (t·ṙ) t × ṙ.

At rest they vanish, in a stream too: as in Morison's equation the stream enters the drag alone.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import final

import casadi as ca
import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.loads.load import Load, Section, Site
from cosserat_casadi.maths.numbers import Numbers, is_zero, repeated, stacked_rows
from cosserat_casadi.maths.typing import Matrix

STILL = 1e-8
"""ε, m/s: drag is too large by the share ½ (ε/v)², 5e-11 at 1 mm/s; below ε it is as small as a drag can be."""


@final
class FlowLoad(Load[scenes.Flow]):
    """A fluid of a density (kg/m³) that streams at a velocity (m/s)."""

    record = scenes.Flow
    uniform = True

    def acts_on(self, load: scenes.Flow, rod: str) -> bool:
        """Whether the load acts on this rod: every rod, unless the load names some."""
        return load.acts_on_rod(rod)

    def wrench(self, load: scenes.Flow, section: Section, values: Mapping[str, Matrix]) -> tuple[Matrix, Matrix]:
        """Force (N/m) and moment (N m/m) in world axes; the moment comes from the added mass in motion."""
        force: Matrix = ca.DM(3, 1)
        moment: Matrix = ca.DM(3, 1)
        velocity = section.velocity - values["velocity"]
        tangent = section.rotation[:, 2]
        along = ca.dot(velocity, tangent) * tangent
        across = velocity - along
        if not (is_zero(load.normal) and is_zero(load.tangential)):
            of_normal = load.normal * _speed(across) * across
            of_tangential = np.pi * load.tangential * _speed(velocity) * along
            diameter = section.data[0]
            force = -load.density / 2 * diameter * (of_normal + of_tangential)
        if not (is_zero(load.normal_resistance) and is_zero(load.tangential_resistance)):
            force = force - load.normal_resistance * across - load.tangential_resistance * along
        if load.gravity is not None:
            force = force - load.density * section.data[1] * ca.vertcat(*load.gravity)
        # At rest there is no added mass.
        if section.acceleration.nnz() and not is_zero(load.added_mass):
            added = load.added_mass * load.density * section.data[1]
            inertia, turning = _added_mass(section)
            force = force - added * inertia
            moment = -added * turning
        return force, moment

    def data(self, load: scenes.Flow, site: Site) -> Numbers:
        """Diameter, m, and area of fluid displaced, m², at the sections."""
        if load.diameter is not None:
            ends = load.diameter if isinstance(load.diameter, tuple) else (load.diameter, load.diameter)
            diameter: Numbers = ends[0] + (ends[1] - ends[0]) * site.X
        else:
            assert site.rod.diameter is not None, "the rules of the scene ask for one"
            diameter = site.rod.diameter(site.X)
        displaced = np.pi / 4 * diameter**2
        # A tube displaces as much as a solid rod; a rod that is not round displaces the area of its section.
        if site.rod.diameter is None and site.rod.area is not None:
            displaced = site.rod.area(site.X)
        return stacked_rows([repeated(diameter, site.X.shape[0]), repeated(displaced, site.X.shape[0])])


def _speed(velocity: Matrix) -> Matrix:
    """|v|, m/s, with finite derivatives at zero."""
    return ca.sqrt(ca.sumsqr(velocity) + STILL**2)


def _added_mass(section: Section) -> tuple[Matrix, Matrix]:
    """Force and moment of the added mass, 3×1 each, over minus the added mass per length."""
    tangent = section.rotation[:, 2]
    turning = ca.cross(section.angular_velocity, tangent)
    along = ca.dot(tangent, section.velocity)
    across = section.acceleration - ca.dot(tangent, section.acceleration) * tangent
    turned = ca.dot(turning, section.velocity) * tangent + along * turning
    return across - turned, along * ca.cross(tangent, section.velocity)
