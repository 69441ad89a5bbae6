"""Inverse problems: inputs recovered from poses, closed form, targets out of reach, bounds, refusals."""

from __future__ import annotations

import importlib
import json
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Model, Outcome, Scene, SceneError, Solution, build, inverse, read_scene, solve
from cosserat_casadi.scene import scene_from_dict
from cosserat_casadi.scene.writing import scene_tables
from tests.conftest import ROOT
from tests.scenes import WEIGHT, push, scene

TENSIONS = ["lower_east.tension", "lower_north.tension", "upper_west.tension", "upper_south.tension"]


def changed(base: Scene, **tables: Any) -> Scene:
    return scene_from_dict({**scene_tables(base), **tables})


def pose_of(solution: Solution, rod: str) -> dict[str, Any]:
    tip = solution.tip(rod)
    position, quaternion = tip.position.tolist(), tip.quaternion.tolist()
    return {"kind": "pose", "rod": rod, "position": position, "quaternion": quaternion}


def test_tensions_are_recovered_from_a_pose() -> None:
    base = changed(read_scene(ROOT / "examples" / "two_section_robot.toml"), inputs=TENSIONS)
    truth = dict(zip(TENSIONS, [3.0, 7.0, 2.0, 9.0], strict=True))
    target = pose_of(solve(build(base), truth), "backbone")
    found = inverse(build(changed(base, targets=[target])))
    assert found.met
    assert found.gaps[0].angle is not None
    assert_allclose([found.gaps[0].position, found.gaps[0].angle], 0.0, rtol=0, atol=1e-9)
    for name, tension in truth.items():
        assert_allclose(found.values[name].item(), tension, rtol=1e-7, atol=0)


@pytest.mark.slow
def test_only_what_is_bounded_changes() -> None:
    """A payload that is listed for a controller keeps the scene's value where tensions alone have bounds."""
    base = read_scene(ROOT / "examples" / "two_section_robot.toml")
    truth = dict(zip(TENSIONS, [3.0, 7.0, 2.0, 9.0], strict=True))
    robot = changed(base, inputs=[*TENSIONS, "payload.force"], accuracy={"modes": 3, "nodes": 12})
    # A heavier payload than the scene's: with the scene's own the tensions alone cannot meet the pose.
    target = pose_of(solve(build(robot), {**truth, "payload.force": [0.0, 0.0, -0.4]}), "backbone")
    bounds = [{"input": name, "upper": 12.0} for name in TENSIONS]
    found = inverse(build(changed(robot, targets=[target], bounds=bounds)))
    assert_allclose(found.values["payload.force"].ravel(), [0.0, 0.0, -0.1], rtol=0, atol=0)
    # Three modes are not enough for the tolerance: what is judged here is the gap that the search leaves.
    assert np.abs(found.gaps[0].position).max() > 1e-3
    # One limit, far off, sets it free.
    bounds.append({"input": "payload.force", "upper": 10.0})
    freed = inverse(build(changed(robot, targets=[target], bounds=bounds)))
    assert_allclose(freed.gaps[0].position, 0.0, rtol=0, atol=1e-9)


def reachable(tensions: list[float]) -> Model:
    """The robot with a pose as its target that these tensions lead to, and tensions of at most 25 N to find."""
    robot = changed(
        read_scene(ROOT / "examples" / "two_section_robot.toml"), inputs=TENSIONS, accuracy={"modes": 3, "nodes": 10}
    )
    target = pose_of(solve(build(robot), dict(zip(TENSIONS, tensions, strict=True))), "backbone")
    bounds = [{"input": name, "upper": 25.0} for name in TENSIONS]
    return build(changed(robot, targets=[target], bounds=bounds))


@pytest.mark.slow
@pytest.mark.parametrize("tensions", [[9.81, 12.326, 0.0, 1.52], [0.0, 17.306, 15.885, 0.0]])
def test_scattered_starts_leave_a_local_minimum(tensions: list[float]) -> None:
    """From the scene's own tensions the search ends far off, at a bound; from another start the pose is met."""
    model = reachable(tensions)
    local = inverse(model, starts=0, estimate_error=False)
    assert local.gaps[0].position > 0.1
    assert local.at_bounds
    assert f"a local minimum at the bound of {', '.join(local.at_bounds)}" in local.solution.message
    assert "the best of 1 start." in local.solution.message
    found = inverse(model, estimate_error=False)
    assert found.met
    assert 1 < found.starts <= 9
    # The same scene has the same starts.
    again = inverse(model, estimate_error=False)
    assert_allclose(again.solution.inputs, found.solution.inputs, rtol=0, atol=0)


