"""TOML text, from a file or a string, to tables; for every text the outcome is tables or a `SceneError`."""

from __future__ import annotations

import math
import os
import re
import tomllib
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from cosserat_casadi.errors import Problem, SceneError

LARGEST = 1_000_000
"""Bytes of the largest scene that is read."""

DEEPEST = 64
"""Most dots in one key; the parser needs memory in proportion to the square of this number."""

EMPTY = ("is empty", "a scene has schema = 1 and at least one [[rods]]")
"""Problem and remedy of a file without text."""

TOO_DEEP = "is nested too deeply for a scene"
"""Problem of tables that are too deep for Python's parser or its stack."""


def file_text(path: Path) -> str:
    """Read the text of a file.

    Raises:
        SceneError: it cannot be read, is empty, is too large or is not UTF-8.
    """
    try:
        if path.is_dir():
            raise SceneError(Problem(str(path), "is a directory", "a scene is a TOML file"))
        with path.open("rb") as file:
            content = file.read(LARGEST + 1)
            size = os.fstat(file.fileno()).st_size
    except FileNotFoundError:
        raise SceneError(Problem(str(path), "no such file")) from None
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", error)
        raise SceneError(Problem(str(path), f"cannot be read: {reason}")) from None
    if len(content) > LARGEST:
        # A pipe has no size beforehand.
        raise SceneError(_too_large(str(path), max(size, len(content))))
    return _decoded(path, content)


def _decoded(path: Path, content: bytes) -> str:
    if not content.strip():
        raise SceneError(Problem(str(path), *EMPTY))
    not_text = SceneError(Problem(str(path), "is not text in UTF-8", "a scene is a TOML file"))
    if b"\0" in content:
        raise not_text
    try:
        return content.decode("utf-8-sig")
    except ValueError:
        raise not_text from None


def _too_large(where: str, size: int) -> Problem:
    # Rounded up: a file of one byte too many is not shown as one of 1.0 MB.
    tenths = math.ceil(size / 1e5)
    megabytes = tenths / 10
    return Problem(where, f"is {megabytes:.1f} MB; a scene is at most 1 MB")


WRITTEN_TWICE = "a key, or a table, stands twice; each entry of a list has its own [[…]], as in [[loads]]"
"""Remedy for keys that TOML cannot declare or overwrite."""


def parsed(text: str, where: str = "") -> dict[str, Any]:
    """Parse TOML text.

    Args:
        text: the text.
        where: the file of the text, for a problem of all of it.

    Raises:
        SceneError: it is not TOML, is empty, too large or nested too deeply.
    """
    if len(text) > LARGEST:
        raise SceneError(_too_large(where, len(text)))
    if not text.strip():
        raise SceneError(Problem(where, *EMPTY))
    if keys_are_too_deep(text):
        raise SceneError(Problem(where, TOO_DEEP))
    try:
        return tomllib.loads(text)
    except RecursionError:
        raise SceneError(Problem(where, TOO_DEEP)) from None
    except ValueError as error:
        raise SceneError(_syntax_problem(str(error))) from None


def keys_are_too_deep(text: str) -> bool:
    """Whether a dotted key is so deep that parsing it would take all memory; keys cannot span lines."""
    # A bare key ends at one of these signs; a quoted key may hold them, but its dots follow quotes.
    bare = re.split(r"[=,{}\[\]#\n]", text)
    lines = text.split("\n")
    return _most(r"[^.\s]\s*\.", bare) > DEEPEST or _most(r"[\"']\s*\.", lines) > DEEPEST


def _most(pattern: str, parts: Iterable[str]) -> int:
    """Largest number of matches of a pattern, which has a dot, in a part of a text; 0 for a text with few dots."""
    counts = [len(re.findall(pattern, part)) for part in parts if part.count(".") > DEEPEST]
    return max(counts, default=0)


def _syntax_problem(message: str) -> Problem:
    """A problem from the message of the parser, which usually ends in line and column."""
    parts = re.fullmatch(r"(.*) \(at (.*)\)", message, re.DOTALL)
    # Without these it is Python's refusal of a number with thousands of digits.
    if parts is None:
        return Problem("", "is not TOML: a number in it is beyond all range")
    problem, position = parts.groups()
    return Problem(position, f"is not TOML: {problem}", WRITTEN_TWICE if problem.startswith("Cannot") else "")
