"""Motion over a stretch of time in which the equations are smooth: collocation steps, adaptive or of a given size.

Equations that jump or have a kink in time are integrated piece by piece: a step must not reach over a kink. See
:mod:`step_control` for the error that decides the size of a step, and :mod:`stage_newton` for its equations.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import replace
from math import isclose
from typing import Protocol

import numpy as np

from cosserat_casadi.numerics.collocation import STAGES, Collocation
from cosserat_casadi.numerics.given_step import solve_given_step
from cosserat_casadi.numerics.guards import Guards
from cosserat_casadi.numerics.integration import (
    AfterStep,
    Integration,
    IntegrationCost,
    Settle,
    StepOutcome,
    StepSettings,
)
from cosserat_casadi.numerics.motion_equations import Instant, MotionEquations
from cosserat_casadi.numerics.step import CarriedStep
from cosserat_casadi.numerics.step_control import StepControl
from cosserat_casadi.numerics.step_run import RESOLVED_TIME, StepRun

FIRST_SHARE = 1e-3
"""Default first step, as a share of the piece."""

SINGULAR_STEPS = 4
"""Consecutive, ever shorter steps with singular matrices after which the equations count as singular."""

SINGULAR_SHRINKAGE = 0.1
"""Factor on a step whose matrices are singular."""

TRIES = 1000
"""Number of tried steps over which the pace of a motion is judged."""

SLOWEST = 3e-6
"""Least share of the piece per try, on average; with less, the end is hundreds of thousands of tries away."""

WHOLE = 1e-9
"""Distance of a quotient of times from an integer that counts as rounding."""

ROUNDING = 1e-14
"""Relative difference of two times up to which they count as equal."""

FAILED_SHRINKAGE = 0.5
"""Factor on a step whose equations were not solved."""


class StepsElsewhere(Protocol):
    """The steps of one integration, taken by other code than this module with equal results to the last digit."""

    def take(self, one: bool) -> tuple[StepOutcome | None, list[float]]:
        """Take one step, or many, and append them to the rows of the run.

        Returns:
            the outcome of the motion, None if it goes on; and the start time of each step that was tried, s.
        """


Stepper = Callable[[StepRun, StepControl, float], StepsElsewhere]
"""(run, control, shortest step) ↦ other code for the steps of the run, of controlled size."""

StepperAfter = Callable[[int, float], Stepper | None]
"""(iterations taken, share of the piece done) ↦ other code for the rest of the steps; None while there is none."""


def integrate(
    equations: MotionEquations,
    start: Instant,
    end: float,
    method: Collocation,
    settings: StepSettings,
    after_step: AfterStep | None = None,
    guards: Guards | None = None,
    settled: Settle | None = None,
    memory: CarriedStep | None = None,
    stepper: Stepper | None = None,
    stepper_after: StepperAfter | None = None,
) -> Integration:
    """Integrate equations of motion over a piece in which they are smooth.

    Args:
        equations: the equations.
        start: initial state, consistent with the constraints; its a and algebraic entries start the first iteration,
            and its a enters the first error estimate, see :func:`consistent_start`.
        end: end time, s.
        method: the collocation method.
        settings: settings of the steps.
        after_step: callback after every step.
        guards: values that must not become negative; at the zero of one, the motion ends.
        settled: correction of the end of each step; None for no correction.
        memory: data of the steps up to the start, if a motion continues within a piece with the steps of one motion.
        stepper: other code for steps of controlled size; None for the code of this module.
        stepper_after: function that offers other code for the rest after each step of this module; None without it.

    Raises:
        ValueError: the method does not suit the equations or the settings; or times, sizes or tolerances are not
            positive.
    """
    _check(equations, start, end, method, settings)
    run = StepRun(equations, method, settings, start, end, guards, settled, before=memory)
    outcome = StepOutcome.INTERRUPTED
    try:
        # Numbers that overflow are found where they are judged.
        with np.errstate(all="ignore"):
            if settings.size is None:
                outcome = _controlled_steps(run, after_step, stepper, stepper_after)
            else:
                outcome = _equal_steps(run, settings.size, after_step)
    except KeyboardInterrupt:
        # What was computed stands: whoever stops a long motion wants to see it.
        outcome = StepOutcome.INTERRUPTED
    return run.result(outcome)


def _check(equations: MotionEquations, start: Instant, end: float, method: Collocation, settings: StepSettings) -> None:
    """Refuse equations, times and settings that cannot be integrated.

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


def _equal_steps(run: StepRun, size: float, after_step: AfterStep | None) -> StepOutcome:
    """Take equal steps no longer than a given size."""
    begin = run.begun
    # A quotient that is whole up to rounding is meant to be whole: motions of other lengths have the same steps.
    quotient = (run.stop - begin) / size
    count = max(1, int(np.ceil(quotient - WHOLE)))
    run.size = size if abs(count - quotient) <= WHOLE else (run.stop - begin) / count
    taken = round((run.start.time - begin) / run.size)
    if run.before is not None and not isclose(
        begin + taken * run.size, run.start.time, rel_tol=ROUNDING, abs_tol=WHOLE * run.size
    ):
        # The motion goes on from within one of these steps: the steps that follow are counted from there.
        run.before = replace(run.before, begun=run.start.time)
        return _equal_steps(run, size, after_step)
    for number in range(taken + 1, count + 1):
        end = run.stop if number == count else begin + number * run.size
        solution = solve_given_step(run)
        if isinstance(solution, StepOutcome):
            return solution
        run.accept(solution, end, float("nan"), run.size)
        if run.stopped_by_guard():
            return StepOutcome.GUARDED
        if after_step is not None:
            after_step(end, run.size)
    return StepOutcome.COMPLETED


