"""Soft minimum of the eigenvalues of a symmetric pencil on the null space of constraints, with two derivatives.

With K v + Aᵀ w = λ M v and A v = 0, the eigenvalues are those of S − λ D, where S = [[K, Aᵀ], [A, 0]] is the bordered
matrix, D = diag(M, 0) is constant and z = [v; w]. Its inverse is Σ z zᵀ/(λⱼ − λ) + P₀ + λ P₁: the derivatives of a
function of the eigenvalues follow by residues, with divided differences where two of them meet (Kato 1995, chapter II).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from cosserat_casadi.maths.typing import FloatArray

RANK = 1e-12
"""Share of the largest singular value of the constraints below which one counts as zero."""


@dataclass(frozen=True)
class Spectrum:
    """The k finite eigenvalues of a bordered matrix, N×N.

    Attributes:
        values: eigenvalues λ, ascending, shape (k,).
        modes: z = [v; w], N×k, with vᵀ M v = 1.
        constant: P₀, N×N.
        linear: P₁, N×N.
        width: w of the soft minimum −w log Σ exp(−λ/w).
    """

    values: FloatArray
    modes: FloatArray
    constant: FloatArray
    linear: FloatArray
    width: float

    @staticmethod
    def of(bordered: FloatArray, measure: FloatArray, width: float) -> Spectrum:
        """Spectrum of a bordered matrix, N×N, against a measure M, n×n.

        Raises:
            numpy.linalg.LinAlgError: M is not positive on the null space of the constraints.
        """
        n = len(measure)
        stiffness = bordered[:n, :n]
        constraints = bordered[n:, :n]
        values, v = _on_the_null_space(stiffness, constraints, measure)
        # A right inverse of the constraints, and among these the one that is M-orthogonal to all modes.
        inverse = np.linalg.pinv(constraints, rcond=RANK)
        inverse -= v @ (v.T @ measure @ inverse)
        # The part of (S − λ D)⁻¹ without poles: P₀ + λ P₁.
        constant = np.zeros_like(bordered)
        constant[:n, n:] = inverse
        constant[n:, :n] = inverse.T
        constant[n:, n:] = -inverse.T @ stiffness @ inverse
        linear = np.zeros_like(bordered)
        linear[n:, n:] = inverse.T @ measure @ inverse
        # The multipliers that hold a mode: Aᵀ w = (λ M − K) v.
        w = -inverse.T @ stiffness @ v
        return Spectrum(values, np.vstack([v, w]), constant, linear, width)

    @cached_property
    def soft_minimum(self) -> float:
        """−w log Σ exp(−λ/w)."""
        smallest = self.values[0]
        total = np.sum(self._decays)
        return float(smallest - self.width * np.log(total))

    @cached_property
    def gradient(self) -> FloatArray:
        """Derivative of the soft minimum with the bordered matrix, N×N, symmetric: Σ p z zᵀ."""
        weighted_modes = self.modes * self._shares
        return np.asarray(weighted_modes @ self.modes.T)

    def curvature(self, change: FloatArray) -> FloatArray:
        """Change of the gradient with a change of the matrix, both N×N and symmetric."""
        symmetric = (change + change.T) / 2
        changed_modes = symmetric @ self.modes
        # Between modes: zᵢᵀ δS zⱼ times the divided difference of p.
        between = self.modes.T @ changed_modes
        mixed = self.modes @ (self._divided * between) @ self.modes.T
        # Between modes and the rest of the space, where the inverse has no poles.
        by_constant = self.constant @ (changed_modes * self._shares)
        by_linear = self.linear @ (changed_modes * (self._shares * self.values))
        half = (by_constant + by_linear) @ self.modes.T
        # All p change together so that they still add up to one.
        slope = float(self._shares @ np.diagonal(between))
        return np.asarray(mixed - half - half.T + slope / self.width * self.gradient)

    @cached_property
    def _decays(self) -> FloatArray:
        # Above the smallest eigenvalue, so that none of the exponentials overflows.
        above = self.values - self.values[0]
        return np.asarray(np.exp(-above / self.width))

    @cached_property
    def _shares(self) -> FloatArray:
        """Derivative of the soft minimum with each eigenvalue, p; they add up to one."""
        decays = self._decays
        return np.asarray(decays / np.sum(decays))

    @cached_property
    def _divided(self) -> FloatArray:
        """Divided differences (pᵢ − pⱼ)/(λᵢ − λⱼ), k×k; the derivative −p/w where both are equal."""
        differences = self.values[:, None] - self.values
        distance = np.abs(differences) / self.width
        shares = self._shares
        larger = np.maximum(shares[:, None], shares)
        equal = distance == 0.0
        divisor = np.where(equal, 1.0, distance)
        # expm1 keeps all digits where two eigenvalues nearly meet.
        ratio = np.where(equal, -1.0, np.expm1(-distance) / divisor)
        return np.asarray(larger * ratio / self.width)


def _on_the_null_space(
    stiffness: FloatArray,
    constraints: FloatArray,
    measure: FloatArray,
) -> tuple[FloatArray, FloatArray]:
    """Eigenvalues of K against M where A v = 0, ascending, and their vectors, n×k, with vᵀ M v = 1."""
    _, singular, basis = np.linalg.svd(constraints)
    largest = singular.max(initial=0.0)
    rank = int(np.sum(singular > RANK * largest))
    null_space = basis[rank:].T
    # M = L Lᵀ on the null space: its vectors times L⁻ᵀ are M-orthonormal.
    cholesky = np.linalg.cholesky(null_space.T @ measure @ null_space)
    orthonormal = null_space @ np.linalg.inv(cholesky).T
    reduced = orthonormal.T @ stiffness @ orthonormal
    values, vectors = np.linalg.eigh(reduced)
    return np.asarray(values), np.asarray(orthonormal @ vectors)
