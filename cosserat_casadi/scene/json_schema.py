"""The JSON schema of the scene file, for editors: made from the records that read it.

``python -m cosserat_casadi.scene.json_schema`` writes the committed copy, ``scene.schema.json``.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from cosserat_casadi.scene.scene import Scene
from cosserat_casadi.scene.values import TABLE_TITLES

COMMITTED = Path(__file__).with_name("scene.schema.json")
"""Path of the committed copy, which editors use."""

DIALECT = "https://json-schema.org/draft/2020-12/schema"


def scene_json_schema() -> dict[str, Any]:
    """The schema of a scene file, JSON Schema 2020-12."""
    schema = Scene.model_json_schema(by_alias=True)
    tables: dict[str, Any] = {}
    referring = _with_references(schema, tables)
    referring["$defs"].update(tables)
    return {"$schema": DIALECT, **referring}


def _with_references(node: Any, tables: dict[str, Any]) -> Any:
    """A part of the schema with references in place of the tables of varying values, which it repeats for each key.

    Args:
        node: the part.
        tables: receives the schemas of these tables by title.
    """
    if isinstance(node, list):
        return [_with_references(entry, tables) for entry in node]
    if not isinstance(node, dict):
        return node
    if node.get("title") in TABLE_TITLES:
        tables[node["title"]] = node
        return {"$ref": f"#/$defs/{node['title']}"}
    return {key: _with_references(entry, tables) for key, entry in node.items()}


def schema_text() -> str:
    """The text of the committed schema: keys sorted, two spaces, a newline at the end."""
    schema = scene_json_schema()
    text = json.dumps(schema, indent=2, sort_keys=True, ensure_ascii=False)
    return f"{text}\n"


if __name__ == "__main__":
    COMMITTED.write_text(schema_text(), encoding="utf-8")
