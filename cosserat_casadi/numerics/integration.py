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
    """Every way an integration can end. The value is the sentence that a user reads; numbers are beside it."""

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
    STALLED = "The motion was computed to where none of its equations go on."
    GUARDED = "The motion was computed to where it goes on under other equations."


@dataclass(frozen=True)
class StepSettings:
    """How to step.

    Attributes:
        tolerance: error of one step that each entry of x may have, shape (n,); entries that are algebraic are left out.
        size: of all steps, s, which then are not controlled: the piece is divided evenly into steps no longer; None
            for steps as long as the tolerance allows.
        first: first step, s, where steps are controlled; None for a small share of the piece.
        longest: longest step, s.
        shortest: shortest step, as a share of the piece.
        newton: error that Newton's method may leave, over the tolerance.
        lasting: time, s, over which the error of a shorter step acts: it counts by its quotient with the step.
        drifting: time, s, below which Newton's method may leave less, as the step is shorter: its error over the step
            is one of velocities, and what nothing holds keeps them.
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
        steps: steps taken.
        rejected: steps refused, for their error or because their equations were not solved.
        iterations: Newton iterations, of refused steps too; each evaluates F at every stage.
        jacobians: Jacobians evaluated.
        factorisations: times that the matrices of a step were factorised.
    """

    steps: int = 0
    rejected: int = 0
    iterations: int = 0
    jacobians: int = 0
    factorisations: int = 0

    def __add__(self, other: IntegrationCost) -> IntegrationCost:
        """Numbers of both integrations."""
        return IntegrationCost(*map(operator.add, vars(self).values(), vars(other).values()))


@dataclass(frozen=True)
class Integration:
    """A motion over one piece, or over the part of it that was reached.

    Attributes:
        start: where it began.
        steps: the steps taken, one after the other.
        outcome: how it ended.
        next_size: step that would come next, or that failed, s.
        statistics: numbers of its steps, iterations and factorisations.
        guard: number of the guard that came to zero; None where none did.
        memory: what a next step under the same equations would take over; None where there was no step.
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
        """The last instant that was reached."""
        return self.steps[-1].end if self.steps else self.start


def stalled_at(start: Instant) -> Integration:
    """A piece without a step: there are no equations to go on with."""
    return Integration(start, (), StepOutcome.STALLED, float("nan"), IntegrationCost())


AfterStep = Callable[[float, float], None]
"""Called after each step with the time reached and the size of the step, s; KeyboardInterrupt ends the motion."""

Settle = Callable[[TimeStep], Instant]
"""The end of a step, put right by what the method misses of an invariant: at most as much as the step is inexact by."""
