"""Inverse problems of concentric tubes: rotations and translations that bring a tip to a target."""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose
from typer.testing import CliRunner

from cosserat_casadi import SceneError, inverse, parse_scene, solve
from cosserat_casadi.cli.main import app
from cosserat_casadi.control.inverse_accuracy import inverse_rows
from cosserat_casadi.maths.pose_change import rotation_angles
from cosserat_casadi.tubes.robot import robot_of
from cosserat_casadi.tubes.tube_solution import tip_error
from cosserat_casadi.tubes.tube_solve import model_of
from tests.conftest import ROOT

BOUNDS = {"inner.rotation": (-3.2, 3.2), "outer.rotation": (-1.0, 1.0), "inner.translation": (0.1, 0.25)}
ELSEWHERE = {"inner.rotation": 1.9, "outer.rotation": 0.3, "inner.translation": 0.19}
"""Inputs whose tip is a target that can be met."""


@cache
def text_of(name: str) -> str:
    return (ROOT / "examples" / f"{name}.toml").read_text()


def with_target(name: str, kind: str, bounds: dict[str, tuple[float, float]], **pose: object) -> str:
    """A scene of the examples with a target for the inner tube's tip and bounds of inputs."""
    numbers = "".join(f"{key} = {np.asarray(value).tolist()}\n" for key, value in pose.items())
    lines = [text_of(name), f'[[targets]]\nkind = "{kind}"\nrod = "inner"\n{numbers}']
    lines += [f'[[bounds]]\ninput = "{key}"\nlower = {low}\nupper = {high}' for key, (low, high) in bounds.items()]
    return "\n".join(lines)


@pytest.mark.parametrize("name", ["concentric_tubes", pytest.param("loaded_tubes", marks=pytest.mark.slow)])
def test_a_tip_is_brought_to_where_other_inputs_have_it(name: str) -> None:
    goal = solve(parse_scene(text_of(name)), ELSEWHERE).tip("inner").position
    scene = parse_scene(with_target(name, "position", BOUNDS, position=goal))
    found = inverse(scene)
    assert found.met, found.solution.message
    assert found.solution.error_estimate <= scene.accuracy.tolerance
    # Solved anew from straight tubes, with steps of its own.
    again = solve(scene, found.values)
    assert again.converged
    assert_allclose(again.tip("inner").position, goal, rtol=0, atol=2e-7)
    for key, (low, high) in BOUNDS.items():
        assert low <= found.values[key] <= high
    assert found.values["outer.translation"] == solve(scene).inputs[again.robot.columns["outer.translation"]]


def test_a_tip_has_the_pose_that_is_wanted() -> None:
    scene = parse_scene(text_of("concentric_tubes"))
    wanted = solve(scene, ELSEWHERE).tip("inner")
    text = with_target("concentric_tubes", "pose", BOUNDS, position=wanted.position, quaternion=wanted.quaternion)
    found = inverse(solve(parse_scene(text)).model)
    assert found.met, found.solution.message
    tip = found.solution.tip("inner")
    assert_allclose(tip.position, wanted.position, rtol=0, atol=1e-7)
    assert_allclose(rotation_angles(wanted.quaternion, tip.quaternion), 0.0, rtol=0, atol=1e-6)
    # The pose of three numbers too many says which inputs it is of.
    for key, value in ELSEWHERE.items():
        assert_allclose(found.values[key], value, rtol=0, atol=1e-5)


@pytest.mark.slow
def test_beyond_its_reach_the_tip_is_as_near_as_it_can_be() -> None:
    free = {key: (-10.0, 10.0) if "rotation" in key else ends for key, ends in BOUNDS.items()}
    del free["inner.translation"]
    scene = parse_scene(with_target("concentric_tubes", "position", free, position=[0.3, 0.2, 0.1]))
    found = inverse(scene)
    assert found.solution.converged
    assert not found.met
    assert found.at_bounds == ()
    miss = np.array([0.3, 0.2, 0.1]) - found.solution.tip("inner").position
    turning = [found.solution.robot.columns[key] for key in free]
    slopes = found.solution.tip_jacobian[1, 3:, turning] @ miss
    # Turned by any drive the tip moves across the line to the target.
    assert_allclose(slopes / np.linalg.norm(miss), 0.0, rtol=0, atol=1e-6)


