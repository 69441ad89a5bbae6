"""The distance of an answer in smooth contact from the answer with zero widths (docs/smooth-contact.md).

Layers push by a law F(g/w) of the gap over the width. With thinner layers and a stiffness in proportion to 1/w, the gap
under the same force is smaller in proportion: to first order the answer moves in proportion to the width. So its
derivative by the logarithm of all widths is its distance from the answer with zero widths. It follows from the
equations at the answer, dx = −J⁻¹ ∂r/∂(log w) by the implicit function theorem, without a solve.
"""

from __future__ import annotations

import numpy as np

from cosserat_casadi.equilibrium.answer_error import SAFETY, inverse_jacobian, watched_at
from cosserat_casadi.equilibrium.load_path import column
from cosserat_casadi.equilibrium.solution import Solution
from cosserat_casadi.maths.pose_change import change_size
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.function_table import kept_with

THINNER = 1e-3
"""Relative change of the widths for a difference of residuals; its error of second order is as small."""

WAY = 1e-3
"""Share of the change of the unknowns at which poses are compared: the whole change may bend rods far."""


def layer_error(solution: Solution) -> float | None:
    """Estimated change of the watched poses and lengths to zero widths of contact; None without smooth contact.

    Args:
        solution: the end of a solve. There is no estimate without an equilibrium, or if friction remembers a path.

    Returns:
        distance over the length or angle in rad, whichever is largest; None without an estimate.
    """
    model = solution.model
    if not solution.converged or not model.discrete.has_layers or model.inputs.memory is not None:
        return None
    thinner = kept_with(model, "_thinner_layers", lambda: Model(model.discrete.with_layers(1.0 - THINNER)))
    arguments = (solution.x, solution.inputs, 1.0)
    residual_change = column(thinner.path_residual(*arguments)) - column(model.path_residual(*arguments))
    change = -inverse_jacobian(solution) @ residual_change / THINNER
    before, after = (watched_at(solution, x) for x in (solution.x, solution.x + WAY * change))
    estimate = SAFETY * change_size(after.change_from(before)) / WAY
    return float(estimate) if np.isfinite(estimate) else np.inf
