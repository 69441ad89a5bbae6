"""Joints that turn about or slide along one axis: what they leave free, what they hold, and their derivatives."""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Model, SceneError, build, scene_from_dict
from tests.derivatives import check_jacobian
from tests.equilibria import solve
from tests.families import mostly_slow
from tests.model.test_assembly import FEW, PULL, joint, leg, rod

AXIS = np.array([0.3, -0.5, 0.8])
TURNED = [0.8, 0.0, 0.6, 0.0]
FIRST = {"base": {"position": [0.1, 0, 0], "tangent": [0.2, 0.1, 1]}}
SECOND = {"base": {"position": [0, 0.3, 0.05]}}


def held(kind: str, **changes: Any) -> Model:
    """A plate on a clamped rod and on one that is held by a joint of this kind, pushed and turned."""
    first = joint("a", quaternion=TURNED)
    second = joint("b", kind=kind, axis=AXIS.tolist(), quaternion=[0.6, 0.8, 0, 0], position=[0.02, 0.1, -0.03])
    tables = {
        "schema": 1,
        "accuracy": FEW,
        "rods": [rod("a", 0.8, "reissner", **FIRST), rod("b", 0.6, **SECOND)],
        "bodies": [{"name": "plate", "mass": 0.1}],
        "joints": [first, second],
        "loads": [PULL],
        **changes,
    }
    return build(scene_from_dict(tables))


@pytest.mark.parametrize(("kind", "size"), [("revolute", 5), ("prismatic", 5), ("spherical", 3), ("fixed", 6)])
def test_multipliers_of_each_kind(kind: str, size: int) -> None:
    axis = {} if kind in ("revolute", "prismatic") else {"joints": [joint("a"), joint("b", kind=kind)]}
    assert held(kind, **axis).discrete.constraint("joints[1]").size == size


AT_FACTORS = [("revolute", 1.0), ("prismatic", 1.0), ("revolute", 0.6), ("prismatic", 0.6)]


@pytest.mark.parametrize(("kind", "load_factor"), mostly_slow(AT_FACTORS, quick=[("revolute", 0.6)]))
def test_jacobian_vs_ad(kind: str, load_factor: float) -> None:
    """Also where the rod itself is carried, so that its base moves."""
    carried = rod("b", 0.5, base={"rod": "a", "at": 0.5, "position": [0.02, 0.01, 0.0], "quaternion": [0.6, 0, 0.8, 0]})
    for rods in ([rod("a", 0.8, "reissner", **FIRST), rod("b", 0.6, **SECOND)], [rod("a", 0.8, **FIRST), carried]):
        model = held(kind, rods=rods)
        check_jacobian(model, load_factor)


