"""The soft minimum of the eigenvalues of a bordered matrix as a CasADi function with two exact derivatives."""

from __future__ import annotations

from functools import cache
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
    return _Value("soft_minimum", _Place(doubles.reshape(rows, rows), size, width))


class _Place:
    """Spectrum of the matrix asked about last: value, gradient and curvature share one decomposition."""

    def __init__(self, measure: FloatArray, size: int, width: float) -> None:
        self.measure, self.size, self.width = measure, size, width
        self._last: tuple[bytes, Spectrum | None] = (b"", None)

    def spectrum(self, matrix: ca.DM) -> Spectrum | None:
        """The spectrum of a matrix; None where it is not finite or the measure is zero for some variation."""
        full = matrix.full()
        if self._last[0] != full.tobytes():
            self._last = full.tobytes(), self._computed(full)
        return self._last[1]

    def _computed(self, matrix: FloatArray) -> Spectrum | None:
        if not np.all(np.isfinite(matrix)):
            return None
        try:
            return Spectrum.of(matrix, self.measure, self.width)
        except np.linalg.LinAlgError:
            return None


class _Computed(ca.Callback):  # type: ignore[misc]
    """What Python computes of the spectrum, a function of the matrix and perhaps of changes of it side by side."""

    def __init__(self, name: str, place: _Place, changes: int = 0) -> None:
        super().__init__()
        self.place, self.changes = place, changes
        self.construct(name, {})

    def get_n_in(self) -> int:
        return 2 if self.changes else 1

    def get_n_out(self) -> int:
        return 1

    def get_sparsity_in(self, i: int) -> ca.Sparsity:
        return self._square(self.changes if i else 1)

    def _square(self, count: int) -> ca.Sparsity:
        return ca.Sparsity.dense(self.place.size, self.place.size * count)


class _Value(_Computed):
    """Matrix ↦ soft minimum."""

    def get_sparsity_out(self, i: int) -> ca.Sparsity:
        return ca.Sparsity.dense(1, 1)

    def eval(self, arg: list[ca.DM]) -> list[float]:
        spectrum = self.place.spectrum(arg[0])
        return [np.nan if spectrum is None else spectrum.soft_minimum]

    def init(self) -> None:
        self.gradient = _Gradient("soft_minimum_gradient", self.place)

    def has_forward(self, nfwd: int) -> bool:
        return True

    def get_forward(self, nfwd: int, name: str, inames: list[str], onames: list[str], opts: Any) -> ca.Function:
        matrix, value, change = self._symbols(nfwd)
        columns = ca.reshape(change, self.place.size**2, nfwd)
        rate = ca.vec(self.gradient(matrix)).T @ columns
        return ca.Function(name, [matrix, value, change], [rate], inames, onames, opts)

    def has_reverse(self, nadj: int) -> bool:
        return True

    def get_reverse(self, nadj: int, name: str, inames: list[str], onames: list[str], opts: Any) -> ca.Function:
        matrix, value, _ = self._symbols(1)
        seeds = ca.MX.sym("seeds", 1, nadj)
        return ca.Function(name, [matrix, value, seeds], [ca.kron(seeds, self.gradient(matrix))], inames, onames, opts)

    def _symbols(self, count: int) -> tuple[ca.MX, ca.MX, ca.MX]:
        matrix = ca.MX.sym("matrix", self._square(1))
        return matrix, ca.MX.sym("value"), ca.MX.sym("change", self._square(count))


class _Gradient(_Computed):
    """Matrix ↦ gradient; its derivative is symmetric, so it is its own transpose."""

    def get_sparsity_out(self, i: int) -> ca.Sparsity:
        return self._square(1)

    def eval(self, arg: list[ca.DM]) -> list[FloatArray]:
        spectrum = self.place.spectrum(arg[0])
        return [np.full((self.place.size,) * 2, np.nan) if spectrum is None else spectrum.gradient]

    def has_forward(self, nfwd: int) -> bool:
        return True

    def get_forward(self, nfwd: int, name: str, inames: list[str], onames: list[str], opts: Any) -> ca.Function:
        matrix, gradient = (ca.MX.sym(word, self._square(1)) for word in ("matrix", "gradient"))
        changes = ca.MX.sym("changes", self._square(nfwd))
        curved = _curvature(self.place, nfwd)(matrix, changes)
        return ca.Function(name, [matrix, gradient, changes], [curved], inames, onames, opts)

    def has_reverse(self, nadj: int) -> bool:
        return True

    def get_reverse(self, nadj: int, name: str, inames: list[str], onames: list[str], opts: Any) -> ca.Function:
        return self.get_forward(nadj, name, inames, onames, opts)


class _Curvature(_Computed):
    """Matrix and changes of it ↦ changes of the gradient."""

    def get_sparsity_out(self, i: int) -> ca.Sparsity:
        return self._square(self.changes)

    def eval(self, arg: list[ca.DM]) -> list[FloatArray]:
        spectrum, changes = self.place.spectrum(arg[0]), arg[1].full()
        if spectrum is None:
            return [np.full_like(changes, np.nan)]
        return [np.hstack([spectrum.curvature(change) for change in np.hsplit(changes, self.changes)])]


@cache
def _curvature(place: _Place, changes: int) -> _Curvature:
    return _Curvature("soft_minimum_curvature", place, changes)
