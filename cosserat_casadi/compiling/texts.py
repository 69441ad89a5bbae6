"""Templates of this package with their words filled in, and its files in C."""

from __future__ import annotations

import re
from collections.abc import Mapping
from importlib import resources
from typing import Any

FILES = resources.files("cosserat_casadi") / "compiling"
"""The folder of the templates, and of the files in C."""

INCLUDED = re.compile(r"@\{include (\S+)\}\n")
"""Pattern of a line that includes another template."""

SECTION = re.compile(r"@\{if (not )?(\w+)\}\n((?:(?!@\{if ).)*?)@\{end\}\n", re.DOTALL)
"""Pattern of an innermost section of a template: ``@{if word}`` or ``@{if not word}``, lines, ``@{end}``."""

DEVICE = re.compile(r"(?:SOLVER|@\{MACRO\})_DEVICE ")
"""Pattern of the qualifier of functions in a header that compilers for GPUs need."""


def render(template: str, words: dict[str, Any]) -> str:
    """Fill the words in a template of this package; the text is also for GPUs if the word ``on_device`` is true.

    Templates are included at ``@{include part}``; sections are kept if their word is true, or false for ``if not``.
    """
    on_device = bool(words.get("on_device"))
    text = resource("templates", template, on_device=on_device)
    while INCLUDED.search(text):
        text = INCLUDED.sub(lambda part: resource("templates", part[1], on_device=on_device), text)
    while SECTION.search(text):
        text = SECTION.sub(lambda found: found[3] if bool(words.get(found[2])) != bool(found[1]) else "", text)
    return fill(text, words)


def fill(text: str, words: Mapping[str, Any]) -> str:
    """Fill the words ``@{word}`` in the text of a template."""
    return re.sub(r"@\{(\w+)\}", lambda match: str(words[match[1]]), text)


def resource(folder: str, file: str, *, on_device: bool = False) -> str:
    """Read a file of this package, without the qualifiers of functions for GPUs unless ``on_device``."""
    text = (FILES / folder / file).read_text(encoding="utf-8")
    return text if on_device else DEVICE.sub("", text)


def files_in_c() -> list[str]:
    """Names of the files of this package in C."""
    return sorted(file.name for file in (FILES / "c").iterdir())
