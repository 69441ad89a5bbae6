"""Statuses of the solver in C, and the outcomes that they are."""

from cosserat_casadi.numerics.outcome import Outcome

OUTCOMES = (
    Outcome.CONVERGED,
    Outcome.MAX_ITERATIONS,
    Outcome.NOT_FINITE,
    Outcome.SINGULAR,
    Outcome.LOAD_STALLED,
    Outcome.UNRESOLVED,
)
"""Statuses of the solver in C, in the order of their numbers."""