@pytest.mark.slow
@pytest.mark.parametrize("tensions", [[1.219, 0.0, 0.0, 0.0], [0.0, 10.917, 5.081, 0.0]])
def test_slack_tendons_are_found_slack(tensions: list[float]) -> None:
    """A tension of zero that nothing presses to its bound is found exactly, where an interior point stays off it."""
    found = inverse(reachable(tensions), starts=0, estimate_error=False)
    assert found.met
    for name, tension in zip(TENSIONS, tensions, strict=True):
        assert_allclose(found.values[name].item(), tension, rtol=0, atol=1e-6)


@pytest.mark.slow
def test_of_many_tensions_those_near_the_scenes_are_taken() -> None:
    """Four tensions for three coordinates: no solution on the line of solutions is nearer by more than the damping."""
    base = changed(read_scene(ROOT / "examples" / "two_section_robot.toml"), inputs=TENSIONS)
    truth = dict(zip(TENSIONS, [9.0, 3.0, 7.0, 6.0], strict=True))
    position = solve(build(base), truth).tip().position.tolist()
    model = build(changed(base, targets=[{"kind": "position", "rod": "backbone", "position": position}]))
    found = inverse(model)
    assert found.met
    assert_allclose(found.gaps[0].position, 0.0, rtol=0, atol=1e-8)
    start, reached = model.pack(), found.solution.inputs
    assert np.linalg.norm(reached - start) < np.linalg.norm(np.array(list(truth.values())) - start)


def test_constant_curvature_closed_form() -> None:
    """One straight tendon at a distance d on a planar rod bends it to the curvature T d / EI: x = (1 − cos κL)/κ."""
    stiffness, distance, length, tension = 1.4, 0.02, 0.8, 60.0
    cable = {"name": "cable", "kind": "tendon", "rod": "rod", "tension": 5.0, "offset": [distance, 0.0]}
    curvature = tension * distance / stiffness
    x, z = (1 - np.cos(curvature * length)) / curvature, np.sin(curvature * length) / curvature
    target = {"kind": "position", "rod": "rod", "position": [x, 0.0, z]}
    bounds = [{"input": "cable.tension", "upper": 1e3}]
    found = inverse(scene(strain="planar", actuators=[cable], targets=[target], bounds=bounds))
    assert found.met
    assert_allclose(found.gaps[0].position, 0.0, rtol=0, atol=1e-8)
    assert isinstance(found.values["cable.tension"], float)
    assert_allclose(found.values["cable.tension"], tension, rtol=1e-7, atol=0)


@pytest.mark.slow
def test_lengths_of_a_parallel_robot() -> None:
    """The six-rod platform brought to a pose by the lengths of its rods."""
    names = [f"leg_{i}.length" for i in range(1, 7)]
    base = changed(read_scene(ROOT / "examples" / "six_rod_platform.toml"), inputs=names, accuracy={"modes": 4})
    truth = dict(zip(names, [0.44, 0.45, 0.44, 0.45, 0.43, 0.44], strict=True))
    body = solve(build(base), truth).body()
    target = {
        "kind": "pose",
        "body": "platform",
        "position": body.position.tolist(),
        "quaternion": body.quaternion.tolist(),
    }
    found = inverse(build(changed(base, targets=[target])))
    # The pose is one of these four modes, to rounding; whether they are enough for the tolerance is not asked.
    assert_allclose(found.gaps[0].position, 0.0, rtol=0, atol=1e-9)
    assert_allclose([found.values[name].item() for name in names], list(truth.values()), rtol=0, atol=1e-8)


def test_base_and_curve() -> None:
    """A rod without load is moved by its base on to a straight line that is turned and shifted."""
    points = [[0.1, 0.2, 0.3 + 0.8 * X] for X in (0.25, 0.5, 1.0)]
    target = {"kind": "curve", "rod": "rod", "at": [0.25, 0.5, 1.0], "points": points}
    found = inverse(build(scene(inputs=["rod.base.position"], targets=[target])))
    assert found.met
    assert_allclose(found.values["rod.base.position"].ravel(), [0.1, 0.2, 0.3], rtol=0, atol=1e-8)


OUT_OF_REACH = {"kind": "position", "rod": "rod", "position": [0.0, 0.0, 1.8]}


def test_out_of_reach_gives_the_closest_and_says_so() -> None:
    """A rod of 0.8 m that keeps its length, and a point 1.8 m away: 1 m is left."""
    found = inverse(scene(push(force=[0.5, 0, 0]), inputs=["push.force"], targets=[OUT_OF_REACH]))
    assert found.solution.converged
    assert not found.met
    assert_allclose(found.gaps[0].position, 1.0, rtol=0, atol=1e-6)
    assert "misses tip of rod by 1 m" in found.solution.message
    assert found.gaps[0].angle is None


