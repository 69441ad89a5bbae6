"""Motion over a stretch of time in which the equations are smooth: collocation steps, adaptive or of a given size.

Equations that jump or have a kink in time are integrated piece by piece: a step must not reach over a kink. See
:mod:`step_control` for the error that decides the size of a step, and :mod:`stage_newton` for its equations. A Jacobian
serves several steps while few iterations suffice.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from enum import Enum

import numpy as np

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.numerics.collocation import Collocation
from cosserat_casadi.numerics.motion_equations import Instant, Linearisation, MotionEquations
from cosserat_casadi.numerics.stage_newton import NewtonBounds, StageOutcome, StageSolution, solve_stages
from cosserat_casadi.numerics.step import Step, end_of, extrapolated, motion_at
from cosserat_casadi.numerics.step_control import MOST_ITERATIONS, StepControl, estimated_error
from cosserat_casadi.numerics.step_matrices import StepMatrices, step_matrices

FEW_ITERATIONS = 4
"""Iterations of a step up to which its Jacobian serves the next step too: to save more of them costs as much."""

ITERATIONS_OF_GIVEN_STEP = 40
"""Most Newton iterations of a step whose size is given: no shorter one may be tried."""

FIRST_SHARE = 1e-3
"""First step as a share of the piece, where none is suggested."""

SINGULAR_STEPS = 4
"""Steps in a row, each shorter than the last, whose matrices are singular before the equations count as singular."""

SINGULAR_SHRINKAGE = 0.1
"""What is left of a step whose matrices are singular."""

RESOLVED_TIME = 16.0 * float(np.finfo(np.float64).eps)
"""Smallest step, relative to the time, that rounding of the time does not blur."""

FAILED_SHRINKAGE = 0.5
"""What is left of a step whose equations were not solved."""


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
    """

    tolerance: FloatArray
    size: float | None = None
    first: float | None = None
    longest: float = np.inf
    shortest: float = 1e-9
    newton: float = 1e-3


@dataclass(frozen=True)
class StepStatistics:
    """What an integration cost.

    Attributes:
        steps: steps taken.
        rejected: steps refused, for their error or because their equations were not solved.
        iterations: Newton iterations, of refused steps too; each evaluates F at every stage.
        jacobians: Jacobians evaluated.
        factorisations: times that the matrices of a step were factorised.
    """

    steps: int
    rejected: int
    iterations: int
    jacobians: int
    factorisations: int


@dataclass(frozen=True)
class Integration:
    """A motion over one piece, or over the part of it that was reached.

    Attributes:
        start: where it began.
        steps: the steps taken, one after the other.
        outcome: how it ended.
        next_size: step that would come next, or that failed, s.
        statistics: what it cost.
    """

    start: Instant
    steps: tuple[Step, ...]
    outcome: StepOutcome
    next_size: float
    statistics: StepStatistics

    @property
    def end(self) -> Instant:
        """The last instant that was reached."""
        if not self.steps:
            return self.start
        return self.steps[-1].end

    @property
    def message(self) -> str:
        """The sentence of the outcome, with time and size of the step where it ended early."""
        sentence = str(self.outcome.value)
        if self.outcome is StepOutcome.COMPLETED:
            return sentence
        return f"{sentence} Reached: t = {self.end.time:.9g} s, with a step of {self.next_size:.3g} s."


AfterStep = Callable[[float, float], None]
"""Called after each step with the time reached and the size of the step, s; KeyboardInterrupt ends the motion."""


def integrate(
    equations: MotionEquations,
    start: Instant,
    end: float,
    method: Collocation,
    settings: StepSettings,
    after_step: AfterStep | None = None,
) -> Integration:
    """Integrate equations of motion over a piece in which they are smooth.

    Args:
        equations: the equations.
        start: where to begin, consistent with the constraints; its a and its algebraic entries begin the first
            iteration, and its a the first estimate of an error, see :func:`consistent_start`.
        end: time, s.
        method: the collocation method.
        settings: how to step.
        after_step: told of every step.

    Raises:
        ValueError: the method does not suit the equations or the settings; or times, sizes or tolerances are not
            positive.
    """
    _check(equations, start, end, method, settings)
    run = _Run(equations, method, settings, start, end)
    outcome = StepOutcome.INTERRUPTED
    try:
        # Numbers that overflow are found where they are judged.
        with np.errstate(all="ignore"):
            if settings.size is None:
                outcome = _controlled_steps(run, after_step)
            else:
                outcome = _equal_steps(run, settings.size, after_step)
    except KeyboardInterrupt:
        # What was computed stands: whoever stops a long motion wants to see it.
        outcome = StepOutcome.INTERRUPTED
    return run.result(outcome)


