"""Inputs that meet targets near an equilibrium, by Newton's method for rows of a table with known neighbours.

The equilibrium r(x, u) = 0 and the weighted errors e(x, u) of the targets are linearised together. With the derivatives
K = ∂r/∂x, R = ∂r/∂u and E_x, E_u of the errors, the unknowns follow a change du of the inputs by
dx = −K⁻¹ (r + R du), so that errors become

    e − E_x K⁻¹ r + (E_u − E_x K⁻¹ R) du .

The shortest du that makes them zero is taken, in the scales of the inputs; an input that would leave its range stays at
its bound, and the others compensate. A few iterations, of which the last converge quadratically, replace rounds of an
optimiser. If they do not reach the targets, another method still may.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from cosserat_casadi.control.inverse_result import Inverse
from cosserat_casadi.control.lifted_problem import LiftedProblem
from cosserat_casadi.control.targets import wanted_poses
from cosserat_casadi.equilibrium.solution import Equilibrium
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.numerics.broyden import solved

MOST_TURNS = 15
"""Most iterations; near targets take three to six."""

LONGEST = 0.3
"""Largest change of an input, in its scale, or of an unknown in one iteration."""

NO_ERROR = 1e-9
"""Weighted dimensionless error of a target that counts as zero."""

SETTLED = 1e-10
"""Change of inputs, in their scales, and of unknowns that counts as zero."""

UNMOVED = 1e-9
"""Singular value, over the largest one, below which inputs do not change the errors."""


def followed(problem: LiftedProblem, start: Equilibrium[Any]) -> Inverse | None:
    """Run Newton's method from an equilibrium near the targets and judge the result; None if it does not converge."""
    model = problem.model
    wanted = wanted_poses(problem.targets)
    x = start.x
    change = problem.change(start.inputs)
    lower, upper = problem.ranges()
    for _ in range(MOST_TURNS):
        inputs = problem.inputs(change)
        stiffness, residual = (part.full() for part in model.jacobian(x, inputs))
        by_input = model.input_jacobian(x, inputs).full()[:, problem.variables.indices] * problem.scale
        linear = problem.errors(x, change, problem.origin, wanted)
        errors, errors_by_x, errors_by_change = (part.full() for part in linear)
        # The unknowns change by minus the first column, and by minus the others times du.
        follows = solved(stiffness, np.column_stack([residual, by_input]))
        if follows is None:
            return None
        balanced = errors[:, 0] - errors_by_x @ follows[:, 0]
        moved = errors_by_change - errors_by_x @ follows[:, 1:]
        if not (np.all(np.isfinite(balanced)) and np.all(np.isfinite(moved))):
            return None
        step = shortest(moved, balanced, lower - change, upper - change)
        x_step = -follows[:, 0] - follows[:, 1:] @ step
        largest = float(np.abs(np.concatenate([x_step, step])).max())
        if largest <= SETTLED:
            # Steps settle too where the ranges end short of the targets.
            reached = float(np.abs(errors).max(initial=0.0)) <= NO_ERROR
            return problem.judged(x, change, rounds=0) if reached else None
        share = min(1.0, LONGEST / largest)
        x = x + share * x_step
        change = np.clip(change + share * step, lower, upper)
    return None


def shortest(moved: FloatArray, errors: FloatArray, lower: FloatArray, upper: FloatArray) -> FloatArray:
    """Short change of n inputs within ranges that removes m errors, as far as inputs that are not at bounds can.

    Args:
        moved: derivatives of the errors by the inputs, shape (m, n).
        errors: errors, shape (m,).
        lower: least changes, shape (n,).
        upper: largest changes, shape (n,).

    Returns:
        shape (n,).
    """
    step = np.zeros(len(lower))
    free = np.ones(len(lower), dtype=bool)
    while np.any(free):
        left = errors + moved[:, ~free] @ step[~free]
        step[free] = -np.linalg.pinv(moved[:, free], rcond=UNMOVED) @ left
        outside = free & ((step < lower) | (step > upper))
        if not np.any(outside):
            break
        step[outside] = np.clip(step, lower, upper)[outside]
        free &= ~outside
    return step
