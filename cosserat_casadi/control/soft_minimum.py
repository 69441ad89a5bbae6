"""The soft minimum of the eigenvalues of a bordered matrix as a CasADi function with two exact derivatives.

NumPy computes the eigenvalues, so the functions are callbacks. There are three because CasADi asks each callback for a
callback of its derivative: the derivative of the value is the gradient, its derivative is a curvature in directions.

They are the eigenvalues of a symmetric pencil on the null space of constraints. With K v + Aᵀ w = λ M v and A v = 0,
the eigenvalues are those of S − λ D, where S = [[K, Aᵀ], [A, 0]] is the bordered matrix, D = diag(M, 0) is constant and
z = [v; w]. Its inverse is Σ z zᵀ/(λⱼ − λ) + P₀ + λ P₁: the derivatives of a function of the eigenvalues follow by
residues, with divided differences where two of them meet (Kato 1995, chapter II).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, cached_property, lru_cache
from typing import Any

import casadi as ca
import numpy as np

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.numerics.neutral import kept_by

RANK = 1e-12
"""Singular value of the constraints, over the largest one, below which it counts as zero."""


@cache
def soft_minimum(measure: bytes, size: int, width: float) -> ca.Callback:
    """Make the function bordered matrix, size×size, ↦ soft minimum, 1×1; NaN if it has no meaning.

    It is cached, because CasADi keeps no reference to a callback, which must outlive the problems that call it.

    Args:
        measure: measure M of :class:`Spectrum`, as the bytes of its doubles, row by row.
        size: number of rows of the bordered matrix.
        width: width w of the soft minimum.
    """
    doubles = np.frombuffer(measure)
    rows = round(len(doubles) ** 0.5)
    spectra = _SpectrumCache(doubles.reshape(rows, rows), size, width)
    return _Value("soft_minimum", spectra)


class _SpectrumCache:
    """Spectra of matrices; the last one is kept, so that value, gradient and curvature share one decomposition."""

    def __init__(self, measure: FloatArray, size: int, width: float) -> None:
        self.size = size

        @lru_cache(maxsize=1)
        def of_doubles(doubles: bytes) -> Spectrum | None:
            matrix = np.frombuffer(doubles).reshape(size, size)
            if not np.all(np.isfinite(matrix)):
                return None
            try:
                return Spectrum.of(matrix, measure, width)
            except np.linalg.LinAlgError:
                return None

        self._of_doubles = of_doubles

    def spectrum(self, matrix: ca.DM) -> Spectrum | None:
        """Compute the spectrum of a matrix; None if it is not finite or the measure vanishes for some variation."""
        return self._of_doubles(matrix.full().tobytes())


class _SpectralFunction(ca.Callback):  # type: ignore[misc]
    """A function of the matrix, and possibly of changes of it side by side, that follows from the spectrum.

    It has forward and reverse derivatives, unless it depends on changes.
    """

    def __init__(self, name: str, spectra: _SpectrumCache, changes: int = 0) -> None:
        super().__init__()
        self.spectra = spectra
        self.changes = changes
        self.construct(name, {})

    def read(self, spectrum: Spectrum, *changes: ca.DM) -> float | FloatArray:
        """Evaluate the result."""
        raise NotImplementedError

    def eval(self, arg: list[ca.DM]) -> list[float | FloatArray]:
        spectrum = self.spectra.spectrum(arg[0])
        if spectrum is None:
            return [np.full(self.get_sparsity_out(0).shape, np.nan)]
        return [self.read(spectrum, *arg[1:])]

    def has_forward(self, nfwd: int) -> bool:
        return not self.changes

    def has_reverse(self, nadj: int) -> bool:
        return not self.changes

    def get_n_in(self) -> int:
        return 2 if self.changes else 1

    def get_n_out(self) -> int:
        return 1

    def get_sparsity_in(self, i: int) -> ca.Sparsity:
        return self._side_by_side(self.changes if i else 1)

    def get_sparsity_out(self, i: int) -> ca.Sparsity:
        return self._side_by_side(self.changes or 1)

    def _side_by_side(self, count: int) -> ca.Sparsity:
        """Sparsity of so many dense matrices side by side."""
        rows = self.spectra.size
        return ca.Sparsity.dense(rows, rows * count)


class _Value(_SpectralFunction):
    """Matrix ↦ soft minimum."""

    def get_sparsity_out(self, i: int) -> ca.Sparsity:
        return ca.Sparsity.dense(1, 1)

    def read(self, spectrum: Spectrum, *changes: ca.DM) -> float:
        return spectrum.soft_minimum

    def init(self) -> None:
        self.gradient = _Gradient("soft_minimum_gradient", self.spectra)

    def get_forward(self, nfwd: int, name: str, inames: list[str], onames: list[str], opts: Any) -> ca.Function:
        matrix, value = self._symbols()
        changes = ca.MX.sym("change", self._side_by_side(nfwd))
        # Each change of the matrix as one column: the rate is ⟨gradient, change⟩.
        columns = ca.reshape(changes, self.spectra.size**2, nfwd)
        gradient = ca.vec(self.gradient(matrix))
        arguments = [matrix, value, changes]
        return ca.Function(name, arguments, [gradient.T @ columns], inames, onames, opts)

    def get_reverse(self, nadj: int, name: str, inames: list[str], onames: list[str], opts: Any) -> ca.Function:
        matrix, value = self._symbols()
        seeds = ca.MX.sym("seeds", 1, nadj)
        # The gradient times each seed, side by side.
        adjoints = ca.kron(seeds, self.gradient(matrix))
        arguments = [matrix, value, seeds]
        return ca.Function(name, arguments, [adjoints], inames, onames, opts)

    def _symbols(self) -> tuple[ca.MX, ca.MX]:
        """Arguments of every derivative in CasADi: the input and the output."""
        matrix = ca.MX.sym("matrix", self._side_by_side(1))
        return matrix, ca.MX.sym("value")


class _Gradient(_SpectralFunction):
    """Matrix ↦ gradient, whose derivative is symmetric, so that forward and reverse derivatives agree."""

    def read(self, spectrum: Spectrum, *changes: ca.DM) -> FloatArray:
        return spectrum.gradient

    def get_forward(self, nfwd: int, name: str, inames: list[str], onames: list[str], opts: Any) -> ca.Function:
        square = self._side_by_side(1)
        matrix = ca.MX.sym("matrix", square)
        gradient = ca.MX.sym("gradient", square)
        changes = ca.MX.sym("changes", self._side_by_side(nfwd))
        # CasADi asks for so many directions at once; each number has a callback of its own.
        curvature = _curvature(self.spectra, nfwd)
        changes_of_gradient = curvature(matrix, changes)
        arguments = [matrix, gradient, changes]
        return ca.Function(name, arguments, [changes_of_gradient], inames, onames, opts)

    def get_reverse(self, nadj: int, name: str, inames: list[str], onames: list[str], opts: Any) -> ca.Function:
        return self.get_forward(nadj, name, inames, onames, opts)


class _Curvature(_SpectralFunction):
    """Matrix and changes of it ↦ changes of the gradient."""

    def read(self, spectrum: Spectrum, *changes: ca.DM) -> FloatArray:
        (side_by_side,) = changes
        matrices = np.hsplit(side_by_side.full(), self.changes)
        return np.hstack([spectrum.curvature(matrix) for matrix in matrices])


@cache
def _curvature(spectra: _SpectrumCache, changes: int) -> _Curvature:
    # Kept alive by the cache, like the value.
    return _Curvature("soft_minimum_curvature", spectra, changes)


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
        """Derivative of the soft minimum by the bordered matrix, N×N, symmetric: Σ p z zᵀ."""
        weighted_modes = self.modes * self._shares
        return np.asarray(weighted_modes @ self.modes.T)

    def curvature(self, change: FloatArray) -> FloatArray:
        """Change of the gradient by a change of the matrix, both N×N and symmetric."""
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
        """Derivatives p of the soft minimum by the eigenvalues, whose sum is one."""
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
    null_space = kept_by(constraints, RANK)
    # M = L Lᵀ on the null space: its vectors times L⁻ᵀ are M-orthonormal.
    cholesky = np.linalg.cholesky(null_space.T @ measure @ null_space)
    orthonormal = null_space @ np.linalg.inv(cholesky).T
    reduced = orthonormal.T @ stiffness @ orthonormal
    values, vectors = np.linalg.eigh(reduced)
    return np.asarray(values), np.asarray(orthonormal @ vectors)
