"""Standard output and standard error of a terminal or a pipe that may not know every letter, or not take more."""

from __future__ import annotations

import codecs
import io
import os
import sys
import unicodedata

PLAIN = {
    "²": "^2",
    "³": "^3",
    "µ": "u",
    "±": "+/-",
    "×": "x",
    "−": "-",
    "–": "-",
    "…": "...",
    "●": "*",
    "ℓ": "l",
    "≤": "<=",
    "≥": ">=",
    "→": "->",
}
"""What stands for a letter that the terminal does not know."""

HANDLER = "cosserat_plain"
"""Name of the error handler that writes it."""


def prepare_streams() -> None:
    """Let standard output and standard error write plain letters for those that their encoding lacks."""
    codecs.register_error(HANDLER, _plain_letters)
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors=HANDLER)


def flush_streams() -> None:
    """Write what standard output still holds.

    Raises:
        OSError: it cannot be written, as on a full disk.
    """
    if sys.stdout is not None:
        sys.stdout.flush()


def silence_output() -> None:
    """Drop what is still to be written to standard output: its reader is gone, or its disk full.

    Python would try once more at its end, and print a traceback.
    """
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, sys.stdout.fileno())
    os.close(nowhere)


def _plain_letters(error: UnicodeError) -> tuple[str, int]:
    """The handler: plain letters for those that an encoding lacks, and where to go on."""
    if not isinstance(error, UnicodeEncodeError):
        raise error
    letters = error.object[error.start : error.end]
    plain = "".join(_plain_letter(letter) for letter in letters)
    return plain, error.end


def _plain_letter(letter: str) -> str:
    if letter in PLAIN:
        return PLAIN[letter]
    # An accent is dropped; what nothing stands for is a question mark.
    decomposed = unicodedata.normalize("NFKD", letter)
    ascii_part = decomposed.encode("ascii", errors="ignore").decode("ascii")
    return ascii_part or "?"
