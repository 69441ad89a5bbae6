"""Settings of an integration in time, and its result."""

from __future__ import annotations

import operator
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import Enum

import numpy as np

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.numerics.motion_equations import Instant
from cosserat_casadi.numerics.step import CarriedStep, TimeStep


class StepOutcome(Enum):
    """Outcomes of an integration. The value is the sentence for the user, without numbers."""

    COMPLETED = "The motion was computed to its end."
    STEP_TOO_SMALL = "The motion was computed in part: the steps became too small, it may have no continuation."
    NOT_SOLVED = (
        "The motion was computed in part: the equations of a step of the given size were not solved; use smaller steps."
    )
    NOT_FINITE = "The motion was computed in part: the equations gave a value that is not a finite number."
    SINGULAR = (
        "The motion was computed in part: its equations are singular; constraints may contradict or repeat each other."
    )
    INTERRUPTED = "The motion was computed in part: it was interrupted."
    TOO_MANY_STEPS = "The motion was computed in part: its steps are so short that hundreds of thousands were needed."
    STALLED = "The motion was computed to a time beyond which none of its equations hold."
    GUARDED = "The motion was computed to a time from which on other equations hold."


@dataclass(frozen=True)
class StepSettings:
    """Settings of the time steps.

    Attributes:
        tolerance: tolerated error of each entry of x in one step, shape (n,); algebraic entries are ignored.
        size: largest size of equal steps, s, into which the piece is divided without error control; None for steps as
            long as the tolerance allows.
        first: first controlled step, s; None for a small share of the piece.
        longest: longest step, s.
        shortest: shortest step, as a share of the piece.
        newton: error of Newton's method, over the tolerance.
        lasting: time, s, over which the error of a shorter step acts; its error counts by this time over the step.
        drifting: step size, s, below which the allowed error of Newton's method falls with the size: the error over the
            step is a velocity, which a free rod keeps.
    """

    tolerance: FloatArray
    size: float | None = None
    first: float | None = None
    longest: float = np.inf
    shortest: float = 1e-9
    newton: float = 1e-3
    lasting: float = 0.0
    drifting: float = 0.0


@dataclass(frozen=True)
class IntegrationCost:
    """Numbers of steps, iterations and factorisations of an integration.

    Attributes:
        steps: number of accepted steps.
        rejected: number of steps refused for their error, or because their equations were not solved.
        iterations: number of Newton iterations, including refused steps; each evaluates F at every stage.
        jacobians: number of Jacobian evaluations.
        factorisations: number of factorisations of the matrices of a step.
    """

    steps: int = 0
    rejected: int = 0
    iterations: int = 0
    jacobians: int = 0
    factorisations: int = 0

    def __add__(self, other: IntegrationCost) -> IntegrationCost:
        """Sum the numbers of two integrations."""
        return IntegrationCost(*map(operator.add, vars(self).values(), vars(other).values()))


@dataclass(frozen=True)
class Integration:
    """A motion over one piece, or over the part of it that was reached.

    Attributes:
        start: state at the start.
        steps: the steps taken, in order.
        outcome: outcome of the integration.
        next_size: size of the next step, or of the step that failed, s.
        statistics: numbers of steps, iterations and factorisations.
        guard: index of the guard that came to zero; None if none did.
        memory: data that a next step under these equations would take over; None if there was no step.
    """

    start: Instant
    steps: Sequence[TimeStep]
    outcome: StepOutcome
    next_size: float
    statistics: IntegrationCost
    guard: int | None = None
    memory: CarriedStep | None = None

    @property
    def end(self) -> Instant:
        """The last instant of the integration."""
        return self.steps[-1].end if self.steps else self.start


def stalled_at(start: Instant) -> Integration:
    """Make the result of a piece without a step, as there are no equations to continue."""
    return Integration(start, (), StepOutcome.STALLED, float("nan"), IntegrationCost())


AfterStep = Callable[[float, float], None]
"""Callback after each step, (time reached, size of the step), s; KeyboardInterrupt in it ends the motion."""

Settle = Callable[[TimeStep], Instant]
"""Correction of the end of a step for the drift of an invariant, by at most the error of the step."""
