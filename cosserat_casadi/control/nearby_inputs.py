"""Inputs that meet targets near an equilibrium: Newton's method for rows of a table, whose neighbours are known.

The equilibrium r(x, u) = 0 and the weighted errors e(x, u) of the targets are linearised together. With the derivatives
K = ∂r/∂x, R = ∂r/∂u and E_x, E_u of the errors, the unknowns follow a change du of the inputs by
dx = −K⁻¹ (r + R du), so that errors become

    e − E_x K⁻¹ r + (E_u − E_x K⁻¹ R) du .

The shortest du that makes them zero is taken, in the scales of the inputs; one that would leave its range stays at the
end of it, and the others make up for it. A few turns, of which the last are quadratic, where an optimiser takes rounds.
Where this does not end at the targets, nothing is said about whether another method would.
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np
import numpy.typing as npt

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model

MOST_TURNS = 15
"""Turns before the search is given up: near ones take three to six."""

LONGEST = 0.3
"""Largest change of an input, in its scale, or of an unknown in one turn."""

NO_ERROR = 1e-9
"""Weighted error of a target, without unit, that counts as none."""

SETTLED = 1e-10
"""Change of inputs, in their scales, and of unknowns that counts as none."""

UNMOVED = 1e-9
"""Share of the largest singular value below which inputs do not move the errors."""


@dataclass(frozen=True)
class NearbyInputs:
    """A model, the errors of its targets and their derivatives.

    Attributes:
        model: the model.
        errors: x, changes of n inputs in their scales, origin, wanted poses ↦ e, E_x, E_u; E_u in the scales too.
        entries: of the stacked inputs that may change, shape (n,).
        scale: of these, shape (n,).
    """

    model: Model
    errors: ca.Function
    entries: npt.NDArray[np.int64]
    scale: FloatArray

    def found(
        self,
        x: FloatArray,
        change: FloatArray,
        origin: FloatArray,
        wanted: FloatArray,
        ranges: tuple[FloatArray, FloatArray],
    ) -> tuple[FloatArray, FloatArray] | None:
        """Unknowns, shape (size,), and changes of the inputs, shape (n,), without errors; None where not found.

        Args:
            x: unknowns to start from.
            change: changes of the inputs to start from.
            origin: stacked inputs that changes count from.
            wanted: poses that the targets ask for.
            ranges: least and largest changes, shape (n,) each.
        """
        lower, upper = ranges
        for _ in range(MOST_TURNS):
            inputs = origin.copy()
            inputs[self.entries] += self.scale * change
            stiffness, residual = (part.full() for part in self.model.jacobian(x, inputs))
            by_input = self.model.input_jacobian(x, inputs).full()[:, self.entries] * self.scale
            errors, errors_by_x, errors_by_change = (part.full() for part in self.errors(x, change, origin, wanted))
            try:
                follows = np.linalg.solve(stiffness, np.column_stack([residual, by_input]))
            except np.linalg.LinAlgError:
                return None
            balanced = errors[:, 0] - errors_by_x @ follows[:, 0]
            moved = errors_by_change - errors_by_x @ follows[:, 1:]
            if not (np.all(np.isfinite(balanced)) and np.all(np.isfinite(moved))):
                return None
            step = _shortest(moved, balanced, lower - change, upper - change)
            x_step = -follows[:, 0] - follows[:, 1:] @ step
            largest = max(float(np.abs(step).max(initial=0.0)), float(np.abs(x_step).max(initial=0.0)))
            if largest <= SETTLED:
                # Steps settle too where the ranges end short of the targets.
                reached = float(np.abs(errors).max(initial=0.0)) <= NO_ERROR
                return (x, change) if reached else None
            share = min(1.0, LONGEST / largest)
            x = x + share * x_step
            change = np.clip(change + share * step, lower, upper)
        return None


def _shortest(moved: FloatArray, errors: FloatArray, lower: FloatArray, upper: FloatArray) -> FloatArray:
    """A short change of n inputs within ranges that takes m errors away, as far as inputs not at an end of theirs can.

    Args:
        moved: what each input moves the errors by, shape (m, n).
        errors: shape (m,).
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
