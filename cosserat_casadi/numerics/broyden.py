"""A Jacobian that is kept: Broyden's rank-one updates carry it from one iterate to the next."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import TypeAlias

import casadi as ca
import numpy as np

from cosserat_casadi.maths.typing import FloatArray

Jacobian: TypeAlias = FloatArray | ca.DM
"""Dense, shape (n, n); or sparse, n×n: of an assembly, whose blocks keep the work linear in the number of rods."""

THIN = 1e-13
"""Share of the largest diagonal entry of the triangular factor below which a sparse Jacobian counts as singular."""

SINGULAR = 1e-12
"""Reciprocal of the condition beyond which a Jacobian counts as singular."""


@dataclass
class Secant:
    """A Jacobian of an earlier iterate and the full steps taken since then.

    The inverse of Broyden's update is applied from the steps alone: C. T. Kelley, *Iterative Methods for Linear and
    Nonlinear Equations*, SIAM 1995, section 7.3.

    Attributes:
        jacobian: Jacobian where the first step began.
        steps: the steps since, each the full one that :meth:`step` gave, shape (n,).
    """

    jacobian: Jacobian
    steps: list[FloatArray] = field(default_factory=list)

    @property
    def finite(self) -> bool:
        """Whether every entry of the Jacobian is a finite number."""
        entries = self.jacobian.nonzeros() if isinstance(self.jacobian, ca.DM) else self.jacobian
        return bool(np.all(np.isfinite(entries)))

    def step(self, residual: FloatArray) -> FloatArray | None:
        """Minus the inverse of the updated Jacobian times a vector of shape (n,); None where it is not finite."""
        z = self._through(residual, self.steps)
        if z is None or not self.steps:
            return z
        last = self.steps[-1]
        with np.errstate(all="ignore"):
            z = z / (1.0 - (last @ z) / (last @ last))
        return z if np.all(np.isfinite(z)) else None

    def response(self, rate: FloatArray, residual: FloatArray) -> FloatArray | None:
        """Minus the inverse times any vector of shape (n,); None where it is not finite.

        The update that belongs to the last step takes the step that would follow it.

        Args:
            rate: the vector.
            residual: residual at the iterate.
        """
        following = self.step(residual) if self.steps else None
        steps = self.steps if following is None else [*self.steps, following]
        found = self._through(rate, steps)
        return None if found is None or not np.all(np.isfinite(found)) else found

    def _through(self, vector: FloatArray, steps: Sequence[FloatArray]) -> FloatArray | None:
        """Minus the inverse times a vector, updated by each step and its follower."""
        z = newton_step(self.jacobian, vector)
        if z is None:
            return None
        for before, after in pairwise(steps):
            z = z + after * ((before @ z) / (before @ before))
        return z


def newton_step(jacobian: Jacobian, residual: FloatArray) -> FloatArray | None:
    """The Newton step; the shortest one where the Jacobian is singular to rounding; None where there is none.

    A rod that symmetry lets turn without energy has a singular Jacobian: along that direction nothing moves.
    """
    if not len(residual):
        return np.zeros(0)
    if isinstance(jacobian, ca.DM):
        sparse_step = _sparse_step(jacobian, residual)
        if sparse_step is not None:
            return sparse_step
        jacobian = dense(jacobian)
    if not (np.all(np.isfinite(jacobian)) and np.all(np.isfinite(residual))):
        return None
    step: FloatArray | None = _regular_step(jacobian, residual)
    if step is None:
        step = np.asarray(np.linalg.lstsq(jacobian, -residual, rcond=SINGULAR)[0], dtype=np.float64)
    return step if np.all(np.isfinite(step)) else None


def _regular_step(jacobian: FloatArray, residual: FloatArray) -> FloatArray | None:
    """The step of a Jacobian that is not singular to rounding, else None.

    The same factors solve for a probe: it meets every direction, so a small singular value lengthens its solution.
    """
    probe = np.cos(np.arange(1.0, len(residual) + 1.0) ** 2)
    try:
        steps = np.linalg.solve(jacobian, np.column_stack([-residual, probe / np.linalg.norm(probe)]))
    except np.linalg.LinAlgError:
        return None
    with np.errstate(all="ignore"):
        stretch = float(np.linalg.norm(steps[:, 1]) * np.abs(jacobian).max())
    return np.asarray(steps[:, 0], dtype=np.float64) if stretch <= 1.0 / SINGULAR else None


def dense(jacobian: Jacobian) -> FloatArray:
    """A Jacobian as an array, shape (n, n)."""
    return np.asarray(jacobian.full() if isinstance(jacobian, ca.DM) else jacobian, dtype=np.float64)


def _sparse_step(jacobian: ca.DM, residual: FloatArray) -> FloatArray | None:
    """The Newton step by a sparse QR factorisation; None where that cannot tell the Jacobian from a singular one."""
    if not (np.all(np.isfinite(jacobian.nonzeros())) and np.all(np.isfinite(residual))):
        return None
    _, triangular, *_ = factors = ca.qr_sparse(jacobian)
    diagonal = np.abs(np.array(ca.diag(triangular).full()[:, 0]))
    if diagonal.min() <= THIN * diagonal.max():
        return None
    step: FloatArray = np.asarray(ca.qr_solve(ca.DM(-residual), *factors).full()[:, 0])
    return step if np.all(np.isfinite(step)) else None
