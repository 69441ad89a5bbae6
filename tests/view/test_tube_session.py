"""Concentric tubes moved from a browser: what the page is told, and what it draws."""

from __future__ import annotations

import json
import threading
from functools import cache
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import SceneError, TubeSolution, build, discretise, read_scene, solve
from cosserat_casadi.page.drawn_model import SECTIONS
from cosserat_casadi.page.page_facts import page_facts
from cosserat_casadi.view.server import RobotServer
from cosserat_casadi.view.tube_session import TubeSession
from cosserat_casadi.view.view_session import opened
from tests.browser import PATIENCE, browser
from tests.conftest import ROOT
from tests.scenes import push, scene


@cache
def first(name: str) -> TubeSolution:
    found = solve(read_scene(ROOT / "examples" / f"{name}.toml"))
    assert isinstance(found, TubeSolution)
    return found


def session_of(name: str = "concentric_tubes") -> TubeSession:
    session = opened(first(name))
    assert isinstance(session, TubeSession)
    return session


def part(session: TubeSession, state: dict[str, Any], kind: str, name: str) -> np.ndarray:
    """Numbers of a drawn part, a row for each section or arrow."""
    entry = next(entry for entry in session.facts()["layout"] if (entry["kind"], entry["name"]) == (kind, name))
    numbers = state["drawn"][entry["first"] : entry["first"] + entry["rows"] * entry["columns"]]
    return np.array(numbers).reshape(entry["columns"], entry["rows"])


def test_the_page_draws_the_robot_and_its_loads() -> None:
    session = session_of("loaded_tubes")
    json.dumps(session.facts(), allow_nan=False)
    state = session.move(session.first.inputs.tolist())
    assert state["found"]
    assert sum(entry["rows"] * entry["columns"] for entry in session.facts()["layout"]) == len(state["drawn"])
    shape = session.first.shape
    for name, pose in session.first.tips.items():
        tube = part(session, state, "rod", name)
        assert_allclose(tube[0], [0, 0, 0, 1, 0, 0, 0], rtol=0, atol=1e-8)
        assert_allclose(tube[-1, :3], pose.position, rtol=0, atol=1e-7)
        reach = session.first.inputs[session.first.robot.columns[f"{name}.translation"]]
        nearest = np.argmin(np.abs(shape.distance - reach * SECTIONS[24]))
        assert np.linalg.norm(tube[24, :3] - shape.position[nearest]) <= abs(shape.distance[nearest] - reach / 2) + 1e-6
    assert_allclose(
        part(session, state, "arrows", "push")[0, :3], session.first.tip("inner").position, rtol=0, atol=1e-7
    )
    assert_allclose(part(session, state, "arrows", "push")[0, 3:], [0.0, -0.4, 0.0], rtol=0, atol=1e-12)
    weight = part(session, state, "arrows", "weight")
    assert np.all(weight[:, 5] < 0.0)


def test_the_page_is_told_as_much_as_of_rods() -> None:
    of_rods = page_facts(solve(build(scene(push()), discretise(scene(push()), 1, 2))))
    assert set(session_of().facts()) == {*of_rods, "motion", "modes", "note"}
    tube = session_of().facts()["rods"]["inner"]
    assert {*of_rods["rods"]["rod"], "shape", "x", "y"} == set(tube)
    assert tube["x"] == [0.9e-3] * len(SECTIONS)


def test_sliders_stay_in_the_ranges_of_the_drives() -> None:
    ends = {(slider["input"], slider["label"]): slider for slider in session_of("loaded_tubes").facts()["sliders"]}
    assert (ends["outer.translation", ""]["least"], ends["outer.translation", ""]["most"]) == (0.0, 0.22)
    assert ends["push.force", "y"]["least"] < -0.4 < ends["push.force", "y"]["most"]
    hand = session_of("loaded_tubes").facts()["hand"]
    assert hand == [0, 1, 2, 3]


def test_it_follows_the_last_equilibrium_and_begins_anew_beyond_a_snap() -> None:
    session = session_of()
    inputs = session.first.inputs.copy()
    turning = session.first.robot.columns["inner.rotation"]
    for turn in (3.0, 4.0, 5.0, 6.0):
        inputs[turning] = turn
        state = session.move(inputs.tolist())
        assert state["found"] and not state["anew"]
    # Turned to here from straight tubes it would be on the other side of opposed drives.
    direct = solve(session.first.model, inputs)
    assert np.abs(session._present.x - direct.x).max() > 1.0
    inputs[turning] = 7.0
    state = session.move(inputs.tolist())
    assert state["found"] and state["anew"]
    again = session.reset(session.first.inputs.tolist())
    assert_allclose(
        part(session, again, "rod", "inner")[-1, :3], session.first.tip("inner").position, rtol=0, atol=1e-7
    )


def test_derivatives_are_differences() -> None:
    session = session_of()
    inputs = session.first.inputs
    columns = np.array(session.derivatives()).reshape(2, len(inputs), 7)
    step = 1e-5
    for k in range(len(inputs)):
        poses = []
        for sign in (1.0, -1.0):
            at = inputs.copy()
            at[k] += sign * step
            tip = solve(session.first.model, at, start=session.first.x, estimate_error=False).tip("inner")
            poses.append(np.concatenate([tip.position, tip.quaternion]))
        assert_allclose(columns[1, k], (poses[0] - poses[1]) / (2 * step), rtol=0, atol=1e-6)


def test_the_hand_leads_a_tip_to_a_point() -> None:
    session = session_of()
    goal = session.first.tip("inner").position + np.array([0.003, 0.002, -0.004])
    for point in (goal, goal + np.array([0.001, 0.0, 0.0])):
        answer = session.reach({"rod": "inner"}, point.tolist())
        assert answer["met"], answer["text"]
        assert_allclose(part(session, answer, "rod", "inner")[-1, :3], point, rtol=0, atol=1e-6)
        found = solve(session.first.model, np.array(answer["inputs"]), start=session._present.x)
        assert_allclose(found.tip("inner").position, point, rtol=0, atol=1e-6)
    assert session.accuracy()["within"]
    assert not session.reach({"rod": "inner"}, [0.5, 0.5, 0.0])["met"]


def test_what_is_out_of_range_is_refused() -> None:
    session = session_of()
    with pytest.raises(SceneError, match="must be from 0 to the length of the tube"):
        session.move([0.0, 0.4, 0.0, 0.2])
    with pytest.raises(SceneError, match="must be finite"):
        session.move([None, 0.1, 0.0, 0.2])


@pytest.mark.slow
def test_a_browser_shows_tubes() -> None:
    with RobotServer(session_of("loaded_tubes")) as server, browser() as window:
        thread = threading.Thread(target=server.serve_forever)
        thread.start()
        try:
            page = window.new_page(viewport={"width": 1100, "height": 700})
            faults: list[str] = []
            page.on("pageerror", lambda error: faults.append(str(error)))
            page.goto(server.address, timeout=PATIENCE)
            page.wait_for_selector("body[data-ready]", timeout=PATIENCE)
            assert "inner" in page.inner_text("body")
        finally:
            server.shutdown()
            thread.join()
    assert faults == []
