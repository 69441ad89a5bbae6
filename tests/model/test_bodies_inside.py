"""Bodies on sections inside a rod, against the same rod cut there, and against beams without mass."""

from __future__ import annotations

from typing import Any

import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Scene, SceneError, build, modes_of, scene_from_dict
from tests.derivatives import check_jacobian
from tests.equilibria import solve
from tests.model.test_assembly import rod

PLACES = [0.3, 0.7]
FINE = {"modes": 6, "nodes": 9}
BODIES: list[dict[str, Any]] = [
    {"name": "lower", "mass": 0.3, "inertia": [0.01, 0.02, 0.015], "centre_of_mass": [0.02, 0.01, 0.03]},
    {"name": "upper", "mass": 0.4, "inertia": [0.02, 0.02, 0.03]},
]
LOADS = [
    {"name": "w", "kind": "gravity", "acceleration": [1.0, 0.5, -3.0]},
    {"name": "p", "kind": "body_wrench", "body": "lower", "force": [0.5, 0.2, 0.1], "position": [0.05, 0, 0]},
]


def joint(body: str, **where: Any) -> dict[str, Any]:
    return {"body": body, "kind": "fixed", "position": [0.01, 0, 0.02], "quaternion": [0.8, 0.6, 0, 0], **where}


def tables(rods: list[dict[str, Any]], joints: list[dict[str, Any]]) -> dict[str, Any]:
    return {"schema": 1, "accuracy": FINE, "rods": rods, "bodies": BODIES, "joints": joints, "loads": LOADS}


def whole(places: list[float] = PLACES, **more: Any) -> Scene:
    joints = [joint(body["name"], rod="a", at=at) for body, at in zip(BODIES, places, strict=True)]
    return scene_from_dict({**tables([rod("a", 1.0)], joints), **more})


def cut() -> Scene:
    rods = [rod("a", 0.3), rod("b", 0.4, base={"rod": "a"}), rod("c", 0.3, base={"rod": "b"})]
    return scene_from_dict(tables(rods, [joint("lower", rod="a"), joint("upper", rod="b")]))


@pytest.mark.slow
def test_a_rod_with_bodies_vs_the_rod_cut_at_them() -> None:
    one, three = solve(build(whole())), solve(build(cut()))
    assert one.converged
    assert three.converged
    assert_allclose(one.tip("a").position, three.tip("c").position, rtol=0, atol=1e-6)
    for body in ("lower", "upper"):
        assert_allclose(one.body(body).position, three.body(body).position, rtol=0, atol=1e-6)
        assert_allclose(one.body(body).rotation, three.body(body).rotation, rtol=0, atol=1e-6)
    frequencies = modes_of(one).angular_frequencies[:5]
    assert_allclose(frequencies, modes_of(three).angular_frequencies[:5], rtol=1e-5, atol=0)


def test_jacobian_vs_ad() -> None:
    model = build(whole(accuracy={"modes": 3, "nodes": 6}))
    check_jacobian(model)


@pytest.mark.slow
def test_a_ball_inside_a_rod_rests_on_a_floor() -> None:
    """The floor bears what the two stretches of the rod leave it: the ball is at its radius above."""
    lying = {"position": [0, 0, 0.1], "tangent": [1, 0, 0]}
    tables = {
        "schema": 1,
        "accuracy": FINE,
        "rods": [rod("a", 1.0, base=lying)],
        "bodies": [{"name": "ball", "mass": 0.3, "radius": 0.07}],
        "joints": [{"body": "ball", "rod": "a", "at": 0.5, "kind": "fixed"}],
        "loads": [{"name": "w", "kind": "gravity", "acceleration": [0, 0, -4.0]}],
        "obstacles": [{"name": "floor", "kind": "plane", "point": [0, 0, 0], "normal": [0, 0, 1], "bodies": ["ball"]}],
    }
    solution = solve(build(scene_from_dict(tables)))
    assert solution.converged
    (contact,) = solution.contacts
    assert contact.owner == "ball"
    assert_allclose(solution.body("ball").position[2], 0.07, rtol=0, atol=1e-9)
    # The clamp and the floor carry all of the weight.
    assert_allclose(solution.base_wrench("a").force[2] + contact.force[2], 4.0 * (0.7 + 0.3), rtol=0, atol=1e-9)


def test_the_place_of_a_joint_as_a_parameter() -> None:
    """The body at 0.3 moved to 0.4 is that of a scene with the joint there."""
    model = build(whole(parameters=["joints[0].at"]))
    there = build(whole([0.4, 0.7]))
    solution = solve(model, parameters={"joints[0].at": 0.4})
    assert solution.converged
    assert_allclose(solution.body("lower").position, solve(there).body("lower").position, rtol=0, atol=1e-6)


def test_a_section_before_the_base_is_refused() -> None:
    with pytest.raises(SceneError) as refused:
        whole([-0.1, 1.0])
    assert [(one.where, one.problem) for one in refused.value.problems] == [("joints[0].at", "must be >= 0, got -0.1")]


@pytest.mark.slow
def test_a_body_at_the_tip_of_a_rod_that_is_wound_up_is_reached_as_the_rod_is() -> None:
    """A tendon of 40 N turns the tip more than three times: the body goes with it, and weighs next to nothing there."""
    rod = {
        "name": "rod",
        "length": 0.2,
        "strain": "kirchhoff",
        "material": {"youngs_modulus": 2e9, "poisson_ratio": 0.4, "density": 1100.0},
        "section": {"shape": "circle", "radius": 1e-3},
    }
    tables = {
        "schema": 1,
        "accuracy": {"modes": 8, "nodes": 30},
        "rods": [rod],
        "loads": [{"name": "weight", "kind": "gravity", "acceleration": [0, 0, -9.81]}],
        "actuators": [{"name": "cable", "kind": "tendon", "rod": "rod", "tension": 40.0, "offset": [4e-3, 0.0]}],
    }
    alone = solve(build(scene_from_dict(tables)))
    body = {"bodies": [{"name": "load", "mass": 0.02}], "joints": [{"rod": "rod", "body": "load", "kind": "fixed"}]}
    loaded = solve(build(scene_from_dict({**tables, **body})))
    assert loaded.converged and loaded.stable, loaded.message
    assert_allclose(loaded.tip().position, alone.tip().position, rtol=0, atol=1e-3)
    assert_allclose(loaded.base_wrench().force[2] - alone.base_wrench().force[2], 0.02 * 9.81, rtol=1e-9, atol=0)