@pytest.mark.slow
def test_bounds_are_kept_and_reached() -> None:
    """The nearest that a force of at most 0.3 N brings the tip: at the bound, and against a scan over the range."""
    target = {"kind": "position", "rod": "rod", "position": [0.4, 0.0, 0.6]}
    bounds = [{"input": "push.force", "lower": [-0.3, 0.0, 0.0], "upper": [0.3, 0.0, 0.0]}]
    bounded = scene(push(force=[0.0, 0.0, 0.0]), inputs=["push.force"], targets=[target], bounds=bounds)
    found = inverse(build(bounded))
    assert not found.met
    force = found.values["push.force"].ravel()
    assert_allclose(force, [0.3, 0.0, 0.0], rtol=0, atol=1e-6)
    assert "a local minimum at the bound of push.force, the best of 9 starts." in found.solution.message
    assert np.all(np.abs(force) <= [0.3, 0.0, 0.0])
    tips = [solve(build(bounded), {"push.force": [f, 0, 0]}).tip().position for f in np.linspace(-0.3, 0.3, 5)]
    scanned = min(float(np.linalg.norm(tip - target["position"])) for tip in tips)
    assert_allclose(found.gaps[0].position, scanned, rtol=0, atol=1e-6)


def test_weights_decide_between_targets() -> None:
    """Two points for one tip on a line: the nearer to the one of weight w, the larger w; least squares in between."""
    targets = [{"kind": "position", "rod": "rod", "position": [0.0, 0.0, 0.8 + z]} for z in (0.0, 0.2)]
    for weight in (1.0, 3.0):
        targets[1] = {**targets[1], "weight": weight}
        found = inverse(build(scene(inputs=["rod.base.position"], targets=targets)))
        assert_allclose(found.values["rod.base.position"][2, 0], 0.2 * weight / (1 + weight), rtol=0, atol=1e-8)
        assert not found.met


@pytest.mark.slow
def test_the_equilibrium_is_that_of_a_solve() -> None:
    """Inputs found, given to a plain solve, lead to the same tip; the file says what is left."""
    found = inverse(read_scene(ROOT / "examples" / "finger_to_point.toml"))
    assert found.met
    again = solve(found.solution.model, found.values)
    assert_allclose(again.tip().position, found.solution.tip().position, rtol=0, atol=1e-12)
    file = found.to_dict()
    assert (file["targets_met"], file["converged"], file["stable"]) == (True, True, True)
    assert file["targets"][0]["position_gap"] <= 1e-7 * 0.1
    assert file["error_estimate"] <= 1e-7
    json.dumps(file, allow_nan=False)


@pytest.mark.slow
def test_a_gap_is_not_smaller_than_the_error_of_its_model() -> None:
    """Modes and nodes that the user fixed meet the target on their own rod, which is far from the scene's."""
    base = read_scene(ROOT / "examples" / "finger_to_point.toml")
    coarse = inverse(changed(base, accuracy={"modes": 2, "nodes": 8, "tolerance": 1e-6}))
    (gap,) = coarse.gaps
    assert gap.position <= 1e-6 * 0.1
    assert gap.position_error is not None
    assert coarse.solution.error_estimate is not None
    assert_allclose(gap.position_error, coarse.solution.error_estimate * 0.1, rtol=1e-12, atol=0)
    assert gap.position_error > 1e-6 * 0.1
    assert not coarse.met
    assert "The targets are met." not in coarse.solution.message
    assert "estimated error of the model" in coarse.solution.message
    file = coarse.to_dict()
    assert file["targets"][0]["position_error_estimate"] == gap.position_error
    # The estimate is honest: at the same inputs the resolved rod misses the target by no more than it.
    resolved = solve(build(changed(base, accuracy={"modes": 12, "nodes": 24})), coarse.values)
    miss = np.linalg.norm(resolved.tip().position - base.targets[0].position)
    assert 1e-6 * 0.1 < miss <= gap.position_error
    wide = inverse(changed(base, accuracy={"modes": 2, "nodes": 8, "tolerance": 0.1}))
    assert wide.met


def test_modes_that_do_not_resolve_the_rod_are_no_result() -> None:
    """As in a solve: beyond a tenth of the length the equilibrium is not one of the rod, however small the gap."""
    base = read_scene(ROOT / "examples" / "finger_to_point.toml")
    found = inverse(changed(base, accuracy={"modes": 1, "nodes": 4}))
    assert found.gaps[0].position <= 1e-10
    assert found.solution.outcome is Outcome.UNRESOLVED
    assert "The estimated error is 0.22 of the length." in found.solution.message
    assert not found.met


