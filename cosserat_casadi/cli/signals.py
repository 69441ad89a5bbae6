"""Ctrl-C and SIGTERM: both end a command with a sentence, and with nothing half-written, within a second.

A signal raises KeyboardInterrupt where Python runs. It does not inside a long call of CasADi, and where CasADi has
called Python the exception is lost: a thread that hears of signals by itself ends the process then.
"""

from __future__ import annotations

import atexit
import os
import shutil
import signal
import socket
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from types import TracebackType


class StoppedError(Exception):
    """A command was stopped, and has said so itself."""


SIGNALS = (signal.SIGINT, signal.SIGTERM)
"""Signals that stop a command."""

GRACE = 0.7
"""Time that a command has after a signal to end by itself, s."""

LONG_GRACE = 30.0
"""Time for a command that writes partial results, such as the beginning of a motion, to end after a signal, s."""

LOOKS = 0.05
"""Time between two looks at whether the command is over, s."""

_received: list[int] = []
"""Signals that have come, in their order."""

_temporary_folders: list[str] = []
"""Folders for temporary files: one at the most."""

_unhurried = threading.Event()
"""Whether the command writes its partial results after a signal."""

_said = threading.Event()
"""Whether the user has been told that the command was stopped."""

_saying = threading.Lock()
"""Held by the thread that tells the user: the command itself and the thread that watches may both come to it."""


def install_handlers() -> None:
    """Turn the signals into KeyboardInterrupt, so that unfinished files are removed on the way out."""
    for number in SIGNALS:
        signal.signal(number, _interrupt)
    sys.unraisablehook = _report_unraisable
    # Libraries in C that cannot raise an exception print it by this hook, and go on.
    sys.excepthook = _report_uncaught


def end_in_time(sentence: str, exit_codes: Mapping[int, int]) -> None:
    """End the process where a command has not ended by itself some time after a signal, or at a second one.

    Temporary files lie in one folder from now on, which is removed.

    Args:
        sentence: printed on standard error then.
        exit_codes: of the process, by the number of the signal.
    """
    folder = tempfile.mkdtemp(prefix="cosserat_casadi-")
    _temporary_folders.append(folder)
    tempfile.tempdir = folder
    atexit.register(remove_temporary_files)
    told, heard = socket.socketpair()
    for end in (told, heard):
        end.setblocking(end is heard)
    signal.set_wakeup_fd(told.fileno(), warn_on_full_buffer=False)
    # Kept by the thread: the numbers of signals come through it as long as the process lives.
    arguments = (told, heard, sentence, exit_codes)
    threading.Thread(target=_watch, args=arguments, name="signals", daemon=True).start()


def remove_temporary_files() -> None:
    """Remove the folder of temporary files, where the process ends without its last rites."""
    for folder in _temporary_folders:
        shutil.rmtree(folder, ignore_errors=True)


def say_once(sentence: str) -> None:
    """Print a sentence on standard error, unless the command or the thread that watches has printed one before.

    Args:
        sentence: the sentence, which says that the command was stopped.
    """
    with _saying:
        if _said.is_set():
            return
        _said.set()
        clear_line = "\r\x1b[2K\x1b[?25h" if os.isatty(2) else ""
        with suppress(OSError):
            os.write(2, f"{clear_line}{sentence}\n".encode())


def take_time() -> None:
    """Let the command that runs write its partial results after a signal."""
    _unhurried.set()


def forget_signals() -> None:
    """Begin anew: a command has not been stopped yet."""
    _received.clear()
    _unhurried.clear()
    _said.clear()


def remove_handlers() -> None:
    """Let the signals end the process without a word: the command is done."""
    for number in SIGNALS:
        signal.signal(number, signal.SIG_DFL)
    signal.set_wakeup_fd(-1)


def was_terminated() -> bool:
    """Whether SIGTERM was the first signal that has come."""
    return bool(_received) and _received[0] == signal.SIGTERM


def was_interrupted() -> bool:
    """Whether any signal has come."""
    return bool(_received)


@contextmanager
def remembered_interrupt() -> Iterator[Callable[[], None]]:
    """A function that raises KeyboardInterrupt if the user has interrupted since.

    CasADi calls Python to look at its arguments, and takes whatever that raises for a refusal of the argument: an
    interrupt that falls there is lost. It is remembered, and raised again at the next report of progress.
    """
    handlers_before = {number: signal.signal(number, _interrupt) for number in SIGNALS}

    def raise_again() -> None:
        if _received:
            raise KeyboardInterrupt

    try:
        yield raise_again
    finally:
        for number, handler in handlers_before.items():
            signal.signal(number, handler)


def _watch(told: socket.socket, heard: socket.socket, sentence: str, exit_codes: Mapping[int, int]) -> None:
    """End the process some time after the first signal that comes, or at the second."""
    first = _next_signal(heard)
    began = time.monotonic()
    heard.settimeout(LOOKS)
    while time.monotonic() - began < (LONG_GRACE if _unhurried.is_set() else GRACE):
        try:
            _next_signal(heard)
        except TimeoutError:
            continue
        break
    say_once(sentence)
    remove_temporary_files()
    told.close()
    os._exit(exit_codes[first])


def _next_signal(heard: socket.socket) -> int:
    """Number of the next signal that stops a command.

    Raises:
        TimeoutError: none has come in the time that the socket has.
    """
    while True:
        number = heard.recv(1)[0]
        if number in SIGNALS:
            return number


def _report_unraisable(unraisable: sys.UnraisableHookArgs) -> None:
    """Keep quiet of an interrupt that falls where nothing can be raised: it is remembered."""
    if not isinstance(unraisable.exc_value, KeyboardInterrupt):
        sys.__unraisablehook__(unraisable)


def _report_uncaught(kind: type[BaseException], error: BaseException, at: TracebackType | None) -> None:
    """Keep quiet of an interrupt that a library in C has swallowed: it is remembered."""
    if not issubclass(kind, KeyboardInterrupt):
        sys.__excepthook__(kind, error, at)


def _interrupt(number: int, frame: object) -> None:
    _received.append(number)
    raise KeyboardInterrupt
