"""The viewer in a real browser, with its server."""

from __future__ import annotations

import contextlib
import http.client
import json
import socket
import struct
import threading
import time
from collections.abc import Iterator
from typing import Any
from urllib.parse import quote

import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import build, solve
from cosserat_casadi.view.server import CONNECTIONS, HOST, RobotServer
from cosserat_casadi.view.view_session import opened
from tests.browser import PATIENCE, browser
from tests.view.test_view_session import strip


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
        page.wait_for_selector("body[data-ready]", timeout=PATIENCE)
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
    expected = solve(model, {"front.tension": 5.5}).tip().position
    assert_allclose(page.evaluate("window.robot.tip()"), expected, rtol=0, atol=1e-8)
    page.wait_for_function("() => window.robot.stable === true", timeout=PATIENCE)
    assert "In equilibrium, stable" in page.inner_text("#status")


def test_the_tip_follows_the_hand_and_inverse_has_the_last_word(page: Any) -> None:
    box = page.locator("#hand").bounding_box()
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    before = page.evaluate("window.robot.inputs['front.tension']")
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + 40, y + 10, steps=4)
    page.wait_for_function(f"() => Math.abs(window.robot.inputs['front.tension'] - {before}) > 0.3", timeout=PATIENCE)
    page.wait_for_function(
        f"() => document.getElementById('hand').getBoundingClientRect().x > {box['x'] + 10}", timeout=PATIENCE
    )
    page.mouse.up()
    page.wait_for_function("() => 'met' in window.robot.state", timeout=PATIENCE)
    # One tendon leads the tip along a line: the point beside it is not reached, and the words say so.
    assert "Not all targets are met" in page.inner_text("#status")
    assert page.evaluate("window.robot.inputs['push.force.x']") == 0.3


def test_modes_and_motion_are_played_with_a_time_bar(page: Any) -> None:
    page.get_by_role("button", name="Vibrations here").click()
    page.wait_for_selector("body.playing", timeout=PATIENCE)
    page.get_by_label("Play or pause").click()
    assert "Hz, swings" in page.inner_text("#transport")
    assert "In motion" in page.inner_text("#status")
    page.get_by_role("button", name="Motion of the scene").click()
    page.wait_for_function(
        "() => /^[0-9.]+ s/.test(document.querySelector('#transport output').textContent)", timeout=PATIENCE
    )
    bar = page.get_by_label("Time")
    bar.evaluate("(range) => { range.value = 0.5; range.dispatchEvent(new Event('input')); }")
    assert page.inner_text("#transport output") == "0.200 s"
    with page.expect_download(timeout=PATIENCE) as film:
        page.get_by_role("button", name="Film").click()
    # WebM and MP4 say what they are in their first bytes.
    content = film.value.path().read_bytes()
    assert content.startswith(b"\x1aE\xdf\xa3") or content[4:8] == b"ftyp"
    # Without a picture a file is a hundred bytes long.
    assert len(content) > 2000
    with page.expect_download(timeout=PATIENCE) as picture:
        page.get_by_role("button", name="Save picture").click()
    # The scene has no title: the page calls it by what it shows.
    assert picture.value.suggested_filename == "cosserat_rods.png"
    assert film.value.suggested_filename.startswith("cosserat_rods.")
    assert picture.value.path().read_bytes().startswith(b"\x89PNG")
    page.get_by_label("Back to the equilibrium").click()
    assert not page.locator("#transport").is_visible()
    assert "In equilibrium" in page.inner_text("#status")


def test_the_page_follows_dark_mode(page: Any) -> None:
    grounds = {}
    for scheme in ("light", "dark"):
        page.emulate_media(color_scheme=scheme)
        grounds[scheme] = page.eval_on_selector("#panel", "(panel) => getComputedStyle(panel).backgroundColor")
    page.emulate_media(color_scheme="light")
    assert grounds == {"light": "rgb(255, 255, 255)", "dark": "rgb(27, 32, 38)"}


def test_a_robot_beyond_the_tolerance_is_said_to_be_so_and_refined(page: Any, server: RobotServer) -> None:
    told = {"within": False, "text": "Estimated error 0.04 of the length.", "refines": True}
    page.evaluate(
        """(told) => {
          window.asked = { accuracy: ServerRobot.prototype.accuracy, refined: ServerRobot.prototype.refined };
          ServerRobot.prototype.accuracy = async () => told;
          ServerRobot.prototype.refined = () => new Promise((resolve) => { window.answerRefined = resolve; });
        }""",
        told,
    )
    page.evaluate("window.robot.setInput('front.tension', 4.0)")
    page.wait_for_function("() => window.answerRefined")
    told_so = "In equilibrium, stable, beyond the tolerance"
    page.wait_for_function("(text) => document.getElementById('status').innerText.includes(text)", arg=told_so)
    assert "Estimated error 0.04" in page.inner_text("#status")
    assert page.evaluate("document.getElementById('status').className") == "warn"
    page.evaluate(
        """() => window.answerRefined(
          { within: true, text: "Drawn with modes.", drawn: window.robot.state.drawn.map((value) => value) })"""
    )
    page.wait_for_function("() => document.getElementById('status').className === 'good'")
    assert "Drawn with modes." in page.inner_text("#status")
    page.evaluate("() => Object.assign(ServerRobot.prototype, window.asked)")


