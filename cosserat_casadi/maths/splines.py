"""Tables of values over time or along a rod as piecewise polynomials, and the least norm of such polynomials.

Monotone cubic curves through points, and their integrals, are by the method of Fritsch and Carlson (1980). Slopes at
the points are weighted harmonic means of the slopes of the chords beside them (Fritsch and Butland, 1984), so that a
curve through points that rise never falls. Beyond its ends a curve continues straight.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import casadi as ca
import numpy as np

from cosserat_casadi.maths.numbers import Numbers, as_matrix, is_symbolic
from cosserat_casadi.maths.typing import FloatArray, Matrix

Interpolation = Literal["linear", "cubic", "step"]

_INSIDE = np.array([0.1, 0.4, 0.6, 0.9])
"""Places in a piece that tell a cubic polynomial, as shares of its length; at the ends it may jump."""

_BINOMIALS = np.array([1.0, 3.0, 3.0, 1.0])
"""Binomial coefficients of the third degree."""

_DEGREES = np.arange(4)

_CONTROL = np.linalg.inv(_BINOMIALS * _INSIDE[:, None] ** _DEGREES * (1 - _INSIDE[:, None]) ** (3 - _DEGREES))
"""Control points of a cubic polynomial from its values at these places, shape (4, 4)."""

_SQUARE = np.array(
    [np.outer(_BINOMIALS, _BINOMIALS) * (np.add.outer(_DEGREES, _DEGREES) == k) / math.comb(6, k) for k in range(7)]
)
"""Matrices from Bernstein coefficients of two cubic polynomials to coefficients of their product, shape (7, 4, 4)."""

_LEAST_NORM_ERROR = 1e-14
"""Error of the least norm as a share of the largest norm: some tens of rounding errors."""

_HALVINGS = 53
"""Most halvings of a piece: the number of binary digits, after which its halves cannot be distinguished."""


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
    elif interpolation == "cubic" and len(knots) > 1:
        coefficients[1:-1] = cubic_coefficients(knots, values)
    return coefficients


def cubic_coefficients(knots: FloatArray, values: FloatArray, *, natural: bool = False) -> FloatArray:
    """Coefficients of 1, s, s², s³ of the cubic spline through values, shape (k − 1, 4, entries).

    Args:
        knots: ascending, shape (k,), two or more.
        values: at the knots, shape (k, entries).
        natural: whether the spline has no curvature at its ends, in place of no slope.
    """
    spacing = np.diff(knots)[:, None]
    chord = np.diff(values, axis=0) / spacing
    return _cubics(spacing, values, _spline_slopes(spacing, chord, natural=natural))


def _cubics(spacing: FloatArray, values: FloatArray, slopes: FloatArray) -> FloatArray:
    """Coefficients of 1, s, s², s³ of the cubics with these values and slopes at k knots, shape (k − 1, 4, entries)."""
    chord = np.diff(values, axis=0) / spacing
    left = slopes[:-1]
    right = slopes[1:]
    quadratic = (3 * chord - 2 * left - right) / spacing
    cubic = (left + right - 2 * chord) / spacing**2
    return np.stack([values[:-1], left, quadratic, cubic], axis=1)


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
        return np.asarray(constant + s * (linear + s * (quadratic + s * cubic)))

    return at


def spline_basis(knots: FloatArray, X: Numbers) -> Numbers:
    """Weights of the values at knots in the cubic spline through them, as :func:`table_values` has it.

    Args:
        knots: ascending, shape (k,).
        X: places, shape (n,), numbers or expressions.

    Returns:
        shape (k, n).
    """
    coefficients = table_coefficients(knots, np.eye(len(knots)), "cubic")[1:-1]
    first = np.zeros((len(knots), 1))
    first[0] = 1.0
    weights = as_matrix(first @ np.ones((1, X.shape[0])))
    for start, length, (_, *powers) in zip(knots[:-1], np.diff(knots), coefficients, strict=True):
        # Each segment adds the change of the spline in it, up to X. At a knot the segment before it has the slope.
        gone = ca.fmin(ca.fmax(0.0, as_matrix(X) - start), length)
        for degree, power in enumerate(powers, 1):
            weights = weights + ca.DM(power) @ (gone**degree).T
    return weights if is_symbolic(X) else ca.DM(weights).full()


def least_norm(path: Callable[[FloatArray], FloatArray], cuts: FloatArray) -> tuple[float, float]:
    """Least norm of a path of polynomials, and its time, s; infinite if the path is NaN.

    Pieces are halved, and those kept that can hold a lesser norm than the least that was met at an end: the squared
    norm of a piece is nowhere less than the least of its coefficients in Bernstein's basis. Halving averages control
    points, which loses no digits however small the path becomes, and takes all degrees alike.

    Args:
        path: times, shape (T,), s ↦ values, shape (T, entries): between two cuts a polynomial up to the third degree.
        cuts: ascending, shape (pieces + 1,), s.

    Returns:
        The norm, to 1e-14 of the largest, and the time of it.
    """
    starts = cuts[:-1]
    widths = np.diff(cuts)
    times = starts[:, None] + widths[:, None] * _INSIDE
    values = path(times.ravel()).reshape(*times.shape, -1)
    finite = np.all(np.isfinite(values), axis=(1, 2))
    if not np.any(finite):
        return float("inf"), float(cuts[0])
    starts, widths, points = starts[finite], widths[finite], _CONTROL @ values[finite]
    # Scaling by a power of two is exact: norms of very small and very large values can then be squared.
    exponent = np.frexp(np.abs(points).max())[1]
    points = np.ldexp(points, -exponent)
    allowed = _LEAST_NORM_ERROR * np.linalg.norm(points, axis=2).max()
    least, time = np.inf, 0.0
    for _ in range(_HALVINGS):
        ends = np.linalg.norm(points[:, [0, -1]], axis=2)
        piece, side = np.unravel_index(ends.argmin(), ends.shape)
        if ends[piece, side] < least:
            least, time = ends[piece, side], starts[piece] + side * widths[piece]
        bounds = np.einsum("kij,nie,nje->nk", _SQUARE, points, points).min(axis=1)
        lower = np.sqrt(np.maximum(bounds, 0.0)) < least - allowed
        if not np.any(lower):
            break
        points = _halves(points[lower])
        widths = np.repeat(widths[lower] / 2, 2)
        starts = np.repeat(starts[lower], 2)
        starts[1::2] += widths[1::2]
    return float(np.ldexp(least, exponent)), float(time)


def _halves(points: FloatArray) -> FloatArray:
    """Control points of both halves of each piece, by de Casteljau's averages: shape (n, 4, e) ↦ (2 n, 4, e)."""
    left, right = [points[:, 0]], [points[:, -1]]
    while points.shape[1] > 1:
        points = points[:, :-1] / 2 + points[:, 1:] / 2
        left.append(points[:, 0])
        right.append(points[:, -1])
    both = np.stack([np.stack(left, axis=1), np.stack(right[::-1], axis=1)], axis=1)
    return both.reshape(-1, *both.shape[2:])


