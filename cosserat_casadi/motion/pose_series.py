"""Poses of sections and bodies, and states of actuators, at many times at once."""

from __future__ import annotations

from typing import NamedTuple

import casadi as ca
import numpy as np
import numpy.typing as npt

from cosserat_casadi.maths.calls import evaluated
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model

AT_ONCE = 1024
"""Number of times whose nodes are in memory together: fields at nodes are much larger than the wanted sections."""


class Poses(NamedTuple):
    """Poses over T times in the world frame; of one frame, or of k sections.

    Attributes:
        position: shape (T, 3) or (T, k, 3), m.
        quaternion: world_Q_section, w x y z, shape (T, 4) or (T, k, 4).
    """

    position: FloatArray
    quaternion: FloatArray


class ActuatorStates(NamedTuple):
    """Effort and conjugate of an actuator or a joint over T times.

    Attributes:
        effort: tension (N), pressure (Pa), or moment (N m) or force (N) of a joint, shape (T,).
        conjugate: length (m), volume (m³), angle (rad) or displacement (m) on which the effort works, shape (T,).
    """

    effort: FloatArray
    conjugate: FloatArray


def poses_of(function: ca.Function, x: FloatArray, inputs: FloatArray) -> Poses:
    """Poses of a tip or a body from its function of the model.

    Args:
        function: (x, inputs) ↦ position, quaternion and rotation.
        x: unknowns at T times, shape (T, model.size).
        inputs: stacked inputs there, shape (T, model.inputs.size).

    Returns:
        the poses, of shapes (T, 3) and (T, 4).
    """
    position, quaternion, _ = evaluated(function, x, inputs)
    return Poses(position[:, :, 0], quaternion[:, :, 0])


def section_poses(model: Model, rod: str, X: npt.ArrayLike, x: FloatArray, inputs: FloatArray) -> Poses:
    """Poses of k sections of a rod by the interpolant through the nodes, as in a solution.

    Args:
        model: the model.
        rod: name of the rod.
        X: one abscissa in [0, 1], or an array of shape (k,).
        x: unknowns at T times, shape (T, model.size).
        inputs: stacked inputs there, shape (T, model.inputs.size).

    Returns:
        the poses, of shapes (T, k, 3) and (T, k, 4), or (T, 3) and (T, 4) for one abscissa.
    """
    # The nodes are asked for once a time, and the sections follow by one matrix: less than a call for each section.
    interpolation = model.discrete.rods[rod].grid.interpolation_matrix(X)
    position = np.empty((len(x), *np.shape(X), 3))
    quaternion = np.empty((len(x), *np.shape(X), 4))
    for first in range(0, len(x), AT_ONCE):
        rows = slice(first, first + AT_ONCE)
        nodal_position, nodal_quaternion, *_ = evaluated(model.fields[rod], x[rows], inputs[rows])
        np.einsum("...n,tin->t...i", interpolation, nodal_position, out=position[rows])
        np.einsum("...n,tin->t...i", interpolation, nodal_quaternion, out=quaternion[rows])
        # Between nodes an interpolated quaternion is a unit quaternion to the accuracy of the grid only.
        quaternion[rows] /= np.linalg.norm(quaternion[rows], axis=-1, keepdims=True)
    return Poses(position, quaternion)


def states_of(function: ca.Function, x: FloatArray, inputs: FloatArray) -> ActuatorStates:
    """Effort and conjugate of an actuator or a joint from its function; arguments as in :func:`poses_of`."""
    # The third output of an actuator, the rate of the conjugate with the unknowns, is for control.
    effort, conjugate, *_ = evaluated(function, x, inputs)
    return ActuatorStates(effort[:, 0, 0], conjugate[:, 0, 0])
