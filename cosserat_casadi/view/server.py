"""The page of a session, served on this machine alone; the browser asks, the session answers."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from dataclasses import dataclass, field
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, HTTPServer, ThreadingHTTPServer
from importlib import resources
from threading import Lock
from typing import Any

from cosserat_casadi.errors import CosseratError, Problem, SceneError
from cosserat_casadi.page.page import page_text
from cosserat_casadi.view.contact_session import ContactSession
from cosserat_casadi.view.session import Session

HOST = "127.0.0.1"
"""Nobody else's machine reaches it."""

LARGEST_QUESTION = 1_000_000
"""Bytes of a question beyond which it is none of ours."""

SCRIPTS = ("server_robot.js", "theatre.js")


def check_port(port: int) -> None:
    """Refuse a port of this machine that cannot be taken, before any work is done for it.

    Raises:
        SceneError: another program has it, or it needs rights that this one has not.
    """
    try:
        HTTPServer((HOST, port), BaseHTTPRequestHandler).server_close()
    except OSError as error:
        problem = f"{port} cannot be taken: {error.strerror}"
        raise SceneError(Problem("--port", problem, "leave it out: a free one is found")) from None


@dataclass
class Desk:
    """The questions that a browser may ask, and the page that asks them.

    Attributes:
        session: who answers.
    """

    session: Session | ContactSession
    page: bytes = field(init=False)
    _lock: Lock = field(init=False, default_factory=Lock)

    def __post_init__(self) -> None:
        folder = resources.files("cosserat_casadi.view") / "assets"
        scripts = [(folder / name).read_text(encoding="utf-8") for name in SCRIPTS]
        self.page = page_text(self.session.facts(), scripts).encode()

    def answer(self, question: str, asked: dict[str, Any]) -> Any:
        """The answer to a question; a refusal is an answer with the sentence ``refused``.

        Raises:
            KeyError: there is no such question, or something it needs is missing.
        """
        session = self.session
        if question == "motion" and isinstance(session, Session):
            # It may take a minute, in which the robot can be moved: it has a model of its own.
            return _refusable(session.motion)
        with self._lock:
            if question in ("move", "reset"):
                inputs = asked["inputs"]
                answer = session.move if question == "move" else session.reset
                return _refusable(lambda: answer(inputs))
            plain = {"derivatives": session.derivatives, "eigenvalues": session.eigenvalues}
            if question in plain:
                return plain[question]()
            if isinstance(session, ContactSession):
                raise KeyError(question)
            if question == "reach":
                return _refusable(lambda: session.reach(asked["pose"], asked["position"]))
            return _refusable({"modes": session.modes}[question])


def _refusable(answer: Callable[[], dict[str, Any]]) -> dict[str, Any]:
    try:
        return answer()
    except CosseratError as error:
        return {"refused": str(error)}


class RobotServer(ThreadingHTTPServer):
    """A server of a session's page, ready to serve.

    Attributes:
        desk: who answers.
    """

    def __init__(self, session: Session | ContactSession, port: int = 0) -> None:
        """Take a port of this machine, 0 for one that is free; OSError where it is taken."""
        self.desk = Desk(session)
        super().__init__((HOST, port), _Handler)

    @property
    def address(self) -> str:
        """What a browser is to open."""
        return f"http://{HOST}:{self.server_port}/"

    def handle_error(self, request: Any, client_address: Any) -> None:
        """Say nothing where a page that has been closed does not wait for its answer."""
        if not isinstance(sys.exception(), ConnectionError):
            super().handle_error(request, client_address)


class _Handler(BaseHTTPRequestHandler):
    """GET gives the page, POST to the name of a question its answer, both as JSON."""

    protocol_version = "HTTP/1.1"
    disable_nagle_algorithm = True
    server: RobotServer

    def do_GET(self) -> None:
        if self._is_foreign():
            return
        if self.path != "/":
            self.send_error(HTTPStatus.NOT_FOUND)
            return
        self._send("text/html; charset=utf-8", self.server.desk.page)

    def do_POST(self) -> None:
        if self._is_foreign():
            return
        length = int(self.headers.get("Content-Length", "0"))
        if length > LARGEST_QUESTION:
            self.send_error(HTTPStatus.REQUEST_ENTITY_TOO_LARGE)
            return
        try:
            asked = json.loads(self.rfile.read(length) or b"{}")
            answer = self.server.desk.answer(self.path.removeprefix("/"), asked)
        except (KeyError, TypeError, ValueError) as error:
            self.send_error(HTTPStatus.BAD_REQUEST, f"no question of the page: {error!r}")
            return
        self._send("application/json", _json(answer))

    def _is_foreign(self) -> bool:
        """Refuse a request that a page from elsewhere makes, under a name of its own for this machine."""
        port = self.server.server_port
        named = self.headers.get("Host", "")
        origin = self.headers.get("Origin", f"http://{named}")
        if named in (f"{HOST}:{port}", f"localhost:{port}") and origin == f"http://{named}":
            return False
        self.send_error(HTTPStatus.FORBIDDEN)
        return True

    def _send(self, kind: str, content: bytes) -> None:
        self.send_response(HTTPStatus.OK)
        self.send_header("Content-Type", kind)
        self.send_header("Content-Length", str(len(content)))
        self.send_header("Cache-Control", "no-store")
        self.end_headers()
        self.wfile.write(content)

    def log_message(self, format: str, *args: Any) -> None:  # noqa: A002 - the name of the base class
        """Say nothing of each request."""


def _json(answer: Any) -> bytes:
    """An answer as text; JSON has no word for what is not a number, and the page takes null for it."""
    try:
        return json.dumps(answer, allow_nan=False).encode()
    except ValueError:
        return json.dumps(_finite(answer)).encode()


def _finite(answer: Any) -> Any:
    """An answer with None for numbers that are not finite."""
    if isinstance(answer, dict):
        return {key: _finite(value) for key, value in answer.items()}
    if isinstance(answer, list):
        return [_finite(value) for value in answer]
    if isinstance(answer, float) and not abs(answer) < float("inf"):
        return None
    return answer
