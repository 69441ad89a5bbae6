"""Stability of an equilibrium under loads that derive from a potential: the sign of the second variation."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cosserat_casadi.maths.typing import FloatArray

ZERO = 1e-10
"""An eigenvalue below this share of the largest, or of EI/ℓ where that is more, is zero to rounding."""


@dataclass(frozen=True)
class Stability:
    """Second variation of the energy, in units of EI/ℓ, over the admissible variations.

    Where symmetry lets the whole rod move on without energy, as a round column turns about its axis once it has
    buckled, an eigenvalue is zero: that variation is neutral and decides nothing.

    Attributes:
        smallest_eigenvalue: smallest eigenvalue of the symmetric part of the scaled Jacobian.
        negative: number of eigenvalues below zero: independent variations that release energy.
        zero: number of eigenvalues that are zero to rounding: independent variations that cost none.
    """

    smallest_eigenvalue: float
    negative: int = 0
    zero: int = 0

    @property
    def neutral(self) -> bool:
        """Whether some variation costs no energy while none releases any."""
        return self.zero > 0 and not self.negative

    @property
    def stable(self) -> bool:
        """Whether every admissible variation costs energy, those apart that are neutral."""
        return not self.negative


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
    return admissible_spectrum(jacobian, strains)[0]


def admissible_spectrum(jacobian: FloatArray, strains: int) -> tuple[FloatArray, FloatArray]:
    """Eigenvalues of the second variation over the k admissible variations, ascending, and those variations, n×k.

    Args:
        jacobian: as in :func:`second_variation`.
        strains: as there.
    """
    hessian, constraints = jacobian[:strains, :strains], jacobian[strains:, :strains]
    free = np.eye(strains)
    if len(constraints):
        _, singular, basis = np.linalg.svd(constraints)
        rank = int(np.sum(singular > 1e-12 * singular[0]))
        free = basis[rank:].T
        hessian = free.T @ hessian @ free
    if not hessian.size:
        return np.zeros(0), np.zeros((strains, 0))
    values, vectors = np.linalg.eigh((hessian + hessian.T) / 2)
    return np.asarray(values), np.asarray(free @ vectors)


def judged(eigenvalues: FloatArray) -> Stability:
    """What eigenvalues of the second variation, ascending, say."""
    if not eigenvalues.size:
        return Stability(np.inf)
    rounding = ZERO * max(1.0, float(np.abs(eigenvalues).max()))
    zero = int(np.sum(np.abs(eigenvalues) <= rounding))
    return Stability(float(eigenvalues[0]), int(np.sum(eigenvalues < -rounding)), zero)
