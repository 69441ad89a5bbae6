"""Templates of this package with their words filled in, and its files in C."""

from __future__ import annotations

import re
from collections.abc import Mapping
from importlib import resources
from typing import Any

SECTION = re.compile(r"^@\{if (\w+)\}\n(.*?)^@\{end\}\n", re.MULTILINE | re.DOTALL)
"""Lines of a template that stay where a word is true: ``@{if word}``, the lines, ``@{end}``."""


def render(template: str, words: dict[str, Any]) -> str:
    """A template of this package with its words filled in.

    Parts that it includes, ``@{include part}``, and sections whose word is true stand in the text.
    """
    text = resource("templates", template)
    whole = re.sub(r"@\{include (\S+)\}\n", lambda part: resource("templates", part[1]), text)
    held = SECTION.sub(lambda section: section[2] if words.get(section[1]) else "", whole)
    return fill(held, words)


def fill(text: str, words: Mapping[str, Any]) -> str:
    """The text of a template with its words filled in: ``@{word}``."""
    return re.sub(r"@\{(\w+)\}", lambda match: str(words[match[1]]), text)


def resource(folder: str, file: str) -> str:
    """Text of a file of this package."""
    return (resources.files("cosserat_casadi.codegen") / folder / file).read_text(encoding="utf-8")


def files_in_c() -> list[str]:
    """Names of the files of this package in C."""
    return sorted(file.name for file in (resources.files("cosserat_casadi.codegen") / "c").iterdir())
