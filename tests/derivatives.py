"""Jacobians by automatic differentiation and by differences: what those that the package writes are held to."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import casadi as ca
import numpy as np
import numpy.typing as npt
from numpy.testing import assert_allclose

from cosserat_casadi import Model
from cosserat_casadi.maths.typing import FloatArray


def central_differences(function: Callable[[FloatArray], Any], at: npt.ArrayLike, step: npt.ArrayLike) -> FloatArray:
    """Derivatives of a function with n numbers by steps to either side, one column a number.

    Args:
        function: numbers, shape (n,) ↦ a number, an array or a matrix of CasADi, whose entries count column by column.
        at: the numbers, shape (n,).
        step: of all numbers, or of each.
    """
    centre = np.asarray(at, dtype=float)

    def value(moved: FloatArray) -> FloatArray:
        result = function(moved)
        return np.ravel(result.full() if isinstance(result, ca.DM) else result, order="F")

    steps = np.diag(np.broadcast_to(step, centre.shape))
    return np.column_stack([(value(centre + change) - value(centre - change)) / (2 * change.sum()) for change in steps])


def jacobian_by_ad(model: Model, x: FloatArray, load_factor: float) -> FloatArray:
    """∂ residual / ∂x at a share of the loads, at the inputs of the scene, shape (size, size)."""
    # In scalars the derivative takes a third of the time that it takes in matrices.
    symbol = ca.SX.sym("x", model.size)
    residual = model.path_residual.expand()(symbol, model.pack(), load_factor)
    jacobian = ca.Function("jacobian", [symbol], [ca.jacobian(residual, symbol)])
    return np.asarray(jacobian(x).full())


def check_jacobian(model: Model, load_factor: float = 0.6, *, seed: int = 1, atol: float = 1e-13) -> None:
    """Compare the model's Jacobian with that by automatic differentiation, at unknowns that are drawn."""
    x = 0.3 * np.random.default_rng(seed).standard_normal(model.size)
    own = model.path_jacobian(x, model.pack(), load_factor).full()
    assert_allclose(own, jacobian_by_ad(model, x, load_factor), rtol=0, atol=atol)
