"""Joints at the bases of rods, between rods, and between sections and the world."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import solve_ivp

from cosserat_casadi import Model, SceneError, build, modes_of, scene_from_dict, simulate
from tests.derivatives import check_jacobian
from tests.equilibria import solve
from tests.families import mostly_slow

LENGTH = 0.5
GRAVITY = 9.81
WEIGHT = {"name": "weight", "kind": "gravity", "acceleration": [0, 0, -GRAVITY]}
DOWN = {"position": [0, 0, 1], "tangent": [0.3, 0, -1]}
WORLD = {"world": True, "position": [0.0, 0.0, 1.0]}


def link(name: str, modulus: float = 2e9, **changes: Any) -> dict[str, Any]:
    return {
        "name": name,
        "length": LENGTH,
        "strain": "planar",
        "material": {"youngs_modulus": modulus, "poisson_ratio": 0.4, "density": 1100.0},
        "section": {"shape": "circle", "radius": 5e-3},
        **changes,
    }


def hinge(rod: str = "a", **changes: Any) -> dict[str, Any]:
    return {"rod": rod, "at": 0.0, "kind": "revolute", "axis": [0, 1, 0], **changes}


def ends(first: Any, second: Any, **changes: Any) -> dict[str, Any]:
    return {"kind": "revolute", "axis": [0, 1, 0], "between": [first, second], **changes}


def scene(rods: list[Any], joints: list[Any], **changes: Any) -> dict[str, Any]:
    accuracy = {"modes": 4, "nodes": 8}
    return {"schema": 1, "accuracy": accuracy, "rods": rods, "joints": joints, "loads": [WEIGHT], **changes}


TWO = scene([link("a", base=DOWN), link("b")], [hinge(), ends({"rod": "a"}, {"rod": "b", "at": 0.0})])
TWO_LINKS = scene_from_dict({**TWO, "inputs": ["a.base.position"]})
ON_A_BODY = scene(
    [link("a", strain="kirchhoff", base=DOWN), link("b", strain="kirchhoff")],
    [{"rod": "a", "body": "p", "kind": "fixed"}, hinge("b", body="p", position=[0.01, 0, 0.02])],
    bodies=[{"name": "p", "mass": 0.02}],
)
SLIDING = scene([link("a", strain="reissner", base=DOWN)], [hinge(kind="prismatic", axis=[0.2, 1, 0.4])])


@pytest.mark.parametrize("tables", mostly_slow([TWO, ON_A_BODY, SLIDING], quick=[ON_A_BODY, SLIDING]))
def test_jacobian_vs_ad(tables: dict[str, Any]) -> None:
    model = build(scene_from_dict(tables))
    check_jacobian(model)


def test_chain_of_two_hangs_straight_and_each_joint_bears_what_hangs_from_it() -> None:
    solution = solve(build(TWO_LINKS))
    assert solution.converged and solution.stable
    weight = 1100.0 * np.pi * 5e-3**2 * LENGTH * GRAVITY
    assert_allclose(solution.tip("b").position, [0, 0, 0], rtol=0, atol=1e-9)
    assert_allclose(solution.base_wrench("a").force, [0, 0, 2 * weight], rtol=0, atol=1e-9)
    assert_allclose(solution.base_wrench("b").force, [0, 0, weight], rtol=0, atol=1e-9)
    # Inside the rod the hinge is no load: what it bears passes the first section.
    assert_allclose(np.linalg.norm(solution.internal_wrench([0.0], "b")[0][3:]), weight, rtol=1e-9, atol=0)


def test_fixed_joint_at_a_base_is_a_clamp() -> None:
    clamped = solve(build(scene_from_dict(scene([link("a", base=DOWN)], []))))
    fixed = solve(build(scene_from_dict(scene([link("a", base=DOWN)], [{"rod": "a", "at": 0.0, "kind": "fixed"}]))))
    assert_allclose(fixed.tip().position, clamped.tip().position, rtol=0, atol=1e-12)
    assert_allclose(fixed.base_wrench().moment, clamped.base_wrench().moment, rtol=0, atol=1e-10)


def test_beam_on_two_supports() -> None:
    """A hinge at the base and a ball at X = 0.8, from moments about the ball and about the hinge."""
    beam = link("a", base={"tangent": [1, 0, 0]})
    ball = {"rod": "a", "at": 0.8, "kind": "spherical", "position": [0.8 * LENGTH, 0, 0]}
    solution = solve(build(scene_from_dict(scene([beam], [hinge(), ball]))))
    weight = 1100.0 * np.pi * 5e-3**2 * LENGTH * GRAVITY
    assert_allclose(solution.base_wrench().force[2], weight * (1 - 0.5 / 0.8), rtol=1e-4, atol=0)
    assert_allclose(solution.base_wrench().moment[1], 0.0, rtol=0, atol=1e-5)


@pytest.mark.slow
def test_frequency_of_a_rigid_pendulum() -> None:
    """Of a rod that hardly bends: ω² = m g l/2 over m (l²/3 + r²/4)."""
    rod = link("a", modulus=2e12, base={"tangent": [0, 0, -1]})
    first = modes_of(scene_from_dict(scene([rod], [hinge()]))).modes[0]
    squared = GRAVITY * LENGTH / 2 / (LENGTH**2 / 3 + 5e-3**2 / 4)
    assert_allclose(2 * np.pi * first.frequency, np.sqrt(squared), rtol=1e-6, atol=0)


def test_two_sections_that_are_no_bases_meet() -> None:
    right = link("b", strain="kirchhoff", base={"position": [0.5, 0, 0.2], "tangent": [-1, 0, 0.6]})
    model: Model = build(scene_from_dict(scene([link("a"), right], [ends({"rod": "a"}, {"rod": "b"}, name="pin")])))
    solution = solve(model)
    assert solution.converged
    assert_allclose(solution.tip("a").position, solution.tip("b").position, rtol=0, atol=1e-10)


def closed_chain(**changes: Any) -> dict[str, Any]:
    """Two planar links on hinges, whose last joint is in the world."""
    shoulder = {"name": "shoulder", **hinge()}
    elbow = ends({"rod": "a"}, {"rod": "b", "at": 0.0}, name="elbow")
    rods = [link("a", base={"tangent": [1, 0, 1]}), link("b", base={"tangent": [1, 0, 0.2]})]
    foot = {"world": True, "position": [0.6, 0.0, 0.1]}
    return scene(rods, [shoulder, elbow, {"name": "foot", **ends(foot, {"rod": "b"})}], loads=[], **changes)


def test_hinge_in_the_world_closes_a_chain_of_planar_links_in_their_plane() -> None:
    """Without loads they stay straight: the elbow is where two circles meet."""
    solution = solve(build(scene_from_dict(closed_chain())))
    foot = np.array([0.6, 0.0, 0.1])
    aside = np.sqrt(LENGTH**2 - foot @ foot / 4) * np.array([-foot[2], 0, foot[0]]) / np.linalg.norm(foot)
    assert solution.converged
    assert_allclose(solution.tip("b").position, foot, rtol=0, atol=1e-12)
    assert_allclose(solution.tip("a").position, foot / 2 + aside, rtol=0, atol=1e-9)


@pytest.mark.parametrize("change", [{"axis": [0.1, 1, 0]}, {"between": [{**WORLD, "position": [0.6, 0.1, 0.1]}]}])
def test_a_chain_of_planar_links_that_closes_out_of_its_plane_is_refused(change: dict[str, Any]) -> None:
    tables = closed_chain()
    elbow, foot = tables["joints"][1:]
    elbow["axis"] = change.get("axis", elbow["axis"])
    foot["between"] = [*change.get("between", foot["between"][:1]), foot["between"][1]]
    with pytest.raises(SceneError, match="over-constrains"):
        build(scene_from_dict(tables))


def test_planar_rod_is_not_held_in_the_world_beside_its_plane() -> None:
    beside = {"world": True, "position": [0.1, 0.03, 0.4]}
    tables = scene([link("a")], [ends(beside, {"rod": "a"})], loads=[])
    with pytest.raises(SceneError, match="over-constrains the tip of 'a'"):
        build(scene_from_dict(tables))


@pytest.mark.parametrize("name", ["shoulder.axis", "elbow.axis"])
def test_hinge_that_keeps_a_closed_chain_in_its_plane_has_no_axis_as_parameter(name: str) -> None:
    with pytest.raises(SceneError, match=f"{name}: is an axis that keeps planar rods in their plane"):
        build(scene_from_dict(closed_chain(parameters=[name])))


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("foot.position", [0.6, 0.03, 0.1]),
        ("foot.axis", [0.1, 1, 0]),
        ("a.base.quaternion", [np.cos(0.1), np.sin(0.1), 0, 0]),
    ],
)
def test_parameter_that_would_take_a_closed_chain_out_of_its_plane_is_refused(name: str, value: list[float]) -> None:
    """The joints would still hold it in a plane alone, and the chain would end beside its last joint."""
    foot = {"rod": "b", "at": 1.0, "kind": "revolute", "axis": [0, 1, 0], "position": [0.6, 0.0, 0.1]}
    tables = closed_chain(parameters=[name])
    tables["joints"][2] = {"name": "foot", **foot}
    tables["rods"][0]["base"] = {"quaternion": [1, 0, 0, 0]}
    with pytest.raises(SceneError, match="holds other directions with these parameters"):
        build(scene_from_dict(tables)).at({name: value})


def test_place_of_the_last_joint_of_a_closed_chain_is_a_parameter_in_its_plane() -> None:
    tables = closed_chain(parameters=["foot.position"])
    tables["joints"][2] = {"name": "foot", "rod": "b", **hinge("b", at=1.0, position=[0.6, 0.0, 0.1])}
    moved = solve(build(scene_from_dict(tables)), parameters={"foot.position": [0.5, 0.0, 0.3]})
    assert moved.converged
    assert_allclose(moved.tip("b").position, [0.5, 0.0, 0.3], rtol=0, atol=1e-12)
    assert_allclose(np.linalg.norm(moved.tip("a").position), LENGTH, rtol=0, atol=1e-9)


def test_base_that_moves_as_an_input_takes_its_hinge_along() -> None:
    model = build(TWO_LINKS)
    moved = solve(model, {"a.base.position": [0.1, 0.2, 1.3]})
    assert_allclose(moved.tip("b").position, [0.1, 0.2, 0.3], rtol=0, atol=1e-9)


@pytest.mark.parametrize(
    ("joint", "where", "problem"),
    [
        (ends({"rod": "a", "at": 0.0}, {"rod": "b", "at": 0.0}), "joints[0].between", "joins two bases"),
        ({**ends(0, 0), "between": [{"rod": "a"}]}, "joints[0].between[1]", "missing"),
        (ends({"rod": "a", "att": 0.0}, {"world": True}), "joints[0].between[0].att", "unknown key"),
        (
            ends({"rod": "a", "position": [0, 0, 1]}, {"world": True}),
            "joints[0].between[0].position",
            "stands in the end of a rod",
        ),
        ({"rod": "a", "kind": "fixed"}, "joints[0].position", "missing"),
        (hinge(position=[0, 0, 1]), "joints[0].position", "stands in a joint at X = 0 without body"),
        (hinge("free"), "joints[0].at", "holds a base that is free"),
        (hinge("carried"), "joints[0].at", "the base of 'carried' is beside the section that carries it"),
    ],
)
def test_refusals(joint: dict[str, Any], where: str, problem: str) -> None:
    carried = link("carried", base={"rod": "a", "position": [0.01, 0, 0]})
    rods = [link("a"), link("b"), link("free", base={"free": True}), carried]
    with pytest.raises(SceneError) as refused:
        scene_from_dict(scene(rods, [joint]))
    assert [(one.where, one.problem) for one in refused.value.problems] == [(where, problem)]


def test_a_rod_that_spins_on_a_ball_without_inertia_is_refused() -> None:
    bar = {"name": "a", "length": 0.3, "stiffness": {"bending_y": 0.5}, "strain": "planar", "linear_density": 0.1}
    ball = {"rod": "a", "at": 0.0, "kind": "spherical"}
    simulation = {"duration": 0.1}
    with pytest.raises(SceneError, match=r"rods\[0\].rotary_inertia.*nothing resists a spin"):
        scene_from_dict(scene([bar], [ball], simulation=simulation))
    scene_from_dict(scene([{**bar, "rotary_inertia": [0, 0, 1e-6]}], [ball], simulation=simulation))
    scene_from_dict(scene([bar], [hinge()], simulation=simulation))


@pytest.mark.parametrize(
    ("tables", "swings"),
    [
        (TWO, True),
        (ON_A_BODY, True),
        # The whole of it swings when the first rod is hinged too.
        ({**ON_A_BODY, "joints": [hinge(), {"rod": "a", "body": "p", "kind": "fixed"}, hinge("b", body="p")]}, True),
        # Springs, clamps, the world or another rod hold it.
        (scene([link("a", base=DOWN)], [hinge(stiffness=0.1)]), False),
        (scene([link("a", base=DOWN)], [{"rod": "a", "at": 0.0, "kind": "fixed"}]), False),
        (scene([link("a", base=DOWN)], [hinge(), {"rod": "a", "kind": "fixed", "position": [0, 0, 0.5]}]), False),
        (
            {
                **ON_A_BODY,
                "rods": [link("a", base=DOWN), link("b", base={"position": [0.1, 0, 1], "tangent": [0, 0, -1]})],
                "joints": [hinge(), *({"rod": rod, "body": "p", "kind": "spherical"} for rod in "ab")],
            },
            False,
        ),
    ],
)
def test_what_swings_begins_unloaded(tables: dict[str, Any], swings: bool) -> None:
    assert scene_from_dict({**tables, "simulation": {"duration": 0.1}}).starts_unloaded is swings


def test_a_bob_on_a_link_swings_as_the_pendulum() -> None:
    """A body at its end does not hold a hinged rod: let go from the side both fall, (m ℓ² + I) θ̈ = m g ℓ cos θ."""
    rod = link("a", strain=["torsion"], base={"tangent": [1, 0, 0]})
    rod["material"]["density"] = 1e-3
    bob = {"name": "bob", "mass": 1.0, "inertia": [0.01, 0.01, 0.01]}
    joints = [hinge(), {"rod": "a", "body": "bob", "kind": "fixed"}]
    simulation = {"duration": 0.5, "tolerance": 1e-5, "frames": 6}
    tables = scene([rod], joints, bodies=[bob], accuracy={"modes": 1}, simulation=simulation)
    motion = simulate(scene_from_dict(tables))
    assert motion.converged
    speed_up = GRAVITY * LENGTH / (LENGTH**2 + 0.01)
    fall = solve_ivp(
        lambda _, y: [y[1], speed_up * np.cos(y[0])], (0, 0.5), [0, 0], t_eval=motion.times, rtol=1e-10, atol=1e-12
    )
    wanted = LENGTH * np.column_stack([np.cos(fall.y[0]), -np.sin(fall.y[0])])
    assert_allclose(motion.body("bob").position[:, [0, 2]], wanted, rtol=0, atol=2e-5 * LENGTH)


@pytest.mark.parametrize(("position", "outcome"), [([0.05, 0, -0.1], "CONVERGED"), ([0, 0.03, 0], "OUT_OF_PLANE")])
def test_base_as_an_input_keeps_a_closed_chain_in_its_plane(position: list[float], outcome: str) -> None:
    """The joints hold the chain in its plane alone: beside it they would stay open, unseen by the residual."""
    tables = closed_chain(inputs=["a.base.position"])
    solution = solve(build(scene_from_dict(tables)), {"a.base.position": position})
    assert solution.outcome.name == outcome
    if not solution.converged:
        assert "'b' at its joint in the world" in solution.message
    assert_allclose(solution.tip("b").position[[0, 2]], [0.6, 0.1], rtol=0, atol=1e-9)


@pytest.mark.parametrize(("end", "outcome"), [([0.02, 0, -0.02], "COMPLETED"), ([0, 0.03, 0], "OUT_OF_PLANE")])
def test_a_base_that_moves_a_closed_chain_out_of_its_plane_is_told(end: list[float], outcome: str) -> None:
    driven = {"input": "a.base.position", "times": [0.0, 0.02], "values": [[0, 0, 0], end], "interpolation": "cubic"}
    simulation = {"duration": 0.02, "tolerance": 1e-2, "frames": 2}
    tables = closed_chain(inputs=["a.base.position"], motions=[driven], simulation=simulation)
    motion = simulate(build(scene_from_dict(tables), moving=True))
    assert motion.outcome.name == outcome
    if not motion.converged:
        assert "'b' at its joint in the world" in motion.message
