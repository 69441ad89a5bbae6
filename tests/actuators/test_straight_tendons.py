"""Tendons straight between holes: against shooting with forces at the holes, and many holes against a smooth course."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.optimize import root

from cosserat_casadi import Scene, SceneError, Solution, build, export, load, scene_from_dict
from cosserat_casadi.scene.writing import scene_text
from tests.derivatives import check_jacobian
from tests.equilibria import solve
from tests.equilibrium.test_assemblies import ROUND, march
from tests.families import mostly_slow

HOLES = [0.3, 0.65, 1.0]
OFFSET = np.array([0.05, -0.03])
PUSH = np.array([0.3, 0.2, -0.4])
WEIGHT = np.array([0.4, 0.0, -1.0])
TENDON: dict[str, Any] = {"name": "c", "kind": "tendon", "rod": "a", "offset": OFFSET.tolist(), "holes": HOLES}


def scene(strain: str = "reissner", accuracy: dict[str, Any] | None = None, **tendon: Any) -> Scene:
    """A rod under its weight, a push and a tendon with these keys, of 4 N unless its length is given."""
    if "length" not in tendon:
        tendon = {"tension": 4.0, **tendon}
    stiffness = ROUND if strain == "reissner" else {"bending_y": 1.0}
    rod = {"name": "a", "length": 1.0, "strain": strain, "stiffness": stiffness, "linear_density": 0.5}
    tables = {
        "schema": 1,
        "accuracy": accuracy or {"modes": 7, "nodes": 10},
        "rods": [rod],
        "actuators": [{**TENDON, **tendon}],
        "loads": [
            {"name": "w", "kind": "gravity", "acceleration": (WEIGHT / 0.5).tolist()},
            {"name": "p", "kind": "tip_wrench", "rod": "a", "force": PUSH.tolist()},
        ],
    }
    return scene_from_dict(tables)


def solved(wanted: Scene) -> Solution:
    solution = solve(build(wanted))
    assert solution.converged, solution.message
    return solution


def shot(tension: float, friction: float) -> tuple[np.ndarray, np.ndarray]:
    """Tip position and orientation by shooting.

    Unknown are the internal wrench at the base and where the holes are: between holes the rod is integrated under its
    weight, and at each the two spans pull at the hole.
    """
    arm = np.array([*OFFSET, 0.0])

    def walk(unknown: np.ndarray) -> tuple[np.ndarray, tuple[np.ndarray, np.ndarray]]:
        force, moment = unknown[:3], unknown[3:6]
        holes = np.vstack([arm, unknown[6:].reshape(3, 3)])
        chords = np.diff(holes, axis=0)
        directions = chords / np.linalg.norm(chords, axis=1)[:, None]
        angles = np.arccos(np.clip(np.sum(directions[1:] * directions[:-1], axis=1), -1, 1))
        tensions = tension * np.exp(-friction * np.concatenate([[0.0], np.cumsum(angles)]))
        pulls = np.vstack([tensions[:, None] * directions, np.zeros(3)])
        pose = (np.zeros(3), np.eye(3))
        gaps = []
        for k, length in enumerate(np.diff([0.0, *HOLES])):
            pose, force, moment = march(pose, force, moment, length, WEIGHT)
            hole = pose[0] + pose[1] @ arm
            gaps.append(hole - holes[k + 1])
            # What acts at the section is taken from the internal wrench.
            at_hole = pulls[k + 1] - pulls[k]
            force = force - at_hole
            moment = moment - np.cross(pose[1] @ arm, at_hole)
        return np.concatenate([*gaps, force - PUSH, moment]), pose

    start = np.concatenate([np.zeros(6), *[[*OFFSET, at] for at in HOLES]])
    found = root(lambda unknown: walk(unknown)[0], start, tol=1e-13)
    assert np.abs(walk(found.x)[0]).max() < 1e-10
    return walk(found.x)[1]


@pytest.mark.parametrize("friction", [0.0, 0.4])
def test_tip_vs_shooting(friction: float) -> None:
    solution = solved(scene(friction=friction))
    position, rotation = shot(4.0, friction)
    assert_allclose(solution.tip().position, position, rtol=0, atol=1e-8)
    assert_allclose(solution.tip().rotation, rotation, rtol=0, atol=1e-8)


def test_many_holes_near_a_continuous_course_at_second_order() -> None:
    """A chord is shorter than its arc by the square of the angle: twice the holes, a quarter of the difference."""
    accuracy = {"modes": 3, "nodes": 6}
    course = scene("planar", {"modes": 9, "nodes": 14}, offset=[0.05, 0])
    tendon = course.actuators[0].model_copy(update={"holes": None})
    smooth = solved(course.model_copy(update={"actuators": (tendon,)}))
    distances = []
    for count in (4, 8, 16):
        places = (np.arange(1, count + 1) / count).tolist()
        straight = solved(scene("planar", accuracy, offset=[0.05, 0], holes=places))
        distances.append(float(np.linalg.norm(straight.tip().position - smooth.tip().position)))
    rates = np.log2(np.array(distances[:-1]) / distances[1:])
    assert_allclose(rates, 2.0, rtol=0, atol=0.1)


FEW = {"modes": 2, "nodes": 5}
CABLES: dict[str, dict[str, Any]] = {
    "tension": {},
    "friction": {"friction": 0.4},
    "length": {"length": 0.96},
    "slack": {"length": 0.96, "slack": True, "friction": 0.3, "axial_stiffness": 90.0},
}


@pytest.mark.parametrize("name", mostly_slow(CABLES, quick=["slack"]))
def test_jacobian_vs_ad(name: str) -> None:
    model = build(scene(accuracy=FEW, **CABLES[name]))
    check_jacobian(model, 0.7, seed=2)


def test_pull_is_the_gradient_of_the_length() -> None:
    model = build(scene(accuracy=FEW))
    x = 0.3 * np.random.default_rng(3).standard_normal(model.size)
    symbol = ca.MX.sym("x", model.size)
    _, length, by_x = model.actuator["c"](symbol, model.pack())
    compared = ca.Function("compared", [symbol], [by_x, ca.jacobian(length, symbol)])
    own, ad = (values.full() for values in compared(x))
    assert_allclose(own, ad, rtol=0, atol=1e-14)


def test_length_is_the_sum_of_the_distances_of_the_holes() -> None:
    solution = solved(scene())
    pose = solution.pose([0.0, *HOLES])
    holes = pose.position + pose.rotation[:, :, :2] @ OFFSET
    distances = np.linalg.norm(np.diff(holes, axis=0), axis=1)
    assert_allclose(solution.actuator("c")["length"], distances.sum(), rtol=1e-13, atol=0)


@pytest.mark.slow
def test_digits_of_c(tmp_path: Path) -> None:
    model = build(scene("planar", FEW, offset=[0.05, 0.0], friction=0.3))
    compiled = load(export(model, tmp_path / "straight", "straight"))
    assert_allclose(compiled.solve().x, solve(model).x, rtol=0, atol=1e-10)


def test_a_hole_moves_with_its_disk() -> None:
    """Places that are tied are one parameter."""
    tables = scene(accuracy={"modes": 4, "nodes": 7}).model_dump(by_alias=True, exclude_unset=True)
    moved = {**tables["actuators"][0], "holes": [0.4, 0.65, 1.0]}
    disks = {"name": "d", "rod": "a", "at": [0.3, 0.65], "radius": 0.1, "mass": 0.1}
    tied = scene_from_dict({**tables, "disks": [disks], "parameters": [["d.at[0]", "c.holes[0]"]]})
    there = scene_from_dict({**tables, "actuators": [moved], "disks": [{**disks, "at": [0.4, 0.65]}]})
    model = build(tied)
    solution = solve(model, parameters={"d.at[0]": 0.4})
    assert solution.converged
    # With the place as an expression, as C has it.
    left = model.residual(solution.x, model.pack(), model.parameters.pack({"d.at[0]": 0.4}))
    assert_allclose(left.full(), 0.0, rtol=0, atol=1e-9)
    assert_allclose(solution.tip().position, solved(there).tip().position, rtol=0, atol=1e-12)
    with pytest.raises(SceneError, match="tie the two together"):
        build(scene_from_dict({**tables, "disks": [disks], "parameters": ["d.at[0]"]}))


def test_routing_through_disks_is_read_as_holes() -> None:
    tables = scene().model_dump(by_alias=True, exclude_unset=True)
    tendon = {key: value for key, value in TENDON.items() if key != "holes"} | {"tension": 4.0, "routing": "disks"}
    disks = [{"rod": "a", "at": HOLES, "radius": 0.1}, {"rod": "a", "at": [0.5], "radius": 0.1}]
    read = scene_from_dict({**tables, "actuators": [{**tendon, "span": [0.3, 1.0]}], "disks": disks})
    assert read.actuators[0].holes == (0.3, 0.5, 0.65, 1.0)
    assert scene_from_dict(read.model_dump(by_alias=True, exclude_unset=True)) == read
    assert "holes" in scene_text(read)


@pytest.mark.parametrize(
    ("changes", "where", "problem"),
    [
        ({"holes": [0.5, 0.4]}, "actuators[0].holes[1]", "must be > 0.5, the hole before it, got 0.4"),
        ({"span": [0.4, 1.0]}, "actuators[0].holes[0]", "must be within its span, 0.4 to 1, got 0.3"),
        ({"routing": "disks"}, "actuators[0].routing", "stands beside holes"),
    ],
)
def test_refusals(changes: dict[str, Any], where: str, problem: str) -> None:
    with pytest.raises(SceneError) as refused:
        scene(**changes)
    assert [(one.where, one.problem) for one in refused.value.problems] == [(where, problem)]
