"""Stability of an equilibrium under loads that derive from a potential: the sign of the second variation."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model


@dataclass(frozen=True)
class Variations:
    """Which unknowns vary freely, and which equations restrict them.

    Attributes:
        free: places of strain coordinates and of moving frames, shape (n,).
        held: places of multipliers, whose equations are the gaps of supports and ties, shape (m,).
        units: energy that the equation of each free unknown is divided by, shape (n,), J.
    """

    free: npt.NDArray[np.int64]
    held: npt.NDArray[np.int64]
    units: FloatArray


def variations(model: Model) -> Variations:
    """Variations of a model."""
    discrete = model.discrete
    differential = discrete.unknowns.differential
    free = np.flatnonzero(differential)
    return Variations(free, np.flatnonzero(~differential), discrete.unknowns.units[free])


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


def second_variation(jacobian: FloatArray, allowed: Variations) -> Stability:
    """Eigenvalue test of an equilibrium.

    Args:
        jacobian: of the whole system at the equilibrium, (n + m)×(n + m).
        allowed: what varies; only variations in the null space of the linearised gaps are admissible.
    """
    return judged(admissible_eigenvalues(jacobian, allowed))


def admissible_eigenvalues(jacobian: FloatArray, allowed: Variations) -> FloatArray:
    """Eigenvalues of the second variation over the admissible variations, ascending.

    Each unknown counts in the energy unit of its own rod or frame. A frame whose quaternion changes its length, which
    moves nothing, has the eigenvalue 2 there.

    Args:
        jacobian: as in :func:`second_variation`.
        allowed: as there.
    """
    return admissible_spectrum(jacobian, allowed)[0]


def admissible_spectrum(jacobian: FloatArray, allowed: Variations) -> tuple[FloatArray, FloatArray]:
    """Eigenvalues of the second variation over the k admissible variations, ascending, and those variations, n×k.

    Args:
        jacobian: as in :func:`second_variation`.
        allowed: as there.
    """
    hessian = jacobian[np.ix_(allowed.free, allowed.free)]
    constraints = jacobian[np.ix_(allowed.held, allowed.free)]
    # A slack cable asks nothing of the rod: its equation is about its tension alone.
    constraints = constraints[
        np.abs(constraints).max(axis=1, initial=0.0) > np.abs(np.diagonal(jacobian)[allowed.held])
    ]
    roots = np.sqrt(allowed.units / allowed.units.max(initial=0.0))
    if len(set(allowed.units)) > 1:
        hessian, constraints = roots[:, None] * hessian / roots, constraints / roots
    free = np.eye(len(allowed.free))
    if len(constraints):
        _, singular, basis = np.linalg.svd(constraints)
        rank = int(np.sum(singular > 1e-12 * singular[0]))
        free = basis[rank:].T
        hessian = free.T @ hessian @ free
    if not hessian.size:
        return np.zeros(0), np.zeros((len(allowed.free), 0))
    values, vectors = np.linalg.eigh((hessian + hessian.T) / 2)
    return np.asarray(values), np.asarray(free @ vectors / roots[:, None])


def judged(eigenvalues: FloatArray) -> Stability:
    """What eigenvalues of the second variation, ascending, say."""
    if not eigenvalues.size:
        return Stability(np.inf)
    rounding = ZERO * max(1.0, float(np.abs(eigenvalues).max()))
    zero = int(np.sum(np.abs(eigenvalues) <= rounding))
    return Stability(float(eigenvalues[0]), int(np.sum(eigenvalues < -rounding)), zero)
