"""Tables of values over time as piecewise polynomials, and how near to zero such a polynomial comes."""

from __future__ import annotations

from collections.abc import Callable
from typing import Literal

import numpy as np

from cosserat_casadi.maths.typing import FloatArray

Interpolation = Literal["linear", "cubic", "step"]

_INSIDE = np.array([0.1, 0.4, 0.6, 0.9])
"""Places in a piece that tell a cubic polynomial, as shares of its length; at the ends it may jump."""


def table_coefficients(knots: FloatArray, values: FloatArray, interpolation: Interpolation) -> FloatArray:
    """Coefficients of 1, s, s², s³ in the segments of a table, shape (k + 1, 4, entries).

    The first segment lies before the first knot, the last one from the last knot on; there the value is constant. s is
    the time from the knot at the segment's beginning; in the first segment, from the first knot.

    Args:
        knots: ascending times, shape (k,), s.
        values: at the knots, shape (k, entries).
        interpolation: between the knots.
    """
    count, entries = values.shape
    coefficients = np.zeros((count + 1, 4, entries))
    coefficients[0, 0] = values[0]
    coefficients[1:, 0] = values
    if interpolation == "linear":
        coefficients[1:-1, 1] = np.diff(values, axis=0) / np.diff(knots)[:, None]
    elif interpolation == "cubic":
        coefficients[1:-1] = _cubic_coefficients(knots, values)
    return coefficients


def table_values(
    knots: FloatArray, values: FloatArray, interpolation: Interpolation
) -> Callable[[FloatArray], FloatArray]:
    """The values of a table over time: T times of shape (T,), s ↦ shape (T, entries)."""
    coefficients = table_coefficients(knots, values, interpolation)
    origins = np.concatenate([knots[:1], knots])

    def at(times: FloatArray) -> FloatArray:
        segments = np.searchsorted(knots, times, side="right")
        s = (times - origins[segments])[:, None]
        constant, linear, quadratic, cubic = np.moveaxis(coefficients[segments], 1, 0)
        found: FloatArray = constant + s * (linear + s * (quadratic + s * cubic))
        return found

    return at


def least_norm(path: Callable[[FloatArray], FloatArray], start: float, end: float) -> tuple[float, float]:
    """Least norm of a path between two times, and the time of it, s; infinite where the path is no number.

    Where the squared norm is least its derivative is zero, or the path begins or ends. The squared norm of a cubic
    polynomial is one of degree six: the roots of its derivative are all that can be.

    Args:
        path: times, shape (T,), s ↦ values, shape (T, entries): a polynomial up to the third degree from start to end.
        start: s.
        end: s.
    """
    length = end - start
    inside = path(start + length * _INSIDE)
    if not np.all(np.isfinite(inside)):
        return float("inf"), start
    coefficients = np.linalg.solve(np.vander(_INSIDE, increasing=True), inside)
    squares = np.zeros(7)
    for entry in coefficients.T:
        squares += np.convolve(entry, entry)
    slope = np.polynomial.polynomial.polyder(squares)
    # A double root may come out as a pair beside the real axis: any place in the piece can be looked at.
    roots = np.polynomial.polynomial.polyroots(slope).real
    places = np.concatenate([[0.0, 1.0], np.clip(roots, 0.0, 1.0)])
    norms = np.linalg.norm(np.vander(places, 4, increasing=True) @ coefficients, axis=1)
    least = int(norms.argmin())
    return float(norms[least]), float(start + length * places[least])


def _cubic_coefficients(knots: FloatArray, values: FloatArray) -> FloatArray:
    """Coefficients of the cubic spline of zero slope at both ends, shape (k − 1, 4, entries)."""
    spacing = np.diff(knots)[:, None]
    chord = np.diff(values, axis=0) / spacing
    slopes = _spline_slopes(spacing, chord)
    left = slopes[:-1]
    right = slopes[1:]
    quadratic = (3 * chord - 2 * left - right) / spacing
    cubic = (left + right - 2 * chord) / spacing**2
    return np.stack([values[:-1], left, quadratic, cubic], axis=1)


def _spline_slopes(spacing: FloatArray, chord: FloatArray) -> FloatArray:
    """Slopes at the knots that make accelerations continuous, zero at both ends, shape (k, entries).

    The equation of an inner knot i is h_i m_(i−1) + 2 (h_(i−1) + h_i) m_i + h_(i−1) m_(i+1) = 3 (h_i d_(i−1) + h_(i−1)
    d_i) with spacings h and slopes of chords d. It is solved by elimination downwards, then upwards: its matrix is
    diagonally dominant and needs no pivots.

    Args:
        spacing: h, shape (k − 1, 1), s.
        chord: d, shape (k − 1, entries), units per s.
    """
    before = spacing[:-1]
    after = spacing[1:]
    diagonal = 2 * (before + after)
    right_side = 3 * (after * chord[:-1] + before * chord[1:])
    inner = len(right_side)
    for i in range(1, inner):
        factor = after[i] / diagonal[i - 1]
        diagonal[i] -= factor * before[i - 1]
        right_side[i] -= factor * right_side[i - 1]
    slopes = np.zeros((len(chord) + 1, chord.shape[1]))
    for i in reversed(range(inner)):
        slopes[i + 1] = (right_side[i] - before[i] * slopes[i + 2]) / diagonal[i]
    return slopes
