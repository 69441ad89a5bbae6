"""Server of the page of a session, on this machine only; it passes questions of the browser to the session.

Since other users of the machine can connect to its ports, the address holds a secret. Any bytes of a request give a
question or a refusal.
"""

from __future__ import annotations

import base64
import hashlib
import io
import json
import re
import secrets
import socket
import sys
import time
from collections.abc import Callable, Collection, Mapping
from contextlib import nullcontext
from dataclasses import dataclass, field
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, HTTPServer, ThreadingHTTPServer
from importlib import resources
from threading import Lock
from typing import Any

from pydantic import BaseModel, ConfigDict, FiniteFloat, ValidationError

from cosserat_casadi.errors import CosseratError, Problem, SceneError
from cosserat_casadi.page.page import page_text
from cosserat_casadi.results.json_text import plain
from cosserat_casadi.view.robot_session import RobotSession

HOST = "127.0.0.1"
"""Address of the server, which no other machine reaches."""

LARGEST_QUESTION = 1_000_000
"""Largest size of a question, bytes."""

CONNECTIONS = 32
"""Largest number of simultaneous connections; a browser opens six per server."""

PATIENCE = 30.0
"""Time limit for receiving a request, for sending an answer, and for an idle connection, s."""

SECRET_BYTES = 16
"""Number of random bytes in a secret."""

SCRIPTS = ("server_robot.js", "playback.js")


def check_port(port: int) -> None:
    """Refuse a port that cannot be opened, before any other work.

    Raises:
        SceneError: the port is in use by another program, or needs further rights.
    """
    try:
        HTTPServer((HOST, port), BaseHTTPRequestHandler).server_close()
    except OSError as error:
        problem = f"{port} cannot be taken: {error.strerror}"
        raise SceneError(Problem("--port", problem, "leave it out: a free one is found")) from None


@dataclass
class Desk:
    """The page of a session, and answers to its questions.

    Attributes:
        session: session that answers.
        page: the page.
        policy: value of the header Content-Security-Policy.
    """

    session: RobotSession
    page: bytes = field(init=False)
    policy: str = field(init=False)
    _lock: Lock = field(init=False, default_factory=Lock)

    def __post_init__(self) -> None:
        folder = resources.files("cosserat_casadi.view") / "assets"
        scripts = [(folder / name).read_text(encoding="utf-8") for name in SCRIPTS]
        text = page_text(self.session.facts(), scripts)
        self.page = text.encode()
        self.policy = _policy(text)

    def answer(self, name: str, question: Question) -> Any:
        """The answer to a question; a refusal is an answer with its sentence in ``refused``.

        Args:
            name: name of the question.
            question: parts of the question.

        Raises:
            QuestionError: the question is unknown, or a part is missing or wrong.
        """
        session = self.session
        if name not in session.questions:
            raise QuestionError("the page asks no such question")
        given: list[Any] = []
        if name in ("move", "reset", "refined"):
            given = [question.all_inputs(session.model.inputs.size)]
        elif name == "reach":
            given = [*question.point(session.pose_names)]
        # Motions and refined equilibria may take a minute: they run without the lock, on separate models.
        at_once = name not in ("motion", "refined")
        with self._lock if at_once else nullcontext():
            return _refusable(getattr(session, name), *given)


def _refusable(method: Callable[..., Any], *given: Any) -> Any:
    try:
        return method(*given)
    except CosseratError as error:
        return {"refused": str(error)}


def _policy(page: str) -> str:
    """Policy of the page: only its scripts and styles, and connections only to this server."""
    scripts = " ".join(map(_digest, re.findall(r"<script>(.*?)</script>", page, re.DOTALL)))
    styles = " ".join(map(_digest, re.findall(r"<style>(.*?)</style>", page, re.DOTALL)))
    rules = (
        "default-src 'none'",
        f"script-src {scripts}",
        f"style-src {styles}",
        "img-src data:",
        "connect-src 'self'",
        "base-uri 'none'",
        "form-action 'none'",
        "frame-ancestors 'none'",
    )
    return "; ".join(rules)


def _digest(text: str) -> str:
    """Hash of a text, in the form of a policy."""
    digest = hashlib.sha256(text.encode()).digest()
    return f"'sha256-{base64.b64encode(digest).decode()}'"


