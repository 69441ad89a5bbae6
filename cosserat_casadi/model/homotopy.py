"""The load path from the unloaded scene to the scene: one load factor λ, applied to finished equations.

At λ = 0 nothing acts and every constraint is a limp spring; at λ = 1 the loads have grown to their values and the
springs are rigid. A row r of a constraint, with its own unknown u, becomes λ r + (1 − λ)^p s u: the spring's
compliance falls from one to zero. A spring holds each floating frame at its pose in the unloaded scene, and goes from
rigid to limp. The mechanics do not depend on λ. Docs/theory.md, section 8.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import casadi as ca

from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.rod.actuation import Actuation
from cosserat_casadi.rod.wrenches import PoseWrench, RodLoad

LoadFactor = Matrix | None
"""Load factor λ, 1×1; None stands for λ = 1, the scene itself, and adds no instruction."""


@dataclass(frozen=True)
class Compliance:
    """Compliance of a block of equations along the load path.

    Attributes:
        power: p of (1 − λ)^p; 3 for constraints that hold rods that do not fit: they are stiff early.
        scale: s, without unit; negative if the equation falls with its unknown.
    """

    power: int
    scale: float = 1.0

    def at(self, load_factor: Matrix) -> Matrix:
        """Compliance (1 − λ)^p s, 1×1."""
        return self.scale * (1 - load_factor) ** self.power


def smoothing_at(first: float, last: float, load_factor: LoadFactor) -> Matrix:
    """Smoothing of a corner, 1×1, which falls from ``first + last`` at λ = 0 to ``last`` at λ = 1."""
    return ca.DM(last) if load_factor is None else last + (1 - load_factor) * first


def scaled(load: RodLoad, load_factor: LoadFactor) -> RodLoad:
    """A load on a rod at a load factor."""
    if load_factor is None:
        return load
    if isinstance(load, PoseWrench):
        growth = 1 if load.growth is None else load.growth()
        return replace(load, scale=load_factor**growth * load.scale)
    # An absent force or moment stays absent, so that it adds no instruction.
    force, moment = (None if part is None else load_factor * part for part in (load.force, load.moment))
    return replace(load, force=force, moment=moment)


def scaled_effort(actuation: Actuation, load_factor: LoadFactor) -> Actuation:
    """An actuator at a load factor."""
    if load_factor is None:
        return actuation
    return replace(actuation, effort=load_factor * actuation.effort)


def row_at(row: Matrix, unknown: Matrix, compliance: Compliance, load_factor: LoadFactor) -> Matrix:
    """An equation at a load factor, λ r + (1 − λ)^p s u.

    Args:
        row: r, the equation of the scene itself, zero in equilibrium, k×1.
        unknown: u, the unknown that a spring of this equation acts on, k×1.
        compliance: p and s.
        load_factor: λ.
    """
    if load_factor is None:
        return row
    spring_row = compliance.at(load_factor) * unknown
    return load_factor * row + spring_row


def column_at(columns: Matrix, load_factor: LoadFactor) -> Matrix:
    """Derivatives of an equation at a load factor, without the derivative of its spring."""
    return columns if load_factor is None else load_factor * columns


def spring(size: int, compliance: Compliance, load_factor: LoadFactor) -> Matrix | None:
    """Derivative of the springs of equations by their own unknowns, size×size; None for the scene itself."""
    return None if load_factor is None else compliance.at(load_factor) * ca.MX.eye(size)
