"""Cost of a residual in a fit: its square, or less for a large one, so that outliers weigh less.

The cost of a residual r in standard deviations is ½ ρ(r²); its derivative is r times the weight ρ′(r²). P. J. Huber,
E. M. Ronchetti, *Robust Statistics*, 2nd ed., Wiley 2009, chapter 7.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cosserat_casadi.maths.typing import FloatArray


@dataclass(frozen=True)
class Loss:
    """A cost of residuals.

    Attributes:
        kind: "squares", "huber" or "cauchy".
        width: residual above which the cost is less than the square; unused for "squares".
    """

    kind: str = "squares"
    width: float = 2.0

    def cost(self, residual: FloatArray) -> float:
        """Cost of residuals, half the sum of ρ(r²)."""
        squares = residual * residual
        if self.kind == "squares":
            rho = squares
        elif self.kind == "huber":
            beyond = 2 * self.width * np.abs(residual) - self.width**2
            rho = np.where(squares <= self.width**2, squares, beyond)
        else:
            rho = self.width**2 * np.log1p(squares / self.width**2)
        return float(np.sum(rho)) / 2

    def weights(self, residual: FloatArray) -> FloatArray:
        """Weight ρ′(r²) of each residual, from 1 for small ones to 0; shape as the residuals."""
        if self.kind == "squares":
            return np.ones_like(residual)
        if self.kind == "huber":
            return self.width / np.maximum(np.abs(residual), self.width)
        return 1 / (1 + (residual / self.width) ** 2)

    def noise_squares(self, residual: FloatArray) -> float:
        """Sum of squares that gives the noise of the data in the covariance (Jᵀ W J)⁻¹ of a weighted fit.

        With ψ = ρ′ r the asymptotic covariance of the estimate is mean(ψ²) / mean(ψ′)² (Jᵀ J)⁻¹ (Huber and
        Ronchetti, section 7.6), and Jᵀ W J is about mean(W) Jᵀ J.
        """
        weights = self.weights(residual)
        slope = float(np.mean(self._slopes(residual)))
        if slope <= 0.0:
            # Most lie where a loss that grows slower and slower says nothing of their spread.
            return float(residual @ residual)
        influence = weights * residual
        return float(influence @ influence) * float(np.mean(weights)) / slope**2

    def _slopes(self, residual: FloatArray) -> FloatArray:
        """Derivatives of ψ by the residual; shape as the residuals."""
        if self.kind == "squares":
            return np.ones_like(residual)
        if self.kind == "huber":
            return np.where(np.abs(residual) <= self.width, 1.0, 0.0)
        squares = (residual / self.width) ** 2
        return (1 - squares) / (1 + squares) ** 2
