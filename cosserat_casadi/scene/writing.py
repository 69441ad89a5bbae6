"""A scene as the text of a scene file."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from typing import Any

from cosserat_casadi.scene.scene import Scene


def scene_tables(scene: Scene) -> dict[str, Any]:
    """The tables of a scene's file: the given keys, without defaults."""
    return scene.model_dump(mode="json", by_alias=True, exclude_unset=True)


def scene_text(scene: Scene) -> str:
    """A scene as TOML text; reading it gives an equal scene."""
    given = scene_tables(scene)
    # In TOML plain keys stand before the first table: after its heading they would belong to it.
    values = {key: value for key, value in given.items() if not _holds_tables(value)}
    blocks = [_lines(values)]
    for key, value in given.items():
        if isinstance(value, dict):
            blocks.append(f"[{key}]\n{_lines(value)}")
        elif _holds_tables(value):
            blocks.extend(f"[[{key}]]\n{_lines(entry)}" for entry in value)
    return "\n".join(blocks)


def _holds_tables(value: Any) -> bool:
    """Whether a value is a table, or a list with tables in it."""
    if isinstance(value, list):
        return any(isinstance(entry, dict) for entry in value)
    return isinstance(value, dict)


def _lines(table: Mapping[str, Any]) -> str:
    """A line for each key; inner tables are inline, so that entries of lists stay whole."""
    lines = [f"{entry}\n" for entry in _assignments(table)]
    return "".join(lines)


def _assignments(table: Mapping[str, Any]) -> list[str]:
    assignments = []
    for key, value in table.items():
        # TOML has no null: a key that is given as None from Python is left out.
        if value is not None:
            assignments.append(f"{_key(key)} = {_value(value)}")
    return assignments


def _key(key: str) -> str:
    """A key, in quotes unless it is a bare key of TOML: a dot would mean a table."""
    return key if re.fullmatch(r"[A-Za-z0-9_-]+", key) else _value(key)


def _value(value: Any) -> str:
    """A TOML value; strings and numbers are written as in JSON, which TOML reads too."""
    if isinstance(value, dict):
        entries = ", ".join(_assignments(value))
        return f"{{ {entries} }}"
    if isinstance(value, list):
        entries = ", ".join(_value(entry) for entry in value)
        return f"[{entries}]"
    if isinstance(value, float):
        return repr(value)
    text = json.dumps(value, ensure_ascii=False)
    # JSON does not escape DEL, which TOML refuses.
    return text.replace("\x7f", "\\u007f")
