"""Stability of an equilibrium under loads that derive from a potential: the sign of the second variation."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cosserat_casadi.maths.typing import FloatArray


@dataclass(frozen=True)
class Stability:
    """Second variation of the energy, in units of EI/ℓ, over the admissible variations.

    Attributes:
        smallest_eigenvalue: smallest eigenvalue of the symmetric part of the scaled Jacobian.
        neutral: whether that eigenvalue is zero to rounding.
    """

    smallest_eigenvalue: float
    neutral: bool

    @property
    def stable(self) -> bool:
        """Whether every admissible variation costs energy."""
        return self.smallest_eigenvalue > 0.0 and not self.neutral


def second_variation(jacobian: FloatArray, strains: int) -> Stability:
    """Eigenvalue test of an equilibrium.

    Args:
        jacobian: of the whole system at the equilibrium, (n + m)×(n + m).
        strains: n, number of strain coordinates; the m rows below hold the linearised supports, and only
            variations in their null space are admissible.
    """
    return judged(admissible_eigenvalues(jacobian, strains))


def admissible_eigenvalues(jacobian: FloatArray, strains: int) -> FloatArray:
    """Eigenvalues of the second variation over the admissible variations, ascending.

    Args:
        jacobian: as in :func:`second_variation`.
        strains: as there.
    """
    hessian = jacobian[:strains, :strains]
    constraints = jacobian[strains:, :strains]
    # A slack cable asks nothing of the rod: its equation is about its tension alone.
    constraints = constraints[np.linalg.norm(constraints, axis=1) > np.abs(np.diagonal(jacobian)[strains:])]
    if len(constraints):
        _, singular, basis = np.linalg.svd(constraints)
        rank = int(np.sum(singular > 1e-12 * singular[0]))
        free = basis[rank:].T
        hessian = free.T @ hessian @ free
    if not hessian.size:
        return np.zeros(0)
    return np.asarray(np.linalg.eigvalsh((hessian + hessian.T) / 2))


def judged(eigenvalues: FloatArray) -> Stability:
    """What eigenvalues of the second variation, ascending, say."""
    if not eigenvalues.size:
        return Stability(np.inf, neutral=False)
    scale = max(1.0, float(np.abs(eigenvalues).max()))
    smallest = float(eigenvalues[0])
    return Stability(smallest, neutral=abs(smallest) <= 1e-10 * scale)
