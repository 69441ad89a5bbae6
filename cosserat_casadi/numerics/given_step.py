"""A step of prescribed size, which grows to its size if its equations cannot be solved at once.

With one Jacobian for all stages, Newton's method fails if a step turns a rod far; with one at each stage it converges
further. If that fails too, a shorter step from the same start is solved first. A shorter step cannot replace the
prescribed one, but the accelerations and multipliers at the stages are continuous functions of the size: the solution
for one size predicts the solution for the next, until the prescribed size is reached.
"""

from __future__ import annotations

from cosserat_casadi.numerics.integration import StepOutcome
from cosserat_casadi.numerics.stage_newton import StageSolution
from cosserat_casadi.numerics.step_run import StepRun

LEAST_GROWTH = 2.0**-8
"""Least increment of the size that is tried, over the prescribed size."""

LONGER = 1.5
"""Factor on the increment after a solved size; it is halved after an unsolved one."""


def solve_given_step(run: StepRun) -> StageSolution | StepOutcome:
    """Solve the equations of the next step of a run, of its present size, or return how the motion ends."""
    solution = run.solve()
    if not isinstance(solution, StepOutcome):
        return solution
    wanted = run.size
    share, longest = _grown(run, wanted)
    run.size = wanted
    if longest is not None and share == 1.0:
        return longest
    if longest is not None and solution is StepOutcome.SINGULAR:
        # Only the matrices of the given size are singular.
        return StepOutcome.NOT_SOLVED
    return solution


def _grown(run: StepRun, wanted: float) -> tuple[float, StageSolution | None]:
    """Solve the step with a Jacobian at each stage, for a size that grows to the prescribed one.

    Returns:
        the largest share of the size that was solved, and the solution; 0 and None if none was solved.
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
