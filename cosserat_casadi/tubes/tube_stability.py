"""Stability of an equilibrium of the tubes: the second variation of its energy, by conjugate points.

The angles have the energy of `tubes.tube_flow`; under loads of constant direction in the world, the tangent enters it
too. They are free at the tip, and held at the drives and at the plate. The steps of the integration are symplectic:
they belong to a discrete energy, whose second variation is block tridiagonal. Its pivots from the tip on follow from
the derivatives of the configuration of the sections by that of the tip, and the number of their negative eigenvalues is
the number of directions in which the energy falls. For the continuous energy these are the conjugate points of I. M.
Gelfand, S. V. Fomin, *Calculus of Variations*, 1963, sections 26 to 29. See docs/tubes.md.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.tubes.tube_functions import TubeFunctions
from cosserat_casadi.tubes.variations import TipVariations

NEUTRAL = 1e-9
"""Singular value of the derivative of the drives' angles, over the largest one, below which it counts as zero."""

NO_LENGTH = 1e-12
"""Length of a step, over that of the robot, below which it counts as zero."""

NUDGE = 1e-14
"""Shift of an exactly singular matrix; the pivots' signs on either side of it have equal sums."""


@dataclass(frozen=True)
class TubeStability:
    """Stability of an equilibrium from the second variation.

    Attributes:
        falling: number of independent directions in which the energy falls; None for loads without an energy.
        neutral: whether there is a further direction in which the energy does not change: the robot is about to snap.
        determinant: determinant of the derivative of the drives' angles by the angles at the tips; 1 for tubes that do
            not twist, 0 where a robot snaps.
    """

    falling: int | None
    neutral: bool
    determinant: float

    @property
    def stable(self) -> bool | None:
        """Whether the energy rises in every direction; None where the loads have no energy."""
        if self.falling is None:
            return None
        return self.falling == 0 and not self.neutral


def stability_of(model: TubeFunctions, x: FloatArray, inputs: FloatArray) -> TubeStability:
    """Judge an equilibrium.

    Args:
        model: the robot.
        x: unknowns of the equilibrium.
        inputs: inputs of the robot.
    """
    jacobian = model.jacobian(x, inputs)[0].full()
    singular = np.linalg.svd(jacobian, compute_uv=False)
    falling = _falling(model, model.varied(x, inputs), inputs) if model.robot.has_energy else None
    return TubeStability(
        falling=falling,
        neutral=bool(singular[-1] <= NEUTRAL * singular[0]),
        determinant=float(np.linalg.det(jacobian)),
    )


def _falling(model: TubeFunctions, variations: TipVariations, inputs: FloatArray) -> int:
    """Number of directions in which the energy falls: negative eigenvalues of all pivots."""
    falling = 0
    configuration = variations.configuration
    outermost = float(model.robot.translations(inputs).max())
    negligible = NO_LENGTH * outermost / float(model.robot.torsion.min())
    for before, after, step in zip(configuration[:-1], configuration[1:], variations.of_steps, strict=True):
        # A piece without length changes nothing.
        if np.abs(step).max() > negligible:
            falling += _negative(np.linalg.solve(-step, _divided(after, before)))
    return falling + _negative(_held(model, inputs, configuration[-1], variations.at_plate))


def _held(model: TubeFunctions, inputs: FloatArray, configuration: FloatArray, torques: FloatArray) -> FloatArray:
    """Last pivot: stiffness of the robot at the plate plus torsional stiffness in the housing, n×n, scaled.

    The plate holds the tangent. With the compliance C of the housing the pivot is A + C⁻¹. A drive at the plate has
    zero compliance, for which C⁻¹ does not exist: 1 + √C A √C exists and has equal signs.
    """
    robot = model.robot
    root = np.sqrt((robot.length - robot.translations(inputs)).clip(min=0.0) / robot.torsion)
    at_plate = -_divided(torques, configuration)[:, : robot.size]
    return np.eye(robot.size) + root[:, None] * at_plate * root


def _divided(numerator: FloatArray, denominator: FloatArray) -> FloatArray:
    """The quotient A B⁻¹ with a square B."""
    size = len(denominator)
    try:
        return np.asarray(np.linalg.solve(denominator.T, numerator.T).T)
    except np.linalg.LinAlgError:
        nudged = denominator + NUDGE * np.abs(denominator).max() * np.eye(size)
        return np.asarray(np.linalg.solve(nudged.T, numerator.T).T)


def _negative(matrix: FloatArray) -> int:
    """Number of negative eigenvalues of a matrix that is symmetric up to rounding."""
    eigenvalues = np.linalg.eigvalsh((matrix + matrix.T) / 2)
    return int(np.sum(eigenvalues < 0.0))