@pytest.mark.slow
def test_a_stable_equilibrium_when_asked() -> None:
    """Beyond its critical load a column meets its target straight; asked for a stable one, it is told that none is."""
    column = scene(
        push(force=[0.0, 0.0, -12.0]),
        strain="planar",
        inputs=["push.force"],
        targets=[{"kind": "position", "rod": "rod", "position": [0.0, 0.0, 0.8]}],
        bounds=[{"input": "push.force", "lower": [0.0, 0.0, -12.0], "upper": [0.0, 0.0, -10.0]}],
    )
    straight = inverse(build(column))
    assert (straight.met, straight.solution.stable, straight.unstable) == (True, False, True)
    assert straight.solution.message.startswith("Not stable: a real rod leaves this equilibrium.")
    assert "unstable" in straight.solution.message
    asked = inverse(build(column), stable=True)
    assert not asked.met


def test_without_inputs_and_bounds_all_magnitudes_but_gravity_are_found() -> None:
    pushed = solve(build(scene(WEIGHT, push())), {"push.force": [0.6, 0.7, -0.2]})
    target = pose_of(pushed, "rod")
    target = {"kind": "position", "rod": "rod", "position": target["position"]}
    heavy = build(scene(WEIGHT, push(), targets=[target]))
    found = inverse(heavy)
    assert found.met
    values = heavy.inputs.unpack(found.solution.inputs)
    assert_allclose(np.ravel(values["weight.acceleration"]), WEIGHT["acceleration"], rtol=0, atol=0)
    assert_allclose(np.ravel(values["push.force"]), [0.6, 0.7, -0.2], rtol=0, atol=1e-4)


def test_refusals() -> None:
    target = {"kind": "position", "rod": "rod", "position": [0, 0, 1]}
    with pytest.raises(SceneError, match=r"targets: missing"):
        inverse(build(scene(push(), inputs=["push.force"])))
    with pytest.raises(SceneError, match="no input is left to find"):
        inverse(build(scene(WEIGHT, targets=[target])))
    cable = {"name": "cable", "kind": "tendon", "rod": "rod", "tension": 5.0, "offset": [0.01, 0.0]}
    bounds = [{"input": "cable.tension", "upper": -1.0}]
    with pytest.raises(SceneError, match=r"bounds\[0\].upper: is below 0, the least that cable.tension can be"):
        inverse(build(scene(actuators=[cable], targets=[target], bounds=bounds)))
    follower = push(frame="body", force=[1, 0, 0])
    with pytest.raises(SceneError, match="no potential"):
        inverse(build(scene(follower, inputs=["push.force"], targets=[target])), stable=True)


def test_a_search_that_takes_long_begins_no_further_starts(monkeypatch: pytest.MonkeyPatch) -> None:
    """It says how many are left out, and is not repeated on more modes; each start is reported before it begins."""
    module = importlib.import_module("cosserat_casadi.control.inverse")
    target = {"kind": "position", "rod": "rod", "position": [0.4, 0.0, 0.6]}
    bounds = [{"input": "push.force", "lower": [-0.3, 0.0, 0.0], "upper": [0.3, 0.0, 0.0]}]
    far = scene(
        push(force=[0.0, 0.0, 0.0]),
        inputs=["push.force"],
        targets=[target],
        bounds=bounds,
        accuracy={"tolerance": 1e-4},
    )
    # Every look at the clock takes half of the time: the second further start is left out.
    times = iter(np.arange(100.0) * module.LONGEST * 0.6)
    monkeypatch.setattr(module, "monotonic", lambda: next(times))
    told: list[str] = []
    found = inverse(far, report=told.append)
    assert not found.met
    assert (found.starts, found.starts_left_out) == (2, module.STARTS - 1)
    assert f"the best of 2 starts. The search took too long for {module.STARTS - 1} further ones." in (
        found.solution.message
    )
    starts = [line for line in told if line.startswith("start ")]
    assert len(starts) == 1
    assert starts[0].startswith(f"start 2 of {module.STARTS + 1}, ")
    assert len(told) == 2


def test_an_optimiser_that_runs_out_of_time_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    """The equilibrium at the inputs where it was is judged; no target is met by chance, and no minimum is claimed."""
    module = importlib.import_module("cosserat_casadi.control.lifted_problem")
    target = {"kind": "position", "rod": "rod", "position": [0.1, 0.0, 0.99]}
    near = scene(push(force=[0.0, 0.0, 0.0]), inputs=["push.force"], targets=[target], accuracy={"tolerance": 1e-4})
    assert not inverse(near).cut_short
    monkeypatch.setitem(module.IPOPT, "max_wall_time", 1e-9)
    found = inverse(near)
    assert found.cut_short
    assert found.solution.converged
    assert not found.met
    assert "The optimiser ran out of time" in found.solution.message
    assert "It is a local minimum" not in found.solution.message