class RobotServer(ThreadingHTTPServer):
    """A server of a session's page, ready to serve."""

    def __init__(self, session: RobotSession, port: int = 0) -> None:
        """Open a port of this machine, 0 for any free port; OSError if it is in use."""
        self.desk = Desk(session)
        self._secret = secrets.token_urlsafe(SECRET_BYTES)
        self._ticket = secrets.token_urlsafe(SECRET_BYTES)
        self._ticket_lock = Lock()
        self._open: set[Any] = set()
        super().__init__((HOST, port), _Handler)

    @property
    def address(self) -> str:
        """Address of the page, with the secret."""
        return f"http://{HOST}:{self.server_port}/{self._secret}/"

    @property
    def address_for_once(self) -> str:
        """Address of the page that is valid for one request only.

        Command lines of programs, such as a browser's, are visible to all users of a machine.
        """
        return f"http://{HOST}:{self.server_port}/{self._ticket}"

    def is_secret(self, word: str) -> bool:
        """Whether a word is the secret of the address."""
        return secrets.compare_digest(word.encode(), self._secret.encode())

    def takes_ticket(self, word: str) -> bool:
        """Whether a word is the ticket of the one-time address; a valid ticket is used up."""
        with self._ticket_lock:
            valid = bool(self._ticket) and secrets.compare_digest(word.encode(), self._ticket.encode())
            if valid:
                self._ticket = ""
        return valid

    def process_request(self, request: Any, client_address: Any) -> None:
        """Serve a connection in a new thread, or close it if there are too many."""
        if len(self._open) >= CONNECTIONS:
            self.shutdown_request(request)
            return
        self._open.add(request)
        super().process_request(request, client_address)

    def shutdown_request(self, request: Any) -> None:
        """Close a connection, and release its place.

        Both threads may call it if a signal interrupts the start of the serving thread.
        """
        self._open.discard(request)
        super().shutdown_request(request)

    def handle_error(self, request: Any, client_address: Any) -> None:
        """Ignore errors of closed or sleeping pages that do not take their answers."""
        if not isinstance(sys.exception(), ConnectionError | TimeoutError):
            super().handle_error(request, client_address)


class _Arrival(io.RawIOBase):
    """Reader of a socket with a deadline; raises TimeoutError after it.

    The time limit of a socket restarts with every byte: a slow sender could hold a connection for ever.
    """

    def __init__(self, connection: socket.socket) -> None:
        self._connection = connection
        self._end = 0.0

    def begin(self) -> None:
        """Restart the deadline, for the next request."""
        self._end = time.monotonic() + PATIENCE

    def readable(self) -> bool:
        """True: a connection can be read."""
        return True

    def readinto(self, buffer: Any) -> int:
        """Fill a buffer with received bytes."""
        left = self._end - time.monotonic()
        if left <= 0.0:
            raise TimeoutError
        self._connection.settimeout(left)
        try:
            return self._connection.recv_into(buffer)
        finally:
            self._connection.settimeout(PATIENCE)


