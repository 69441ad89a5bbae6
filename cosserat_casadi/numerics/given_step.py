"""A step of prescribed size: where its equations are not solved at once, the step grows to its size.

With one Jacobian for all stages, Newton's method fails where a step turns a rod far; with one at each stage it goes on.
Where that fails too, a shorter step from the same start is solved first. No shorter step may stand for the
prescribed one, but as the size grows, the accelerations and multipliers at the stages change with it continuously: the
solution for one size predicts the solution for the next, until the prescribed size is reached.
"""

from __future__ import annotations

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
    share, longest = _grown(run, wanted)
    run.size = wanted
    if longest is not None and share == 1.0:
        return longest
    if longest is not None and solution is StepOutcome.SINGULAR:
        # The matrices are so at the given size alone.
        return StepOutcome.NOT_SOLVED
    return solution


def _grown(run: StepRun, wanted: float) -> tuple[float, StageSolution | None]:
    """The step with a Jacobian at each stage, of a size that grows to the given one.

    Returns:
        the largest share of the size that was solved, and the solution; 0 and None where none is solved.
    """
    longest = 0.0
    solution = None
    growth = 1.0
    while longest < 1.0 and growth >= LEAST_GROWTH:
        share = min(1.0, longest + growth)
        run.size = share * wanted
        if solution is None:
            guess = run.guess()
        else:
            # The stages of the longer step are at these times of the shorter one.
            guess = run.method.values_at(run.method.nodes * (share / longest)) @ solution.unknowns
        longer = run.solve_coupled(guess)
        if longer is None:
            growth /= 2.0
        else:
            longest, solution = share, longer
            growth *= LONGER
    return longest, solution
