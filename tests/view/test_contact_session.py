"""A scene whose contacts are exact, moved from a browser."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Scene, Solution, build, scene_from_dict, solve
from cosserat_casadi.page.drawn_model import SECTIONS, drawn_layout
from cosserat_casadi.page.page_facts import page_facts
from cosserat_casadi.view.contact_session import ContactSession
from cosserat_casadi.view.server import RobotServer
from cosserat_casadi.view.view_session import opened
from tests.browser import PATIENCE, browser
from tests.scenes import rod

CENTRE = np.array([0.06, 0.0, 0.3])
RADIUS = 0.04


def pushed_over_a_ball() -> Scene:
    """An upright planar rod, pushed to +x, where a ball is in its way; a vessel that another rod is in."""
    slim = {"section": {"shape": "circle", "radius": 0.01}, "material": {"youngs_modulus": 5e7, "poisson_ratio": 0.4}}
    left = rod("planar", name="left", base={"position": [-0.5, 0.0, 0.0]})
    front = {name: value for name, value in rod("planar").items() if name not in ("stiffness", "linear_density")}
    return scene_from_dict(
        {
            "schema": 1,
            "accuracy": {"modes": 5, "nodes": 10},
            "rods": [{**front, **slim}, left],
            "loads": [
                {"name": "push", "kind": "tip_wrench", "rod": "rod", "force": [1.0, 0.0, 0.0]},
                {"name": "stroke", "kind": "tip_wrench", "rod": "left", "force": [0.05, 0.0, 0.0]},
            ],
            "inputs": ["push.force"],
            "obstacles": [
                {"name": "ball", "kind": "sphere", "centre": CENTRE.tolist(), "radius": RADIUS, "rods": ["rod"]},
                {
                    "name": "vessel",
                    "kind": "lumen",
                    "points": [[-0.5, 0.0, -0.1], [-0.5, 0.0, 0.4], [-0.5, 0.0, 0.9]],
                    "radius": 0.2,
                    "rods": ["left"],
                },
            ],
        }
    )


@pytest.fixture(scope="module")
def first() -> Solution:
    found = solve(build(pushed_over_a_ball()))
    assert found.converged
    return found


@pytest.fixture(scope="module")
def session(first: Solution) -> ContactSession:
    made = opened(first)
    assert isinstance(made, ContactSession)
    return made


@pytest.mark.slow
def test_every_move_finds_contacts_and_draws_them(session: ContactSession, first: Solution) -> None:
    answer = session.move([1.3, 0.0, 0.0])
    assert answer["found"]
    expected = solve(first.model, {"push.force": [1.3, 0.0, 0.0]}, start=first)
    numbers = np.array(answer["drawn"])
    (entry, _) = (entry for entry in drawn_layout(session.model) if entry["kind"] == "rod")
    poses = numbers[entry["first"] : entry["first"] + 7 * entry["columns"]].reshape(-1, 7)
    pose = expected.pose(SECTIONS, "rod")
    assert_allclose(poses, np.hstack([pose.position, pose.quaternion]), rtol=0, atol=1e-9)
    (contact,) = answer["contacts"]
    # The section touches by its radius.
    (point,) = np.array(contact["points"])
    assert_allclose(np.linalg.norm(point - CENTRE), RADIUS + 0.01, rtol=0, atol=1e-8)
    assert_allclose(contact["force"], expected.contacts[0].force, rtol=1e-6, atol=1e-9)
    assert contact["words"].startswith("rod touches ball at X = 0.")
    # Away from the ball there is none.
    assert session.move([-0.5, 0.0, 0.0])["contacts"] == []
    assert len(session.reset([1.3, 0.0, 0.0])["contacts"]) == 1


def test_a_number_that_is_none_is_said_and_forgotten(session: ContactSession) -> None:
    answer = session.move([None, 0.0, 0.0])
    assert answer["label"] == "not_finite"
    assert session.eigenvalues() is None
    assert session.move([1.0, 0.0, 0.0])["found"]
    assert session.eigenvalues()[0] > 0


@pytest.mark.slow
def test_the_estimated_error_is_told(session: ContactSession, monkeypatch: pytest.MonkeyPatch) -> None:
    session.move([1.3, 0.0, 0.0])
    assert session.accuracy()["within"] is None
    asked = session.model.scene.accuracy.model_copy(update={"tolerance": 1e-9})
    asked.model_fields_set.add("tolerance")
    strict = session.model.scene.model_copy(update={"accuracy": asked})
    monkeypatch.setattr(session, "model", build(strict, session.model.discretisation))
    told = session.accuracy()
    assert told["within"] is False
    assert not told["refines"]
    assert "of the length, asked 1e-09" in told["text"]


def test_obstacles_are_drawn_where_they_are(session: ContactSession, first: Solution) -> None:
    facts = page_facts(first, session.model)
    assert [slider["input"] for slider in facts["sliders"]] == ["push.force"] * 3
    ball, vessel = (np.array(obstacle["net"]) for obstacle in facts["obstacles"])
    assert_allclose(np.linalg.norm(ball - CENTRE, axis=2), RADIUS, rtol=0, atol=1e-6)
    assert_allclose(np.linalg.norm(vessel[:, :, :2] - [-0.5, 0.0], axis=2), 0.2, rtol=0, atol=1e-6)


@pytest.fixture
def page(session: ContactSession) -> Iterator[Any]:
    """The page of the session, ready; a fault in it fails the test."""
    with RobotServer(session) as server, browser() as window:
        thread = threading.Thread(target=server.serve_forever)
        thread.start()
        try:
            opened_page = window.new_page(viewport={"width": 1100, "height": 700})
            faults: list[str] = []
            opened_page.on("pageerror", lambda error: faults.append(str(error)))
            opened_page.goto(server.address, timeout=PATIENCE)
            opened_page.wait_for_selector("body[data-ready]", timeout=PATIENCE)
            yield opened_page
        finally:
            server.shutdown()
            thread.join()
        assert faults == []


@pytest.mark.slow
def test_contact_moves_under_the_slider(page: Any, session: ContactSession, first: Solution) -> None:
    slider = page.get_by_label("push.force x, N", exact=True)
    slider.evaluate("(range) => { range.value = 1.4; range.dispatchEvent(new Event('input')); }")
    page.wait_for_function("() => window.robot.inputs['push.force.x'] === 1.4", timeout=PATIENCE)
    expected = solve(first.model, {"push.force": [1.4, 0.0, 0.0]}, start=first)
    assert_allclose(page.evaluate("window.robot.tip('rod')"), expected.tip("rod").position, rtol=0, atol=1e-7)
    assert "rod touches ball at X = 0." in page.inner_text("#readings")
    page.wait_for_function("() => window.robot.stable === true", timeout=PATIENCE)
    # What contact leaves out is not offered, and said.
    assert "Contact is exact, and every move searches for it anew, which takes about " in page.inner_text("#note")
    assert page.get_by_label("derivatives").count() == 0
    assert page.locator("#hand").count() == 0
    assert page.get_by_role("button", name="Vibrations here").count() == 0
    assert page.evaluate("fetch('modes', { method: 'POST', body: '{}' }).then((answer) => answer.status)") == 400
    # The ball is on the picture, in the colour of obstacles, as long as it is wanted.
    sandy = """() => { window.robot.redraw(); const source = document.getElementById("canvas");
        const copy = document.createElement("canvas").getContext("2d");
        copy.canvas.width = source.width; copy.canvas.height = source.height; copy.drawImage(source, 0, 0);
        const { data } = copy.getImageData(0, 0, source.width, source.height); let count = 0;
        for (let i = 0; i < data.length; i += 4) count += data[i + 3] > 40 && data[i] > 1.25 * data[i + 2];
        return count; }"""
    shown = page.evaluate(sandy)
    page.get_by_label("obstacles").uncheck()
    assert shown > 3000 + page.evaluate(sandy)
