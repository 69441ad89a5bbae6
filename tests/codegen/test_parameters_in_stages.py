"""Stages of optimal-control problems whose scenes have parameters: compiled, for acados, lifted and embedded."""

from __future__ import annotations

from collections.abc import Sequence
from types import SimpleNamespace

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Model, Solution, solve
from cosserat_casadi.codegen.acados import acados_expressions, acados_functions
from cosserat_casadi.codegen.motion_stage import compiled_motion_stage, equations_functions, poses_functions
from cosserat_casadi.codegen.stage import compiled_stage, stage_functions
from cosserat_casadi.control import Condensing, Horizon, embedded, lifted, motion_stage
from cosserat_casadi.maths.typing import FloatArray
from tests.codegen.test_parameters_in_c import RECIPES


@pytest.fixture(scope="module")
def model() -> Model:
    return RECIPES["pwire"].model()


@pytest.fixture(scope="module")
def near(model: Model) -> Solution:
    return solve(model)


def slopes_of(function: ca.Function, at: Sequence[FloatArray]) -> list[FloatArray]:
    """Jacobian of a function, with CasADi's own derivatives."""
    symbols = function.mx_in()
    results = function.call(symbols, True)
    blocks = [ca.densify(ca.jacobian(result, symbol)) for result in results for symbol in symbols]
    return [block.full() for block in ca.Function("slopes", symbols, blocks).call([ca.DM(each) for each in at])]


def test_stage_at_rest(model: Model, near: Solution) -> None:
    """The function and its Jacobian against the model's own functions."""
    p = 1.02 * model.parameters.pack()
    plain, slopes, *_ = stage_functions(model, "stage", curvature=False)
    assert plain.name_in() == ["x", "inputs", "p"]
    at = [near.x, near.inputs, p]
    residual, pose = plain(*at)
    assert_allclose(residual, model.residual(*at), rtol=0, atol=1e-12)
    assert_allclose(pose, ca.vertcat(*model.tip["rod"](*at)[:2]), rtol=0, atol=1e-13)
    found = slopes(*at, residual, pose)
    expected = [model.jacobian(*at)[0], model.input_jacobian(*at), model.parameter_jacobian(*at)]
    expected += model.tip_jacobian["rod"](*at)
    for block, wanted in zip(found, expected, strict=True):
        assert_allclose(block.full(), wanted.full(), rtol=0, atol=1e-11)


@pytest.mark.slow
def test_compiled_stages(model: Model, near: Solution) -> None:
    p = 1.02 * model.parameters.pack()
    at = [near.x, near.inputs, p]
    stage = compiled_stage(model, "pstage")
    assert_allclose(stage(*at)[0], model.residual(*at), rtol=0, atol=1e-12)
    in_motion = motion_stage(model, 0.02, parameters=True)
    compiled = compiled_motion_stage(in_motion, "pmoving")
    somewhere = [0.1 * np.ones(size) for word, size in in_motion.sizes.items() if word != "p"]
    somewhere.insert(3, p)
    assert_allclose(
        compiled.equations.function(*somewhere), in_motion.equations.function(*somewhere), rtol=1e-11, atol=1e-11
    )


