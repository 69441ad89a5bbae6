"""One discretisation for load cases: it holds at each of them, and says so honestly."""

from __future__ import annotations

import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import SceneError, build, choose, discretise, parse_scene, solve
from cosserat_casadi.accuracy.ranges import input_ranges
from cosserat_casadi.equilibrium.metrics import pose_distance
from cosserat_casadi.scene.writing import scene_text
from tests.scenes import push, rod, scene


@pytest.mark.slow
def test_a_discretisation_holds_at_every_case() -> None:
    """Against a much finer solution of each case; neither case's own choice serves the other."""
    wanted = scene(push(force=[0.4, 0.0, 0.0]), accuracy={"tolerance": 1e-5})
    cases = [{"push.force": [1.5, 0.0, 0.0]}, {"push.force": [0.0, 1.0, -0.3]}, {"push.force": [0.0, 0.0, 0.0]}]
    choice = choose(wanted, cases=cases)
    assert choice.met
    assert choice.solves == 3
    own = [solve(wanted, case).model.size for case in cases]
    assert max(own) <= choice.model.size
    fine = build(wanted, discretise(wanted, 14, 34, "magnus8"))
    for case in cases:
        assert pose_distance(solve(choice.model, case), solve(fine, case)) <= 1e-5
    again = parse_scene(scene_text(choice.scene))
    assert again == choice.scene
    assert solve(again).model.discretisation == choice.model.discretisation


def test_the_worst_case_is_the_one_with_the_largest_estimate() -> None:
    wanted = scene(push(force=[0.4, 0.0, 0.0]))
    cases = [{"push.force": [size, 0.0, 0.0]} for size in (0.1, 2.0, 0.5)]
    choice = choose(wanted, tolerance=1e-4, cases=cases)
    estimates = [solve(choice.model, case).error_estimate for case in cases]
    worst = max(error for error in estimates if error is not None)
    assert_allclose(choice.error_estimate, worst, rtol=1e-3, atol=0)
    assert_allclose(choice.worst["push.force"].ravel(), cases[estimates.index(worst)]["push.force"], rtol=0, atol=0)
    assert_allclose(choice.scene.accuracy.tolerance, 1e-4, rtol=0, atol=0)


def test_a_case_without_equilibrium_is_not_met() -> None:
    """A load beyond all numbers: the case is told, and the tolerance not met, though the other case is within it."""
    cases = [{"push.force": [0.1, 0.0, 0.0]}, {"push.force": [1e200, 0.0, 0.0]}]
    choice = choose(scene(push(), strain="planar"), tolerance=1e-2, cases=cases)
    assert not choice.met
    (failed,) = choice.without_equilibrium
    assert_allclose(failed["push.force"][0], 1e200, rtol=1e-12, atol=0)
    assert choice.error_estimate is not None
    assert choice.error_estimate <= 1e-2


CURVATURE = "rod.intrinsic.curvature.y"


@pytest.mark.slow
def test_modes_are_chosen_for_parameters_as_for_inputs() -> None:
    """A rod that a parameter bends more wants more modes; the file says what they were chosen for."""
    curved = {**rod("planar"), "intrinsic": {"curvature": [0, [0.5, 0.0], 0]}}
    wanted = scene(push(force=[0.2, 0.0, 0.0]), rods=[curved], parameters=[CURVATURE])
    bent = {"push.force": [0.4, 0.0, 0.0], CURVATURE: [2.0, 6.0]}
    choice = choose(wanted, tolerance=1e-6, cases=[{}, bent])
    assert choice.met
    assert choice.scene.parameters == wanted.parameters
    assert choice.scene.accuracy.chosen_for == (
        "push.force.x=0.2:0.4",
        "rod.intrinsic.curvature.y[0]=0.5:2",
        "rod.intrinsic.curvature.y[1]=0:6",
    )
    assert choice.model.size > choose(wanted, tolerance=1e-6, cases=[{}]).model.size
    again = parse_scene(scene_text(choice.scene))
    assert again == choice.scene
    # On the modes that were chosen, the model with parameters is as exact as it says.
    model = build(again)
    found = solve(model, {"push.force": bent["push.force"]}, parameters={CURVATURE: bent[CURVATURE]})
    fine = build(wanted, discretise(wanted, 14, 34, "magnus8"))
    exact = solve(fine, {"push.force": bent["push.force"]}, parameters={CURVATURE: bent[CURVATURE]})
    assert pose_distance(found, exact) <= 1e-6


def test_a_single_value_away_from_the_scene_s_is_kept() -> None:
    """Modes that were chosen at one load say at which; a second choice verifies them there."""
    choice = choose(scene(push(force=[0.4, 0.0, 0.0])), tolerance=1e-3, cases=[{"push.force": [1.5, 0.0, 0.0]}])
    assert choice.scene.accuracy.chosen_for == ("push.force.x=1.5:1.5",)
    ranges = input_ranges(choice.scene)
    assert (ranges.lower[0], ranges.upper[0]) == (1.5, 1.5)


def test_cases_are_refused_where_none_is_given_or_ranges_are_too() -> None:
    with pytest.raises(SceneError, match="cases: must have at least one case"):
        choose(scene(push()), cases=[])
    with pytest.raises(SceneError, match="cases: stand beside ranges"):
        choose(scene(push()), {"push.force": (0, 1)}, cases=[{}])


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