def request(server: RobotServer, method: str, path: str, body: str = "", **headers: str) -> tuple[int, bytes]:
    # The server may refuse a connection in the middle of a question.
    with contextlib.closing(http.client.HTTPConnection(HOST, server.server_port, timeout=30)) as connection:
        connection.request(method, path_of(server, path), body, headers)
        answer = connection.getresponse()
        return answer.status, answer.read()


def path_of(server: RobotServer, path: str) -> str:
    """A path below the secret of the server."""
    return server.address.removeprefix(f"http://{HOST}:{server.server_port}") + path.removeprefix("/")


def test_what_is_no_question_is_refused(server: RobotServer) -> None:
    assert request(server, "GET", "/etc/passwd")[0] == 404
    assert request(server, "POST", "/nothing", "{}")[0] == 400
    status, content = request(server, "POST", "/move", json.dumps({"inputs": [0.3, 0.0, -0.2, None]}))
    assert status == 200
    assert json.loads(content)["label"] == "not_finite"


NO_QUESTIONS = {
    "no json": "move",
    "{}": "move",
    "[]": "move",
    '"inputs"': "move",
    '{"inputs": [1]}': "move",
    '{"inputs": {"a": 1}}': "move",
    '{"inputs": [1, 2, 3, "4"]}': "move",
    '{"inputs": [1, 2, 3, true]}': "move",
    '{"inputs": [1, 2, 3, [4]]}': "reset",
    f'{{"inputs": [1, 2, 3, {10**400}]}}': "move",
    f'{{"inputs": [1, 2, 3, 1{"0" * 5000}]}}': "move",
    "[" * 100_000: "move",
    '{"a":' * 100_000: "move",
    '{"position": [0, 0, 0]}': "reach",
    '{"pose": {"rod": "rod"}}': "reach",
    '{"pose": {"rod": "rod"}, "position": [0, 0]}': "reach",
    '{"pose": {"rod": "rod"}, "position": [0, 0, 1e999]}': "reach",
    f'{{"pose": {{"rod": "rod"}}, "position": [0, 0, {10**400}]}}': "reach",
    '{"pose": {"rod": "r\\u00f6d \\u0416"}, "position": [0, 0, 0]}': "reach",
    '{"pose": {"a\\r\\nX-Mine: 1\\r\\n\\r\\nb": "rod"}, "position": [0, 0, 0]}': "reach",
    '{"pose": {"rod": ["rod"]}, "position": [0, 0, 0]}': "reach",
    '{"pose": ["rod"], "position": [0, 0, 0]}': "reach",
}
"""What is sent, and under the name of which question."""


@pytest.mark.parametrize("body", NO_QUESTIONS, ids=lambda body: body[:50])
def test_what_cannot_be_read_is_refused_without_a_word(
    server: RobotServer, capsys: pytest.CaptureFixture[str], body: str
) -> None:
    connection = http.client.HTTPConnection(HOST, server.server_port, timeout=30)
    connection.request("POST", path_of(server, NO_QUESTIONS[body]), body.encode())
    answer = connection.getresponse()
    content = answer.read().decode()
    connection.close()
    assert answer.status == 400
    assert answer.reason == "Bad Request"
    assert content.count("\n") == 1
    assert "X-Mine" not in answer.headers
    assert capsys.readouterr().err == ""


@pytest.mark.parametrize("position", ["[1e300, 0, 0]", "[1e-320, 0, 0]"])
def test_far_points_are_answered(server: RobotServer, position: str, capsys: pytest.CaptureFixture[str]) -> None:
    body = f'{{"pose": {{"rod": "rod"}}, "position": {position}}}'
    status, content = request(server, "POST", "/reach", body)
    assert status == 200
    assert not json.loads(content).get("met")
    assert capsys.readouterr().err == ""


def told(server: RobotServer, sent: bytes) -> bytes:
    """What comes back where these bytes are sent, until the server closes the connection."""
    with socket.create_connection((HOST, server.server_port), timeout=30) as connection:
        connection.sendall(sent)
        parts = []
        while part := connection.recv(65536):
            parts.append(part)
    return b"".join(parts)


LENGTHS = {
    "Content-Length: -1": 400,
    "Content-Length: +5": 400,
    "Content-Length: 1_0": 400,
    "Content-Length: \u0663": 400,
    "Content-Length: many": 400,
    f"Content-Length: {10**30}": 400,
    "Content-Length: 1000001": 413,
    "Content-Length: 2\r\nContent-Length: 3": 411,
    "Transfer-Encoding: chunked": 411,
    "Accept: */*": 411,
}
"""Lines of a request, and how it is answered."""


@pytest.mark.parametrize("line", LENGTHS)
def test_lengths_that_are_none_are_refused_and_the_connection_closed(
    server: RobotServer, capsys: pytest.CaptureFixture[str], line: str
) -> None:
    head = f"POST {path_of(server, 'move')} HTTP/1.1\r\nHost: {HOST}:{server.server_port}\r\n{line}\r\n\r\n"
    answer = told(server, head.encode())
    assert answer.startswith(f"HTTP/1.1 {LENGTHS[line]} ".encode())
    assert capsys.readouterr().err == ""


