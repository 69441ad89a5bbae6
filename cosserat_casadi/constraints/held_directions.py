"""Held directions, P and D of docs/theory.md, section 8, and their reduction for rods in a plane.

A rod that stays in the x–z plane of its base is held in that plane alone: holding directions in which it cannot move
would make the equations dependent.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from cosserat_casadi.constraints.section_constraint import HeldDirections
from cosserat_casadi.maths.numbers import is_zero
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.rod.properties import RodProperties

FLAT = 1e-9
"""Sine of an angle, or distance relative to a length, that may be rounding."""

ALL = np.eye(3)
IN_PLANE = ALL[:, [0, 2]]
"""The x and z axes of a planar rod's base, in which its sections move."""

NORMAL = ALL[:, 1]
"""The y axis of a planar rod's base, about which its sections turn."""

NONE = np.zeros((3, 0))

CLAMPED = HeldDirections(ALL, ALL)
"""Position and rotation are held: a clamped tip, a fixed joint, the base of a carried rod."""

PINNED = HeldDirections(ALL, NONE)
"""Position is held, rotation is free: a pinned tip, a spherical joint."""


def across(axis: Sequence[float], rotation: FloatArray) -> FloatArray:
    """Two unit vectors at right angles to an axis, in the axes of the tip, shape (3, 2).

    Args:
        axis: axis in the axes of the holder, of any length but zero.
        rotation: rotation from the axes of the tip into those of the holder, shape (3, 3).
    """
    direction = rotation.T @ np.asarray(axis, dtype=float)
    # The first right singular vector of a row is along it; the others span what is orthogonal to it.
    _, _, rows = np.linalg.svd(direction[None, :])
    return np.asarray(rows[1:].T)


def in_plane(held: HeldDirections, normal: FloatArray = NORMAL) -> HeldDirections:
    """Held directions of a section that cannot leave a plane: displacements in it, rotation about its normal.

    Args:
        held: the directions of a section that moves in space.
        normal: unit normal of the plane in the axes of ``held``, shape (3,).
    """
    along_normal = np.outer(normal, normal)
    positions = _basis((ALL - along_normal) @ held.positions)
    rotations = _basis(along_normal @ held.rotations)
    # All displacements in the plane are held along its axes, whichever way the place is turned.
    turn_with_pose = held.turn_with_pose and positions.shape[1] == 1
    if positions.shape[1] == 2:
        positions = IN_PLANE
    if rotations.shape[1]:
        rotations = NORMAL[:, None]
    return HeldDirections(positions, rotations, turn_with_pose)


def upright(held: HeldDirections) -> HeldDirections:
    """Held directions of a planar rod that keeps its body in the plane too, so that the body does not tilt."""
    if np.any(np.abs(IN_PLANE.T @ held.rotations) > FLAT):
        return held
    return replace(held, rotations=np.hstack([IN_PLANE, held.rotations]))


def in_any_plane(held: HeldDirections, normal: FloatArray) -> HeldDirections:
    """Held directions of a body or section that cannot leave a plane, with the normal in their axes."""
    along_normal = np.outer(normal, normal)
    return HeldDirections(_basis((ALL - along_normal) @ held.positions), _basis(along_normal @ held.rotations), True)


def across_plane(held: HeldDirections, normal: FloatArray = NORMAL) -> HeldDirections:
    """Held directions that a plane holds already: displacements along its normal, rotations about axes in it."""
    along_normal = np.outer(normal, normal)
    positions = _basis(along_normal @ held.positions)
    return HeldDirections(positions, _basis((ALL - along_normal) @ held.rotations), held.turn_with_pose)


def keeps_plane(held: HeldDirections, normal: FloatArray = NORMAL) -> bool:
    """Whether a body with these held directions may leave its hold across a plane to another constraint.

    This is so if it cannot move along the normal, given in the axes of the directions, and both tilts out of the plane
    are held or neither.
    """
    left = normal - held.positions @ (held.positions.T @ normal)
    if np.linalg.norm(left) > FLAT:
        return False
    tilts = _tilts(held, normal)
    return bool(np.all(tilts <= FLAT) or (len(tilts) == 2 and np.all(tilts >= 1 - FLAT)))


def confines(held: HeldDirections, normal: FloatArray = NORMAL) -> bool:
    """Whether a body or section with these held directions stays in a plane, along the normal and against tilts."""
    tilts = _tilts(held, normal)
    return keeps_plane(held, normal) and len(tilts) == 2 and bool(np.all(tilts >= 1 - FLAT))


def _tilts(held: HeldDirections, normal: FloatArray) -> FloatArray:
    """Held parts of two tilts out of a plane, shape (2,) or less."""
    return np.asarray(np.linalg.svd(across(normal.tolist(), ALL).T @ held.rotations, compute_uv=False))


def _basis(vectors: FloatArray) -> FloatArray:
    """Orthonormal basis of the span of vectors, shape (3, k); the largest component of each vector is positive."""
    left, sizes, _ = np.linalg.svd(vectors, full_matrices=False)
    span = left[:, sizes > FLAT]
    projector = span @ span.T
    basis = []
    for _ in range(span.shape[1]):
        column = projector[:, int(np.argmax(np.diag(projector)))]
        unit = column / np.linalg.norm(column)
        basis.append(unit)
        projector = projector - np.outer(unit, unit)
    return np.reshape(basis, (-1, 3)).T


def stays_in_plane(rod: RodProperties) -> bool:
    """Whether a rod cannot leave the local x–z plane of its base."""
    # Component 4 of the strain is the shear along y, out of the plane.
    shears_out = not is_zero(rod.intrinsic[4]) or 4 in rod.admitted
    if shears_out:
        return False
    return rod.turning_axes in ((), (1,))