def _spline_slopes(spacing: FloatArray, chord: FloatArray, *, natural: bool) -> FloatArray:
    """Slopes at the knots that make accelerations continuous, shape (k, entries).

    The equation of an inner knot i is h_i m_(i−1) + 2 (h_(i−1) + h_i) m_i + h_(i−1) m_(i+1) = 3 (h_i d_(i−1) + h_(i−1)
    d_i) with spacings h and slopes of chords d. It is solved by elimination downwards, then upwards: its matrix is
    diagonally dominant and needs no pivots. See C. de Boor, *A Practical Guide to Splines*, Springer 2001, chapter IV.

    Args:
        spacing: h, shape (k − 1, 1).
        chord: d, shape (k − 1, entries).
        natural: whether accelerations, 2 m_0 + m_1 − 3 d_0 and the like, are zero at the ends, in place of slopes.
    """
    before = spacing[:-1]
    after = spacing[1:]
    one = np.ones((1, 1))
    beside = one if natural else 0.0 * one
    # Row i is left_(i−1) m_(i−1) + diagonal_i m_i + right_i m_(i+1).
    left = np.vstack([after, beside])
    right = np.vstack([beside, before])
    diagonal = np.vstack([one + beside, 2 * (before + after), one + beside])
    slopes = np.vstack([3 * beside * chord[:1], 3 * (after * chord[:-1] + before * chord[1:]), 3 * beside * chord[-1:]])
    for i in range(1, len(slopes)):
        factor = left[i - 1] / diagonal[i - 1]
        diagonal[i] -= factor * right[i - 1]
        slopes[i] -= factor * slopes[i - 1]
    slopes[-1] /= diagonal[-1]
    for i in reversed(range(len(slopes) - 1)):
        slopes[i] = (slopes[i] - right[i] * slopes[i + 1]) / diagonal[i]
    return slopes


