"""A compiled stage in motion against CasADi's derivatives of the plain one: values, Jacobians, second derivatives."""

from __future__ import annotations

from collections.abc import Callable, Iterator
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
from cosserat_casadi.maths.calls import functions_within
from cosserat_casadi.maths.typing import FloatArray
from tests.codegen.test_load import cached, needs_compiler
from tests.control.swing import arm
from tests.families import mostly_slow
from tests.motion.test_rods_that_strike_rods import free_rods
from tests.moving_scenes import FAMILIES, model_of, rod

pytestmark = needs_compiler

WRITTEN = ("SXFunction", "MXFunction")
"""Classes of functions with instructions."""


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


def rods_that_touch(strain: str, sections: int) -> MotionStage:
    """Two clamped rods that cross, with friction between them."""
    tables = free_rods()
    del tables["velocities"]
    tables["accuracy"] = {"modes": 1, "nodes": 3}
    tables["rod_contacts"][0]["friction"] = 0.3
    for own in tables["rods"]:
        own["strain"] = strain
        del own["base"]["free"]
    return motion_stage(build(scene_from_dict(tables), moving=True), 1e-3, sections=sections)


def test_derivatives_of_rods_that_touch_are_short() -> None:
    """Functions that the Jacobian calls are for one column: written for all columns they have 85 000 instructions."""
    for function in equations_functions(rods_that_touch("kirchhoff", 2), "touching_equations", curvature=False):
        called = [each for each in functions_within(function) if each.class_name() in WRITTEN]
        assert sum(each.n_instructions() for each in called) < 25_000


def plain_slopes(function: ca.Function, at: list[FloatArray]) -> Iterator[FloatArray]:
    """Jacobian blocks of a function column by column, each the derivative in one direction."""
    value, along = function(*at), function.forward(1)
    for number, argument in enumerate(at):
        columns = []
        for direction in np.eye(len(argument)):
            seeds = [direction if other == number else np.zeros(len(each)) for other, each in enumerate(at)]
            columns.append(along(*at, value, *seeds).full())
        yield np.hstack([np.zeros((len(value.full()), 0)), *columns])


@pytest.mark.slow
@pytest.mark.parametrize("strain", ["planar", "kirchhoff"])
def test_rods_that_touch_vs_plain(strain: str) -> None:
    stage = rods_that_touch(strain, 8)
    compiled = compiled_motion_stage(stage, f"touching_{strain}")
    state, unknowns, inputs, rate = somewhere(stage)
    at = [0.1 * state, 0.1 * unknowns, inputs, np.array([1e-2]), rate]
    found, expected = compiled.equations.function, stage.equations.function
    values = expected(*at).full()
    assert_allclose(found(*at), values, rtol=0, atol=1e-12 * np.abs(values).max())
    for block, plain in zip(slopes_of(found, at), plain_slopes(expected, at), strict=True):
        assert_allclose(block.full(), plain, rtol=0, atol=1e-12 * np.abs(values).max())
    multipliers = np.linspace(-1.0, 2.0, stage.unknowns_size)
    outputs = [ca.DM(*found.size_out(0)), multipliers]
    for part, block in zip(found.reverse(1).call([*at, *outputs]), slopes_of(found, at), strict=True):
        assert_allclose(part.full()[:, 0], multipliers @ block.full(), rtol=0, atol=1e-12 * np.abs(values).max())


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
