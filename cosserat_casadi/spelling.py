"""Words of messages: known ones that an unknown one looks like, and counts with their nouns."""

from __future__ import annotations

import difflib
from collections.abc import Iterable


def closest(word: str, known: Iterable[str]) -> str:
    """A remedy for an unknown word: the known one that it looks like, or all that are known."""
    words = list(known)
    close = close_matches(word, words)
    if close:
        return f"did you mean '{close[0]}'?"
    return f"known: {', '.join(words[:30])}"


def close_matches(word: str, known: Iterable[str]) -> list[str]:
    """The known word that looks most like another; empty where none does."""
    # difflib takes time with the square of the length.
    return difflib.get_close_matches(word[:40], known, n=1)


def counted(count: int, noun: str) -> str:
    """A count with its noun, such as "1 row" or "12,000 rows"."""
    if count == 1:
        return f"1 {noun}"
    return f"{count:,} {noun}s"