def test_rows_of_targets_are_met_one_after_the_other() -> None:
    scene = parse_scene(text_of("concentric_tubes"))
    goals = [solve(scene, {**ELSEWHERE, "inner.rotation": angle}).tip("inner").position for angle in (1.8, 1.9, 2.0)]
    with_goal = parse_scene(with_target("concentric_tubes", "position", BOUNDS, position=goals[0]))
    (target,) = with_goal.targets
    rows = inverse_rows(with_goal, [(target.model_copy(update={"position": tuple(goal)}),) for goal in goals])
    for row, goal in zip(rows, goals, strict=True):
        assert row.met
        assert_allclose(row.solution.tip("inner").position, goal, rtol=0, atol=1e-7)
    # The neighbours of a row that is met need no optimiser.
    assert sorted(row.rounds for row in rows)[:2] == [0, 0]


def test_the_error_of_a_model_with_few_steps_counts() -> None:
    scene = parse_scene(text_of("concentric_tubes"))
    coarse = model_of(robot_of(scene), 1)
    told = solve(coarse)
    fine = solve(model_of(robot_of(scene), 16))
    true = tip_error(told, fine)
    assert told.error_estimate is not None
    assert true <= told.error_estimate <= 3 * true
    assert told.within_tolerance is (told.error_estimate <= scene.accuracy.tolerance)
    assert solve(coarse, estimate_error=False).error_estimate is None


def test_a_solution_that_is_followed_stays_on_its_branch() -> None:
    scene = parse_scene(text_of("concentric_tubes"))
    start = solve(scene)
    there = solve(start.model, {"inner.rotation": 3.0}, start=start)
    direct = solve(start.model, {"inner.rotation": 3.0})
    assert there.converged
    assert_allclose(there.x, direct.x, rtol=0, atol=1e-8)


@pytest.mark.parametrize(
    ("target", "fault"),
    [
        ('kind = "curve"\nrod = "inner"\nat = [1.0]\npoints = [[0, 0, 0.1]]', "is for points along a rod"),
        ('kind = "position"\nrod = "inner"\nat = 0.5\nposition = [0, 0, 0.1]', "is a place on a rod"),
        ('kind = "position"\nrod = "wire"\nposition = [0, 0, 0.1]', "no tube is named 'wire'"),
        ('kind = "position"\nbody = "plate"\nposition = [0, 0, 0.1]', "no body is named 'plate'"),
    ],
)
def test_targets_of_tubes_are_those_of_tips(target: str, fault: str) -> None:
    with pytest.raises(SceneError, match=fault):
        parse_scene(f"{text_of('concentric_tubes')}\n[[targets]]\n{target}")


def test_without_targets_there_is_nothing_to_look_for() -> None:
    with pytest.raises(SceneError, match="targets: missing"):
        inverse(parse_scene(text_of("concentric_tubes")))


def test_without_bounds_all_tubes_move() -> None:
    assert inverse(parse_scene(with_target("concentric_tubes", "position", {}, position=[0, 0, 0.1]))).met


@pytest.mark.slow
def test_on_the_command_line(tmp_path: Path) -> None:
    goal = solve(parse_scene(text_of("concentric_tubes")), ELSEWHERE).tip("inner").position
    file = tmp_path / "tubes.toml"
    file.write_text(with_target("concentric_tubes", "position", BOUNDS, position=goal))
    output, plot = tmp_path / "found.json", tmp_path / "found.png"
    done = CliRunner().invoke(app, ["inverse", str(file), "--output", str(output), "--plot", str(plot)])
    assert done.exit_code == 0, done.output
    assert "The targets are met" in done.output
    data = json.loads(output.read_text())
    assert data["targets_met"]
    assert data["targets"][0]["what"] == "tip of inner"
    assert_allclose(data["tubes"]["inner"]["tip"]["position"], goal, rtol=0, atol=1e-7)
    assert plot.stat().st_size > 0
