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
        stiffness, gaps = bordered[:n, :n], bordered[n:, :n]
        values, v = _on_the_null_space(stiffness, gaps, measure)
        closing = np.linalg.pinv(gaps, rcond=RANK)
        closing -= v @ (v.T @ measure @ closing)
        constant, linear = np.zeros_like(bordered), np.zeros_like(bordered)
        constant[:n, n:], constant[n:, :n] = closing, closing.T
        constant[n:, n:] = -closing.T @ stiffness @ closing
        linear[n:, n:] = closing.T @ measure @ closing
        return Spectrum(values, np.vstack([v, -closing.T @ stiffness @ v]), constant, linear, width)

    @cached_property
    def soft_minimum(self) -> float:
        """−w log Σ exp(−λ/w)."""
        return float(self.values[0] - self.width * np.log(np.sum(self._decays)))

    @cached_property
    def gradient(self) -> FloatArray:
        """Derivative of the soft minimum with the bordered matrix, N×N, symmetric: Σ p z zᵀ."""
        return np.asarray((self.modes * self._shares) @ self.modes.T)

    def curvature(self, change: FloatArray) -> FloatArray:
        """Change of the gradient with that of the matrix, both N×N and symmetric."""
        moved = (change + change.T) / 2 @ self.modes
        between = self.modes.T @ moved
        eased = self.constant @ (moved * self._shares) + self.linear @ (moved * (self._shares * self.values))
        half = eased @ self.modes.T
        slope = float(self._shares @ np.diagonal(between))
        mixed = self.modes @ (self._divided * between) @ self.modes.T
        return np.asarray(mixed - half - half.T + slope / self.width * self.gradient)

    @cached_property
    def _decays(self) -> FloatArray:
        return np.asarray(np.exp(-(self.values - self.values[0]) / self.width))

    @cached_property
    def _shares(self) -> FloatArray:
        """Derivative of the soft minimum with each eigenvalue, p; they add up to one."""
        return np.asarray(self._decays / np.sum(self._decays))

    @cached_property
    def _divided(self) -> FloatArray:
        """Divided differences (pᵢ − pⱼ)/(λᵢ − λⱼ), k×k; the derivative −p/w where both are equal."""
        apart = np.abs(self.values[:, None] - self.values) / self.width
        larger = np.maximum(self._shares[:, None], self._shares)
        equal = apart == 0.0
        ratio = np.where(equal, -1.0, np.expm1(-apart) / np.where(equal, 1.0, apart))
        return np.asarray(larger * ratio / self.width)


def _on_the_null_space(stiffness: FloatArray, gaps: FloatArray, measure: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Eigenvalues of K against M where A v = 0, ascending, and their vectors, n×k, with vᵀ M v = 1."""
    _, singular, basis = np.linalg.svd(gaps)
    free = basis[int(np.sum(singular > RANK * singular.max(initial=0.0))) :].T
    unit = free @ np.linalg.inv(np.linalg.cholesky(free.T @ measure @ free)).T
    values, turn = np.linalg.eigh(unit.T @ stiffness @ unit)
    return np.asarray(values), np.asarray(unit @ turn)
