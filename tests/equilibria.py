"""Equilibria that tests of equations compare: without estimates of their errors, which take longer than the solve."""

from __future__ import annotations

from typing import Any

import cosserat_casadi
from cosserat_casadi import Model, Scene, Solution


def solve(subject: Model | Scene, values: Any = None, **options: Any) -> Solution:
    """The equilibrium, as :func:`cosserat_casadi.solve` gives it; that of a model has no estimate of its error."""
    if isinstance(subject, Model):
        options = {"estimate_error": False, **options}
    solution: Solution = cosserat_casadi.solve(subject, values, **options)
    return solution
