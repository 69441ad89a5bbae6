"""Standard output and standard error of terminals and pipes with limited encodings, or closed ones."""

from __future__ import annotations

import codecs
import errno
import io
import os
import sys
import unicodedata
from contextlib import suppress
from itertools import groupby
from typing import Any, BinaryIO

from rich import console

PLAIN = {
    "µ": "u",
    "λ": "lambda",
    "Λ": "Lambda",
    "±": "+/-",
    "×": "x",
    "−": "-",
    "–": "-",
    "…": "...",
    "●": "*",
    "·": ".",
    "÷": "/",
    "\N{FRACTION SLASH}": "/",
    "ℓ": "l",
    "≤": "<=",
    "≥": ">=",
    "→": "->",
}
"""Substitutes for letters missing in the encoding of the terminal."""

HANDLER = "cosserat_plain"
"""Name of the error handler that writes these substitutes."""


class Console(console.Console):
    """A console that prints text unchanged apart from markup.

    By default rich turns ``:b:`` in ``x=a:b:3`` into an emoji, and colours numbers and paths.
    """

    def __init__(self, *, stderr: bool = False) -> None:
        super().__init__(stderr=stderr, emoji=False, highlight=False)


def prepare_streams() -> None:
    """Make standard output and standard error accept any text.

    Letters missing in the encoding become plain ones; text that standard error cannot take is dropped; a width of zero
    columns is treated like that of a pipe.
    """
    codecs.register_error(HANDLER, _plain_letters)
    _open_missing_streams()
    if isinstance(sys.stderr, io.TextIOWrapper):
        sys.stderr = _dropping(sys.stderr)
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors=HANDLER)
    if os.environ.get("COLUMNS", "1").strip("0") == "":
        del os.environ["COLUMNS"]


def binary_output() -> BinaryIO:
    """Binary standard output.

    Raises:
        OSError: it is closed.
    """
    if sys.stdout is None:
        raise OSError(errno.EBADF, os.strerror(errno.EBADF))
    return sys.stdout.buffer


def _open_missing_streams() -> None:
    """Open closed standard streams, so that no other file gets their numbers and their output."""
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            # The lowest free number is used, which is this one.
            os.open(os.devnull, os.O_RDWR)


class _Dropping(io.FileIO):
    """A file that drops text after write errors; the exit code reports the outcome too."""

    def write(self, content: Any) -> int:
        """Write a content, as far as possible."""
        with suppress(OSError):
            rest = memoryview(content)
            while len(rest):
                rest = rest[super().write(rest) :]
        return len(content)


def _dropping(stream: io.TextIOWrapper) -> io.TextIOWrapper:
    """A stream for the same file that drops text after write errors, e.g. on a full disk."""
    file = _Dropping(stream.fileno(), "w", closefd=False)
    return io.TextIOWrapper(file, encoding=stream.encoding, errors=stream.errors, write_through=True)


def flush_streams() -> None:
    """Flush standard output.

    Raises:
        OSError: it cannot be written, e.g. on a full disk.
    """
    if sys.stdout is not None:
        sys.stdout.flush()


def silence_output() -> None:
    """Drop the rest of standard output, after its reader has closed it or on a full disk.

    Otherwise Python would retry at exit, and print a traceback.
    """
    if sys.stdout is None:
        return
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, sys.stdout.fileno())
    os.close(nowhere)


def _plain_letters(error: UnicodeError) -> tuple[str, int]:
    """The error handler: substitutes for letters missing in an encoding, and the position to continue."""
    if not isinstance(error, UnicodeEncodeError):
        raise error
    letters = error.object[error.start : error.end]
    plain = ""
    for raised, run in groupby(letters, lambda letter: unicodedata.decomposition(letter).startswith("<super>")):
        written = "".join(_plain_letter(letter) for letter in run)
        # 10⁶ must not become 106.
        plain += f"^{written}" if raised else written
    # Nor 10½ 101/2.
    if plain[:1].isdigit() and error.object[: error.start][-1:].isdigit():
        plain = f" {plain}"
    return plain, error.end


def _plain_letter(letter: str) -> str:
    """The substitute for one letter, or a question mark."""
    if letter in PLAIN:
        return PLAIN[letter]
    match unicodedata.name(letter, "").split():
        case ["GREEK", "SMALL", "LETTER", name]:
            return name.lower()
        case ["GREEK", "CAPITAL", "LETTER", name]:
            return name.capitalize()
    if unicodedata.combining(letter):
        return ""
    decomposed = unicodedata.normalize("NFKD", letter)
    if decomposed == letter:
        return letter if letter.isascii() else "?"
    return "".join(_plain_letter(part) for part in decomposed)
