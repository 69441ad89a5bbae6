"""Lengths and base poses of rods as inputs: the same equilibria as scenes that are written with those values."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Model, SceneError, build, parse_scene, solve
from cosserat_casadi.model.load_cases import column_indices
from tests.derivatives import central_differences
from tests.families import mostly_slow

NAMES = ("push.force", "wind.force", "cable.tension", "arm.length", "arm.base.position", "arm.base.quaternion")
FREE = f"inputs = {list(NAMES)}"
SCENE = """
schema = 1
{inputs}
[accuracy]
modes = 7
nodes = 16
[[rods]]
name = "arm"
length = {length}
strain = {strain}
stiffness = {{ bending_x = 0.02, bending_y = 0.03, torsion = 0.025, shear_x = 500, shear_y = 400, extension = 900 }}
linear_density = 0.03
intrinsic = {{ curvature = [{bend}, [-1.0, 0.5], {twist}], tangent = [0.01, 0, 1.02] }}
base = {{ position = {position}, quaternion = {quaternion} }}
[[loads]]
name = "weight"
kind = "gravity"
acceleration = [1, 2, -9.81]
[[loads]]
name = "wind"
kind = "distributed_wrench"
rod = "arm"
force = [0.1, 0.2, [0, 1]]
moment = [0.001, 0, 0]
frame = "body"
[[loads]]
name = "push"
kind = "tip_wrench"
rod = "arm"
force = [0.1, -0.05, 0.02]
[[actuators]]
name = "cable"
kind = "tendon"
rod = "arm"
tension = 2.0
offset = [[0.006, -0.003], 0.001]
[[actuators]]
name = "cell"
kind = "chamber"
rod = "arm"
pressure = 2e4
area = 2e-5
offset = [0.001, [0.003, 0.001]]
{more}
"""
HELD = '[[supports]]\nrod = "arm"\nkind = "pinned"\nposition = [0.2, -0.15, 0.12]'
PLACE = [0.1, -0.2, 0.05]
TURN = (np.array([0.9, 0.2, -0.3, 0.1]) / np.linalg.norm([0.9, 0.2, -0.3, 0.1])).tolist()


def text(length: float, position: list[float], quaternion: list[float], strain: str = "reissner", **more: str) -> str:
    flat = strain == "planar"
    words = {"bend": 0.0 if flat else 0.3, "twist": 0.0 if flat else 0.4, "inputs": FREE, "more": "", **more}
    return SCENE.format(length=length, position=position, quaternion=quaternion, strain=f'"{strain}"', **words)


def at_home(strain: str = "reissner", **more: str) -> Model:
    return build(parse_scene(text(0.2, [0.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0], strain, **more)))


# The norm of a quaternion does not matter.
MOVED = {"arm.length": 0.26, "arm.base.position": PLACE, "arm.base.quaternion": 2 * np.array(TURN)}


@pytest.mark.parametrize(
    ("strain", "more"),
    mostly_slow([("reissner", ""), ("kirchhoff", ""), ("planar", ""), ("reissner", HELD)], quick=[("reissner", "")]),
)
def test_inputs_vs_a_scene_written_so(strain: str, more: str) -> None:
    found = solve(at_home(strain, more=more), MOVED)
    wanted = solve(build(parse_scene(text(0.26, PLACE, TURN, strain, more=more))))
    assert found.converged
    assert wanted.converged
    X = [0.0, 0.3, 1.0]
    assert_allclose(found.pose(X).position, wanted.pose(X).position, rtol=0, atol=1e-11)
    assert_allclose(found.pose(X).rotation, wanted.pose(X).rotation, rtol=0, atol=1e-11)
    assert_allclose(found.strain(X), wanted.strain(X), rtol=0, atol=1e-9)
    assert_allclose(found.internal_wrench(X), wanted.internal_wrench(X), rtol=0, atol=1e-10)
    assert_allclose(found.base_wrench().moment, wanted.base_wrench().moment, rtol=0, atol=1e-11)
    for name in ("cable", "cell"):
        assert_allclose(list(found.actuator(name).values()), list(wanted.actuator(name).values()), rtol=1e-11, atol=0)


def test_literal_transport_vs_products_of_exponentials() -> None:
    literal = text(0.2, [0, 0, 0], [1, 0, 0, 0]).replace("nodes = 16", 'rotation = "permuted"\nnodes = 24')
    model, other = build(parse_scene(literal)), at_home()
    x = np.random.default_rng(8).standard_normal(model.size) / 20
    tips = [one.tip["arm"](x, one.pack(MOVED))[0].full() for one in (model, other)]
    assert_allclose(tips[0], tips[1], rtol=0, atol=1e-7)


@pytest.mark.parametrize("more", ["", HELD])
def test_jacobian_and_input_jacobian_vs_finite_differences(more: str) -> None:
    model = at_home(more=more)
    x, u = np.random.default_rng(2).standard_normal(model.size) / 5, model.pack(MOVED)
    by_x = central_differences(lambda x: model.residual(x, u), x, 1e-6)
    assert_allclose(model.jacobian(x, u)[0].full(), by_x, rtol=0, atol=3e-7)
    by_inputs = central_differences(lambda u: model.residual(x, u), u, 1e-6)
    assert_allclose(model.input_jacobian(x, u).full(), by_inputs, rtol=1e-5, atol=1e-6)


def test_tip_jacobian_vs_automatic() -> None:
    model = at_home()
    x, u = np.random.default_rng(2).standard_normal(model.size) / 5, model.pack(MOVED)
    symbols = [ca.MX.sym("x", model.size), ca.MX.sym("u", len(u))]
    pose = ca.vertcat(*model.tip["arm"](*symbols)[:2])
    wanted = ca.Function("wanted", symbols, [ca.jacobian(pose, s) for s in symbols])(x, u)
    for found, by_ad in zip(model.tip_jacobian["arm"](x, u), wanted, strict=True):
        assert_allclose(found.full(), by_ad.full(), rtol=0, atol=1e-12)


def test_a_scene_that_leaves_no_length_free_pays_nothing() -> None:
    fixed = f"inputs = {list(NAMES[:3])}"
    bare, free = at_home(inputs=fixed), at_home()
    without = at_home(inputs=f"inputs = {[*NAMES[:3], 'weight.acceleration']}")
    assert bare.operations(bare.residual) < free.operations(free.residual)
    assert bare.operations(bare.residual) <= without.operations(without.residual)


@pytest.mark.parametrize(
    ("name", "value", "says"),
    [
        ("arm.length", 0.0, "must be > 0"),
        ("arm.length", -0.1, "must be > 0"),
        ("arm.base.quaternion", [0, 0, 0, 0], "must not be zero"),
        ("arm.base.position", [0, 0], "must have 3 numbers"),
    ],
)
def test_values_that_no_rod_can_have_are_refused(name: str, value: object, says: str) -> None:
    with pytest.raises(SceneError, match=says):
        at_home().pack({name: value})  # type: ignore[dict-item]


def test_columns_of_load_cases_name_every_entry() -> None:
    columns = column_indices(at_home().inputs)
    assert [name for name in columns if name.startswith("arm")] == [
        "arm.length",
        *[f"arm.base.position.{axis}" for axis in "xyz"],
        *[f"arm.base.quaternion.{axis}" for axis in "wxyz"],
    ]
    assert "cable.tension" in columns


@pytest.mark.parametrize(
    ("inputs", "more", "says"),
    [
        ('inputs = ["arm.radius"]', "", "has no 'radius' to leave free"),
        ('inputs = ["arm.base.position"]', HELD, "bends in a plane and its tip is held"),
    ],
)
def test_inputs_that_cannot_be_free_are_refused(inputs: str, more: str, says: str) -> None:
    flat = HELD.replace("-0.15", "0.0") if more else ""
    with pytest.raises(SceneError, match=says):
        parse_scene(text(0.3, [0, 0, 0], [1, 0, 0, 0], "planar", inputs=inputs, more=flat))
