"""The way from the unloaded scene to the scene: one load factor λ around finished equations.

At λ = 0 nothing acts and every constraint is a limp spring; at λ = 1 the loads have grown to their values and the
springs are rigid. A row r of a constraint, with its own unknown u, becomes λ r + (1 − λ)^p s u: the spring's
compliance falls from one to zero. So do the rows of a floating frame, which a spring holds at its pose in the unloaded
scene, from rigid to limp. The mechanics know nothing of λ. Docs/theory.md, section 8.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import casadi as ca

from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.rod.actuation import Actuation
from cosserat_casadi.rod.wrenches import PoseWrench, RodLoad

LoadFactor = Matrix | None
"""λ, 1×1; None stands for the scene itself, λ = 1, and adds no instruction."""


@dataclass(frozen=True)
class Compliance:
    """How a block of equations yields on the way to the scene.

    Attributes:
        power: p of (1 − λ)^p; 3 for what holds rods that do not fit, which is far stiffer than they are.
        scale: s, without unit; below zero where the equation falls with its unknown.
    """

    power: int
    scale: float = 1.0

    def at(self, load_factor: Matrix) -> Matrix:
        """Compliance (1 − λ)^p s, 1×1."""
        return self.scale * (1 - load_factor) ** self.power


def smoothing_at(first: float, last: float, load_factor: LoadFactor) -> Matrix:
    """Smoothing of a corner, 1×1: falls from ``first + last`` in the unloaded scene to ``last`` in the scene."""
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
    """Derivative of the springs of some equations with their own unknowns, size×size; None at the scene itself."""
    return None if load_factor is None else compliance.at(load_factor) * ca.MX.eye(size)
