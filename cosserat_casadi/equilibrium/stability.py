"""Stability of an equilibrium under loads that derive from a potential: the sign of the second variation.

See docs/theory.md, section 9. The reduction to admissible variations is the null-space method: J. Nocedal, S. J.
Wright, *Numerical Optimization*, 2nd ed., Springer 2006, section 16.2.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.numerics.neutral import kept_by

ZERO = 1e-10
"""Share of the largest eigenvalue, or of EI/ℓ if that is more, below which an eigenvalue is zero to rounding."""

RIGID = 1e4
"""Stiffness of a cable or a stop, in units of EI/ℓ, above which it counts as rigid."""

DEPENDENT = 1e-12
"""Share of the largest singular value of the constraints below which a constraint repeats others."""


@dataclass(frozen=True)
class ConstrainedVariations:
    """Unknowns that vary freely, and the equations that restrict them.

    Attributes:
        free: indices of the unknowns that may vary, strain coordinates and poses of floating frames, shape (n,).
        held: indices of the multipliers, whose equations are the constraints, shape (m,).
        units: energy that the equation of each free unknown is divided by, shape (n,), J.
    """

    free: npt.NDArray[np.int64]
    held: npt.NDArray[np.int64]
    units: FloatArray


def variations(model: Model) -> ConstrainedVariations:
    """Sort a model's unknowns into unknowns that vary and unknowns of constraints, which restrict them."""
    unknowns = model.discrete.unknowns
    free = np.flatnonzero(unknowns.differential)
    held = np.flatnonzero(~unknowns.differential)
    return ConstrainedVariations(free, held, unknowns.units[free])


@dataclass(frozen=True)
class Stability:
    """Second variation of the energy, in units of EI/ℓ, over the admissible variations.

    If symmetry lets the whole rod move without energy, as a buckled round column turns about its axis, an eigenvalue is
    zero: its variation is neutral and does not decide.

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
        some_cost_none = self.zero > 0
        return some_cost_none and not self.negative

    @property
    def stable(self) -> bool:
        """Whether every admissible variation costs energy, except neutral ones."""
        return not self.negative


def second_variation(jacobian: FloatArray, allowed: ConstrainedVariations) -> Stability:
    """Test an equilibrium by the eigenvalues of its second variation.

    Args:
        jacobian: Jacobian of the whole system at the equilibrium, (n + m)×(n + m).
        allowed: free unknowns; only variations in the null space of the linearised constraints are admissible.
    """
    return stability_of(admissible_eigenvalues(jacobian, allowed))


def admissible_eigenvalues(jacobian: FloatArray, allowed: ConstrainedVariations) -> FloatArray:
    """Eigenvalues of the second variation over the admissible variations, ascending.

    Each unknown counts in the energy unit of its rod or frame. The norm of a frame's quaternion, which moves nothing,
    has the eigenvalue 2.

    Args:
        jacobian: as in :func:`second_variation`.
        allowed: as in :func:`second_variation`.
    """
    return admissible_spectrum(jacobian, allowed)[0]


def admissible_spectrum(jacobian: FloatArray, allowed: ConstrainedVariations) -> tuple[FloatArray, FloatArray]:
    """Ascending eigenvalues of the second variation over the k admissible variations, and these variations, n×k.

    Args:
        jacobian: as in :func:`second_variation`.
        allowed: as in :func:`second_variation`.
    """
    block = np.ix_(allowed.free, allowed.free)
    yielding = _yielding(jacobian, allowed)
    held = np.setdiff1d(allowed.held, yielding, assume_unique=True)
    # Slack or elastic cables and elastic stops follow the variations: they are eliminated.
    pull = jacobian[np.ix_(allowed.free, yielding)] / np.diagonal(jacobian)[yielding]
    hessian = jacobian[block] - pull @ jacobian[np.ix_(yielding, allowed.free)]
    constraints = jacobian[np.ix_(held, allowed.free)]
    largest_unit = allowed.units.max(initial=0.0)
    roots = np.sqrt(allowed.units / largest_unit)
    # Rods with one energy unit need no scaling, which would cost digits.
    if len(set(allowed.units)) > 1:
        hessian = roots[:, None] * hessian / roots
        constraints = constraints / roots
    basis = np.eye(len(allowed.free))
    if len(constraints):
        basis = kept_by(constraints, DEPENDENT)
        hessian = basis.T @ hessian @ basis
    if not hessian.size:
        # The constraints leave no admissible variation.
        return np.zeros(0), np.zeros((len(allowed.free), 0))
    # The symmetric part decides; at an equilibrium under loads with a potential the rest is rounding.
    symmetric = (hessian + hessian.T) / 2
    eigenvalues, vectors = np.linalg.eigh(symmetric)
    admissible = basis @ vectors / roots[:, None]
    return np.asarray(eigenvalues), np.asarray(admissible)


def _yielding(jacobian: FloatArray, allowed: ConstrainedVariations) -> npt.NDArray[np.int64]:
    """Indices of the held unknowns whose own equations are elastic or slack rather than rigid."""
    gradients = np.linalg.norm(jacobian[np.ix_(allowed.held, allowed.free)], axis=1)
    pulls = np.linalg.norm(jacobian[np.ix_(allowed.free, allowed.held)], axis=0)
    own = np.abs(np.diagonal(jacobian)[allowed.held])
    is_soft = gradients * pulls <= RIGID * own
    return np.asarray(allowed.held[(own > 0.0) & is_soft])


def restricted(
    jacobian: FloatArray, held: list[FloatArray], allowed: ConstrainedVariations
) -> tuple[FloatArray, ConstrainedVariations]:
    """A Jacobian with further rows that restrict the variations.

    Args:
        jacobian: as in :func:`second_variation`.
        held: rows of the linearised constraints, shape (n + m,) each.
        allowed: as in :func:`second_variation`.
    """
    size = len(jacobian)
    bordered = np.zeros((size + len(held), size + len(held)))
    bordered[:size, :size] = jacobian
    if held:
        bordered[size:, :size] = held
    further = np.arange(size, size + len(held), dtype=np.int64)
    return bordered, replace(allowed, held=np.concatenate([allowed.held, further]))


def stability_of(eigenvalues: FloatArray) -> Stability:
    """Stability from the eigenvalues of the second variation, ascending."""
    if not eigenvalues.size:
        return Stability(np.inf)
    sizes = np.abs(eigenvalues)
    rounding = ZERO * max(1.0, float(sizes.max()))
    negative = eigenvalues < -rounding
    zero = sizes <= rounding
    return Stability(
        smallest_eigenvalue=float(eigenvalues[0]),
        negative=int(np.sum(negative)),
        zero=int(np.sum(zero)),
    )
