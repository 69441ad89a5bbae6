"""Templates: words, parts and sections."""

from __future__ import annotations

from importlib import resources
from typing import Any

import pytest

from cosserat_casadi.compiling import texts

TEMPLATES = [file.name for file in (resources.files("cosserat_casadi.compiling") / "templates").iterdir()]

NESTED = """first
@{if outer}
outer @{word}
@{if inner}
inner
@{end}
@{if not inner}
no inner
@{end}
@{end}
end @{if outer}
 of outer
@{end}
"""


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        ({}, "first\nend "),
        ({"outer": 2}, "first\nouter W\nno inner\nend  of outer\n"),
        ({"outer": True, "inner": True}, "first\nouter W\ninner\nend  of outer\n"),
        ({"inner": True, "outer": 0}, "first\nend "),
    ],
)
def test_sections(monkeypatch: pytest.MonkeyPatch, words: dict[str, Any], expected: str) -> None:
    parts = {"whole.in": "@{include nested.in}\n", "nested.in": NESTED}
    monkeypatch.setattr(texts, "resource", lambda folder, file, **_more: parts[file])
    assert texts.render("whole.in", {"word": "W", **words}) == expected


@pytest.mark.parametrize("name", TEMPLATES)
def test_every_section_ends(name: str) -> None:
    text = texts.resource("templates", name)
    assert text.count("@{if ") == text.count("@{end}\n")
