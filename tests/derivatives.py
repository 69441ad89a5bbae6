"""Jacobians by automatic differentiation: what those that the package writes by structure are held to."""

from __future__ import annotations

import casadi as ca
import numpy as np
from numpy.testing import assert_allclose

from cosserat_casadi import Model
from cosserat_casadi.maths.typing import FloatArray


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
