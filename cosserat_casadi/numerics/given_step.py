"""A step whose size is given: where its equations are not solved at once, shorter ones show the way to their solution.

No shorter step may stand for it, but what shorter ones arrive at is nearly what it arrives at: their accelerations at
the times of its stages are a first iterate that the step before, on its polynomial, cannot foretell.
"""

from __future__ import annotations

import numpy as np

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.numerics.integration import StepOutcome
from cosserat_casadi.numerics.stage_newton import StageSolution
from cosserat_casadi.numerics.step import Step
from cosserat_casadi.numerics.step_run import StepRun

MOST_HALVINGS = 5
"""Times that the steps which show the way are halved."""


def solve_given_step(run: StepRun) -> StageSolution | StepOutcome:
    """Solve the equations of the next step of a run, of its present size; else say how the motion ends."""
    solution = run.solve()
    if not isinstance(solution, StepOutcome):
        return solution
    for halvings in range(1, MOST_HALVINGS + 1):
        shorter = _shorter_steps(run, 2**halvings)
        if shorter is None:
            continue
        if solution is StepOutcome.SINGULAR:
            # So it is at this size alone.
            solution = StepOutcome.NOT_SOLVED
        found = run.solve(_at_stages(run, shorter))
        if not isinstance(found, StepOutcome):
            return found
    return solution


def _shorter_steps(run: StepRun, count: int) -> list[Step] | None:
    """So many steps in place of the next one; None where one of them is not solved."""
    begin = run.now.time
    parts = StepRun(run.equations, run.method, run.settings, run.now, begin + run.size)
    parts.size = run.size / count
    solved = True
    for number in range(1, count + 1):
        solution = parts.solve()
        if isinstance(solution, StepOutcome):
            solved = False
            break
        parts.accept(solution, begin + number * parts.size, float("nan"))
    run.iterations += parts.iterations
    run.jacobians += parts.jacobians
    run.factorisations += parts.factorisations
    return parts.steps if solved else None


def _at_stages(run: StepRun, shorter: list[Step]) -> FloatArray:
    """Accelerations and algebraic values of shorter steps at the stages of the next one, shape (s, n)."""
    rows = []
    for node in run.method.nodes:
        number = min(int(node * len(shorter)), len(shorter) - 1)
        instant = shorter[number].at(run.now.time + float(node) * run.size)
        rows.append(np.where(run.equations.differential, instant.a, instant.x))
    return np.stack(rows)