@dataclass(frozen=True)
class HermiteCurve:
    """A curve of cubics that meet at points with their slopes.

    Attributes:
        abscissae: of the points, rising, shape (n,), n ≥ 2.
        values: at the points, shape (n,).
        slopes: at the points, shape (n,).
    """

    abscissae: FloatArray
    values: FloatArray
    slopes: FloatArray

    @property
    def ends(self) -> tuple[float, float]:
        """First and last abscissa."""
        return float(self.abscissae[0]), float(self.abscissae[-1])

    def integral(self, at: Matrix) -> Matrix:
        """Integral of the curve from zero, 1×1, for an expression of an abscissa, 1×1.

        One cubic is evaluated at a time, so that a derivative at a point is the derivative on one side of it.
        """
        pieces = [self._piece(i, at) for i in range(len(self.abscissae) + 1)]
        result = pieces[-1]
        for abscissa, piece in zip(self.abscissae[::-1], pieces[-2::-1], strict=True):
            result = ca.if_else(at < abscissa, piece, result)
        return result - self._integral_at_zero

    def share_left(self, at: Matrix) -> Matrix:
        """Distance to the nearer end relative to the distance between the ends; negative beyond an end."""
        first, last = self.ends
        share: Matrix = ca.fmin(at - first, last - at) / (last - first)
        return share

    @cached_property
    def _polynomials(self) -> FloatArray:
        """Coefficients of value, slope, square and cube in the distance from the left point, shape (n − 1, 4)."""
        return _cubics(np.diff(self.abscissae), self.values, self.slopes)

    @cached_property
    def _integrals(self) -> FloatArray:
        """Integral of the curve from its first point to each, shape (n,)."""
        width = np.diff(self.abscissae)
        powers = np.column_stack([width, width**2 / 2, width**3 / 3, width**4 / 4])
        of_intervals = np.sum(self._polynomials * powers, axis=1)
        return np.concatenate([[0.0], np.cumsum(of_intervals)])

    @cached_property
    def _integral_at_zero(self) -> float:
        """Integral of the curve from its first point to zero."""
        piece = int(np.searchsorted(self.abscissae, 0.0, side="right"))
        return float(ca.DM(self._piece(piece, ca.DM(0.0))))

    def _piece(self, number: int, at: Matrix) -> Matrix:
        """Integral from the first point by one cubic; number 0 and number n are the straight lines beyond the ends."""
        begin = max(number - 1, 0)
        distance = at - self.abscissae[begin]
        if number in (0, len(self.abscissae)):
            coefficients = np.array([self.values[begin], self.slopes[begin], 0.0, 0.0])
        else:
            coefficients = self._polynomials[begin]
        value, slope, square, cube = map(float, coefficients)
        by_distance = value + distance * (slope / 2 + distance * (square / 3 + distance * (cube / 4)))
        piece: Matrix = float(self._integrals[begin]) + distance * by_distance
        return piece


def monotone_curve(abscissae: FloatArray, values: FloatArray) -> HermiteCurve:
    """The curve through points that rise or stay level.

    Args:
        abscissae: rising, shape (n,), n ≥ 2.
        values: shape (n,).
    """
    return HermiteCurve(abscissae, values, _slopes(abscissae, values))


def _slopes(abscissae: FloatArray, values: FloatArray) -> FloatArray:
    """Slopes at the points: weighted harmonic means of the chords, and at the ends a parabola's, limited."""
    width = np.diff(abscissae)
    chord = np.diff(values) / width
    if len(chord) == 1:
        return np.array([chord[0], chord[0]])
    slopes = np.zeros(len(abscissae))
    for i in range(1, len(abscissae) - 1):
        before, after = chord[i - 1], chord[i]
        if before * after > 0.0:
            near_left = 2 * width[i] + width[i - 1]
            near_right = width[i] + 2 * width[i - 1]
            slopes[i] = (near_left + near_right) / (near_left / before + near_right / after)
    slopes[0] = _end_slope(width[0], width[1], chord[0], chord[1])
    slopes[-1] = _end_slope(width[-1], width[-2], chord[-1], chord[-2])
    return slopes


def _end_slope(near: float, far: float, chord: float, next_chord: float) -> float:
    """Slope of the parabola through three points at its end, where that keeps the curve monotone."""
    slope = ((2 * near + far) * chord - near * next_chord) / (near + far)
    if slope * chord <= 0.0:
        return 0.0
    if chord * next_chord <= 0.0 and abs(slope) > 3 * abs(chord):
        return float(3 * chord)
    return float(slope)