def _check(equations: MotionEquations, start: Instant, end: float, method: Collocation, settings: StepSettings) -> None:
    """Refuse what cannot be integrated.

    Raises:
        ValueError: with all that is wrong.
    """
    wrong = []
    if not end > start.time:
        wrong.append(f"end: {end} is not after the start, {start.time}; give a later one")
    if not np.all(settings.tolerance[equations.differential] > 0.0):
        wrong.append("tolerance: must be positive for every differential entry")
    for name, size in (("size", settings.size), ("first", settings.first)):
        if size is not None and not 0.0 < size < np.inf:
            wrong.append(f"{name}: {size} is no positive step")
    if not method.stiffly_accurate and settings.size is None:
        wrong.append(f"size: {method.name} estimates no error; give the size of its steps, or take Radau IIA")
    if not method.stiffly_accurate and not np.all(equations.differential):
        wrong.append(f"method: {method.name} does not converge for equations with multipliers; take Radau IIA")
    if wrong:
        raise ValueError("; ".join(wrong))


@dataclass
class _Run:
    """What changes from one step to the next.

    Attributes:
        equations: the equations.
        method: the collocation method.
        settings: how to step.
        start: where the motion begins.
        stop: time at which it shall end, s.
        steps: the steps taken.
        size: of the step to be tried next, s.
        bounds: weights of an error, and when Newton's method stops.
        linearisation: the Jacobian in use; None where the next step needs a new one.
        fresh: whether that Jacobian was evaluated after the last instant reached.
        matrices: the linear systems in use; None where there are none for the Jacobian.
        rejected: steps refused.
        iterations: Newton iterations.
        jacobians: Jacobians evaluated.
        factorisations: times that matrices were factorised.
    """

    equations: MotionEquations
    method: Collocation
    settings: StepSettings
    start: Instant
    stop: float
    steps: list[Step] = field(default_factory=list)
    size: float = 0.0
    linearisation: Linearisation | None = None
    fresh: bool = False
    matrices: StepMatrices | None = None
    rejected: int = 0
    iterations: int = 0
    jacobians: int = 0
    factorisations: int = 0

    def __post_init__(self) -> None:
        differential = self.equations.differential
        weights = np.zeros(self.equations.size)
        weights[differential] = 1.0 / self.settings.tolerance[differential]
        iterations = MOST_ITERATIONS if self.settings.size is None else ITERATIONS_OF_GIVEN_STEP
        self.bounds = NewtonBounds(weights, self.settings.newton, iterations)

    @property
    def now(self) -> Instant:
        """The last instant reached."""
        if not self.steps:
            return self.start
        return self.steps[-1].end

    def result(self, outcome: StepOutcome) -> Integration:
        """The end of the integration."""
        statistics = StepStatistics(
            steps=len(self.steps),
            rejected=self.rejected,
            iterations=self.iterations,
            jacobians=self.jacobians,
            factorisations=self.factorisations,
        )
        return Integration(self.start, tuple(self.steps), outcome, self.size, statistics)

    def renew_jacobian(self) -> None:
        """Have the next step evaluate a Jacobian of its own."""
        self.linearisation = None
        self.matrices = None

    def solve(self) -> StageSolution | StepOutcome:
        """Solve the equations of a step of the present size; else say how the motion ends if no other is tried."""
        solution = self._solve_with_jacobian()
        if isinstance(solution, StepOutcome) and not self.fresh:
            # The Jacobian may be too old: the same step gets one of its own.
            self.renew_jacobian()
            solution = self._solve_with_jacobian()
        if isinstance(solution, StepOutcome):
            # A shorter step has its middle elsewhere.
            self.renew_jacobian()
        return solution

    def _solve_with_jacobian(self) -> StageSolution | StepOutcome:
        """Solve with the Jacobian in use, or a new one where there is none."""
        linearisation = self.linearisation
        if linearisation is None:
            linearisation = self.equations.linearised(self.predicted_middle())
            self.linearisation = linearisation
            self.jacobians += 1
            self.fresh = True
        if not linearisation.finite:
            return StepOutcome.NOT_FINITE
        if self.matrices is None or self.matrices.step != self.size:
            self.matrices = step_matrices(self.method, self.size, linearisation, self.equations.differential)
            self.factorisations += 1
        if self.matrices is None:
            return StepOutcome.SINGULAR
        solution = solve_stages(self.equations, self.matrices, self.now, self.guess(), self.bounds)
        self.iterations += solution.iterations
        if solution.outcome is StageOutcome.NOT_FINITE:
            return StepOutcome.NOT_FINITE
        if solution.outcome is StageOutcome.DIVERGED:
            return StepOutcome.NOT_SOLVED
        return solution

    def guess(self) -> FloatArray:
        """First iterate of the stages: the polynomial of the step before, or the start."""
        if self.steps:
            return extrapolated(self.steps[-1], self.size)
        unknowns = np.where(self.equations.differential, self.start.a, self.start.x)
        return np.tile(unknowns, (self.method.stages, 1))

    def predicted_middle(self) -> Instant:
        """The middle of the step as the first iterate has it: a Jacobian there is nearest to those of all stages."""
        time = self.now.time + self.size / 2.0
        return motion_at(self.method, self.equations.differential, self.now, self.size, self.guess(), 0.5, time)

    def error_of(self, solution: StageSolution, after_a_jump: bool) -> float:
        """Estimated error over tolerance of the step that was solved last."""
        if self.matrices is None:
            return float("nan")
        return estimated_error(self.matrices, self.now, solution.unknowns, self.bounds, after_a_jump)

    def accept(self, solution: StageSolution, end: float, error: float) -> None:
        """Take a step, and decide whether its Jacobian serves the next one."""
        differential = self.equations.differential
        now = self.now
        arrived = end_of(self.method, differential, now, self.size, solution.unknowns, end)
        step = Step(
            method=self.method,
            differential=differential,
            start=now,
            size=self.size,
            unknowns=solution.unknowns,
            end=arrived,
            error=error,
            iterations=solution.iterations,
            residual=solution.residual,
            contraction=solution.contraction,
        )
        self.steps.append(step)
        self.fresh = False
        if solution.iterations > FEW_ITERATIONS:
            self.renew_jacobian()