def _in_place(model: Model, x: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Of the second rod's tip in the plate: offset from the joint, rotation from the joint's, and the joint's axis."""
    inputs = model.pack()
    position, _, rotation = (m.full() for m in model.tip["b"](x, inputs))
    plate, _, world_R_plate = (m.full() for m in model.body["plate"](x, inputs))
    record = model.scene.joints[1]
    offset = world_R_plate.T @ (position - plate)[:, 0] - np.asarray(record.position)
    w, a, b, c = record.quaternion
    place = model.discrete.constraint("joints[1]").pose
    assert_allclose(np.abs(place.quaternion), np.abs([w, a, b, c]), rtol=0, atol=1e-15)
    return offset, world_R_plate.T @ rotation @ place.rotation.T, AXIS / np.linalg.norm(AXIS)


def test_revolute_joint_turns_about_its_axis_alone() -> None:
    model = held("revolute")
    solution = solve(model)
    assert solution.converged
    offset, turn, axis = _in_place(model, solution.x)
    assert_allclose(offset, 0.0, rtol=0, atol=1e-10)
    assert_allclose(turn @ axis, axis, rtol=0, atol=1e-10)
    assert np.arccos((np.trace(turn) - 1) / 2) > 0.05


def test_prismatic_joint_slides_along_its_axis_alone() -> None:
    model = held("prismatic")
    solution = solve(model)
    assert solution.converged
    offset, turn, axis = _in_place(model, solution.x)
    assert_allclose(turn, np.eye(3), rtol=0, atol=1e-10)
    assert_allclose(np.cross(offset, axis), 0.0, rtol=0, atol=1e-10)
    assert abs(offset @ axis) > 0.005


@pytest.mark.parametrize("kind", mostly_slow(["revolute", "prismatic"], quick=["prismatic"]))
def test_multipliers_do_no_work_in_what_is_free(kind: str) -> None:
    """The joint's wrench on the tip has no moment about the hinge's axis, no force along the slide's."""
    model = held(kind)
    solution = solve(model)
    assert solution.converged
    wrench = model.fields["b"](solution.x, solution.inputs)[2].full()[:, -1]
    place = model.discrete.constraint("joints[1]").pose
    _, turn, axis = _in_place(model, solution.x)
    axis_in_section = place.rotation.T @ turn.T @ axis
    part = wrench[:3] if kind == "revolute" else wrench[3:]
    assert_allclose(part @ axis_in_section, 0.0, rtol=0, atol=1e-11)
    assert np.linalg.norm(part) > 1e-2


@pytest.mark.parametrize("kind", mostly_slow(["revolute", "prismatic"], quick=["revolute"]))
def test_plate_is_in_balance(kind: str) -> None:
    """Wrenches of both rods on the plate, its weight and the pull sum to nothing, about the origin of the world."""
    model = held(kind)
    solution = solve(model)
    inputs = solution.inputs
    plate, _, world_R_plate = (m.full() for m in model.body["plate"](solution.x, inputs))
    point = plate[:, 0] + world_R_plate @ np.array(PULL["position"])
    force = np.array(PULL["force"])
    moment = np.cross(point, force)
    for name in ("a", "b"):
        position, _, internal, _, _ = (m.full() for m in model.fields[name](solution.x, inputs))
        rotation = model.tip[name](solution.x, inputs)[2].full()
        tip_force = rotation @ internal[3:, -1]
        force = force - tip_force
        moment = moment - rotation @ internal[:3, -1] - np.cross(position[:, -1], tip_force)
    assert_allclose(force, 0.0, rtol=0, atol=1e-10)
    assert_allclose(moment, 0.0, rtol=0, atol=1e-10)


@pytest.mark.parametrize("angle", [0.0, 1.0, np.pi])
def test_derivatives_finite_at_any_turn(angle: float) -> None:
    model = held("revolute")
    x = model.unloaded()
    quaternion = np.array([np.cos(angle / 2), 0.0, 0.0, np.sin(angle / 2)])
    for name, frame in model.discrete.frames.items():
        x[model.discrete.deviation(name)][3:] = quaternion - frame.start.quaternion
    symbol = ca.MX.sym("x", model.size)
    jacobian = model.path_jacobian(symbol, model.pack(), 1.0)
    ones = np.ones(model.size)
    second = ca.Function("second", [symbol], [ca.jtimes(jacobian @ ones, symbol, ones)])
    assert np.all(np.isfinite(second(x).full()))
    assert np.all(np.isfinite(model.path_jacobian(x, model.pack(), 1.0).full()))


def test_planar_rods_with_hinges_about_their_normal_hold_a_body_once() -> None:
    """As with spherical joints, only the first keeps the body in the plane."""
    legs = (leg("a", 0.0, "planar"), leg("b", 0.1, "planar"))
    hinges = [
        joint(r["name"], kind="revolute", axis=[0, 1, 0], position=[r["base"]["position"][0], 0, 0]) for r in legs
    ]
    tables = {"schema": 1, "rods": list(legs), "bodies": [{"name": "plate"}], "joints": hinges}
    model = build(scene_from_dict(tables))
    assert [placed.size for placed in model.discrete.constraints] == [5, 2]


def test_body_on_two_hinges_of_one_axis_turns_freely() -> None:
    legs = (leg("a", 0.0, "kirchhoff"), leg("b", 0.1, "kirchhoff"))
    hinges = [
        joint(r["name"], kind="revolute", axis=[1, 0, 0], position=[r["base"]["position"][0], 0, 0]) for r in legs
    ]
    tables = {"schema": 1, "rods": list(legs), "bodies": [{"name": "plate"}], "joints": hinges}
    with pytest.raises(SceneError, match="turns freely about the line through its joints"):
        build(scene_from_dict(tables))


def test_models_of_one_scene_share_the_kernels_of_their_joints() -> None:
    """Modes and nodes do not change how a joint is closed; a place does."""
    coarse, fine = held("revolute"), held("revolute", accuracy={"modes": 5, "nodes": 9})
    elsewhere = [joint("a", quaternion=TURNED), joint("b", kind="revolute", axis=AXIS.tolist())]
    constraints = [
        model.discrete.constraint("joints[1]") for model in (coarse, fine, held("revolute", joints=elsewhere))
    ]
    first, second, other = (constraint._kernels for constraint in constraints)
    assert first is second
    assert first is not other
    assert first.law != other.law


def two_rods_that_meet(kind: str, **changes: Any) -> Model:
    """A rod, and one that meets its tip at an angle of atan(4/3) and carries the same body."""
    second = {"length": 0.5, "base": {"position": [0.4, 0, 0], "tangent": [-0.8, 0, 0.6]}}
    tables = {
        "schema": 1,
        "accuracy": FEW,
        "rods": [rod("a", 0.3), rod("b", **second)],
        "bodies": [{"name": "plate", "mass": 0.1}],
        "joints": [
            {"rod": "b", "body": "plate", "kind": "fixed"},
            {"rod": "a", "body": "plate", "kind": kind, **changes},
        ],
    }
    return build(scene_from_dict(tables))


@pytest.mark.parametrize(
    ("kind", "changes"), [("revolute", {"axis": [0, 1, 0]}), ("spherical", {}), ("prismatic", {"axis": [0, 0, 1]})]
)
def test_what_a_joint_leaves_free_does_not_turn_the_unloaded_body(kind: str, changes: dict[str, Any]) -> None:
    model = two_rods_that_meet(kind, **changes)
    open_by = np.abs(model.residual(model.unloaded(), model.pack()).full()).max()
    if kind == "prismatic":
        # It holds the angle between the rods, which do not agree on it: the body stays between them.
        assert open_by > 0.1
    else:
        assert_allclose(open_by, 0.0, rtol=0, atol=1e-12)
