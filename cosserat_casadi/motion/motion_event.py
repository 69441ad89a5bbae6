"""Events of users: zeros of a function of poses and inputs, which are recorded or end the motion.

A function that stops a motion is among the guards of the steps, like the guards of contacts, cables and stops: the
last step ends where the function vanishes. Events that are only recorded do not change the steps; they are found in
the polynomials of the finished steps.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import casadi as ca
import numpy as np

from cosserat_casadi.errors import Problem, SceneError
from cosserat_casadi.maths.typing import FloatArray, Matrix
from cosserat_casadi.model.build import Model
from cosserat_casadi.motion.event_restart import ContactEvent
from cosserat_casadi.motion.history import History
from cosserat_casadi.motion.moving_inputs import Piece
from cosserat_casadi.motion.repeated_call import RepeatedCall
from cosserat_casadi.numerics.events import bracketed_zero
from cosserat_casadi.numerics.guards import THROUGH, WATCHED, Guards
from cosserat_casadi.numerics.motion_equations import Instant

RISES = "rises"
FALLS = "falls"
"""Kinds of events in a result."""

AHEAD = 1e-6
"""Time after the start of a stretch at which a function that vanishes at the start shows its sign, s."""


@dataclass(frozen=True)
class MotionEvent:
    """A function of a moving scene whose zeros are events.

    Attributes:
        name: name of the event in the result.
        value: (model, x, inputs) ↦ scalar, as a CasADi expression of unknowns and stacked inputs, such as
            ``model.tip["arm"](x, inputs)[0][2]``, the height of a tip.
        stop: whether the motion ends where the function crosses zero, in either direction.
    """

    name: str
    value: Callable[[Model, ca.MX, ca.MX], Matrix]
    stop: bool = False


@dataclass(frozen=True)
class EventWatch:
    """The events of a motion on one model.

    Attributes:
        model: the model.
        events: the events.
    """

    model: Model
    events: Sequence[MotionEvent]

    def guards(self, piece: Piece, begin: Instant) -> Guards | None:
        """Make guards of the events that stop a motion, positive at the start of a stretch; None without such events.

        Args:
            piece: piece of the inputs.
            begin: start of the stretch, in the unknowns of the model.
        """
        numbers = self._stopping
        if self.events:
            # Values that are no numbers are refused before a step is taken.
            _ = self.values
        if not numbers:
            return None

        first = self._stopping_values(piece, begin)
        ahead = self._stopping_values(piece, Instant(begin.time + AHEAD, begin.x + AHEAD * begin.v, begin.v, begin.a))
        sides = np.where(np.where(np.abs(first) > THROUGH, first, ahead) < 0.0, -1.0, 1.0)
        return lambda instant: sides * self._stopping_values(piece, instant)

    def jumped(self, before: Piece, piece: Piece, at: Instant) -> int | None:
        """Number of an event that stops a motion and whose value jumps through zero with the inputs; None if none does.

        Args:
            before: piece of the inputs up to the jump.
            piece: piece of the inputs after the jump.
            at: instant of the jump, in the unknowns of the model.
        """
        if not self._stopping:
            return None
        ends = [self._stopping_values(one, at) for one in (before, piece)]
        through = np.flatnonzero((np.min(ends, axis=0) < -THROUGH) & (np.max(ends, axis=0) > THROUGH))
        return int(through[0]) if len(through) else None

    def _stopping_values(self, piece: Piece, instant: Instant) -> FloatArray:
        """Values of the events that stop a motion."""
        return self.values(instant.x[: self.model.size], piece.at(instant.time).value)[self._stopping]

    def crossings(self, history: History) -> tuple[ContactEvent, ...]:
        """Find all zeros of all events in a motion, including the one that stopped it, in order of time."""
        if not self.events or not history.steps:
            return ()
        steps = [step for _, step in history.steps]
        times = np.concatenate([step.start.time + step.size * WATCHED[:-1] for step in steps])
        times = np.append(times, steps[-1].end.time)
        x, inputs = history.rough_positions(times)
        rows = np.array([self.values(*place) for place in zip(x, inputs, strict=True)])
        # What begins at zero, to rounding, does not cross it there.
        rows[0] = np.where(np.abs(rows[0]) > THROUGH, rows[0], rows[1])
        found = []
        stopped = None if history.stopped is None else self._stopping[history.stopped]
        if stopped is not None:
            # The last step ends on the zero, to rounding: it is told once.
            rows[-1, stopped] = rows[-2, stopped]
            found.append(_crossing(self.events[stopped], float(times[-1]), rows[-2, stopped]))
        for k, event in enumerate(self.events):
            for i in np.flatnonzero((rows[:-1, k] > 0.0) != (rows[1:, k] > 0.0)):
                ends = [(float(times[j]), float(rows[j, k])) for j in (i, i + 1)]
                found.append(_crossing(event, bracketed_zero(self._value(history, k), *ends), rows[i, k]))
        return tuple(sorted(found, key=lambda one: one.time))

    def _value(self, history: History, number: int) -> Callable[[float], float]:
        def value(time: float) -> float:
            x, inputs = history.rough_positions(np.array([time]))
            return float(self.values(x[0], inputs[0])[number])

        return value

    @property
    def _stopping(self) -> list[int]:
        """Numbers of the events that stop the motion."""
        return [k for k, event in enumerate(self.events) if event.stop]

    @cached_property
    def values(self) -> RepeatedCall:
        """(x, inputs) ↦ values of all events."""
        x = ca.MX.sym("x", self.model.size)
        inputs = ca.MX.sym("inputs", self.model.inputs.size)
        rows = [ca.MX(event.value(self.model, x, inputs)) for event in self.events]
        for event, row in zip(self.events, rows, strict=True):
            if row.shape != (1, 1):
                problem = f"the value of {event.name!r} has shape {row.shape}"
                raise SceneError(Problem("events", problem, "give one number: a component, or a sum"))
        return RepeatedCall(ca.Function("events", [x, inputs], [ca.densify(ca.vertcat(*rows))]))


def _crossing(event: MotionEvent, time: float, before: float) -> ContactEvent:
    return ContactEvent(FALLS if before > 0.0 else RISES, time, event.name, "", 0.0)
