"""Limit points and bifurcations between two points of a curve: detection, separation and location.

A limit point is a zero of dλ/ds. At a bifurcation a number of the monitor changes sign: for loads with a potential an
eigenvalue of the second variation, which also detects multiple ones; otherwise the smallest singular value of the
bordered matrix with the sign of its determinant, which does not change at a limit point. R. Seydel, *Practical
Bifurcation and Stability Analysis*, 3rd ed., Springer 2010, chapters 4 and 5. See docs/theory.md, section 12.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.numerics.arclength import SINGULAR, ArcPoint, Curve, Monitor

LOCATED = 1e-14
"""Arclength to which an event is located."""

SAME = 1e-8
"""Arclength below which zeros count as one event of higher multiplicity."""

EVALUATIONS = 60
"""Most points computed for one event."""


@dataclass(frozen=True)
class Event:
    """A special point of a curve.

    Attributes:
        kind: "limit" or "bifurcation".
        point: point of the curve.
        multiplicity: count of numbers of the monitor that vanish there.
    """

    kind: str
    point: ArcPoint
    multiplicity: int = 1


@dataclass(frozen=True)
class Arc:
    """A piece of a curve between two of its points.

    Attributes:
        curve: the curve.
        start: first point.
        end: last point, reached in one step.
    """

    curve: Curve
    start: ArcPoint
    end: ArcPoint

    @property
    def step(self) -> float:
        """Arclength of the piece."""
        return self.end.length - self.start.length

    def at(self, s: float) -> ArcPoint | None:
        """Compute the point at an arclength s from the start; None if that fails."""
        if s == 0.0:
            return self.start
        if s == self.step:
            return self.end
        origin = self.start.y
        tangent = self.start.tangent
        # A parabola through both ends predicts; the plane across the tangent keeps s what it is.
        curving = self.end.y - origin - self.step * tangent
        predicted = origin + s * tangent + (s / self.step) ** 2 * curving
        corrected = self.curve.correct(predicted, tangent, float(tangent @ origin) + s)
        if corrected is None:
            return None
        return self.curve.point(corrected[0], tangent, self.start.length + s)

    def zero(self, value: Callable[[ArcPoint], float]) -> ArcPoint | None:
        """Find the zero of a value that changes sign along the piece; None if that fails."""
        computed: dict[float, ArcPoint] = {0.0: self.start, self.step: self.end}

        def value_at(s: float) -> float:
            point = self.at(s)
            if point is None:
                return float("nan")
            computed[s] = point
            return value(point)

        first = (0.0, value(self.start))
        last = (self.step, value(self.end))
        s = bracketed_zero(value_at, first, last)
        return computed.get(s)


def bracketed_zero(value: Callable[[float], float], first: tuple[float, float], last: tuple[float, float]) -> float:
    """Find a zero of a function between two arguments by Brent's method.

    Args:
        value: the function.
        first: an argument with its value.
        last: an argument with its value, of the other sign.

    Returns:
        an argument at which the function was evaluated, within LOCATED of the zero; nan if the function is nan, or has
        one sign at both arguments.
    """
    # Imported here, because a solve meets no event and needs none of SciPy.
    from scipy.optimize import brentq

    known = dict((first, last))

    def value_at(s: float) -> float:
        return known[s] if s in known else value(s)

    try:
        # One that is not located after so many evaluations is as near as it comes.
        zero, _ = brentq(value_at, first[0], last[0], (), LOCATED, maxiter=EVALUATIONS, full_output=True, disp=False)
    except ValueError:
        # A value was not a number.
        return float("nan")
    return float(zero)


def events_between(arc: Arc) -> list[Event] | None:
    """Find all events of a piece in the order of travel; None if a shorter piece is needed to separate them."""
    limits = _limit_points(arc)
    zeros = _monitor_zeros(arc)
    if limits is None or zeros is None:
        return None
    if limits and arc.curve.monitor.feels_limits:
        if not zeros:
            # The sign change of the limit point is undone by another in the same step.
            return None
        # One number of the monitor vanishes because of the limit point: the nearest.
        limit_length = limits[0].point.length
        nearest = min(zeros, key=lambda point: abs(point.length - limit_length))
        zeros = [point for point in zeros if point is not nearest]
    events = limits + _bifurcations(zeros)
    return sorted(events, key=lambda event: event.point.length)


def signed_singular_value(_y: FloatArray, _jacobian: FloatArray, bordered: FloatArray) -> FloatArray:
    """Smallest singular value of the bordered matrix with the sign of its determinant, shape (1,)."""
    smallest = np.linalg.norm(bordered, -2)
    determinant_sign = float(np.linalg.slogdet(bordered)[0])
    return np.array([smallest]) if determinant_sign >= 0.0 else np.array([-smallest])


DETERMINANT = Monitor(signed_singular_value, feels_limits=False)
"""Monitor of equations without a potential."""


def _limit_points(arc: Arc) -> list[Event] | None:
    """Find the limit point of a piece, if there is one; None if that fails."""
    falls_at_start = arc.start.load_factor_rate < 0.0
    falls_at_end = arc.end.load_factor_rate < 0.0
    if falls_at_start == falls_at_end:
        return []
    point = arc.zero(lambda p: p.load_factor_rate)
    if point is None:
        return None
    return [Event("limit", point)]


def _monitor_zeros(arc: Arc) -> list[ArcPoint] | None:
    """Find the zeros of the numbers of the monitor, one by one; None if one cannot be computed."""
    # A value that is zero at both ends belongs to a symmetry.
    neutral = min(_count_neutral(arc.start.spectrum), _count_neutral(arc.end.spectrum))
    spectra = [_without_neutral(point, neutral) for point in (arc.start, arc.end)]
    fewer, more = sorted(int(np.sum(spectrum < 0.0)) for spectrum in spectra)
    zeros = []
    for number in range(fewer, more):
        point = arc.zero(partial(_monitored, number, neutral))
        if point is None:
            return None
        zeros.append(point)
    return zeros


def _monitored(number: int, neutral: int, point: ArcPoint) -> float:
    """Number of the monitor at a point, by its index without neutral ones."""
    return float(_without_neutral(point, neutral)[number])


def _bifurcations(zeros: list[ArcPoint]) -> list[Event]:
    """Turn zeros into events; zeros at one point are one event of higher multiplicity."""
    events: list[Event] = []
    latest = -np.inf
    for point in sorted(zeros, key=lambda p: p.length):
        if point.length - latest <= SAME:
            same = events[-1]
            events[-1] = Event("bifurcation", same.point, same.multiplicity + 1)
        else:
            events.append(Event("bifurcation", point))
            latest = point.length
    return events


def _count_neutral(spectrum: FloatArray) -> int:
    """Count the numbers that are zero up to rounding."""
    sizes = np.abs(spectrum)
    largest = float(sizes.max(initial=0.0))
    rounding = SINGULAR * max(1.0, largest)
    zero = sizes <= rounding
    return int(np.sum(zero))


def _without_neutral(point: ArcPoint, neutral: int) -> FloatArray:
    """Spectrum of a point without the numbers that symmetry keeps at zero along the whole piece, ascending."""
    by_size = np.argsort(np.abs(point.spectrum), kind="stable")
    return point.spectrum[np.sort(by_size[neutral:])]
