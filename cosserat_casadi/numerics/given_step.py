"""A step of prescribed size: where its equations are not solved at once, the step grows to its size.

With one Jacobian for all stages, Newton's method fails where a step turns a rod far; with one at each stage it goes on.
Where that fails too, a shorter step from the same start is solved first. No shorter step may stand for the
prescribed one, but as the size grows, the accelerations and multipliers at the stages change with it continuously: the
solution for one size predicts the solution for the next, until the prescribed size is reached.
"""

from __future__ import annotations

from dataclasses import dataclass

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.numerics.integration import StepOutcome
from cosserat_casadi.numerics.stage_newton import StageSolution
from cosserat_casadi.numerics.step_run import StepRun

LEAST_GROWTH = 2.0**-8
"""Smallest growth that is tried, as a share of the given size."""

LONGER = 1.5
"""Factor on the growth after one that was solved; it is halved after one that was not."""


def solve_given_step(run: StepRun) -> StageSolution | StepOutcome:
    """Solve the equations of the next step of a run, of its present size; else say how the motion ends."""
    solution = run.solve()
    if not isinstance(solution, StepOutcome):
        return solution
    wanted = run.size
    longest = _grown(run, wanted)
    run.size = wanted
    if longest is not None and longest.share == 1.0:
        return longest.solution
    if longest is not None and solution is StepOutcome.SINGULAR:
        # The matrices are so at the given size alone.
        return StepOutcome.NOT_SOLVED
    return solution


@dataclass(frozen=True)
class Longest:
    """The longest step that was solved."""

    share: float
    solution: StageSolution


def _grown(run: StepRun, wanted: float) -> Longest | None:
    """The step with a Jacobian at each stage, of a size that grows to the given one; None where none is solved."""
    longest = None
    growth = 1.0
    while longest is None or longest.share < 1.0:
        if growth < LEAST_GROWTH:
            break
        share = min(1.0, growth if longest is None else longest.share + growth)
        run.size = share * wanted
        solution = run.solve_coupled(_first_iterate(run, share, longest))
        if solution is None:
            growth /= 2.0
        else:
            longest = Longest(share, solution)
            growth *= LONGER
    return longest


def _first_iterate(run: StepRun, share: float, longest: Longest | None) -> FloatArray:
    """Unknowns of the stages as the shorter step, or the step before, has them at their times, shape (s, n)."""
    if longest is None:
        return run.guess()
    shares = run.method.nodes * (share / longest.share)
    return run.method.values_at(shares) @ longest.solution.unknowns
