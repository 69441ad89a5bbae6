"""Standard output and standard error of a terminal or a pipe that may not know every letter, or not take more."""

from __future__ import annotations

import codecs
import io
import os
import sys
import unicodedata
from itertools import groupby

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
    plain = ""
    for raised, run in groupby(letters, _is_superscript):
        written = "".join(_plain_letter(letter) for letter in run)
        # 10⁶ must not become 106.
        plain += f"^{written}" if raised else written
    # Nor 10½ 101/2.
    if plain[:1].isdigit() and error.object[: error.start][-1:].isdigit():
        plain = f" {plain}"
    return plain, error.end


def _is_superscript(letter: str) -> bool:
    return unicodedata.decomposition(letter).startswith("<super>")


def _plain_letter(letter: str) -> str:
    """What stands for one letter; a question mark where nothing does."""
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
