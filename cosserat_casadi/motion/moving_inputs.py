"""Inputs over time: exact values, rates and accelerations of all inputs, in smooth pieces.

The sum of the tables of an input replaces the value of the scene; an input without a table keeps that value. Its waves
are added.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from bisect import bisect_left, bisect_right
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from typing import Any, NamedTuple

import numpy as np

from cosserat_casadi.errors import Problem, refuse
from cosserat_casadi.maths.splines import table_coefficients
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.inputs import InputLayout
from cosserat_casadi.scene.motion_records import InputMotion

SAME_TIME = 1e-12
"""Difference of two times, over the duration, up to which they count as equal: pieces are longer."""

MOST_CUTS = 50
"""Most kinks of a table at which steps end; a table with more kinks is a record, whose kinks steps may pass."""

REMEMBERED_TIMES = 16
"""Number of times at which the inputs are kept: the times of a step and some more."""


class InputState(NamedTuple):
    """All inputs at one time, in the order of the stacked vector.

    Attributes:
        value: values, shape (inputs,), in the units of the inputs.
        rate: first time derivative, shape (inputs,), units per s.
        acceleration: second time derivative, shape (inputs,), units per s².
    """

    value: FloatArray
    rate: FloatArray
    acceleration: FloatArray


@dataclass(frozen=True)
class Break:
    """A time at which the path of an input is not smooth.

    Attributes:
        input: name of the input.
        time: time of the break, s.
        order: order of the first derivative that jumps: 0 for the value itself, 1 for its rate, 2 for its acceleration.
    """

    input: str
    time: float
    order: int


@dataclass(frozen=True)
class Piece:
    """A span of time in which all inputs are smooth, except for weak kinks that steps may pass.

    Attributes:
        start: start of the span, s.
        end: end of the span, s.
        kinks: times of weak kinks inside, ascending, s; see :attr:`_Path.weak`.
    """

    start: float
    end: float
    kinks: tuple[float, ...]
    _constant: FloatArray
    _paths: tuple[tuple[slice, _Path], ...]

    @property
    def smooth(self) -> float:
        """Shortest time between two neighbouring kinks or ends, s."""
        return float(np.diff([self.start, *self.kinks, self.end]).min())

    @property
    def moves(self) -> bool:
        """Whether any input has a path over time."""
        return bool(self._paths)

    def at(self, t: float) -> InputState:
        """Inputs at a time; at start and end their limits from within, beyond these the continuation of the piece."""
        if not self.moves:
            return InputState(self._constant.copy(), *np.zeros((2, len(self._constant))))
        # Every stage of a step asks for them.
        if self._polynomial is not None:
            s = t - self.start
            return InputState(*(np.array([1.0, s, s**2, s**3]) @ self._polynomial).reshape(3, -1))
        orders = np.zeros((3, len(self._constant)))
        orders[0] = self._constant
        for span, path in self._paths:
            orders[:, span] += path.at(t)
        return InputState(*orders)

    @property
    def cubics(self) -> tuple[float, FloatArray] | None:
        """The start, s, and the coefficients of ``_polynomial``; None without them, or where no input moves."""
        return None if not self.moves or self._polynomial is None else (self.start, self._polynomial)

    @cached_property
    def _polynomial(self) -> FloatArray | None:
        """Coefficients of values, rates and accelerations of all inputs in powers of t − start, shape (4, 3 inputs).

        The value is None if an input is not one cubic polynomial in the whole piece.
        """
        if not np.isfinite(self.start):
            return None
        values = np.zeros((4, len(self._constant)))
        values[0] = self._constant
        for span, path in self._paths:
            coefficients = path.coefficients_about(self.start)
            if coefficients is None:
                return None
            values[:, span] += coefficients
        rates = np.zeros_like(values)
        accelerations = np.zeros_like(values)
        rates[:-1] = np.array([[1.0], [2.0], [3.0]]) * values[1:]
        accelerations[:-2] = np.array([[2.0], [6.0]]) * values[2:]
        return np.concatenate([values, rates, accelerations], axis=1)

    @cached_property
    def remembered(self) -> Callable[[float], InputState]:
        """The function :meth:`at` with a memory, as all evaluations of a step ask for the inputs at the same times."""
        return lru_cache(maxsize=REMEMBERED_TIMES)(self.at)

    def __getstate__(self) -> dict[str, Any]:
        # What is remembered is of one process.
        return {name: value for name, value in vars(self).items() if name != "remembered"}

    def values_at(self, times: FloatArray) -> FloatArray:
        """The values alone at T times, shape (T, inputs)."""
        if self.moves and self._polynomial is not None:
            powers = np.vander(times - self.start, 4, increasing=True)
            # No product of matrices: it rounds a row by its place among the others.
            return np.asarray(np.einsum("tk,kn->tn", powers, self._polynomial[:, : len(self._constant)]))
        values = np.tile(self._constant, (len(times), 1))
        for span, path in self._paths:
            values[:, span] += path.values_at(times)
        return values


class MovingInputs:
    """The inputs of a model over time.

    Args:
        layout: the inputs of the model.
        motions: motions of inputs over time; the layout contains every input that they name.
        defaults: stacked values of inputs that do not move, shape (inputs,), in the units of the inputs.

    Raises:
        SceneError: a motion names an input that the model does not have.
    """

    def __init__(self, layout: InputLayout, motions: Sequence[InputMotion], defaults: FloatArray) -> None:
        _refuse_unknown(layout, motions)
        self._motions = tuple(motions)
        self._slices = layout.slices
        degrees = {entry.name: entry.shape[1] for entry, _ in layout}
        self._paths = tuple(_path_of(motion, degrees[motion.input]) for motion in motions)
        self._constant = np.array(defaults, dtype=float)
        for motion in motions:
            if motion.is_table:
                self._constant[self._slices[motion.input]] = 0.0

    @cached_property
    def at_start(self) -> InputState:
        """The inputs at time 0, at a jump after it."""
        return self.at(0.0)

    def at(self, t: float) -> InputState:
        """Inputs at a time; at a jump, their limits from later times."""
        return self._piece(t, np.inf, slack=0.0).at(t)

    def pieces(self, duration: float) -> list[Piece]:
        """Cut the time from 0 to the duration (s) into consecutive spans in which all inputs are smooth."""
        slack = SAME_TIME * duration
        weak_of_paths = [path.weak for path in self._paths]
        strong = []
        for path, of_path in zip(self._paths, weak_of_paths, strict=True):
            strong += [time for time, _ in path.breaks if time not in of_path]
        strong.sort()
        weak = sorted(frozenset().union(*weak_of_paths))
        cuts = [0.0]
        for time in strong:
            # Equal times of two tables may differ by rounding.
            if cuts[-1] + 2 * slack < time < duration - 2 * slack:
                cuts.append(time)
        ends = [*cuts[1:], duration]
        pieces = []
        for start, end in zip(cuts, ends, strict=True):
            first = bisect_right(weak, start + 2 * slack)
            last = bisect_left(weak, end - 2 * slack)
            pieces.append(replace(self._piece(start, end, slack), kinks=tuple(weak[first:last])))
        return pieces

    def breaks(self, duration: float) -> list[Break]:
        """Breaks of the inputs from 0 to the duration (s), in order of time; the inputs rest before 0."""
        found = self._breaks_at_start()
        for motion, path in zip(self._motions, self._paths, strict=True):
            found += [Break(motion.input, time, order) for time, order in path.breaks if 0.0 < time < duration]
        return sorted(found, key=lambda entry: (entry.time, entry.order))

    def jumps(self, duration: float) -> list[Break]:
        """Breaks from 0 to the duration (s) at which the value of an input itself jumps: sudden loads."""
        return [entry for entry in self.breaks(duration) if entry.order == 0]

    def _breaks_at_start(self) -> list[Break]:
        """Inputs that begin to move at once, or to accelerate at once."""
        state = self.at_start
        found = []
        for name in dict.fromkeys(motion.input for motion in self._motions):
            span = self._slices[name]
            if np.any(state.rate[span]):
                found.append(Break(name, 0.0, 1))
            elif np.any(state.acceleration[span]):
                found.append(Break(name, 0.0, 2))
        return found

    def _piece(self, start: float, end: float, slack: float) -> Piece:
        paths = []
        for motion, path in zip(self._motions, self._paths, strict=True):
            span = self._slices[motion.input]
            paths.append((span, path.within(start + slack, end - slack)))
        return Piece(start, end, (), self._constant, tuple(paths))


def _refuse_unknown(layout: InputLayout, motions: Sequence[InputMotion]) -> None:
    known = ", ".join(layout.names) or "none"
    unknown = [motion.input for motion in motions if motion.input not in layout.names]
    remedy = f"build scene.with_motion_inputs(); its inputs are {known}"
    refuse([Problem(name, "is not an input of this model", remedy) for name in unknown])


# Paths of one input


class _Path(ABC):
    """The contribution of one motion to its input, over time."""

    @property
    @abstractmethod
    def breaks(self) -> tuple[tuple[float, int], ...]:
        """Times at which the path is not smooth (s), each with the order of the first derivative that jumps."""

    @property
    def weak(self) -> frozenset[float]:
        """Breaks at which no step has to end, s."""
        return frozenset()

    @abstractmethod
    def within(self, start: float, end: float) -> _Path:
        """Return the path on a span of time without breaks inside, with limits from within at both ends."""

    @abstractmethod
    def at(self, t: float) -> FloatArray:
        """Value, rate and acceleration at a time, shape (3, entries)."""

    @abstractmethod
    def values_at(self, times: FloatArray) -> FloatArray:
        """Values at T times, shape (T, entries)."""

    def coefficients_about(self, origin: float) -> FloatArray | None:
        """Coefficients of 1, s, s², s³ with s = t − origin, shape (4, entries); None if the path is not cubic."""
        return None


@dataclass(frozen=True)
class _Wave(_Path):
    """The wave constant + sine · sin(ω t + φ) + cosine · cos(ω t + φ), shape (entries,) each."""

    constant: FloatArray
    sine: FloatArray
    cosine: FloatArray
    angular_frequency: float
    phase: float

    @property
    def breaks(self) -> tuple[tuple[float, int], ...]:
        return ()

    def within(self, start: float, end: float) -> _Wave:
        return self

    def at(self, t: float) -> FloatArray:
        omega = self.angular_frequency
        sine = np.sin(omega * t + self.phase)
        cosine = np.cos(omega * t + self.phase)
        varying = sine * self.sine + cosine * self.cosine
        rate = omega * (cosine * self.sine - sine * self.cosine)
        return np.array([self.constant + varying, rate, -(omega**2) * varying])

    def values_at(self, times: FloatArray) -> FloatArray:
        angles = self.angular_frequency * times + self.phase
        varying = np.outer(np.sin(angles), self.sine) + np.outer(np.cos(angles), self.cosine)
        return np.asarray(self.constant + varying)


@dataclass(frozen=True)
class _Table(_Path):
    """A piecewise polynomial, constant before its first knot and after its last.

    Attributes:
        knots: ascending times, shape (k,), s.
        origins: time origin of each segment, shape (k + 1,), s.
        coefficients: coefficients of 1, s, s², s³ with s = t − origin, shape (k + 1, 4, entries).
        breaks_at: times at which the table is not smooth, with their orders.
        first: index of the first segment that may be evaluated.
        last: index of the last segment that may be evaluated.
    """

    knots: FloatArray
    origins: FloatArray
    coefficients: FloatArray
    breaks_at: tuple[tuple[float, int], ...]
    first: int
    last: int

    @property
    def breaks(self) -> tuple[tuple[float, int], ...]:
        return self.breaks_at

    @property
    def weak(self) -> frozenset[float]:
        """Times at which the acceleration jumps, and kinks of the path itself if they are many; never its jumps."""
        kinks = [time for time, order in self.breaks_at if order == 1]
        records = kinks if len(kinks) > MOST_CUTS else []
        return frozenset([*records, *(time for time, order in self.breaks_at if order > 2)])

    def within(self, start: float, end: float) -> _Table:
        first = int(np.searchsorted(self.knots, start, side="right"))
        last = int(np.searchsorted(self.knots, end, side="left"))
        return replace(self, first=first, last=max(first, last))

    def at(self, t: float) -> FloatArray:
        # At a break the segment of the span is asked for, not that beyond it.
        segment = bisect_right(self.knots, t)
        segment = min(max(segment, self.first), self.last)
        s = t - float(self.origins[segment])
        # Value, rate and acceleration of 1, s, s², s³.
        powers = np.array([[1.0, s, s**2, s**3], [0.0, 1.0, 2.0 * s, 3.0 * s**2], [0.0, 0.0, 2.0, 6.0 * s]])
        return np.asarray(powers @ self.coefficients[segment])

    def coefficients_about(self, origin: float) -> FloatArray | None:
        if self.first != self.last:
            return None
        moved = origin - self.origins[self.first]
        constant, linear, quadratic, cubic = self.coefficients[self.first]
        return np.array(
            [
                constant + moved * (linear + moved * (quadratic + moved * cubic)),
                linear + moved * (2.0 * quadratic + moved * 3.0 * cubic),
                quadratic + moved * 3.0 * cubic,
                cubic,
            ]
        )

    def values_at(self, times: FloatArray) -> FloatArray:
        segments = np.clip(np.searchsorted(self.knots, times, side="right"), self.first, self.last)
        s = (times - self.origins[segments])[:, None]
        constant, linear, quadratic, cubic = np.moveaxis(self.coefficients[segments], 1, 0)
        return np.asarray(constant + s * (linear + s * (quadratic + s * cubic)))


@lru_cache(maxsize=16)
def _path_of(motion: InputMotion, degrees: int) -> _Path:
    """Make the path of an input with so many Legendre coefficients; it is kept for further levels of a search."""
    if motion.is_table:
        return _table_of(motion)
    # A wave without frequency is refused where the scene is read.
    assert motion.frequency is not None
    angular_frequency = 2 * np.pi * motion.frequency
    amplitude = motion.amplitudes
    zero = np.zeros_like(amplitude)
    if motion.travels:
        # sin(ω t + φ − α) = sin(ω t + φ) cos α − cos(ω t + φ) sin α, with α = 2π X/wavelength.
        cosine, sine = np.zeros((2, degrees))
        cosine[: motion.degrees], sine[: motion.degrees] = motion.along_the_rod
        of_sine = np.outer(cosine, amplitude).ravel()
        of_cosine = -np.outer(sine, amplitude).ravel()
        return _Wave(np.zeros_like(of_sine), of_sine, of_cosine, angular_frequency, motion.phase)
    if motion.wave == "one_minus_cosine":
        return _Wave(amplitude, zero, -amplitude, angular_frequency, motion.phase)
    return _Wave(zero, amplitude, zero, angular_frequency, motion.phase)


def _table_of(motion: InputMotion) -> _Table:
    knots = motion.knots
    values = motion.knot_values
    coefficients = table_coefficients(knots, values, motion.interpolation)
    breaks = [(time, 0) for time in motion.jumps] + [(time, 1) for time in motion.kinks]
    if motion.interpolation == "cubic":
        breaks = _cubic_breaks(knots, values)
    origins = np.concatenate([knots[:1], knots])
    return _Table(knots, origins, coefficients, tuple(breaks), first=0, last=len(knots))


def _cubic_breaks(knots: FloatArray, values: FloatArray) -> list[tuple[float, int]]:
    """Breaks of a spline at its knots: accelerations jump at its ends, their rates between; none of a constant."""
    if not np.any(np.ptp(values, axis=0)):
        return []
    inside = [(time, 3) for time in knots[1:-1].tolist()]
    return [(float(knots[0]), 2), *inside, (float(knots[-1]), 2)]
