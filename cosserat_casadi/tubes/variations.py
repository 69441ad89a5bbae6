"""Variations of the configuration of a robot and of its conjugates along the robot, by those of the free tip.

Without loads the configuration of a section consists of the angles of its tubes, with the torques as conjugates. With
loads it includes the direction of the tangent, with the bending moment as conjugate. The frame may be rotated about the
tangent by any angle, with all angles of tubes rotated back, without a change of the equations here.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cosserat_casadi.maths.rotation import quaternion_to_matrix
from cosserat_casadi.maths.typing import FloatArray

DIRECTIONS = 2
"""Number of rotations of the tangent that change its direction."""


@dataclass(frozen=True)
class TipVariations:
    """Variations by m degrees of freedom of the tip, at k stations from the tip to the plate.

    Attributes:
        configuration: derivatives of the configuration of each station by the tip's, shape (k, m, m), rad: rotations of
            the tubes about the tangent, then rotations of the tangent.
        at_plate: derivatives of the torques of the tubes at the plate, conjugate to rotations, shape (n, m), N m.
        of_steps: derivatives of the configuration at the end of each step by its conjugates at the start, shape
            (k − 1, m, m), rad/(N m).
    """

    configuration: FloatArray
    at_plate: FloatArray
    of_steps: FloatArray


def of_loaded(size: int, stations: FloatArray, along: FloatArray, of_steps: FloatArray) -> TipVariations:
    """Make the variations of a robot under loads that have an energy.

    Args:
        size: number n of tubes.
        stations: stacked states, shape (2 n + 12, k).
        along: changes of the states, stacked as in `LoadedTangent`, by the angles at the tips and a rotation of the
            frame there, shape (2 n + 9, (n + 3) k).
        of_steps: changes of the states at the end of each step by the torques and the moment at its start, shape
            (2 n + 9, (n + 3) (k − 1)).
    """
    height = len(along)
    frames = [quaternion_to_matrix(quaternion) for quaternion in stations[2 * size + 3 : 2 * size + 7].T]
    # Of the turns at the tip those count that change the direction of the tangent.
    of_tip = np.eye(size + 3, size + DIRECTIONS)
    of_tip[size:, size:] = frames[0][:, :DIRECTIONS]
    changes = along.reshape(height, -1, size + 3).transpose(1, 0, 2) @ of_tip
    configuration = [_configuration(size, *pair) for pair in zip(changes, frames, strict=True)]
    steps = of_steps.reshape(height, -1, size + 3).transpose(1, 0, 2)
    responses = []
    for step, frame, end in zip(steps, frames[:-1], frames[1:], strict=True):
        # A torque is a moment about the tangent too.
        conjugate = np.zeros((size + 3, size + DIRECTIONS))
        conjugate[:size, :size] = np.eye(size)
        conjugate[size:, :size] = frame[:, 2:]
        conjugate[size:, size:] = frame[:, :DIRECTIONS]
        responses.append(_configuration(size, step @ conjugate, end))
    torques = changes[-1, size : 2 * size]
    return TipVariations(np.array(configuration), torques, np.array(responses))


def _configuration(size: int, changes: FloatArray, frame: FloatArray) -> FloatArray:
    """Convert changes of the state to changes of the configuration.

    Args:
        size: number n of tubes.
        changes: changes of the state, stacked as in `LoadedTangent`, shape (2 n + 9, m).
        frame: rotation of the frame there, shape (3, 3).

    Returns:
        Rotations of the tubes about the tangent, then of the tangent about the axes across, shape (n + 2, m), rad.
    """
    turns = frame.T @ changes[2 * size : 2 * size + 3]
    return np.concatenate([changes[:size] + turns[2], turns[:DIRECTIONS]])
