"""A compiled stage in motion against CasADi's derivatives of the plain one: values, Jacobians, second derivatives."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import ExportError, Model, build, scene_from_dict
from cosserat_casadi.accuracy.cost import STRAIGHT
from cosserat_casadi.codegen import motion_stage as motion_stage_module
from cosserat_casadi.codegen import stage as stage_module
from cosserat_casadi.codegen.motion_stage import compiled_motion_stage, equations_functions, poses_functions
from cosserat_casadi.control import MotionStage, motion_stage, radau
from cosserat_casadi.maths.typing import FloatArray
from tests.codegen.test_load import cached, needs_compiler
from tests.control.swing import arm
from tests.families import mostly_slow
from tests.moving_scenes import FAMILIES, model_of, rod

pytestmark = needs_compiler


@pytest.fixture(autouse=True)
def quick(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    cached(tmp_path, monkeypatch)


def held(*moved: str) -> Model:
    """A rod with multipliers, whose base, an input, moves: rates of inputs enter."""
    tables = FAMILIES["driven and held"]()
    tables["rods"] = [rod(base=tables["rods"][0]["base"])]
    tables["supports"][0]["position"] = [0.7, -0.2, 0.2]
    tables["inputs"] = ["a.base.position", *moved]
    tables["accuracy"] = {"modes": 1, "nodes": 2}
    return build(scene_from_dict(tables), moving=True)


def turned() -> Model:
    """As `held`, with a base that turns too: its Jacobian is six times as long."""
    return held("a.base.quaternion")


def somewhere(stage: MotionStage) -> list[FloatArray]:
    """Arguments of the equations, away from any motion."""
    random = np.random.default_rng(3)
    state = 0.2 * random.standard_normal(stage.state_size)
    unknowns = 0.2 * random.standard_normal(stage.unknowns_size)
    inputs = stage.model.pack()
    rate = 0.1 * random.standard_normal(len(inputs))
    return [state, unknowns, inputs, rate]


def slopes_of(function: ca.Function, at: list[FloatArray]) -> list[ca.DM]:
    """Jacobian blocks of a function, as CasADi asks for them."""
    outputs = [ca.DM(*function.size_out(i)) for i in range(function.n_out())]
    return list(function.jacobian().call([*map(ca.DM, at), *outputs]))


@pytest.mark.parametrize(
    ("make", "longest"),
    mostly_slow([(arm, STRAIGHT), (arm, 0), (held, STRAIGHT), (turned, STRAIGHT)], quick=[(arm, 0)]),
    ids=["straight", "loops", "with constraint", "with a base that turns"],
)
def test_stage_vs_plain(make: Callable[[], Model], longest: int, monkeypatch: pytest.MonkeyPatch) -> None:
    for module in (stage_module, motion_stage_module):
        monkeypatch.setattr(module, "STRAIGHT", longest)
    stage = motion_stage(make(), 0.03)
    compiled = compiled_motion_stage(stage, f"moving_{make.__name__}")
    at = somewhere(stage)
    compiled_equations, equations = compiled.equations.function, stage.equations.function
    assert_allclose(compiled_equations(*at), equations(*at), rtol=1e-11, atol=1e-12)
    found = slopes_of(compiled_equations, at)
    for block, expected in zip(found, slopes_of(equations, at), strict=True):
        assert_allclose(block.full(), expected.full(), rtol=1e-9, atol=1e-10)
    pose_at = [at[0], at[2]]
    expected_pose = plain_poses(stage)
    assert compiled.poses.name_out() == [f"tip_{rod}" for rod in stage.model.tip]
    assert_allclose(compiled.poses(*pose_at), expected_pose(*pose_at), rtol=1e-12, atol=1e-13)
    for block, expected in zip(slopes_of(compiled.poses, pose_at), slopes_of(expected_pose, pose_at), strict=True):
        assert_allclose(block.full(), expected.full(), rtol=1e-10, atol=1e-11)


def plain_poses(stage: MotionStage) -> ca.Function:
    """Position and quaternion of the one tip of a stage."""
    state, _, inputs, _ = stage.symbols
    (tip,) = stage.model.tip.values()
    position, quaternion, _ = tip(stage.x(state), inputs)
    return ca.Function("poses", [state, inputs], [ca.vertcat(position, quaternion)])


def test_poses_of_bodies() -> None:
    stage = motion_stage(model_of("free with body"), 0.03, radau(1))
    poses, *_ = poses_functions(stage, "poses", curvature=False)
    at = somewhere(stage)
    x = stage.x(ca.DM(at[0]))
    expected = [pose(x, at[2])[:2] for pose in (stage.model.tip["a"], stage.model.body["plate"])]
    assert poses.name_out() == ["tip_a", "body_plate"]
    for found, (position, quaternion) in zip(poses(at[0], at[2]), expected, strict=True):
        assert_allclose(found, ca.vertcat(position, quaternion), rtol=1e-12, atol=1e-13)


def hessian(equations: ca.Function, poses: ca.Function, stage: MotionStage) -> FloatArray:
    """Of a Lagrangian: half the squared deviation of a position, and the residual times its multipliers."""
    arguments = stage.symbols
    state, _, inputs, _ = arguments
    weights = np.linspace(-1.0, 2.0, stage.unknowns_size)
    lagrangian = ca.sumsqr(poses(state, inputs)[:3] - ca.DM([0.3, 0.1, 0.2])) / 2
    lagrangian += ca.dot(weights, equations(*arguments))
    value = ca.hessian(lagrangian, ca.vertcat(*arguments))[0]
    return np.asarray(ca.Function("hessian", arguments, [value])(*somewhere(stage)).full())


@pytest.mark.slow
def test_second_derivatives_vs_plain() -> None:
    tables = FAMILIES["planar"]() | {"accuracy": {"modes": 1, "nodes": 2}}
    stage = motion_stage(build(scene_from_dict(tables), moving=True), 0.03, radau(1))
    poses = plain_poses(stage)
    exact = compiled_motion_stage(stage, "exact_motion", curvature=True)
    expected = hessian(stage.equations.function, poses, stage)
    assert_allclose(hessian(exact.equations.function, exact.poses, stage), expected, rtol=1e-9, atol=1e-11)
    bare = compiled_motion_stage(stage, "bare_motion")
    at = somewhere(stage)
    by_state, by_inputs = (block.full() for block in slopes_of(poses, [at[0], at[2]]))
    count = stage.model.inputs.size
    slopes = np.hstack([by_state, np.zeros((7, stage.unknowns_size)), by_inputs, np.zeros((7, count))])[:3]
    assert_allclose(hessian(bare.equations.function, bare.poses, stage), slopes.T @ slopes, rtol=1e-10, atol=1e-12)


def test_equations_stay_out_of_gauss_newton_hessians() -> None:
    """Second derivatives of the equations with their arguments have no entry: no solver evaluates them."""
    stage = motion_stage(arm(), 0.03)
    _, _, adjoint, second = equations_functions(stage, "arm_equations", curvature=False)
    arguments = len(stage.symbols)
    for row in range(arguments):
        blocks = [row * adjoint.n_in() + column for column in range(arguments)]
        assert [second.nnz_out(block) for block in blocks] == [0] * arguments


def test_a_name_that_is_none_in_c_is_refused() -> None:
    with pytest.raises(ExportError, match="no name for a C library"):
        compiled_motion_stage(motion_stage(arm(), 0.03), "a stage")
