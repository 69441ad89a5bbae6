"""Words in the templates of steps in C, exported or with friction: limits, and coefficients of the method."""

from __future__ import annotations

from typing import Any

from cosserat_casadi.compiling.c_tables import initialiser, method_words, pairs
from cosserat_casadi.numerics import consistent_start, stage_newton, step_matrices
from cosserat_casadi.numerics.collocation import radau
from cosserat_casadi.numerics.step_run import FEW_ITERATIONS

STEP_TOLERANCE = 1e-11
"""Largest displacement error of Newton's method in a step, over the length; joints open by no more."""

STEP_ITERATIONS, MOST_STEP_ITERATIONS = 12, 20
"""Newton iterations of one attempt at a step: by default, and at most."""

STEP_PARTS, MOST_STEP_PARTS = 8, 32
"""Parts that a step may be cut into: by default, and at most."""

STAGES = 2
"""Stages of the Radau method; ``step.c`` is written for this number."""

CONSISTENT = 1e-8
"""Largest constraint residual, and rate of it times the duration, of a consistent start, without unit."""


def limits_of_steps() -> dict[str, Any]:
    """Limits of a step in C, by the words of the templates."""
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
    """Matrices of the method and its first eigenvalue, as initialisers in C, by the words of the templates."""
    method = radau(STAGES)
    eigenvalue = complex(method.eigenvalues[0])
    return {
        **method_words(method),
        "rate": initialiser(pairs([1.0 / eigenvalue])[0]),
        "share": initialiser(pairs([1.0 / eigenvalue**2])[0]),
        "to_eigenvector": initialiser(pairs(method.to_eigenvectors[0])),
        "from_eigenvector": initialiser(pairs(method.from_eigenvectors[:, 0])),
    }
