"""Monotone cubic curves through points, and their integrals: the method of Fritsch and Carlson (1980).

Slopes at the points are weighted harmonic means of the slopes of the chords beside them (Fritsch and Butland, 1984), so
that a curve through points that rise never falls. Beyond its ends a curve goes on straight.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import casadi as ca
import numpy as np

from cosserat_casadi.maths.typing import FloatArray, Matrix


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
        width = np.diff(self.abscissae)
        chord = np.diff(self.values) / width
        left = self.slopes[:-1]
        right = self.slopes[1:]
        square = (3 * chord - 2 * left - right) / width
        cube = (left + right - 2 * chord) / width**2
        return np.column_stack([self.values[:-1], left, square, cube])

    @cached_property
    def _integrals(self) -> FloatArray:
        """Integral of the curve from its first point to each, shape (n,)."""
        width = np.diff(self.abscissae)
        powers = np.column_stack([width, width**2 / 2, width**3 / 3, width**4 / 4])
        return np.concatenate([[0.0], np.cumsum(np.sum(self._polynomials * powers, axis=1))])

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
