"""Words of messages: known words similar to an unknown one, and counts with nouns."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Sequence

FEW = 3
"""Most names in a sentence."""


def closest(word: str, known: Iterable[str]) -> str:
    """A remedy for an unknown word: the most similar known word, or all known words."""
    words = list(known)
    return likely_meant(word, words) or f"known: {', '.join(words[:30])}"


def likely_meant(word: str, known: Iterable[str]) -> str:
    """A remedy with the known word that is most similar to an unknown one; empty if none is similar."""
    # difflib takes time with the square of the length.
    close = difflib.get_close_matches(word[:40], known, n=1)
    return f"did you mean '{close[0]}'?" if close else ""


def counted(count: int, noun: str) -> str:
    """A count with its noun, such as "1 row" or "12,000 rows"."""
    if count == 1:
        return f"1 {noun}"
    return f"{count:,} {noun}s"


def named(names: Sequence[object], most: int = FEW) -> str:
    """The first names and the number of the others, such as "a, b, c and 2 more"."""
    told = ", ".join(map(str, names[:most]))
    return told if len(names) <= most else f"{told} and {len(names) - most} more"