def _crawls(reached: Sequence[float], length: float) -> bool:
    """Whether the pace of a motion is too slow to reach its end.

    A motion whose steps shrink does not count: it is about to end by their size.

    Args:
        reached: start times of the last tries, at most TRIES, s.
        length: duration of the piece, s.
    """
    if len(reached) < TRIES or reached[-1] - reached[0] >= SLOWEST * TRIES * length:
        return False
    middle = reached[TRIES // 2]
    return reached[-1] - middle > (middle - reached[0]) / 2


def _controlled_steps(
    run: StepRun, after_step: AfterStep | None, stepper: Stepper | None, stepper_after: StepperAfter | None
) -> StepOutcome:
    """Take steps as long as the tolerance allows."""
    length = run.stop - run.begun
    resolved = RESOLVED_TIME * max(abs(run.start.time), abs(run.stop))
    shortest = max(run.settings.shortest * length, resolved)
    first = run.settings.first or FIRST_SHARE * length
    control = StepControl(run.method.stages, run.settings.longest, min(first, run.settings.longest))
    if run.before is not None:
        control.remember(run.before.size, run.before.error)
    if run.method.stages != STAGES or len(run.equations.eliminated):
        # Linear systems with eliminated entries are condensed here alone.
        stepper = stepper_after = None
    if stepper is not None:
        return _steps_elsewhere(run, control, stepper(run, control, shortest), after_step)
    reason = StepOutcome.STEP_TOO_SMALL
    singular_steps = 0
    # Times reached before each of the last tries.
    reached = deque([run.now.time], maxlen=TRIES)
    while run.now.time < run.stop:
        if _crawls(reached, length):
            run.size = control.wanted
            return StepOutcome.TOO_MANY_STEPS
        reached.append(run.now.time)
        run.size = control.wanted
        if run.size < shortest or singular_steps == SINGULAR_STEPS:
            return reason
        run.size, end = _next_step(run.now.time, control.wanted, run.stop)
        refusal = _try_step(run, control, end)
        if refusal is None:
            singular_steps = 0
            if run.stopped_by_guard():
                return StepOutcome.GUARDED
            if after_step is not None:
                after_step(end, run.steps[-1].size)
            if stepper_after is not None and run.now.time < run.stop:
                stepper = stepper_after(run.cost.iterations, (run.now.time - run.begun) / length)
                if stepper is not None:
                    return _steps_elsewhere(run, control, stepper(run, control, shortest), after_step)
            continue
        reason = refusal
        run.cost += IntegrationCost(rejected=1)
        if refusal is StepOutcome.SINGULAR:
            singular_steps += 1
    run.size = control.wanted
    return StepOutcome.COMPLETED


def _steps_elsewhere(
    run: StepRun, control: StepControl, steps: StepsElsewhere, after_step: AfterStep | None
) -> StepOutcome:
    """Let other code take steps as long as the tolerance allows, one by one if there is a callback."""
    length = run.stop - run.begun
    looked_at = after_step is not None or run.guards is not None or run.settled is not None
    reached = deque([run.now.time], maxlen=TRIES)
    while True:
        before = len(run.steps)
        outcome, tried = steps.take(looked_at)
        if _crawls(reached, length):
            run.size = control.wanted
            return StepOutcome.TOO_MANY_STEPS
        reached.extend(tried)
        if len(run.steps) > before:
            if run.stopped_by_guard():
                return StepOutcome.GUARDED
            if after_step is not None:
                after_step(run.now.time, run.steps[-1].size)
        if outcome is not None:
            run.size = control.wanted
            return outcome


def _next_step(now: float, wanted: float, stop: float) -> tuple[float, float]:
    """Choose the size of the next step and its end, s, so that no tiny step remains at the end of the piece."""
    remaining = stop - now
    if remaining <= wanted:
        return remaining, stop
    if remaining < 2.0 * wanted:
        return remaining / 2.0, now + remaining / 2.0
    # Not the difference of the times: its rounding would ask for new matrices.
    return wanted, now + wanted


def _try_step(run: StepRun, control: StepControl, end: float) -> StepOutcome | None:
    """Try a step of the run's size and choose the next size; None if it is accepted, else how the motion may end."""
    solution = run.solve()
    if isinstance(solution, StepOutcome):
        shrinkage = SINGULAR_SHRINKAGE if solution is StepOutcome.SINGULAR else FAILED_SHRINKAGE
        control.refuse(run.size, shrinkage)
        if solution is StepOutcome.NOT_SOLVED:
            return StepOutcome.STEP_TOO_SMALL
        return solution

    after_a_jump = control.refused or not (run.steps or run.before)
    error = run.error_of(solution, after_a_jump)
    # Not "error > 1": an error that is not a number must not be accepted.
    if not error <= 1.0:
        control.refuse_error(run.size, error, solution.iterations)
        return StepOutcome.STEP_TOO_SMALL
    control.accept(run.size, error, solution.iterations)
    run.accept(solution, end, error, control.wanted)
    return None
