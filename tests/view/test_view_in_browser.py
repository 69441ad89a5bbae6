"""The viewer in a real browser, with its server."""

from __future__ import annotations

import http.client
import json
import socket
import struct
import threading
import time
from collections.abc import Iterator
from typing import Any

import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import build, solve
from cosserat_casadi.view.server import HOST, RobotServer
from cosserat_casadi.view.session import opened
from tests.browser import browser
from tests.view.test_session import strip


@pytest.fixture(scope="module")
def server() -> Iterator[RobotServer]:
    made = RobotServer(opened(solve(build(strip()))))
    thread = threading.Thread(target=made.serve_forever)
    thread.start()
    yield made
    made.shutdown()
    thread.join()
    made.server_close()


@pytest.fixture(scope="module")
def opened_page(server: RobotServer) -> Iterator[tuple[Any, list[str]]]:
    with browser() as window:
        page = window.new_page(viewport={"width": 1100, "height": 700})
        faults: list[str] = []
        page.on("pageerror", lambda error: faults.append(str(error)))
        page.on("console", lambda message: faults.append(message.text) if message.type == "error" else None)
        page.goto(server.address)
        page.wait_for_selector("body[data-ready]", timeout=20_000)
        yield page, faults


@pytest.fixture
def page(opened_page: tuple[Any, list[str]]) -> Iterator[Any]:
    found, faults = opened_page
    found.evaluate("window.robot.reset()")
    yield found
    assert faults == []


def test_a_slider_moves_the_tip_to_where_solve_says(page: Any, server: RobotServer) -> None:
    model = server.desk.session.first.model
    slider = page.get_by_label("front.tension, N", exact=True)
    slider.evaluate("(range) => { range.value = 5.5; range.dispatchEvent(new Event('input')); }")
    page.wait_for_function("() => window.robot.inputs['front.tension'] === 5.5")
    expected = solve(model, {"front.tension": 5.5}).tip().position[0]
    assert_allclose(page.evaluate("window.robot.tip()"), expected, rtol=0, atol=1e-8)
    page.wait_for_function("() => window.robot.stable === true", timeout=20_000)
    assert "In equilibrium, stable" in page.inner_text("#status")


def test_the_tip_follows_the_hand_and_inverse_has_the_last_word(page: Any) -> None:
    box = page.locator("#hand").bounding_box()
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    before = page.evaluate("window.robot.inputs['front.tension']")
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + 40, y + 10, steps=4)
    page.wait_for_function(f"() => Math.abs(window.robot.inputs['front.tension'] - {before}) > 0.3", timeout=20_000)
    page.wait_for_function(
        f"() => document.getElementById('hand').getBoundingClientRect().x > {box['x'] + 10}", timeout=20_000
    )
    page.mouse.up()
    page.wait_for_function("() => 'met' in window.robot.state", timeout=60_000)
    # One tendon leads the tip along a line: the point beside it is not reached, and the words say so.
    assert "The targets are not all met" in page.inner_text("#status")
    assert page.evaluate("window.robot.inputs['push.force.x']") == 0.3


def test_modes_and_motion_are_played_with_a_time_bar(page: Any) -> None:
    page.get_by_role("button", name="Vibrations here").click()
    page.wait_for_selector("body.playing", timeout=60_000)
    page.get_by_label("Play or pause").click()
    assert "Hz, swings" in page.inner_text("#transport")
    assert "In motion" in page.inner_text("#status")
    page.get_by_role("button", name="Motion of the scene").click()
    page.wait_for_function(
        "() => /^[0-9.]+ s/.test(document.querySelector('#transport output').textContent)", timeout=90_000
    )
    bar = page.get_by_label("Time")
    bar.evaluate("(range) => { range.value = 0.5; range.dispatchEvent(new Event('input')); }")
    assert page.inner_text("#transport output") == "0.200 s"
    page.get_by_label("Back to the equilibrium").click()
    assert not page.locator("#transport").is_visible()
    assert "In equilibrium" in page.inner_text("#status")


def request(server: RobotServer, method: str, path: str, body: str = "", **headers: str) -> tuple[int, bytes]:
    connection = http.client.HTTPConnection(HOST, server.server_port, timeout=30)
    connection.request(method, path, body, headers)
    answer = connection.getresponse()
    content = answer.read()
    connection.close()
    return answer.status, content


def test_what_is_no_question_is_refused(server: RobotServer) -> None:
    assert request(server, "GET", "/etc/passwd")[0] == 404
    assert request(server, "POST", "/nothing", "{}")[0] == 400
    assert request(server, "POST", "/move", "{}")[0] == 400
    assert request(server, "POST", "/move", '{"inputs": [1]}')[0] == 400
    assert request(server, "POST", "/move", "no json")[0] == 400
    status, content = request(server, "POST", "/move", json.dumps({"inputs": [0.3, 0.0, -0.2, None]}))
    assert status == 200
    assert json.loads(content)["label"] == "not_finite"


def test_a_page_that_is_closed_while_it_waits_is_no_fault(
    server: RobotServer, capsys: pytest.CaptureFixture[str]
) -> None:
    for _ in range(3):
        connection = http.client.HTTPConnection(HOST, server.server_port, timeout=30)
        connection.request("POST", "/move", json.dumps({"inputs": [0.3, 0.0, -0.2, 3.0]}))
        # Closed with a reset, as by a browser that is killed.
        connection.sock.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
        connection.sock.close()
    assert request(server, "POST", "/move", json.dumps({"inputs": [0.3, 0.0, -0.2, 3.0]}))[0] == 200
    time.sleep(0.1)
    assert capsys.readouterr().err == ""


def test_pages_from_elsewhere_are_not_answered(server: RobotServer) -> None:
    assert request(server, "GET", "/", Host="robot.example")[0] == 403
    inputs = json.dumps({"inputs": [0.3, 0.0, -0.2, 3.0]})
    assert request(server, "POST", "/move", inputs, Origin="http://robot.example")[0] == 403
    assert request(server, "POST", "/move", inputs)[0] == 200
