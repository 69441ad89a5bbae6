"""Limit points and bifurcations between two points of a curve: found, told apart, located.

A limit point is a zero of d(factor)/d(arclength). At a bifurcation a number of the monitor changes sign: for loads
with a potential an eigenvalue of the second variation, which sees multiple ones too; otherwise the smallest singular
value of the bordered matrix with the sign of its determinant, which a limit point leaves alone. R. Seydel,
*Practical Bifurcation and Stability Analysis*, 3rd ed., Springer 2010, chapters 4 and 5.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.numerics.arclength import SINGULAR, ArcPoint, Curve, Monitor, Plane

LOCATED = 1e-14
"""Arclength to which an event is located."""

SAME = 1e-8
"""Arclength below which zeros are one event of a higher multiplicity."""

EVALUATIONS = 60
"""Most points computed for one event."""


@dataclass(frozen=True)
class Event:
    """A special point of a curve.

    Attributes:
        kind: "limit" or "bifurcation".
        point: where it is.
        multiplicity: numbers of the monitor that vanish there.
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
        """The point an arclength s beyond the start; None where it cannot be computed."""
        if s in (0.0, self.step):
            return self.start if s == 0.0 else self.end
        a, t = self.start.y, self.start.tangent
        curving = self.end.y - a - self.step * t
        guess = a + s * t + (s / self.step) ** 2 * curving
        found = self.curve.correct(guess, Plane(t, float(t @ a) + s))
        return None if found is None else self.curve.point(found[0], t, self.start.length + s)

    def zero(self, value: Callable[[ArcPoint], float]) -> ArcPoint | None:
        """Where a value that changes sign along the piece vanishes; None where it cannot be computed."""
        visited: dict[float, ArcPoint] = {0.0: self.start, self.step: self.end}

        def at(s: float) -> float:
            point = self.at(s)
            if point is None:
                return float("nan")
            visited[s] = point
            return value(point)

        return visited.get(bracketed_zero(at, (0.0, value(self.start)), (self.step, value(self.end))))


def bracketed_zero(value: Callable[[float], float], one: tuple[float, float], other: tuple[float, float]) -> float:
    """Zero of a function between two arguments with values of different sign: the Illinois method.

    M. Dowell, P. Jarratt, *A modified regula falsi method for computing the root of an equation*, BIT 11 (1971).

    Returns:
        the argument last evaluated, within LOCATED of the zero; not a number where the function is not.
    """
    (a, fa), (b, fb) = one, other
    if fa == 0.0 or fb == 0.0:
        return a if fa == 0.0 else b
    last = b
    for _ in range(EVALUATIONS):
        c = b - fb * (b - a) / (fb - fa)
        if not min(a, b) < c < max(a, b):
            c = (a + b) / 2
        fc = value(c)
        if np.isnan(fc):
            return fc
        if fc == 0.0 or abs(c - last) <= LOCATED or abs(b - a) <= LOCATED:
            return c
        if (fc > 0.0) != (fb > 0.0):
            a, fa = b, fb
        else:
            fa /= 2
        b, fb, last = c, fc, c
    return last


def events_between(arc: Arc) -> list[Event] | None:
    """Every event of a piece in the order of travel; None where a shorter piece is needed to tell them apart."""
    limits = _limits(arc)
    zeros = _zeros(arc)
    if limits is None or zeros is None:
        return None
    if limits and arc.curve.monitor.feels_limits:
        if not zeros:
            return None
        nearest = min(zeros, key=lambda point: abs(point.length - limits[0].point.length))
        zeros = [point for point in zeros if point is not nearest]
    return sorted(limits + _merged(zeros), key=lambda event: event.point.length)


def signed_singular_value(jacobian: FloatArray, bordered: FloatArray) -> FloatArray:
    """Smallest singular value of the bordered matrix with the sign of its determinant, shape (1,)."""
    sign = float(np.linalg.slogdet(bordered)[0])
    return np.array([(1.0 if sign >= 0.0 else -1.0) * np.linalg.norm(bordered, -2)])


DETERMINANT = Monitor(signed_singular_value, feels_limits=False)
"""Monitor of equations without a potential."""


def _limits(arc: Arc) -> list[Event] | None:
    if (arc.start.factor_rate < 0.0) == (arc.end.factor_rate < 0.0):
        return []
    point = arc.zero(lambda p: p.factor_rate)
    return None if point is None else [Event("limit", point)]


def _zeros(arc: Arc) -> list[ArcPoint] | None:
    """Where numbers of the monitor change sign, each for itself."""
    neutral = min(_neutral(arc.start.spectrum), _neutral(arc.end.spectrum))
    before, after = (_negative(_without(p.spectrum, neutral)) for p in (arc.start, arc.end))
    found = []
    for k in range(min(before, after), max(before, after)):
        point = arc.zero(lambda p, k=k: float(_without(p.spectrum, neutral)[k]))  # type: ignore[misc]
        if point is None:
            return None
        found.append(point)
    return found


def _merged(zeros: list[ArcPoint]) -> list[Event]:
    events: list[Event] = []
    for point in sorted(zeros, key=lambda p: p.length):
        if events and point.length - events[-1].point.length <= SAME:
            events[-1] = Event("bifurcation", events[-1].point, events[-1].multiplicity + 1)
        else:
            events.append(Event("bifurcation", point))
    return events


def _neutral(spectrum: FloatArray) -> int:
    """How many numbers are zero to rounding."""
    return int(np.sum(np.abs(spectrum) <= SINGULAR * max(1.0, float(np.abs(spectrum).max(initial=0.0)))))


def _without(spectrum: FloatArray, neutral: int) -> FloatArray:
    """The spectrum without the numbers that a symmetry keeps at zero all along the piece, still ascending."""
    kept = np.argsort(np.abs(spectrum), kind="stable")[neutral:]
    return spectrum[np.sort(kept)]


def _negative(spectrum: FloatArray) -> int:
    return int(np.sum(spectrum < 0.0))
