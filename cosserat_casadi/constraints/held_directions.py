"""What each kind of support and joint holds: a choice of directions, P and D of docs/theory.md, section 8.

A rod that stays in the x–z plane of its base needs to be held in that plane alone; what nothing can move is not held a
second time, or the equations would depend on each other.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from cosserat_casadi.constraints.section_constraint import HeldDirections
from cosserat_casadi.maths.numbers import is_zero
from cosserat_casadi.maths.pose import NumericPose
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.rod.properties import RodProperties

ALL = np.eye(3)
IN_PLANE = ALL[:, [0, 2]]
"""The x and z axes of a planar rod's base, in which its sections move."""

NORMAL = ALL[:, [1]]
"""The y axis of a planar rod's base, about which its sections turn."""

NONE = np.zeros((3, 0))

CLAMPED = HeldDirections(ALL, ALL)
"""Position and rotation are held: a clamped tip, a fixed joint, the base of a carried rod."""

PINNED = HeldDirections(ALL, NONE)
"""Position is held, rotation is free: a pinned tip, a spherical joint."""

CLAMPED_IN_PLANE = HeldDirections(IN_PLANE, NORMAL)
PINNED_IN_PLANE = HeldDirections(IN_PLANE, NONE)

PINNED_UPRIGHT = HeldDirections(ALL, IN_PLANE)
"""A spherical joint of a planar rod that keeps its body in the plane too."""

SUPPORTS: dict[str, tuple[HeldDirections, HeldDirections]] = {
    "clamped": (CLAMPED, CLAMPED_IN_PLANE),
    "pinned": (PINNED, PINNED_IN_PLANE),
}
"""What a support holds by the word of the scene: of any rod, and of one that stays in the plane of the support."""


def revolute(axis: Sequence[float], place: NumericPose) -> HeldDirections:
    """The tip turns about an axis of the body alone.

    Args:
        axis: in the axes of the body, any length but zero.
        place: pose of the tip section in the body.
    """
    return HeldDirections(ALL, _across(axis, place), turn_with_place=True)


def prismatic(axis: Sequence[float], place: NumericPose) -> HeldDirections:
    """The tip slides along an axis of the body alone.

    Args:
        axis: in the axes of the body, any length but zero.
        place: pose of the tip section in the body.
    """
    return HeldDirections(_across(axis, place), ALL, turn_with_place=True)


def prismatic_in_plane(axis: Sequence[float], place: NumericPose) -> HeldDirections:
    """The same in the x–z plane of the tip, where something else keeps the body in that plane."""
    direction = place.rotation.T @ np.asarray(axis, dtype=float)
    unit_direction = direction / np.linalg.norm(direction)
    # The y axis of the tip is the normal of the plane: the one direction left to hold lies across the slide in it.
    across = np.cross([0.0, 1.0, 0.0], unit_direction)
    return HeldDirections(across[:, None], NORMAL, turn_with_place=True)


def _across(axis: Sequence[float], place: NumericPose) -> FloatArray:
    """Two unit vectors at right angles to an axis, in the axes of the place, shape (3, 2)."""
    direction = place.rotation.T @ np.asarray(axis, dtype=float)
    # The first right singular vector of a row is along it; the others span what is orthogonal to it.
    _, _, rows = np.linalg.svd(direction[None, :])
    return np.asarray(rows[1:].T)


def stays_in_plane(rod: RodProperties) -> bool:
    """Whether nothing takes a rod out of the local x–z plane of its base."""
    # Component 4 of the strain is the shear along y, out of the plane.
    shears_out = not is_zero(rod.intrinsic[4]) or 4 in rod.admitted
    if shears_out:
        return False
    return rod.turning_axes in ((), (1,))
