"""Joint coordinates of MuJoCo for links and bodies at the poses of an equilibrium."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.optimize import least_squares

from cosserat_casadi.maths.pose import IDENTITY, NumericPose
from cosserat_casadi.maths.pose_change import rotation_vectors
from cosserat_casadi.maths.rotation import quaternion_conjugate, quaternion_product
from cosserat_casadi.maths.typing import FloatArray

MjcfJoint = tuple[str, dict[str, str]]
"""Tag and attributes of a joint."""


def coordinates_at(
    place: NumericPose, joints: Sequence[MjcfJoint], wanted: NumericPose, length: float, near: FloatArray
) -> FloatArray:
    """Coordinates of the joints of a body for a pose, or for the nearest pose that the joints allow.

    Args:
        place: pose of the body relative to its parent at zero coordinates.
        joints: joints of the body in their order: one ``freejoint``, one ball, or hinges and slides.
        wanted: pose relative to the parent; in world axes for a ``freejoint``.
        length: scale of distances against angles, m.
        near: initial guess for hinges and slides, shape (n,), which fixes the full turns of hinges.

    Returns:
        coordinates as in ``qpos``: position and quaternion, a quaternion, or angles and displacements, rad and m.
    """
    tag, attributes = joints[0]
    if tag == "freejoint":
        return np.concatenate([wanted.position, wanted.quaternion])
    if attributes["type"] == "ball":
        return quaternion_product(quaternion_conjugate(place.quaternion), wanted.quaternion)

    def gaps(coordinates: FloatArray) -> FloatArray:
        reached = place
        for (_, joint), coordinate in zip(joints, coordinates, strict=True):
            reached = reached.then(_moved(joint, coordinate))
        turned = rotation_vectors(reached.quaternion, wanted.quaternion)
        return np.concatenate([turned, (reached.position - wanted.position) / length])

    return np.asarray(least_squares(gaps, near, xtol=1e-14, ftol=1e-14, gtol=1e-14).x)


def _moved(joint: dict[str, str], coordinate: float) -> NumericPose:
    """Motion of a body by one hinge or slide, in the axes before this motion."""
    axis = np.array(joint["axis"].split(), dtype=float)
    axis /= np.linalg.norm(axis)
    if joint["type"] == "slide":
        return NumericPose(coordinate * axis, IDENTITY.quaternion)
    anchor = np.array(joint["pos"].split(), dtype=float)
    turn = NumericPose(anchor, np.array([np.cos(coordinate / 2), *(np.sin(coordinate / 2) * axis)]))
    return turn.then(NumericPose(-anchor, IDENTITY.quaternion))
