"""Ctrl-C and SIGTERM: both end a command with a sentence, and with nothing half-written."""

from __future__ import annotations

import signal
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager


class StoppedError(Exception):
    """A command was stopped, and has said so itself."""


SIGNALS = (signal.SIGINT, signal.SIGTERM)
"""Signals that stop a command."""

_received: list[int] = []
"""Those that have come, in their order."""


def install_handlers() -> None:
    """Turn the signals into KeyboardInterrupt, so that what is unfinished is removed on the way out."""
    for number in SIGNALS:
        signal.signal(number, _interrupt)
    sys.unraisablehook = _report_unraisable


def forget_signals() -> None:
    """Begin anew: a command has not been stopped yet."""
    _received.clear()


def remove_handlers() -> None:
    """Let the signals end the process without a word: the command is done."""
    for number in SIGNALS:
        signal.signal(number, signal.SIG_DFL)


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


def _report_unraisable(unraisable: sys.UnraisableHookArgs) -> None:
    """Keep quiet of an interrupt that falls where nothing can be raised: it is remembered."""
    if not isinstance(unraisable.exc_value, KeyboardInterrupt):
        sys.__unraisablehook__(unraisable)


def _interrupt(number: int, frame: object) -> None:
    _received.append(number)
    raise KeyboardInterrupt
