"""What a session answers is what the library finds."""

from __future__ import annotations

import base64
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Scene, SceneError, build, choose, discretise, read_scene, scene_from_dict, solve
from cosserat_casadi.accuracy.fixing import unfixed
from cosserat_casadi.equilibrium.metrics import pose_distance
from cosserat_casadi.page.drawn_model import SECTIONS
from cosserat_casadi.page.slider_ranges import sliders
from cosserat_casadi.view.robot_session import ELSEWHERE
from cosserat_casadi.view.view_session import PERIOD_FRAMES, ViewSession, opened
from tests.conftest import ROOT
from tests.page.pages_made import FEW
from tests.scenes import rod

TIP = slice(7 * (len(SECTIONS) - 1), 7 * (len(SECTIONS) - 1) + 3)
"""Of the tip's position among the numbers that are drawn."""


def strip(**changes: Any) -> Scene:
    """A planar strip, pushed at its tip, bent by a tendon, with a motion."""
    plain = {
        "schema": 1,
        "accuracy": FEW,
        "rods": [rod("planar", damping={"retardation_time": 0.02})],
        "loads": [{"name": "push", "kind": "tip_wrench", "rod": "rod", "force": [0.3, 0.0, -0.2]}],
        "actuators": [{"name": "front", "kind": "tendon", "rod": "rod", "tension": 3.0, "offset": [0.03, 0.0]}],
        "inputs": ["push.force", "front.tension"],
        "simulation": {"duration": 0.4, "tolerance": 1e-2},
    }
    return scene_from_dict({**plain, **changes})


@pytest.fixture(scope="module")
def shared() -> ViewSession:
    return opened(solve(build(strip())))


@pytest.fixture
def session(shared: ViewSession) -> Iterator[ViewSession]:
    shared.reset(shared.first.inputs.tolist())
    yield shared


def tip(answer: dict[str, Any]) -> np.ndarray:
    return np.array(answer["drawn"][TIP])


def test_moving_finds_what_solve_finds(session: ViewSession) -> None:
    model = session.first.model
    for force in ([0.3, 0, -0.2], [1.0, 0, 0.5], [-4.0, 0, -2.0]):
        inputs = model.pack({"push.force": force})
        answer = session.move(inputs.tolist())
        assert answer["found"]
        assert answer["label"] == "converged"
        assert_allclose(tip(answer), solve(model, {"push.force": force}).tip().position, rtol=0, atol=1e-8)


def test_moving_stays_on_the_branch_and_starting_anew_does_not(session: ViewSession) -> None:
    # Pressed down while it is pushed aside the strip leans over, and leans on when it is pushed back a little.
    def inputs(sideways: float, down: float) -> list[float]:
        values = {"push.force": [sideways, 0.0, -down], "front.tension": 0.0}
        packed: list[float] = session.first.model.pack(values).tolist()
        return packed

    for sideways, down in ((0.5, 2.0), (0.5, 4.0), (0.5, 6.0), (0.5, 7.0), (-0.05, 7.0)):
        answer = session.move(inputs(sideways, down))
    assert tip(answer)[0] > 0.5
    assert tip(session.reset(inputs(-0.05, 7.0)))[0] < 0.1


def test_a_number_that_is_none_is_said_and_forgotten(session: ViewSession) -> None:
    inputs = session.first.inputs.tolist()
    answer = session.move([None, *inputs[1:]])
    assert not answer["found"]
    assert answer["label"] == "not_finite"
    assert session.derivatives() is None
    assert session.eigenvalues() is None
    assert session.move(inputs)["found"]


def test_derivatives_are_those_of_the_solution(session: ViewSession) -> None:
    model = session.first.model
    found = np.array(session.derivatives()).reshape(-1, 7)
    assert len(found) == model.inputs.size
    step = 1e-4
    ends = [solve(model, {"front.tension": 3.0 + sign * step}).tip().position for sign in (1, -1)]
    assert_allclose(found[3, :3], (ends[0] - ends[1]) / (2 * step), rtol=1e-6, atol=1e-9)


def test_stability_is_that_of_the_solution(session: ViewSession) -> None:
    assert_allclose(session.eigenvalues()[0], session.first.smallest_eigenvalue, rtol=1e-8)


def test_reaching_a_point_finds_the_inputs(session: ViewSession) -> None:
    start = session.first.tip().position
    # A tendon alone reaches what it reaches: a point of its own path, and not one beside it.
    on_path = solve(session.first.model, {"front.tension": 4.0}).tip().position
    answer = session.reach({"rod": "rod"}, on_path.tolist())
    assert answer["met"]
    assert "The targets are met" in answer["text"]
    assert_allclose(answer["inputs"], [0.3, 0.0, -0.2, 4.0], rtol=0, atol=1e-4)
    assert_allclose(tip(answer), on_path, rtol=0, atol=1e-6)
    beside = session.reach({"rod": "rod"}, (start + np.array([0.1, 0.0, 0.1])).tolist())
    assert not beside["met"]
    assert "Not all targets are met" in beside["text"]
    tension = sliders(session.first.model)[3]
    assert tension.least <= beside["inputs"][3] <= tension.most


