"""How the configuration of a robot and what is conjugate to it change along the robot with the free tip.

Without loads the configuration of a section is the angles of its tubes, and conjugate to them are the torques. With
loads the direction of the tangent belongs to it too, and conjugate to that is the bending moment. The frame may be
turned about the tangent by any angle, with all angles of tubes turned back; what is said here is the same for all.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cosserat_casadi.maths.rotation import quaternion_conjugate, quaternion_product, quaternion_to_matrix
from cosserat_casadi.maths.typing import FloatArray

DIRECTIONS = 2
"""Turns of the tangent that change its direction."""


@dataclass(frozen=True)
class Variations:
    """Changes with m degrees of freedom of the tip, at k stations from the tip to the plate.

    Attributes:
        configuration: of each station with that of the tip, shape (k, m, m), rad: turns of the tubes about the tangent,
            then those of the tangent.
        at_plate: torques of the tubes at the plate, which are conjugate to their turns, shape (n, m), N m.
        of_steps: the configuration at the end of each step with what is conjugate to it at its start, shape
            (k − 1, m, m), rad/(N m).
    """

    configuration: FloatArray
    at_plate: FloatArray
    of_steps: FloatArray


def of_angles(size: int, along: FloatArray, of_steps: FloatArray) -> Variations:
    """Variations of a robot without loads.

    Args:
        size: number n of tubes.
        along: angles and torques at all stations with the angles at the tips, shape (2 n k, n).
        of_steps: angles at the end of each step with the torques at its start, shape (n, n (k − 1)).
    """
    # Of each station the changes of angles, then those of torques.
    changes = along.reshape(-1, 2 * size, size)
    return Variations(
        configuration=changes[:, :size],
        at_plate=changes[-1, size:],
        of_steps=of_steps.reshape(size, -1, size).transpose(1, 0, 2),
    )


def of_loaded(size: int, x: FloatArray, stations: FloatArray, along: FloatArray, of_steps: FloatArray) -> Variations:
    """Variations of a robot under loads that have an energy.

    Args:
        size: number n of tubes.
        x: unknowns, shape (n + 4,).
        stations: stacked states, shape (2 n + 12, k).
        along: their derivatives with x, shape ((2 n + 12) k, n + 4).
        of_steps: those at the end of each step with the torques and the moment at its start, shape
            (2 n + 12, (n + 3) (k − 1)).
    """
    width = len(stations)
    freedoms = size + DIRECTIONS
    quaternions = stations[2 * size + 3 : 2 * size + 7]
    frames = [quaternion_to_matrix(quaternion) for quaternion in quaternions.T]
    changes = along.reshape(-1, width, size + 4) @ _of_tip(size, x)
    configuration = [_configuration(size, *pair) for pair in zip(changes, quaternions.T, strict=True)]
    steps = of_steps.reshape(width, -1, size + 3).transpose(1, 0, 2)
    responses = []
    for step, frame, end in zip(steps, frames[:-1], quaternions.T[1:], strict=True):
        # A torque is a moment about the tangent too.
        conjugate = np.zeros((size + 3, freedoms))
        conjugate[:size, :size] = np.eye(size)
        conjugate[size:, :size] = frame[:, 2:]
        conjugate[size:, size:] = frame[:, :DIRECTIONS]
        responses.append(_configuration(size, step @ conjugate, end))
    torques = changes[-1, size : 2 * size]
    return Variations(np.array(configuration), torques, np.array(responses))


def _of_tip(size: int, x: FloatArray) -> FloatArray:
    """Changes of x with the angles at the tips and the direction of the tangent there, shape (n + 4, n + 2)."""
    changes = np.zeros((size + 4, size + DIRECTIONS))
    changes[:size, :size] = np.eye(size)
    for direction in range(DIRECTIONS):
        turn = np.zeros(4)
        turn[1 + direction] = 0.5
        changes[size:, size + direction] = quaternion_product(x[size:], turn)
    return changes


def _configuration(size: int, changes: FloatArray, quaternion: FloatArray) -> FloatArray:
    """Changes of the configuration where those of a stacked state are given.

    Args:
        size: number n of tubes.
        changes: shape (2 n + 12, m).
        quaternion: of the frame there, shape (4,).

    Returns:
        Turns of the tubes about the tangent, then of the tangent about the axes across, shape (n + 2, m), rad.
    """
    back = quaternion_conjugate(quaternion)
    columns = changes[2 * size + 3 : 2 * size + 7].T
    turns = np.array([2 * quaternion_product(back, column)[1:] for column in columns]).T
    return np.concatenate([changes[:size] + turns[2], turns[:DIRECTIONS]])
