"""Mean frames: rates of a free rod as those of its mean motion and those of its shape about it.

Coordinates of a free rod are the pose of its base and the strains. In them a shape that moves next to no mass is a sum
of large motions that cancel: of the base, and of the rod against the base. How they cancel changes with every turn of
the rod by more than what is left, so that a mass matrix is good for tiny turns alone. In the rates of the mean motion,
in axes that turn with the base, and those of the strains the mass matrix has no part between the two, and changes with
the shape alone: in them one Jacobian serves far longer. This is the choice of a Tisserand frame, made for corrections
alone: F. Canavin, P. Likins, *Floating reference frames for flexible spacecraft*, J. Spacecraft 14 (1977) 724–732.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from cosserat_casadi.maths.typing import FloatArray


@dataclass(frozen=True)
class MeanFrame:
    """The map T from rates of the unknowns to those of the mean motion and the shape, at one instant.

    T v is v but for the entries of poses, which become turn · (v_pose + share v).

    Attributes:
        poses: entries of the poses, shape (p,).
        turn: from the axes of poses to axes that turn with them, orthogonal, shape (p, p).
        share: what the rates of the other entries are in the mean motion; zero for poses, shape (p, n).
    """

    poses: npt.NDArray[np.intp]
    turn: FloatArray
    share: FloatArray

    def to_mean(self, rates: FloatArray) -> FloatArray:
        """T v, shape (n,)."""
        mean = rates.copy()
        mean[self.poses] = self.turn @ (rates[self.poses] + self.share @ rates)
        return mean

    def from_mean(self, mean: FloatArray) -> FloatArray:
        """T⁻¹ v, shape (n,)."""
        rates = mean.copy()
        rates[self.poses] = self.turn.T @ mean[self.poses] - self.share @ mean
        return rates

    def forces_to_mean(self, rows: FloatArray) -> FloatArray:
        """T⁻ᵀ applied to rows of the equations, which are forces that belong to the rates, shape (n,)."""
        mean = rows - self.share.T @ rows[self.poses]
        mean[self.poses] = self.turn @ rows[self.poses]
        return mean

    def forces_from_mean(self, rows: FloatArray) -> FloatArray:
        """Tᵀ applied to rows of the equations, shape (n,)."""
        forces = rows.copy()
        forces[self.poses] = self.turn.T @ rows[self.poses]
        return np.asarray(forces + self.share.T @ forces[self.poses])
