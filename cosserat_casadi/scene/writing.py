"""A scene as the text of a scene file."""

from __future__ import annotations

import json
from typing import Any

from cosserat_casadi.scene.scene import Scene


def scene_tables(scene: Scene) -> dict[str, Any]:
    """A scene as the tables of its file: what the user gave, with defaults left out."""
    return scene.model_dump(mode="json", by_alias=True, exclude_unset=True)


def scene_text(scene: Scene) -> str:
    """A scene as TOML; reading it gives the same scene."""
    given = scene_tables(scene)
    plain = {key: value for key, value in given.items() if not _is_table(value)}
    blocks = [_lines(plain)]
    for key, value in given.items():
        if isinstance(value, dict):
            blocks.append(f"[{key}]\n{_lines(value)}")
        elif _is_table(value):
            blocks.extend(f"[[{key}]]\n{_lines(entry)}" for entry in value)
    return "\n".join(blocks)


def _is_table(value: Any) -> bool:
    return isinstance(value, dict) or (isinstance(value, list) and any(isinstance(entry, dict) for entry in value))


def _lines(table: dict[str, Any]) -> str:
    return "".join(f"{key} = {_value(value)}\n" for key, value in table.items() if value is not None)


def _value(value: Any) -> str:
    """A TOML value; strings and numbers are written as in JSON, which TOML reads alike."""
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{key} = {_value(entry)}" for key, entry in value.items() if entry is not None) + " }"
    if isinstance(value, list):
        return "[" + ", ".join(map(_value, value)) + "]"
    if isinstance(value, float):
        return repr(value)
    return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
