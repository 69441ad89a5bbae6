"""Broyden's rank-one updates of the linear system of all stages of a step.

Each update makes the inverse B⁻¹ agree with what the last correction did to F, and leaves it as it was across that
correction: B₊⁻¹ = (1 + s₊ ŝᵀ) B⁻¹ with the correction s, the one that followed it, s₊, and ŝ the dual of s. Across is
meant in the weighted changes of velocity that :mod:`stage_newton` measures, so that units play no part. The updates
are never formed. C. T. Kelley, *Iterative Methods for Linear and Nonlinear Equations*, SIAM 1995, section 7.3;
:mod:`broyden` has them for equilibria.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from cosserat_casadi.maths.typing import FloatArray


@dataclass
class SecantUpdates:
    """The updates of one step.

    Attributes:
        matrix: A of the collocation method, shape (s, s): changes of h² a to those of h v.
        weights: what each entry of a change of h v is multiplied by, 0 for algebraic ones, shape (n,).
        taken: corrections taken so far, each of shape (s, n).
        duals: of each correction s the ŝ with ŝ·s = 1, orthogonal to all vectors across s, each of shape (s, n).
    """

    matrix: FloatArray
    weights: FloatArray
    taken: list[FloatArray] = field(default_factory=list)
    duals: list[FloatArray] = field(default_factory=list)

    def applied_to(self, corrections: FloatArray) -> FloatArray:
        """Corrections with all updates; not finite where the last one says that F would not change along them.

        Args:
            corrections: those of the linear system before any update, with F after the last correction, shape (s, n).
        """
        with np.errstate(all="ignore"):
            for dual, following in zip(self.duals, self.taken[1:], strict=False):
                corrections = corrections + np.vdot(dual, corrections) * following
            if self.duals:
                # The last update contains what it is to be applied for: s₊ = z + s₊ (ŝ·z), solved for s₊.
                corrections = corrections / (1.0 - np.vdot(self.duals[-1], corrections))
        return corrections

    def take(self, corrections: FloatArray) -> None:
        """Add the update of corrections that are taken, shape (s, n); some differential entry of them is not zero."""
        weighted = (self.matrix @ corrections) * self.weights
        dual = self.matrix.T @ (weighted * self.weights)
        self.taken.append(corrections)
        self.duals.append(dual / np.vdot(weighted, weighted))
