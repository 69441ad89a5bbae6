"""Docstrings say their subjects: "what", "those", "the found" or "one's own" stand where a noun is missing."""

from __future__ import annotations

import ast
import re
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.conftest import ROOT

PACKAGE = ROOT / "cosserat_casadi"

NOUNS_MISSING = {
    "what": r"^What\b|\b[Ww]hat (?:is|was|are|were|has|have|had|it|they|there)\b",
    "those": r"\b[Tt]hose\b(?=[.,;:)]|$| (?:that|which|whose|with|where|there|are|and|as|given|found|made)\b)|^Those\b",
    "found": r"\b(?:the|those|ones?|of) found\b|^Found\b",
    "given": r"\b(?:the|those|ones?|as|is|are|where|not) given\b(?=[.,;:)]|$)|^Given\b",
    "own": r"\bof (?:its|their|one's) own\b|\bown ones?\b|\bthe own\b|\bown(?=[.,;)]|$)",
    "made": r"\b(?:those|ones?|what is|what was) made\b",
    "none of none": r"\bnone of none\b|\bNone where there is none\b",
    "the same": r"^The same\b|\bthe same (?:of|with)\b|[:;] the same(?=[.,;:)]|$| (?:as|at|but|by|for|in|where)\b)",
    "likewise": r"\b[Ll]ikewise\b",
    "of": r"^(?:Of|As|That|Those|Its|Their|It|They)\b",
    "from": r"^(?:After|At|Before|Behind|Between|By|For|From|In|On|Over|To|Under|With|Without)\b",
    "one": r"^One (?:all|each|for|if|of|over|where)\b|^One[.,:]",
    "that of": r"(?:^|[.:;] )[Tt](?:hat|hose) of\b|\n +\w+: that\b",
    "former": r"\bthe (?:former|latter)\b",
}
"""Word that stands in place of a noun, and a pattern of the places where it does.

A reader who jumps to a function does not see the docstring above it: none begins with a reference to that.
"""


def docstrings(text: str) -> Iterator[tuple[int, str]]:
    """Docstrings of modules, classes, functions, constants and fields, with the lines that they begin in."""
    for node in ast.walk(ast.parse(text)):
        body = getattr(node, "body", None)
        for statement in body if isinstance(body, list) else []:
            if isinstance(statement, ast.Expr) and isinstance(statement.value, ast.Constant):
                value = statement.value.value
                if isinstance(value, str):
                    yield statement.lineno, value


def missing_nouns(text: str) -> list[tuple[int, str]]:
    """Lines of a source in which a noun is missing, with the word that stands there."""
    places = []
    for first, docstring in docstrings(text):
        for word, pattern in NOUNS_MISSING.items():
            matches = re.finditer(pattern, docstring)
            places += [(first + docstring.count("\n", 0, match.start()), word) for match in matches]
    return sorted(places)


def room_of(path: Path) -> str:
    return path.relative_to(PACKAGE).parts[0]


ROOMS = sorted({room_of(path) for path in PACKAGE.rglob("*.py")})


@pytest.mark.parametrize("room", ROOMS)
def test_docstrings_say_the_noun(room: str) -> None:
    places = []
    for path in sorted(PACKAGE.rglob("*.py")):
        if room_of(path) == room:
            lines = missing_nouns(path.read_text(encoding="utf-8"))
            places += [f"{path.relative_to(ROOT)}:{line}: {word!r} in place of a noun" for line, word in lines]
    assert not places, "\n" + "\n".join(places)


def test_a_missing_noun_is_seen() -> None:
    source = '''"""What is solved."""
LIMIT = 3
"""Steps of those that are given."""

def solve():
    """Return the equilibrium of the rod, or one of its own.

    Args: none.
    """
'''
    words = Counter(word for _, word in missing_nouns(source))
    assert words == {"what": 1, "those": 1, "given": 1, "own": 1}


@pytest.mark.parametrize(
    ("word", "docstring"),
    [
        ("the same", "The same in numbers."),
        ("the same", "Results.\n\n    Args:\n        bodies: the same of each body."),
        ("the same", "Abscissa at which it ends; the same for a point."),
        ("likewise", "Largest value, likewise."),
        ("of", "Of a tube without bore."),
        ("of", "As the input, h×1."),
        ("of", "Their indices in the stacked inputs."),
        ("from", "From its radius."),
        ("from", "At rest in the unloaded shape."),
        ("one", "One over each entry."),
        ("one", "One: what varies along the rod is its magnetisation."),
        ("that of", "Stiffness of a cable.\n\n    Args:\n        model: that of the motion."),
        ("that of", "Error of the tips; that of the shapes between."),
        ("former", "Guards of events, and the number of the former."),
    ],
)
def test_a_reference_to_another_docstring_is_seen(word: str, docstring: str) -> None:
    assert word in {seen for _, seen in missing_nouns(f'"""{docstring}"""')}


def test_a_comparison_within_a_sentence_is_not_counted() -> None:
    source = '"""One row of a table. Its rate is beside that of another row with the same number of cells."""'
    assert missing_nouns(source) == []


def test_a_said_noun_is_not_counted() -> None:
    source = '"""Solve a scene with its own grid. The given inputs are made of numbers that were found there."""'
    assert missing_nouns(source) == []
