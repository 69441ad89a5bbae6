"""A model in motion as acados takes it: the DAE, its Jacobians, and a step of an IRK on it against the simulator's."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Model, SceneError, build, scene_from_dict
from cosserat_casadi.codegen.acados import acados_expressions, acados_functions, write_acados
from cosserat_casadi.control import radau
from cosserat_casadi.maths.typing import FloatArray
from tests.control.swing import STEP, arm, replayed, task
from tests.moving_scenes import FAMILIES


def supported() -> Model:
    """A rod with multipliers."""
    few = {"modes": 1, "nodes": 2}
    return build(scene_from_dict(FAMILIES["pinned tip"]() | {"accuracy": few}), moving=True)


@pytest.mark.parametrize("make", [arm, supported])
def test_the_dae_vs_the_model(make: Callable[[], Model]) -> None:
    model = make()
    dae = acados_expressions(model, "moving", moving=True)
    differential = model.discrete.unknowns.differential
    size = int(np.count_nonzero(differential))
    count = model.inputs.size
    assert [dae.x.numel(), dae.u.numel(), dae.z.numel()] == [2 * size + count, count, model.size - size]
    random = np.random.default_rng(5)
    x, xdot, u, z = (0.3 * random.standard_normal(symbol.numel()) for symbol in (dae.x, dae.xdot, dae.u, dae.z))
    whole = np.zeros((3, model.size))
    whole[0, differential] = x[:size]
    whole[0, ~differential] = z
    whole[1, differential] = x[size : 2 * size]
    whole[2, differential] = xdot[size : 2 * size]
    residual = model.inverse_dynamics(*whole, x[2 * size :], u, np.zeros(count)).full()[:, 0]
    expected = np.concatenate([xdot[:size] - x[size : 2 * size], residual, xdot[2 * size :] - u])
    value = ca.Function("value", [dae.x, dae.xdot, dae.u, dae.z], [dae.f_impl_expr])
    assert_allclose(value(x, xdot, u, z).full()[:, 0], expected, rtol=1e-11, atol=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize("make", [arm, supported])
def test_jacobians_vs_differentiated_expressions(make: Callable[[], Model]) -> None:
    model = make()
    dae = acados_expressions(model, "moving", moving=True)
    symbols = [dae.x, dae.xdot, dae.u, dae.z]
    random = np.random.default_rng(5)
    at = [0.3 * random.standard_normal(symbol.numel()) for symbol in symbols]
    expected = ca.Function("slopes", symbols, [ca.jacobian(dae.f_impl_expr, symbol) for symbol in symbols])(*at)
    (function,) = [each for each in acados_functions(model, "moving", moving=True) if each.n_out() == 5]
    _, *found = function(*at, 0, ca.DM(0, 1))
    for block, slope in zip(found, expected, strict=True):
        assert_allclose(block.full(), slope.full(), rtol=1e-10, atol=1e-11)


def test_a_step_of_its_integrator_is_one_of_the_simulator() -> None:
    """Runge–Kutta stages of the first-order DAE: their unknowns are all derivatives, as in acados' IRK."""
    wanted = task()
    model = wanted.stage.model
    method = radau(2)
    tensions = np.array([2.0, 2.0]) + STEP * np.arange(9)[:, None] * np.array([0.8, -1.5])
    states = replayed(wanted, tensions, method)
    (function,) = [each for each in acados_functions(model, "moving", moving=True) if each.n_out() == 5]
    half = wanted.stage.state_size // 2
    for number in range(3):
        start = np.concatenate([states[number, :half], states[number, half:] / STEP, tensions[number]])
        end = _step(function, start, np.array([0.8, -1.5]), method.matrix, STEP)
        assert_allclose(end[:half], states[number + 1, :half], rtol=0, atol=1e-10)
        assert_allclose(STEP * end[half : 2 * half], states[number + 1, half:], rtol=0, atol=1e-10)
        assert_allclose(end[2 * half :], tensions[number + 1], rtol=1e-13, atol=0)


def _step(function: ca.Function, start: FloatArray, u: FloatArray, matrix: FloatArray, size: float) -> FloatArray:
    """End of a stiffly accurate Runge–Kutta step of a DAE without algebraic states, by Newton's method."""
    stages, count = len(matrix), len(start)
    slopes = np.zeros((stages, count))
    for _ in range(12):
        points = start + size * matrix @ slopes
        residuals = np.zeros((stages, count))
        jacobian = np.zeros((stages, count, stages, count))
        for i in range(stages):
            value, by_x, by_xdot, _, _ = (block.full() for block in function(points[i], slopes[i], u, [], 0, []))
            residuals[i] = value[:, 0]
            for j in range(stages):
                jacobian[i, :, j] = size * matrix[i, j] * by_x
            jacobian[i, :, i] += by_xdot
        square = jacobian.reshape(stages * count, -1)
        slopes -= np.linalg.solve(square, residuals.ravel()).reshape(stages, count)
    end: FloatArray = start + size * matrix[-1] @ slopes
    return end


def test_a_rod_without_mass_is_refused(tmp_path: Path) -> None:
    tables = FAMILIES["planar"]()
    for key in ("linear_density", "rotary_inertia", "damping"):
        del tables["rods"][0][key]
    model = build(scene_from_dict(tables), moving=True)
    with pytest.raises(SceneError, match="'a' has no mass"):
        write_acados(model, tmp_path / "rod", "rod", moving=True)
    assert not (tmp_path / "rod").exists()
