"""The linear systems of a step of what flies free: one Jacobian, carried to the stages by their mean frames."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.numerics.collocation import Collocation
from cosserat_casadi.numerics.mean_frame import MeanFrame
from cosserat_casadi.numerics.step_matrices import StepMatrices


@dataclass(frozen=True)
class CarriedMatrices:
    """The linear systems of a step, carried from where its Jacobian was evaluated to the stages.

    With T at that place and T_i at a stage, T⁻ᵀ D T⁻¹ changes little from one to the other: D_i ≈ T_iᵀ T⁻ᵀ D T⁻¹ T_i.

    Attributes:
        matrices: of the one Jacobian.
        frame: where it was evaluated.
        frames: at the stages.
    """

    matrices: StepMatrices
    frame: MeanFrame
    frames: Sequence[MeanFrame]

    @property
    def method(self) -> Collocation:
        """The collocation method."""
        return self.matrices.method

    @property
    def step(self) -> float:
        """Size h of the step, s."""
        return self.matrices.step

    def corrections(self, residuals: FloatArray) -> FloatArray:
        """Newton's corrections of all stages, as those of :class:`StepMatrices`.

        Args:
            residuals: F at the stages, shape (s, n).
        """
        pairs = zip(self.frames, residuals, strict=True)
        rows = [self.frame.forces_from_mean(stage.forces_to_mean(residual)) for stage, residual in pairs]
        corrections = self.matrices.corrections(np.stack(rows))
        pairs = zip(self.frames, corrections, strict=True)
        return np.stack([stage.from_mean(self.frame.to_mean(correction)) for stage, correction in pairs])
