"""Tuning: one discretisation that holds over all load cases, and says so honestly."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import SceneError, build, discretise, parse_scene, solve, solve_scene, tune
from cosserat_casadi.equilibrium.metrics import pose_distance
from cosserat_casadi.scene.writing import scene_text
from tests.scenes import push, rod, scene


def test_tuned_discretisation_holds_at_every_case() -> None:
    """Against a much finer solution of each case; neither case's own choice serves the other."""
    wanted = scene(push(force=[0.4, 0.0, 0.0]), accuracy={"tolerance": 1e-5})
    cases = [{"push.force": [1.5, 0.0, 0.0]}, {"push.force": [0.0, 1.0, -0.3]}, {"push.force": [0.0, 0.0, 0.0]}]
    tuning = tune(wanted, cases)
    assert tuning.met
    own = [solve_scene(wanted, case).model.size for case in cases]
    assert max(own) <= tuning.solutions[0].model.size
    for case, solution in zip(cases, tuning.solutions, strict=True):
        fine = solve(build(wanted, discretise(wanted, 14, 34, "magnus8")), case)
        assert pose_distance(solution, fine) <= 1e-5
    again = parse_scene(scene_text(tuning.scene))
    assert again == tuning.scene
    assert solve_scene(again).model.discretisation == tuning.solutions[0].model.discretisation


def test_worst_case_is_the_one_with_the_largest_estimate() -> None:
    wanted = scene(push(force=[0.4, 0.0, 0.0]))
    cases = [{"push.force": [size, 0.0, 0.0]} for size in (0.1, 2.0, 0.5)]
    tuning = tune(wanted, cases, 1e-4)
    estimates = [solution.error_estimate for solution in tuning.solutions]
    assert tuning.worst == int(np.argmax(np.array(estimates, dtype=float)))
    assert_allclose(tuning.scene.accuracy.tolerance, 1e-4, rtol=0, atol=0)


def test_a_case_without_equilibrium_is_not_met() -> None:
    """A load beyond all numbers: the case is called the worst, and the tuning not met."""
    cases = [{"push.force": [0.1, 0.0, 0.0]}, {"push.force": [1e200, 0.0, 0.0]}]
    tuning = tune(scene(push(), strain="planar"), cases, 1e-2)
    assert not tuning.met
    assert tuning.worst == 1
    assert not tuning.solutions[1].converged


def test_parameters_are_tuned_for_as_inputs_are() -> None:
    """A rod that a parameter bends more wants more modes; the file says what they were chosen for."""
    curved = {**rod("planar"), "intrinsic": {"curvature": [0, [0.5, 0.0], 0]}}
    parameters = ["rod.intrinsic.curvature.y"]
    wanted = scene(push(force=[0.2, 0.0, 0.0]), rods=[curved], parameters=parameters)
    bent = {"push.force": [0.4, 0.0, 0.0], "rod.intrinsic.curvature.y": [2.0, 6.0]}
    tuning = tune(wanted, [{}, bent], 1e-6)
    assert tuning.met
    assert tuning.scene.parameters == wanted.parameters
    assert tuning.scene.accuracy.chosen_for == (
        "push.force.x=0.2:0.4",
        "rod.intrinsic.curvature.y[0]=0.5:2",
        "rod.intrinsic.curvature.y[1]=0:6",
    )
    assert tuning.solutions[1].model.size > tune(wanted, [{}], 1e-6).solutions[0].model.size
    again = parse_scene(scene_text(tuning.scene))
    assert again == tuning.scene
    # On the modes that it chose, the model with parameters is as exact as it says.
    model = build(again)
    found = solve(model, {"push.force": bent["push.force"]}, parameters={parameters[0]: bent[parameters[0]]})
    fine = build(wanted, discretise(wanted, 14, 34, "magnus8"))
    exact = solve(fine, {"push.force": bent["push.force"]}, parameters={parameters[0]: bent[parameters[0]]})
    assert pose_distance(found, exact) <= 1e-6


def test_ranges_of_a_scene_are_judged() -> None:
    for ranges, sentence in (
        (["push.force.x=1:-1"], "the lower first"),
        (["push.force.x"], "must be a column and two numbers"),
        ([], "must have at least one entry"),
    ):
        with pytest.raises(SceneError, match=sentence):
            scene(push(), accuracy={"modes": 4, "chosen_for": ranges})
    with pytest.raises(SceneError, match="stands without modes"):
        scene(push(), accuracy={"chosen_for": ["push.force.x=-1:1"]})