class _Handler(BaseHTTPRequestHandler):
    """GET returns the page; POST to the name of a question returns its answer, with JSON both ways."""

    protocol_version = "HTTP/1.1"
    # Requests without a version get a status line too.
    default_request_version = "HTTP/1.0"
    server_version = "cosserat"
    sys_version = ""
    timeout = PATIENCE
    disable_nagle_algorithm = True
    server: RobotServer

    def setup(self) -> None:
        """Set up reading with a deadline for each request."""
        super().setup()
        self.rfile.close()
        self._arrival = _Arrival(self.connection)
        self.rfile = io.BufferedReader(self._arrival)

    def handle_one_request(self) -> None:
        """Wait for a request and answer it; a late request closes the connection."""
        self._arrival.begin()
        super().handle_one_request()

    def do_GET(self) -> None:
        if self._is_foreign():
            return
        if self.server.takes_ticket(self.path.removeprefix("/")):
            self._send(HTTPStatus.SEE_OTHER, "text/plain", b"", {"Location": self.server.address})
            return
        if self._name() != "":
            self.send_error(HTTPStatus.NOT_FOUND)
            return
        desk = self.server.desk
        self._send(HTTPStatus.OK, "text/html", desk.page, {"Content-Security-Policy": desk.policy})

    def do_POST(self) -> None:
        if self._is_foreign():
            return
        name = self._name()
        if name is None:
            self.send_error(HTTPStatus.NOT_FOUND)
            return
        length = self._length()
        if length is None:
            return
        try:
            question = Question.read(self.rfile.read(length))
            answer = self.server.desk.answer(name, question)
        except QuestionError as error:
            self.send_error(HTTPStatus.BAD_REQUEST, str(error))
            return
        except Exception:
            # An internal error: the page gets a status without details, the terminal the traceback.
            self.send_error(HTTPStatus.INTERNAL_SERVER_ERROR)
            raise
        self._send(HTTPStatus.OK, "application/json", _json(answer))

    def _name(self) -> str | None:
        """Name after the secret in the path; None without the secret."""
        secret, slash, name = self.path.removeprefix("/").partition("/")
        return name if slash and self.server.is_secret(secret) else None

    def _length(self) -> int | None:
        """Length of the question, bytes; None after a refusal, which has been sent."""
        told = self.headers.get_all("Content-Length", [])
        if len(told) != 1 or "Transfer-Encoding" in self.headers:
            self.send_error(HTTPStatus.LENGTH_REQUIRED)
            return None
        # int() takes signs, blanks, underscores and digits of all scripts.
        if re.fullmatch("[0-9]{1,12}", told[0]) is None:
            self.send_error(HTTPStatus.BAD_REQUEST, "Content-Length is no number of bytes")
            return None
        length = int(told[0])
        if length > LARGEST_QUESTION:
            self.send_error(HTTPStatus.REQUEST_ENTITY_TOO_LARGE)
            return None
        return length

    def _is_foreign(self) -> bool:
        """Refuse a request of a page from another origin, also under another name of this machine."""
        port = self.server.server_port
        named = self.headers.get("Host", "")
        origin = self.headers.get("Origin", f"http://{named}")
        if named in (f"{HOST}:{port}", f"localhost:{port}") and origin == f"http://{named}":
            return False
        self.send_error(HTTPStatus.FORBIDDEN)
        return True

    def send_error(self, code: int, message: str | None = None, explain: str | None = None) -> None:
        """Refuse a request, and close the connection.

        The sentence is sent as content: in the status line or a header, text of the request could inject headers.
        """
        status = HTTPStatus(code)
        sentence = message or status.phrase
        self._send(status, "text/plain", f"{sentence}\n".encode(errors="replace"), {"Connection": "close"})

    def _send(self, status: HTTPStatus, kind: str, content: bytes, headers: dict[str, str] | None = None) -> None:
        self.send_response(status)
        self.send_header("Content-Type", f"{kind}; charset=utf-8")
        self.send_header("Content-Length", str(len(content)))
        self.send_header("Cache-Control", "no-store")
        self.send_header("Referrer-Policy", "same-origin")
        self.send_header("X-Content-Type-Options", "nosniff")
        self.send_header("Cross-Origin-Resource-Policy", "same-origin")
        for name, value in (headers or {}).items():
            self.send_header(name, value)
        self.end_headers()
        if self.command != "HEAD":
            self.wfile.write(content)

    def log_message(self, format: str, *args: Any) -> None:  # noqa: A002 - the name of the base class
        """Do not log requests."""


def _json(answer: Any) -> bytes:
    """An answer as JSON text, with null for NaN and infinity."""
    try:
        return json.dumps(answer, allow_nan=False).encode()
    except ValueError:
        return json.dumps(plain(answer)).encode()


class QuestionError(Exception):
    """The bytes are not a valid question."""


class Question(BaseModel):
    """Parts of a question.

    Attributes:
        inputs: stacked inputs; None for null.
        position: a position in world axes, m.
        pose: the tip or the body to move: {"rod": name} or {"body": name}.
    """

    model_config = ConfigDict(strict=True, frozen=True)

    inputs: list[FiniteFloat | None] = []
    position: tuple[FiniteFloat, FiniteFloat, FiniteFloat] | None = None
    pose: dict[str, str] = {}

    @classmethod
    def read(cls, content: bytes) -> Question:
        """A question from JSON; without content it has no parts.

        Raises:
            QuestionError: the content is not a JSON object, or a part has a wrong type.
        """
        try:
            return cls.model_validate_json(content or b"{}")
        except ValidationError as error:
            fault = error.errors(include_url=False, include_input=False)[0]
            part = fault["loc"][0] if fault["loc"] else "the question"
            raise QuestionError(f"{part}: {fault['msg']}") from None

    def all_inputs(self, count: int) -> list[float | None]:
        """The inputs, checked to be ``count`` numbers.

        Raises:
            QuestionError: they are missing, or their number is wrong.
        """
        if len(self.inputs) != count:
            raise QuestionError(f"inputs must be a list of {count}")
        return self.inputs

    def point(self, names: Mapping[str, Collection[str]]) -> tuple[dict[str, str], list[float]]:
        """The rod or body to move, and its target position; ``names`` are those of the scene, by kind.

        Raises:
            QuestionError: a part is missing, or its name is unknown.
        """
        if self.position is None or len(self.pose) != 1:
            raise QuestionError("the request needs a position, and a pose that names one rod or one body")
        ((kind, name),) = self.pose.items()
        if name not in names.get(kind, ()):
            raise QuestionError("pose names no rod and no body of the scene")
        return self.pose, list(self.position)
