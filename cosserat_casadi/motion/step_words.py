"""Words of the templates of steps in C, exported or of motions with friction: limits, and the method's numbers."""

from __future__ import annotations

from typing import Any

from cosserat_casadi.compiling.c_tables import initialiser, method_words, pairs
from cosserat_casadi.numerics import consistent_start, stage_newton, step_matrices
from cosserat_casadi.numerics.collocation import radau
from cosserat_casadi.numerics.step_run import FEW_ITERATIONS

STEP_TOLERANCE = 1e-11
"""Displacement over the length that Newton's method may leave in a step: joints are open by no more."""

STEP_ITERATIONS, MOST_STEP_ITERATIONS = 12, 20
"""Corrections of one attempt at a step: where the caller names none, and at most."""

STEP_PARTS, MOST_STEP_PARTS = 8, 32
"""Parts that a step may be cut into: where the caller names none, and at most."""

STAGES = 2
"""Stages of the method, which step.c is written for."""

CONSISTENT = 1e-8
"""Constraint, without unit, and its rate times the duration, up to which a start is consistent."""


def limits_of_steps() -> dict[str, Any]:
    """Limits of a step."""
    return {
        "step_tolerance": STEP_TOLERANCE,
        "step_iterations": STEP_ITERATIONS,
        "most_step_iterations": MOST_STEP_ITERATIONS,
        "step_parts": STEP_PARTS,
        "most_step_parts": MOST_STEP_PARTS,
        "few_iterations": FEW_ITERATIONS,
        "stage_rounding": repr(stage_newton.ROUNDING),
        "stage_singular": 1.0 / step_matrices.SINGULAR,
        "least_contraction": stage_newton.LEAST_CONTRACTION,
        "diverging": stage_newton.DIVERGING,
        "massless": consistent_start.RANK,
        "closed": CONSISTENT,
    }


def words_of_method() -> dict[str, str]:
    """The method as initialisers, with its first eigenvalue."""
    method = radau(STAGES)
    eigenvalue = complex(method.eigenvalues[0])
    return {
        **method_words(method),
        "rate": initialiser(pairs([1.0 / eigenvalue])[0]),
        "share": initialiser(pairs([1.0 / eigenvalue**2])[0]),
        "to_eigenvector": initialiser(pairs(method.to_eigenvectors[0])),
        "from_eigenvector": initialiser(pairs(method.from_eigenvectors[:, 0])),
    }
