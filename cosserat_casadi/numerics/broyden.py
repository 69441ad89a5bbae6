"""Broyden's method: a factorised Jacobian that serves several steps, corrected by rank-one updates.

C. G. Broyden, *A class of methods for solving nonlinear simultaneous equations*, Mathematics of Computation 19 (1965)
577–593. The updates are never formed: their inverse is applied from the steps alone, after C. T. Kelley, *Iterative
Methods for Linear and Nonlinear Equations*, SIAM 1995, section 7.3. See docs/theory.md, section 9.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import pairwise
from typing import TypeAlias

import casadi as ca
import numpy as np

from cosserat_casadi.maths.typing import FloatArray

Jacobian: TypeAlias = FloatArray | ca.DM
"""Dense, shape (n, n); or sparse, n×n: of an assembly, whose blocks keep the work linear in the number of rods."""

SparseFactors: TypeAlias = tuple[ca.DM, ca.DM, ca.DM, list[int], list[int]]
"""Sparse QR factors of CasADi."""

THIN = 1e-13
"""Ratio of diagonal entries of the triangular factor below which a sparse Jacobian counts as singular."""

SINGULAR = 1e-11
"""Reciprocal condition number below which a Jacobian counts as singular."""


@dataclass
class UpdatedJacobian:
    """The Jacobian B of an earlier iterate and the full steps taken since then.

    Attributes:
        jacobian: Jacobian at the start of the first step.
        steps: full steps s₀, s₁, … of :meth:`step` since then, shape (n,) each.
    """

    jacobian: Jacobian
    steps: list[FloatArray] = field(default_factory=list)

    @property
    def finite(self) -> bool:
        """Whether every entry of the Jacobian is a finite number."""
        entries = self.jacobian
        if isinstance(entries, ca.DM):
            entries = entries.nonzeros()
        return bool(np.all(np.isfinite(entries)))

    def step(self, residual: FloatArray) -> FloatArray | None:
        """Compute the quasi-Newton step −B⁻¹ g with all updates.

        Args:
            residual: residual g at the iterate after the last step, shape (n,).

        Returns:
            the step, shape (n,); None if it is not finite.
        """
        step = self._apply_inverse(residual, self.steps)
        if step is None or not self.steps:
            return step
        last = self.steps[-1]
        with np.errstate(all="ignore"):
            # The update of the last step s contains the step s₊ asked for: s₊ = z + s₊ (s·z)/(s·s), solved for s₊.
            step = step / (1.0 - (last @ step) / (last @ last))
        return _finite_or_none(step)

    def response(self, rate: FloatArray, residual: FloatArray) -> FloatArray | None:
        """Compute the change of the unknowns −B⁻¹ v with all updates, for any right-hand side v.

        The update of the last step is formed with the step that would follow it.

        Args:
            rate: right-hand side v, shape (n,).
            residual: residual at the iterate, shape (n,).

        Returns:
            the change, shape (n,); None if it is not finite.
        """
        steps = self.steps
        following_step = self.step(residual) if steps else None
        if following_step is not None:
            steps = [*steps, following_step]
        change = self._apply_inverse(rate, steps)
        return _finite_or_none(change)

    def _apply_inverse(self, vector: FloatArray, steps: Sequence[FloatArray]) -> FloatArray | None:
        """Apply −B⁻¹ and then one update for each pair of consecutive steps; None if B gives no solution."""
        solution = newton_step(self.jacobian, vector, self._factors)
        if solution is None:
            return None
        # B₊⁻¹ = (I + s₊ sᵀ/(s·s)) B⁻¹ for a step s and the step s₊ that followed it.
        for step, next_step in pairwise(steps):
            share = (step @ solution) / (step @ step)
            solution = solution + next_step * share
        return solution

    @cached_property
    def _factors(self) -> SparseFactors | None:
        return sparse_factors(self.jacobian) if isinstance(self.jacobian, ca.DM) else None


def newton_step(
    jacobian: Jacobian, residual: FloatArray, factors: SparseFactors | None = None, singular: float = SINGULAR
) -> FloatArray | None:
    """Solve for the Newton step, or for the shortest one if the Jacobian is singular up to rounding.

    A rod that may rotate without energy by symmetry has a singular Jacobian; nothing moves along that direction.

    Args:
        jacobian: n×n, dense or sparse.
        residual: shape (n,).
        factors: factorisation of a sparse Jacobian by :func:`sparse_factors`, if it serves several steps.
        singular: reciprocal condition number below which a dense Jacobian counts as singular.

    Returns:
        the step, shape (n,); None if it is not finite.
    """
    if not len(residual):
        return np.zeros(0)
    if isinstance(jacobian, ca.DM):
        sparse_step = _sparse_step(factors or sparse_factors(jacobian), residual)
        if sparse_step is not None:
            return sparse_step
        # A sparse QR factorisation gives no shortest step.
        jacobian = dense(jacobian)
    if not np.all(np.isfinite(jacobian)) or not np.all(np.isfinite(residual)):
        return None
    step = regular_step(jacobian, residual, singular)
    return _shortest_step(jacobian, residual, singular) if step is None else _finite_or_none(step)


def solved(matrix: FloatArray, right: FloatArray) -> FloatArray | None:
    """Solve a dense linear system; the solution has the shape of the right-hand sides; None if it is not finite."""
    try:
        solution = np.linalg.solve(matrix, right)
    except np.linalg.LinAlgError:
        return None
    return _finite_or_none(np.asarray(solution, dtype=np.float64))


def _shortest_step(jacobian: FloatArray, residual: FloatArray, singular: float) -> FloatArray | None:
    """Compute the least-squares step of least norm, which does not move along neutral directions."""
    solution, _, _, _ = np.linalg.lstsq(jacobian, -residual, rcond=singular)
    return _finite_or_none(np.asarray(solution, dtype=np.float64))


def dense(jacobian: Jacobian) -> FloatArray:
    """Convert a Jacobian to an array, shape (n, n)."""
    if isinstance(jacobian, ca.DM):
        jacobian = jacobian.full()
    return np.asarray(jacobian, dtype=np.float64)


def regular_step(jacobian: FloatArray, residual: FloatArray, singular: float = SINGULAR) -> FloatArray | None:
    """Compute the Newton step with a finite regular Jacobian; None if the Jacobian is singular up to rounding.

    Args:
        jacobian: shape (n, n).
        residual: shape (n,).
        singular: reciprocal condition number below which the Jacobian counts as singular.
    """
    step = _well_conditioned_step(jacobian, residual, np.ones(len(residual)), singular)
    if step is not None:
        return step
    # Tension makes some rows of a taut rod large, and the columns of the same unknowns: forces of contacts, only one of
    # them. A neutral direction stays singular without their size.
    sizes = np.abs(jacobian)
    units = np.sqrt(np.maximum(1.0, np.minimum(sizes.max(axis=0), sizes.max(axis=1))))
    return _well_conditioned_step(jacobian, residual, units, singular) if units.max() > 1.0 else None


def _well_conditioned_step(
    jacobian: FloatArray, residual: FloatArray, units: FloatArray, singular: float
) -> FloatArray | None:
    """Solve with a Jacobian; None if the Jacobian over the units of its rows and of its columns is singular.

    The factors also solve for a probe with components in all directions: small singular values lengthen its solution.
    """
    # cos k² has no regularity, so that no singular vector of a regular structure is orthogonal to it.
    numbers = np.arange(1.0, len(residual) + 1.0)
    probe = np.cos(numbers**2)
    probe = probe / np.linalg.norm(probe)
    right_sides = np.column_stack([-residual, units * probe])
    try:
        solutions = np.linalg.solve(jacobian, right_sides)
    except np.linalg.LinAlgError:
        return None
    with np.errstate(all="ignore"):
        inverse_size = np.linalg.norm(units * solutions[:, 1])
        size = (np.abs(jacobian) / np.outer(units, units)).max()
        condition = float(inverse_size * size)
    # Not "condition > bound": a condition that is not a number must count as singular too.
    if not condition <= 1.0 / singular:
        return None
    return np.asarray(solutions[:, 0], dtype=np.float64)


def sparse_factors(jacobian: ca.DM) -> SparseFactors | None:
    """Compute sparse QR factors of a Jacobian; None if it may be singular by them."""
    if not np.all(np.isfinite(jacobian.nonzeros())):
        return None
    factors: SparseFactors = ca.qr_sparse(jacobian)
    triangular = factors[1]
    diagonal = ca.diag(triangular).full()[:, 0]
    sizes = np.abs(np.array(diagonal))
    # No estimate of the condition, but free, and enough to hand doubtful ones to the dense method.
    return factors if sizes.min() > THIN * sizes.max() else None


def _sparse_step(factors: SparseFactors | None, residual: FloatArray) -> FloatArray | None:
    """Compute the Newton step by sparse factors; None without them."""
    if factors is None or not np.all(np.isfinite(residual)):
        return None
    solution = ca.qr_solve(ca.DM(-residual), *factors)
    return _finite_or_none(np.asarray(solution.full()[:, 0]))


def _finite_or_none(vector: FloatArray | None) -> FloatArray | None:
    if vector is None or not np.all(np.isfinite(vector)):
        return None
    return vector