def test_a_point_is_not_met_where_the_robot_ends_elsewhere(
    session: ViewSession, monkeypatch: pytest.MonkeyPatch
) -> None:
    point = solve(session.first.model, {"front.tension": 5.0}).tip().position.tolist()
    assert session.reach({"rod": "rod"}, point)["met"]
    at_first = session.library.solve(session.first.inputs)
    monkeypatch.setattr(type(session.library), "follow", lambda *_: at_first)
    answer = session.reach({"rod": "rod"}, point)
    assert answer["found"]
    assert not answer["met"]
    assert answer["text"] == ELSEWHERE


def frames(text: str) -> np.ndarray:
    return np.frombuffer(base64.b64decode(text), "<f4")


def test_modes_swing_about_the_equilibrium(session: ViewSession) -> None:
    answer = session.modes()
    assert answer["text"].startswith("Stable")
    assert len(answer["modes"]) == 2
    pictures = frames(answer["modes"][0]["frames"]).reshape(PERIOD_FRAMES, -1)
    ends = pictures[:, TIP]
    # Damping puts the sections a little out of step: not all pass the equilibrium at once.
    assert_allclose(ends[0], session.first.tip().position, rtol=0, atol=1e-4)
    # To both sides, by about the share of the length that is drawn.
    quarter, three_quarters = ends[PERIOD_FRAMES // 4] - ends[0], ends[3 * PERIOD_FRAMES // 4] - ends[0]
    assert quarter @ three_quarters < 0
    assert_allclose(np.linalg.norm(quarter), 0.15 * 0.8, rtol=0.3)


def test_the_motion_is_that_of_the_scene(session: ViewSession) -> None:
    answer = session.motion()
    assert answer["times"][0] == 0.0
    assert answer["times"][-1] == 0.4
    pictures = frames(answer["frames"]).reshape(len(answer["times"]), -1)
    # It starts at rest in the equilibrium of the scene's own inputs, and nothing moves them.
    assert_allclose(pictures[:, TIP], np.tile(session.first.tip().position, (len(pictures), 1)), rtol=0, atol=1e-3)


def test_without_mass_there_is_a_refusal() -> None:
    light = rod("planar")
    del light["linear_density"]
    session = opened(solve(build(strip(rods=[light], simulation=None))))
    session.reset(session.first.inputs.tolist())
    with pytest.raises(SceneError, match="mass"):
        session.modes()


@pytest.fixture(scope="module")
def planar() -> ViewSession:
    """A rod whose modes were chosen for a push within a plane."""
    pushed = scene_from_dict(
        {
            "schema": 1,
            "rods": [rod("kirchhoff")],
            "loads": [{"name": "push", "kind": "tip_wrench", "rod": "rod", "force": [0.3, 0.0, -0.2]}],
            "accuracy": {"tolerance": 1e-4},
            "inputs": ["push.force"],
        }
    )
    ends = {"push.force.x": (0.2, 0.4), "push.force.y": (-0.1, 0.1), "push.force.z": (-0.3, -0.1)}
    return opened(solve(choose(pushed, ends, samples=1).model))


@pytest.mark.slow
def test_the_estimated_error_is_told_where_modes_were_chosen_for_other_inputs(planar: ViewSession) -> None:
    planar.reset(planar.first.inputs.tolist())
    at_home = planar.accuracy()
    assert at_home["within"] is True
    assert not at_home["refines"]
    planar.move([0.3, 3.0, -0.2])
    aside = planar.accuracy()
    assert aside["within"] is False
    assert aside["refines"]
    assert "of the length, asked 0.0001: the modes were chosen for other inputs" in aside["text"].replace(". ", ": ")


def test_the_robot_is_refined_where_the_hand_rests(planar: ViewSession) -> None:
    inputs = [0.3, 3.0, -0.2]
    rough = tip(planar.reset(inputs))
    refined = planar.refined(inputs)
    assert refined["within"] is True
    exact = solve(unfixed(planar.first.model.scene, 1e-6), {"push.force": inputs}).tip().position
    assert_allclose(tip(refined), exact, rtol=0, atol=1e-4 * planar.first.model.scene.rods[0].length)
    assert np.linalg.norm(rough - exact) > 1e-3


def test_no_error_is_told_where_nobody_asked_for_one(session: ViewSession) -> None:
    session.move(session.first.inputs.tolist())
    assert session.accuracy()["within"] is None
    session.move([None, *session.first.inputs.tolist()[1:]])
    assert session.accuracy()["within"] is None


# Wherever the sliders of a shipped robot go, the modes that it is viewed with are right.


@pytest.mark.slow
def test_a_template_is_right_all_over_its_sliders() -> None:
    """Against finer modes; those of its own inputs, which lie in a plane, are off by a hundred times the tolerance."""
    robot = read_scene(ROOT / "cosserat_casadi" / "cli" / "templates" / "tendon-robot.toml")
    model = choose(robot).model
    fine = build(robot, discretise(robot, 10, 20, "magnus8"))
    own = build(robot, solve(robot).model.discretisation)
    ends = sliders(model)
    least = np.array([slider.least for slider in ends])
    most = np.array([slider.most for slider in ends])
    random = np.random.default_rng(3)
    worst = 0.0
    for share in random.random((6, len(ends))):
        inputs = least + share * (most - least)
        exact = solve(fine, inputs, estimate_error=False)
        assert pose_distance(solve(model, inputs, estimate_error=False), exact) <= 1e-4
        worst = max(worst, pose_distance(solve(own, inputs, estimate_error=False), exact))
    assert worst > 1e-2