@pytest.mark.slow
def test_stage_in_motion(model: Model) -> None:
    """Jacobians made of stiffness, damping and mass against CasADi's own."""
    stage = motion_stage(model, 0.02, parameters=True)
    assert list(stage.sizes) == ["state", "unknowns", "inputs", "p", "inputs_rate"]
    random = np.random.default_rng(2)
    sizes = stage.sizes
    at = [0.1 * random.standard_normal(sizes[word]) for word in sizes]
    at[3] = 1.02 * model.parameters.pack()
    plain, slopes, *_ = equations_functions(stage, "moving", curvature=False)
    fixed = motion_stage(model.at(at[3]), 0.02)
    assert_allclose(plain(*at), fixed.equations(*at[:3], inputs_rate=at[4]), rtol=1e-10, atol=1e-10)
    found = slopes(*at, ca.DM(stage.unknowns_size, 1))
    for block, wanted in zip(found, slopes_of(stage.equations.function, at), strict=True):
        assert_allclose(block.full(), wanted, rtol=0, atol=1e-10 * max(1.0, np.abs(wanted).max()))
    poses, pose_slopes, *_ = poses_functions(stage, "poses", curvature=False)
    assert poses.name_in() == ["state", "inputs", "p"]
    pose_at = [at[0], at[2], at[3]]
    for block, wanted in zip(pose_slopes(*pose_at, ca.DM(7, 1)), slopes_of(poses, pose_at), strict=True):
        assert_allclose(block.full(), wanted, rtol=0, atol=1e-11)
    horizon = Horizon(np.tile(at[0], (2, 1)), at[1][None])
    with_p = Condensing(stage, stage.equations, 1, [0]).condensed(horizon, at[2][None], at[4][None], at[3][None])
    wanted = Condensing(fixed, fixed.equations, 1, [0]).condensed(horizon, at[2][None], at[4][None])
    assert_allclose(with_p.states_by_rates, wanted.states_by_rates, rtol=1e-9, atol=1e-12)


@pytest.mark.parametrize("moving", [False, pytest.param(True, marks=pytest.mark.slow)])
def test_acados(model: Model, moving: bool) -> None:
    """The DAE with parameters is that of the model with these parameters fixed."""
    p = 1.02 * model.parameters.pack()
    functions = acados_functions(model, "wire", moving=moving)
    fixed = acados_functions(model.at(p), "wire", moving=moving)
    random = np.random.default_rng(4)
    at = [0.1 * random.standard_normal(fixed[0].size1_in(i)) for i in range(5)]
    assert [function.size1_in("p") for function in functions] == [model.parameters.size] * len(functions)
    for one, other in zip(functions, fixed, strict=True):
        for found, wanted in zip(one.call([*at, p]), other.call([*at, ca.DM(0, 1)]), strict=True):
            assert_allclose(found.full(), wanted.full(), rtol=1e-10, atol=1e-10)
    dae = acados_expressions(model, "wire", moving=moving)
    assert dae.p.numel() == model.parameters.size
    target = SimpleNamespace()
    dae.assign(target, parameters="p_global")
    assert target.p_global is dae.p
    assert not hasattr(target, "p")
    acados_expressions(model.at(), "wire").assign(target)
    assert not hasattr(target, "p")


def test_lifted_and_embedded(model: Model, near: Solution) -> None:
    """Parameters may be variables of a problem; left out they have the scene's values."""
    p = 1.02 * model.parameters.pack()
    inputs = model.inputs.pack()
    x = ca.MX.sym("x", model.size)
    symbol = ca.MX.sym("p", model.parameters.size)
    rod = lifted(model, x, inputs, near, symbol)
    found = solve(model, parameters=p)
    residual = ca.Function("residual", [x, symbol], [rod.residual])
    assert np.abs(residual(found.x, p).full()).max() < 1e-9
    assert_allclose(ca.Function("r", [x], [lifted(model, x, inputs).residual])(near.x), 0, atol=1e-9)
    equilibrium = embedded(model, near, parameters=True)
    assert_allclose(equilibrium(inputs, p)[0].full()[:, 0], found.x, rtol=0, atol=1e-9)
    given = equilibrium.mx_in()
    slope = ca.Function("slope", given, [ca.jacobian(equilibrium(*given)[0], given[1])])(inputs, p)
    jacobian, _ = model.jacobian(found.x, inputs, p)
    wanted = -np.linalg.solve(jacobian.full(), model.parameter_jacobian(found.x, inputs, p).full())
    assert_allclose(slope.full(), wanted, rtol=0, atol=1e-7 * np.abs(wanted).max())
    assert embedded(model, near).n_in() == 1
