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
"""Share of the largest diagonal entry of the triangular factor below which a sparse Jacobian counts as singular."""

SINGULAR = 1e-11
"""Reciprocal of the condition beyond which a Jacobian counts as singular."""


@dataclass
class UpdatedJacobian:
    """The Jacobian B of an earlier iterate and the full steps taken since then.

    Attributes:
        jacobian: Jacobian where the first step began.
        steps: the steps s₀, s₁, … since, each the full one that :meth:`step` gave, shape (n,).
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
        """The quasi-Newton step −B⁻¹ g with all updates.

        Args:
            residual: g at the iterate that the last step led to, shape (n,).

        Returns:
            the step, shape (n,); None where it is not finite.
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
        """Change of the unknowns −B⁻¹ v with all updates, for any right side v.

        The update that belongs to the last step takes the step that would follow it.

        Args:
            rate: v, shape (n,).
            residual: residual at the iterate, shape (n,).

        Returns:
            the change, shape (n,); None where it is not finite.
        """
        steps = self.steps
        following_step = self.step(residual) if steps else None
        if following_step is not None:
            steps = [*steps, following_step]
        change = self._apply_inverse(rate, steps)
        return _finite_or_none(change)

    def _apply_inverse(self, vector: FloatArray, steps: Sequence[FloatArray]) -> FloatArray | None:
        """Apply −B⁻¹ and then one update for each pair of neighbouring steps; None where B gives no solution."""
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


def newton_step(jacobian: Jacobian, residual: FloatArray, factors: SparseFactors | None = None) -> FloatArray | None:
    """Solve for the Newton step; the shortest one where the Jacobian is singular to rounding.

    A rod that symmetry lets turn without energy has a singular Jacobian: along that direction nothing moves.

    Args:
        jacobian: n×n, dense or sparse.
        residual: shape (n,).
        factors: the factorisation of a sparse Jacobian, by :func:`sparse_factors`, where it serves several steps.

    Returns:
        the step, shape (n,); None where it is not finite.
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
    step = _regular_step(jacobian, residual)
    return shortest_step(jacobian, residual) if step is None else _finite_or_none(step)


def solved(matrix: FloatArray, right: FloatArray) -> FloatArray | None:
    """Solution of a dense linear system, shape as the right-hand sides; None where it has no finite one."""
    try:
        solution = np.linalg.solve(matrix, right)
    except np.linalg.LinAlgError:
        return None
    return _finite_or_none(np.asarray(solution, dtype=np.float64))


def shortest_step(jacobian: FloatArray, residual: FloatArray, singular: float = SINGULAR) -> FloatArray | None:
    """The least-squares step of least norm: along a neutral direction nothing moves.

    Args:
        jacobian: shape (n, m).
        residual: shape (n,).
        singular: share of the largest singular value below which one is zero.

    Returns:
        shape (m,); None where a number is not finite.
    """
    if not np.all(np.isfinite(jacobian)):
        return None
    solution, _, _, _ = np.linalg.lstsq(jacobian, -residual, rcond=singular)
    return _finite_or_none(np.asarray(solution, dtype=np.float64))


def dense(jacobian: Jacobian) -> FloatArray:
    """Convert a Jacobian to an array, shape (n, n)."""
    if isinstance(jacobian, ca.DM):
        jacobian = jacobian.full()
    return np.asarray(jacobian, dtype=np.float64)


def _regular_step(jacobian: FloatArray, residual: FloatArray) -> FloatArray | None:
    """Solve with a Jacobian that is not singular to rounding; None where it is.

    The same factors solve for a probe: it meets every direction, so a small singular value lengthens its solution.
    """
    # cos k² has no regularity, so that no singular vector of a regular structure is orthogonal to it.
    numbers = np.arange(1.0, len(residual) + 1.0)
    probe = np.cos(numbers**2)
    probe = probe / np.linalg.norm(probe)
    right_sides = np.column_stack([-residual, probe])
    try:
        solutions = np.linalg.solve(jacobian, right_sides)
    except np.linalg.LinAlgError:
        return None
    with np.errstate(all="ignore"):
        inverse_size = np.linalg.norm(solutions[:, 1])
        size = np.abs(jacobian).max()
        condition = float(inverse_size * size)
    # Not "condition > bound": a condition that is not a number must count as singular too.
    if not condition <= 1.0 / SINGULAR:
        return None
    return np.asarray(solutions[:, 0], dtype=np.float64)


def sparse_factors(jacobian: ca.DM) -> SparseFactors | None:
    """The sparse QR factors of a Jacobian; None where they cannot tell it from a singular one."""
    if not np.all(np.isfinite(jacobian.nonzeros())):
        return None
    factors: SparseFactors = ca.qr_sparse(jacobian)
    triangular = factors[1]
    diagonal = ca.diag(triangular).full()[:, 0]
    sizes = np.abs(np.array(diagonal))
    # No estimate of the condition, but free, and enough to hand doubtful ones to the dense method.
    return factors if sizes.min() > THIN * sizes.max() else None


def _sparse_step(factors: SparseFactors | None, residual: FloatArray) -> FloatArray | None:
    """The Newton step by sparse factors; None where there are none."""
    if factors is None or not np.all(np.isfinite(residual)):
        return None
    solution = ca.qr_solve(ca.DM(-residual), *factors)
    return _finite_or_none(np.asarray(solution.full()[:, 0]))


def _finite_or_none(vector: FloatArray | None) -> FloatArray | None:
    if vector is None or not np.all(np.isfinite(vector)):
        return None
    return vector
