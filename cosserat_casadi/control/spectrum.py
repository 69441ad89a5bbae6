"""Soft minimum of the eigenvalues of a symmetric matrix on the null space of constraints, with two derivatives.

With z = [v; w], where K v + Aᵀ w = λ v and A v = 0, the eigenvalues are those of the pencil S − λ D of the bordered
matrix S = [[K, Aᵀ], [A, 0]] and D = diag(1, 0). Its inverse is Σ z zᵀ/(λⱼ − λ) + P₀ + λ P₁: the derivatives of a function
of the eigenvalues follow by residues, with divided differences where two of them meet (Kato 1995, chapter II).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.solver.stability import Variations, admissible_spectrum


@dataclass(frozen=True)
class Spectrum:
    """The k finite eigenvalues of a bordered matrix, N×N.

    Attributes:
        values: eigenvalues λ, ascending, shape (k,).
        modes: z = [v; w], N×k, with orthonormal v.
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
    def of(bordered: FloatArray, free: int, width: float) -> Spectrum:
        """Spectrum of a bordered matrix whose first ``free`` rows are those of K."""
        size = len(bordered)
        places = np.arange(size)
        values, v = admissible_spectrum(bordered, Variations(places[:free], places[free:], np.ones(free)))
        stiffness, gaps = bordered[:free, :free], bordered[free:, :free]
        closing = np.linalg.pinv(gaps, rcond=1e-12)
        modes = np.vstack([v, -closing.T @ stiffness @ v])
        constant, linear = np.zeros((size, size)), np.zeros((size, size))
        constant[:free, free:], constant[free:, :free] = closing, closing.T
        constant[free:, free:] = -closing.T @ stiffness @ closing
        linear[free:, free:] = closing.T @ closing
        return Spectrum(values, modes, constant, linear, width)

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
