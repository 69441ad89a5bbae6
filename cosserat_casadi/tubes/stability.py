"""Whether an equilibrium of the tubes is stable: the second variation of its energy, by its conjugate points.

The angles have the energy that `tubes.flow` writes. At a tip they are free, at the drives they are held. The steps of
the integration are symplectic: they are those of a discrete energy, whose second variation is block tridiagonal. Its
pivots from the tip on follow from how the angles change with those at the tips, and their negative eigenvalues are as
many as the directions in which the energy falls. For the continuous energy these are the conjugate points of I. M.
Gelfand, S. V. Fomin, *Calculus of Variations*, 1963, sections 26 to 29. See docs/tubes.md.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.tubes.model import TubeModel

NEUTRAL = 1e-9
"""Singular value of the derivative of the drives' angles, relative to the largest, below which it is zero."""

NO_LENGTH = 1e-12
"""Length of a step, relative to the robot's, below which it has none."""

NUDGE = 1e-14
"""What is added to a matrix that is singular to the last digit: the pivots' signs on either side of it add up alike."""


@dataclass(frozen=True)
class Stability:
    """What the second variation says of an equilibrium.

    Attributes:
        falling: independent directions in which the energy falls.
        neutral: whether there is one more in which it stays the same: the robot is about to snap.
        determinant: of the derivative of the drives' angles with those at the tips; 1 of tubes that do not twist, 0
            where a robot snaps.
    """

    falling: int
    neutral: bool
    determinant: float

    @property
    def stable(self) -> bool:
        """Whether the energy rises in every direction."""
        return self.falling == 0 and not self.neutral


def stability_of(model: TubeModel, x: FloatArray, inputs: FloatArray) -> Stability:
    """Judge an equilibrium.

    Args:
        model: the robot.
        x: angles at the tips, shape (n,), rad.
        inputs: shape (2 n,).
    """
    size = model.size
    along, of_steps = model.variations(x, inputs, 1.0)
    # Stations from the tip to the plate; of each the changes of angles, then those of torques.
    changes = along.full().reshape(-1, 2 * size, size)
    angles = changes[:, :size]
    last_torques = changes[-1, size:]
    from_torques = of_steps.full().reshape(size, -1, size).transpose(1, 0, 2)
    jacobian = model.jacobian(x, inputs, 1.0)[0].full()
    singular = np.linalg.svd(jacobian, compute_uv=False)

    falling = 0
    outermost = float(inputs[1::2].max())
    negligible = NO_LENGTH * outermost / float(model.robot.torsion.min())
    for before, after, step in zip(angles[:-1], angles[1:], from_torques, strict=True):
        # A piece without length changes nothing.
        if np.abs(step).max() > negligible:
            falling += _negative(np.linalg.solve(-step, _divided(after, before)))
    falling += _negative(_held(model, inputs, angles[-1], last_torques))
    return Stability(
        falling=falling,
        neutral=bool(singular[-1] <= NEUTRAL * singular[0]),
        determinant=float(np.linalg.det(jacobian)),
    )


def _held(model: TubeModel, inputs: FloatArray, angles: FloatArray, torques: FloatArray) -> FloatArray:
    """Last pivot: stiffness of the robot at the plate beside that of the torsion in the housing, n×n, scaled.

    With the compliance C of the housing the pivot is A + C⁻¹. A drive at the plate has no compliance, and C⁻¹ no value:
    1 + √C A √C has the same signs, and exists.
    """
    robot = model.robot
    root = np.sqrt((robot.length - inputs[1::2]).clip(min=0.0) / robot.torsion)
    at_plate = -_divided(torques, angles)
    return np.eye(model.size) + root[:, None] * at_plate * root


def _divided(numerator: FloatArray, denominator: FloatArray) -> FloatArray:
    """The quotient A B⁻¹ of n×n matrices."""
    size = len(denominator)
    try:
        return np.asarray(np.linalg.solve(denominator.T, numerator.T).T)
    except np.linalg.LinAlgError:
        nudged = denominator + NUDGE * np.abs(denominator).max() * np.eye(size)
        return np.asarray(np.linalg.solve(nudged.T, numerator.T).T)


def _negative(matrix: FloatArray) -> int:
    """Negative eigenvalues of a matrix that is symmetric up to rounding."""
    eigenvalues = np.linalg.eigvalsh((matrix + matrix.T) / 2)
    return int(np.sum(eigenvalues < 0.0))
