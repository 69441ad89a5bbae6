"""A Jacobian that is kept: Broyden's rank-one updates carry it from one iterate to the next."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from cosserat_casadi.maths.typing import FloatArray


@dataclass
class Secant:
    """A Jacobian of an earlier iterate and the full steps taken since then.

    The inverse of Broyden's update is applied from the steps alone: C. T. Kelley, *Iterative Methods for Linear and
    Nonlinear Equations*, SIAM 1995, section 7.3.

    Attributes:
        jacobian: Jacobian where the first step began, shape (n, n).
        steps: the steps since, each the full one that :meth:`step` gave, shape (n,).
    """

    jacobian: FloatArray
    steps: list[FloatArray] = field(default_factory=list)

    def step(self, residual: FloatArray) -> FloatArray | None:
        """Minus the inverse of the updated Jacobian times a vector of shape (n,); None where it is not finite."""
        z = newton_step(self.jacobian, residual)
        if z is None or not self.steps:
            return z
        for before, after in zip(self.steps, self.steps[1:], strict=False):
            z = z + after * ((before @ z) / (before @ before))
        last = self.steps[-1]
        with np.errstate(all="ignore"):
            z = z / (1.0 - (last @ z) / (last @ last))
        return z if np.all(np.isfinite(z)) else None


def newton_step(jacobian: FloatArray, residual: FloatArray) -> FloatArray | None:
    """The Newton step; the shortest one where the Jacobian is singular; None where there is none."""
    if not len(residual):
        return np.zeros(0)
    if not (np.all(np.isfinite(jacobian)) and np.all(np.isfinite(residual))):
        return None
    step: FloatArray
    try:
        step = np.asarray(np.linalg.solve(jacobian, -residual), dtype=np.float64)
    except np.linalg.LinAlgError:
        step = np.asarray(np.linalg.lstsq(jacobian, -residual, rcond=1e-12)[0], dtype=np.float64)
    return step if np.all(np.isfinite(step)) else None