def test_lines_that_are_no_requests_are_refused(server: RobotServer, capsys: pytest.CaptureFixture[str]) -> None:
    assert told(server, b"\xff\xfe\r\n\r\n").startswith(b"HTTP/1.1 400 ")
    assert told(server, b"GET / HTTP/1.1\r\n" + b"A: b\r\n" * 200 + b"\r\n").startswith(b"HTTP/1.1 431 ")
    assert told(server, f"BREW / HTTP/1.1\r\nHost: {HOST}\r\n\r\n".encode()).startswith(b"HTTP/1.1 501 ")
    assert capsys.readouterr().err == ""


def test_who_does_not_know_the_address_is_not_answered(server: RobotServer) -> None:
    connection = http.client.HTTPConnection(HOST, server.server_port, timeout=30)
    body = json.dumps({"inputs": [0.3, 0.0, -0.2, 3.0]})
    for method, path in (("GET", "/"), ("POST", "/move"), ("POST", "/guessed/move"), ("GET", "/gu\u00e9ssed/")):
        connection.request(method, quote(path), body)
        answer = connection.getresponse()
        assert answer.status == 404
        assert server.address.encode() not in answer.read()
        connection.close()


def test_the_address_for_once_leads_to_the_page_once(server: RobotServer) -> None:
    path = server.address_for_once.removeprefix(f"http://{HOST}:{server.server_port}")
    connection = http.client.HTTPConnection(HOST, server.server_port, timeout=30)
    connection.request("GET", path)
    first = connection.getresponse()
    first.read()
    assert first.status == 303
    assert first.headers["Location"] == server.address
    for again in (path, server.address_for_once):
        connection.request("GET", again)
        second = connection.getresponse()
        assert second.status == 404
        second.read()
    connection.close()


def test_the_page_may_do_what_it_does_and_no_more(server: RobotServer) -> None:
    connection = http.client.HTTPConnection(HOST, server.server_port, timeout=30)
    connection.request("GET", path_of(server, "/"))
    answer = connection.getresponse()
    answer.read()
    connection.close()
    rules = answer.headers["Content-Security-Policy"]
    assert rules.startswith("default-src 'none'; script-src 'sha256-")
    assert "unsafe" not in rules
    assert answer.headers["X-Content-Type-Options"] == "nosniff"


def test_a_script_that_is_not_of_the_page_does_not_run(opened_page: tuple[Any, list[str]]) -> None:
    page, faults = opened_page
    added = """() => { const script = document.createElement("script"); script.textContent = "window.stranger = 1";
        document.body.append(script); return window.stranger ?? null; }"""
    assert page.evaluate(added) is None
    # The browser says why, on the console.
    assert "Content Security Policy" in faults.pop()


def test_what_arrives_late_or_in_drops_is_not_waited_for(server: RobotServer, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("cosserat_casadi.view.server.PATIENCE", 0.3)
    with socket.create_connection((HOST, server.server_port), timeout=30) as connection:
        # Each byte comes well before the limit, and the request never ends.
        with contextlib.suppress(ConnectionError):
            for _ in range(100):
                connection.sendall(b"G")
                time.sleep(0.05)
        with contextlib.suppress(ConnectionError):
            assert connection.recv(1) == b""


def test_connections_are_bounded(server: RobotServer) -> None:
    before = threading.active_count()
    with contextlib.ExitStack() as stack:
        for _ in range(3 * CONNECTIONS):
            stack.enter_context(socket.create_connection((HOST, server.server_port), timeout=30))
        assert threading.active_count() <= before + CONNECTIONS
    # Those that are closed make room again.
    deadline = time.monotonic() + 30.0
    status = 0
    while status != 200 and time.monotonic() < deadline:
        with contextlib.suppress(ConnectionError):
            status, _ = request(server, "POST", "/move", json.dumps({"inputs": [0.3, 0.0, -0.2, 3.0]}))
    assert status == 200


def test_a_signal_while_a_connection_begins_stops_the_server(
    server: RobotServer, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its thread may have served the connection, and closed it, by the time that the signal is heard."""
    start = threading.Thread.start

    def start_and_interrupt(thread: threading.Thread) -> None:
        start(thread)
        thread.join()
        raise KeyboardInterrupt

    with RobotServer(server.desk.session) as interrupted:
        socket.create_connection((HOST, interrupted.server_port), timeout=30).close()
        monkeypatch.setattr(threading.Thread, "start", start_and_interrupt)
        with pytest.raises(KeyboardInterrupt):
            interrupted.handle_request()


def test_a_page_that_is_closed_while_it_waits_is_no_fault(
    server: RobotServer, capsys: pytest.CaptureFixture[str]
) -> None:
    for _ in range(3):
        connection = http.client.HTTPConnection(HOST, server.server_port, timeout=30)
        connection.request("POST", path_of(server, "/move"), json.dumps({"inputs": [0.3, 0.0, -0.2, 3.0]}))
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
