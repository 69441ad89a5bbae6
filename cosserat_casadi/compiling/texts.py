"""Templates of this package with their words filled in, and its files in C."""

from __future__ import annotations

import re
from collections.abc import Mapping
from importlib import resources
from typing import Any

FILES = resources.files("cosserat_casadi") / "compiling"
"""The folder of the templates, and of the files in C."""

INCLUDED = re.compile(r"@\{include (\S+)\}\n")
"""A part of a template that is a template too."""

SECTION = re.compile(r"@\{if (not )?(\w+)\}\n((?:(?!@\{if ).)*?)@\{end\}\n", re.DOTALL)
"""Lines of a template without sections in them: ``@{if word}`` or ``@{if not word}``, the lines, ``@{end}``."""

DEVICE = re.compile(r"(?:SOLVER|@\{MACRO\})_DEVICE ")
"""The qualifier before functions of a header, which compilers for GPUs need."""


def render(template: str, words: dict[str, Any]) -> str:
    """A template of this package with its words filled in; for a GPU where the word ``on_device`` is true.

    Parts that it includes, ``@{include part}``, and sections whose word is true, or false as they ask, stay.
    """
    on_device = bool(words.get("on_device"))
    text = resource("templates", template, on_device=on_device)
    while INCLUDED.search(text):
        text = INCLUDED.sub(lambda part: resource("templates", part[1], on_device=on_device), text)
    while SECTION.search(text):
        text = SECTION.sub(lambda found: found[3] if bool(words.get(found[2])) != bool(found[1]) else "", text)
    return fill(text, words)


def fill(text: str, words: Mapping[str, Any]) -> str:
    """The text of a template with its words filled in: ``@{word}``."""
    return re.sub(r"@\{(\w+)\}", lambda match: str(words[match[1]]), text)


def resource(folder: str, file: str, *, on_device: bool = False) -> str:
    """Text of a file of this package; without the qualifiers of functions for a GPU, unless it is for one."""
    text = (FILES / folder / file).read_text(encoding="utf-8")
    return text if on_device else DEVICE.sub("", text)


def files_in_c() -> list[str]:
    """Names of the files of this package in C."""
    return sorted(file.name for file in (FILES / "c").iterdir())
