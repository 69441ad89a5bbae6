"""Ctrl-C and SIGTERM: both end a command with a sentence, and with nothing half-written, within a second.

In Python code a signal raises KeyboardInterrupt. Inside a long call of CasADi it does not, nor in Python code that
CasADi calls: the next report of progress raises it, or a thread that receives signals too ends the process.
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
from traceback import walk_stack
from types import FrameType, TracebackType

from cosserat_casadi.files import remove_unfinished


class StoppedError(Exception):
    """A command was stopped, and has printed so."""


SIGNALS = (signal.SIGINT, signal.SIGTERM)
"""Signals that stop a command."""

GRACE = 0.7
"""Time limit for a command to end after a signal, s."""

LONG_GRACE = 30.0
"""Time limit after a signal for a command that writes partial results, such as a partial motion, s."""

LOOKS = 0.05
"""Time between checks for the end of the command, s."""

_received: list[int] = []
"""Received signals, in their order."""

_temporary_folders: list[str] = []
"""Folders for temporary files, at most one."""

_unhurried = threading.Event()
"""Whether the command writes its partial results after a signal."""

_said = threading.Event()
"""Whether the user has been told that the command was stopped."""

_saying = threading.Lock()
"""Lock for the message to the user, which the command and the watching thread may both print."""


def install_handlers() -> None:
    """Turn the signals into KeyboardInterrupt, so that unfinished files are removed."""
    for number in SIGNALS:
        signal.signal(number, _interrupt)
    sys.unraisablehook = _report_unraisable
    # C libraries that cannot raise an exception print it by this hook and continue.
    sys.excepthook = _report_uncaught


def end_in_time(sentence: str, exit_codes: Mapping[int, int]) -> None:
    """End the process if the command does not end within the time limit after a signal, or at a second signal.

    From now on temporary files are in one folder, which is removed at the end.

    Args:
        sentence: message on standard error.
        exit_codes: exit codes of the process, by signal number.
    """
    folder = tempfile.mkdtemp(prefix="cosserat_casadi-")
    _temporary_folders.append(folder)
    tempfile.tempdir = folder
    atexit.register(remove_temporary_files)
    told, heard = socket.socketpair()
    for end in (told, heard):
        end.setblocking(end is heard)
    signal.set_wakeup_fd(told.fileno(), warn_on_full_buffer=False)
    # The thread keeps the socket, which receives signal numbers during the life of the process.
    arguments = (told, heard, sentence, exit_codes)
    threading.Thread(target=_watch, args=arguments, name="signals", daemon=True).start()


def remove_temporary_files() -> None:
    """Remove the folder of temporary files and unfinished files, before the process ends without cleanup."""
    remove_unfinished()
    for folder in _temporary_folders:
        shutil.rmtree(folder, ignore_errors=True)


def say_once(sentence: str) -> None:
    """Print a sentence on standard error, unless the command or the watching thread has printed one.

    Args:
        sentence: message that the command was stopped.
    """
    with _saying:
        if _said.is_set():
            return
        _said.set()
        clear_line = "\r\x1b[2K\x1b[?25h" if os.isatty(2) else ""
        with suppress(OSError):
            os.write(2, f"{clear_line}{sentence}\n".encode())


def take_time() -> None:
    """Give the running command time to write its partial results after a signal."""
    _unhurried.set()


def forget_signals() -> None:
    """Reset: no signal received."""
    _received.clear()
    _unhurried.clear()
    _said.clear()


def remove_handlers() -> None:
    """Restore the default handlers after the command."""
    for number in SIGNALS:
        signal.signal(number, signal.SIG_DFL)
    signal.set_wakeup_fd(-1)


def was_terminated() -> bool:
    """Whether the first received signal was SIGTERM."""
    return bool(_received) and _received[0] == signal.SIGTERM


def was_interrupted() -> bool:
    """Whether any signal was received."""
    return bool(_received)


@contextmanager
def remembered_interrupt() -> Iterator[Callable[[], None]]:
    """A function that raises KeyboardInterrupt if the user has interrupted since.

    An interrupt while CasADi calls Python, to inspect arguments or to convert results, is raised at the next report.
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
    """End the process at the time limit after the first signal, or at the second one."""
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
    """Number of the next signal.

    Raises:
        TimeoutError: no signal within the timeout of the socket.
    """
    while True:
        number = heard.recv(1)[0]
        if number in SIGNALS:
            return number


def _report_unraisable(unraisable: sys.UnraisableHookArgs) -> None:
    """Do not print an interrupt that could not be raised: it is remembered."""
    if not isinstance(unraisable.exc_value, KeyboardInterrupt):
        sys.__unraisablehook__(unraisable)


def _report_uncaught(kind: type[BaseException], error: BaseException, at: TracebackType | None) -> None:
    """Do not print an interrupt lost in a C library: it is remembered."""
    if not issubclass(kind, KeyboardInterrupt):
        sys.__excepthook__(kind, error, at)


def _interrupt(number: int, frame: FrameType | None) -> None:
    _received.append(number)
    # In Python code that CasADi calls from C, with CasADi on the stack twice, the exception would be lost.
    modules = [at.f_globals.get("__name__") for at, _ in walk_stack(frame)]
    if modules.count("casadi.casadi") < 2:
        raise KeyboardInterrupt
