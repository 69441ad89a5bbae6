"""The soft minimum of the eigenvalues of a bordered matrix as a CasADi function with two exact derivatives.

NumPy finds the eigenvalues, so the functions are callbacks. There are three because CasADi asks each callback for a
callback of its derivative: the value's is the gradient, the gradient's is the curvature along given directions.
"""

from __future__ import annotations

from functools import cache, lru_cache
from typing import Any

import casadi as ca
import numpy as np

from cosserat_casadi.control.spectrum import Spectrum
from cosserat_casadi.maths.typing import FloatArray


@cache
def soft_minimum(measure: bytes, size: int, width: float) -> ca.Callback:
    """Bordered matrix ↦ soft minimum, size×size ↦ 1×1; NaN where that has no meaning.

    Cached, since CasADi holds no reference to what Python computes: a callback must outlive the problems that call it.

    Args:
        measure: M of :class:`Spectrum`, the bytes of its doubles row by row.
        size: rows of the bordered matrix.
        width: of the soft minimum.
    """
    doubles = np.frombuffer(measure)
    rows = round(len(doubles) ** 0.5)
    spectra = _SpectrumCache(doubles.reshape(rows, rows), size, width)
    return _Value("soft_minimum", spectra)


class _SpectrumCache:
    """Spectra of matrices; the last spectrum is kept: value, gradient and curvature share one decomposition."""

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
        """The spectrum of a matrix; None where it is not finite or the measure is zero for some variation."""
        return self._of_doubles(matrix.full().tobytes())


class _SpectralFunction(ca.Callback):  # type: ignore[misc]
    """A function of the matrix, and perhaps of changes of it side by side, that is read off the spectrum.

    It has both derivatives, unless it is of changes.
    """

    def __init__(self, name: str, spectra: _SpectrumCache, changes: int = 0) -> None:
        super().__init__()
        self.spectra = spectra
        self.changes = changes
        self.construct(name, {})

    def read(self, spectrum: Spectrum, *changes: ca.DM) -> float | FloatArray:
        """The result."""
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
        """Arguments that CasADi gives every derivative: the input and the output."""
        matrix = ca.MX.sym("matrix", self._side_by_side(1))
        return matrix, ca.MX.sym("value")


class _Gradient(_SpectralFunction):
    """Matrix ↦ gradient; its derivative is symmetric, so it is its own transpose."""

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