def _equal_steps(run: _Run, size: float, after_step: AfterStep | None) -> StepOutcome:
    """Take equal steps no longer than a given size."""
    begin = run.start.time
    # A quotient that is whole up to rounding is meant to be whole.
    count = max(1, int(np.ceil((run.stop - begin) / size - 1e-9)))
    run.size = (run.stop - begin) / count
    for number in range(1, count + 1):
        end = begin + number * run.size
        if number == count:
            end = run.stop
        solution = run.solve()
        if isinstance(solution, StepOutcome):
            return solution
        run.accept(solution, end, float("nan"))
        if after_step is not None:
            after_step(end, run.size)
    return StepOutcome.COMPLETED


def _controlled_steps(run: _Run, after_step: AfterStep | None) -> StepOutcome:
    """Take steps as long as the tolerance allows."""
    length = run.stop - run.start.time
    resolved = RESOLVED_TIME * max(abs(run.start.time), abs(run.stop))
    shortest = max(run.settings.shortest * length, resolved)
    first = run.settings.first or FIRST_SHARE * length
    control = StepControl(run.method.stages, run.settings.longest, min(first, run.settings.longest))
    reason = StepOutcome.STEP_TOO_SMALL
    singular_steps = 0
    while run.now.time < run.stop:
        run.size = control.wanted
        if run.size < shortest or singular_steps == SINGULAR_STEPS:
            return reason
        end = _end_of_next(run.now.time, control.wanted, run.stop)
        run.size = end - run.now.time
        refusal = _try_step(run, control, end)
        if refusal is None:
            singular_steps = 0
            if after_step is not None:
                after_step(end, run.steps[-1].size)
            continue
        reason = refusal
        run.rejected += 1
        if refusal is StepOutcome.SINGULAR:
            singular_steps += 1
    run.size = control.wanted
    return StepOutcome.COMPLETED


def _end_of_next(now: float, wanted: float, stop: float) -> float:
    """Where a step of a wanted size ends, so that no tiny one is left at the end of the piece."""
    remaining = stop - now
    if remaining <= wanted:
        return stop
    if remaining < 2.0 * wanted:
        return now + remaining / 2.0
    return now + wanted


def _try_step(run: _Run, control: StepControl, end: float) -> StepOutcome | None:
    """Try a step of the run's size and choose the next one; None where it is taken, else why the motion may end."""
    solution = run.solve()
    if isinstance(solution, StepOutcome):
        shrinkage = FAILED_SHRINKAGE
        if solution is StepOutcome.SINGULAR:
            shrinkage = SINGULAR_SHRINKAGE
        control.refuse(run.size, shrinkage)
        if solution is StepOutcome.NOT_SOLVED:
            return StepOutcome.STEP_TOO_SMALL
        return solution

    after_a_jump = control.refused or not run.steps
    error = run.error_of(solution, after_a_jump)
    # Not "error > 1": an error that is not a number must not be accepted.
    if not error <= 1.0:
        control.refuse_error(run.size, error, solution.iterations)
        return StepOutcome.STEP_TOO_SMALL
    control.accept(run.size, error, solution.iterations)
    run.accept(solution, end, error)
    return None
