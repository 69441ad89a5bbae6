"""The reference of the scene file, every key of every table: made from the records that read it.

Usage: ``python docs/scene_reference.py``, or ``make schema``: writes the committed copy, ``docs/scene.md``.
"""

from __future__ import annotations

import inspect
import json
import re
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from cosserat_casadi.scene.families import Family, contents_of
from cosserat_casadi.scene.fields import unit_and_meaning
from cosserat_casadi.scene.records import Entry, Record, keys_of
from cosserat_casadi.scene.scene import Scene

COMMITTED = Path(__file__).parent / "scene.md"
"""The page in the documentation."""

INTRODUCTION = """\
# The scene file

Every table and every key of a scene, made from the schema by `make schema`. The [guide](guide.md) builds a scene step
by step; editors that know JSON Schema complete and check these keys with
[`scene.schema.json`](../cosserat_casadi/scene/scene.schema.json).

A scene is a TOML file. What it does not name does not exist: an effect that is left out adds no instruction to the
model. A key that this page does not list is refused, as is a value out of its range; every fault is reported at once,
with where, what, and what to do.

* Units are SI. `world` axes are right-handed; the local z axis of a section is the rod's tangent.
* X is the abscissa along a rod relative to its length: 0 at the base, 1 at the tip.
* A quaternion is w, x, y, z, of norm 1; it turns local coordinates into those of the axes that it is given in.
* **3 components**: each is a number, or varies along the rod by itself.
* **Inputs** are what may stay free at run time: arguments of the model's functions and of the exported C. `inputs`
  names them `name.key`; without it, they are all those of loads and actuators that the scene gives.

## Along a rod

What may vary along a rod is a number, where it is constant, or a table that says how it varies; the table means the
same under every key. `cosserat check` prints the values of all of them at base and tip.

| table | meaning |
|---|---|
| `{ base = 8e-3, tip = 4e-3 }` | values at X = 0 and X = 1, linear between them |
| `{ powers = [8e-3, -4e-3] }` | 8e-3 − 4e-3 X: coefficients of 1, X, X², … |
| `{ legendre = [6e-3, -2e-3] }` | 6e-3 − 2e-3 (2X − 1): coefficients of the Legendre polynomials in 2X − 1 |

All three say the same here. Sizes and stiffnesses are linear: they take two coefficients at most. All else takes more.

**A plain list** means one of the three, by its key: a size goes from base to tip, an offset is of powers of X, strains
and spread loads are of Legendre polynomials. In an offset `[8e-3, 4e-3]` is therefore 8e-3 + 4e-3 X, 12 mm at the tip.
A table becomes the list of its key as it is read, in another notation up to ten coefficients; an input that varies has
Legendre coefficients, however the scene writes it.
"""


def reference_text() -> str:
    """The page as it is committed."""
    sections = [
        INTRODUCTION,
        _contents(),
        _heading(2, "Top level"),
        _example(Scene),
        _key_table(Scene, "", [key for key, kinds in contents_by_key(Scene).items() if kinds is None]),
    ]
    # Sections follow the order of the schema, so that a new table is in the page without further ado.
    for key, kinds in contents_by_key(Scene).items():
        if kinds is not None:
            sections += _list_or_table(key, kinds)
    return "\n".join(sections)


def _contents() -> str:
    """The tables of a scene, each with a link to its section."""
    lines = ["| table | what it holds |", "|---|---|"]
    for key, field in Scene.model_fields.items():
        if contents_of(field) is not None:
            lines.append(f"| [`{_title(key)}`](#{key}) | {field.description} |")
    return _block(lines)


def _list_or_table(key: str, kinds: Family[Any] | type[Record]) -> Iterator[str]:
    """The section of one table of the scene, or of one list of tables."""
    yield _heading(2, f"`{_title(key)}`")
    if isinstance(kinds, Family):
        yield f"{_sentence(Scene.model_fields[key].description)}\n"
        yield from _kinds(kinds, level=3)
    else:
        yield from _record(kinds, path=key, level=2)


def _title(key: str) -> str:
    """A table of a scene as its file heads it."""
    if key in ("accuracy", "simulation", "identification", "estimation"):
        return f"[{key}]"
    return f"[[{key}]]"


def _kinds(family: Family[Any], level: int) -> Iterator[str]:
    """One section for each kind of a family."""
    told: dict[str, object] = {}
    for word, record in family.records.items():
        title = f'`{family.key} = "{word}"`'
        yield _heading(level, title)
        # The word stands in the heading, and needs no line in the table.
        yield from _record(record, path=family.table, level=level, without=family.key, told=told)


def _record(
    record: type[Record], path: str, level: int, without: str = "", told: dict[str, object] | None = None
) -> Iterator[str]:
    """The section of one record below its heading, then those of the tables in it.

    Args:
        record: the record.
        path: of its table in the scene.
        level: of its heading.
        without: a key that stands in the heading.
        told: tables that kinds of one family share, which have a section already; tables that get one here are added.
    """
    yield f"{inspect.getdoc(record)}\n"
    if record.example:
        yield _example(record)
    yield _key_table(record, path, [key for key in contents_by_key(record) if key != without])
    if issubclass(record, Entry) and record.inputs:
        inputs = ", ".join(f"`{field}` ({_unit_word(declared.unit)})" for field, declared in record.inputs.items())
        yield f"Inputs: {inputs}.\n"
    for key, kinds in contents_by_key(record).items():
        if kinds is None:
            continue
        if told is not None:
            if told.get(key) is kinds:
                continue
            told[key] = kinds
        yield _heading(level + 1, f"`{path}.{key}`")
        if isinstance(kinds, Family):
            yield f"{_sentence(record.model_fields[key].description)}\n"
            yield from _kinds(kinds, level + 2)
        else:
            yield from _record(kinds, f"{path}.{key}", level + 1)


def contents_by_key(record: type[Record]) -> dict[str, Family[Any] | type[Record] | None]:
    """The keys of a record, each with the tables that it holds, or None for a value."""
    keys = keys_of(record)
    return {key: contents_of(field) for key, field in keys.items()}


# Keys


def _key_table(record: type[Record], path: str, keys: Sequence[str]) -> str:
    """A line for each key of a record that stands under a path of the scene."""
    schema = record.model_json_schema(by_alias=True)
    required = schema.get("required", [])
    lines = ["| key | value | unit | default | meaning |", "|---|---|---|---|---|"]
    for key in keys:
        node = schema["properties"][key]
        unit, meaning = unit_and_meaning(node["description"])
        value = _value(node)
        # References are texts to JSON Schema, names of tables to the reader.
        if meaning.startswith("name"):
            value = value.replace("text", "name")
        if value == TABLE:
            unit = "–"
            value = f"[table](#{_anchor(path, key)})"
        default = "required"
        if key not in required:
            default = _default(node)
        lines.append(f"| `{key}` | {value} | {unit} | {default} | {meaning} |")
    return _block(lines)


def _anchor(path: str, key: str) -> str:
    """The link to the section of an inner table: its heading without signs."""
    return f"{path}{key}".replace(".", "")


def _default(node: Mapping[str, Any]) -> str:
    default = node.get("default")
    # The default of a table is what stands in its own section.
    if default is None or isinstance(default, dict) or default in ("", []):
        return "–"
    return f"`{json.dumps(default)}`"


# Values, from the JSON schema of their records


TABLE = "table"
"""The value of a key that holds an inner table."""

ALONG = "[table](#along-a-rod)"
"""The value of a table that says how something varies along a rod."""

ONE_OR_SEVERAL = "number, or list of numbers"
"""The value that is a number, or several."""

COMPONENT = f"{ONE_OR_SEVERAL}, or {ALONG}"
"""The value of a component that may vary along a rod."""


def _value(node: Mapping[str, Any]) -> str:
    """Values that a key may have, in words."""
    if "const" in node:
        return _word(node["const"])
    if "enum" in node:
        *first, last = (_word(word) for word in node["enum"])
        return f"{', '.join(first)} or {last}"
    # Tables whose keys are the user's, such as columns by input.
    if isinstance(node.get("additionalProperties"), Mapping):
        return "table by name"
    # Records are referred to: what is an object here is the table of what varies.
    if node.get("type") == "object":
        return ALONG
    choices = node.get("oneOf") or node.get("anyOf")
    if choices:
        return _choice(choices)
    if "type" not in node:
        # All that has no type refers to the definition of an inner table.
        return TABLE
    return _typed(node)


def _word(word: Any) -> str:
    return f"`{json.dumps(word)}`"


def _choice(nodes: Sequence[Mapping[str, Any]]) -> str:
    """Choices in words, without the null that stands for a key left out, and without repetition."""
    words = [_value(node) for node in nodes if node.get("type") != "null"]
    # A dictionary drops what comes again and keeps the order.
    distinct = dict.fromkeys(words)
    return ", or ".join(distinct)


def _typed(node: Mapping[str, Any]) -> str:
    kind = node["type"]
    # Lists are of fixed length (vectors) or of any.
    if kind == "array":
        return _list(node)
    if kind == "number":
        return f"number{_range(node)}"
    if kind == "integer":
        return f"whole number{_range(node)}"
    if kind == "boolean":
        return "true or false"
    if "pattern" in node:
        return "name"
    return "text"


def _range(node: Mapping[str, Any]) -> str:
    """The range of a number, as it follows the word."""
    if "minimum" in node and "maximum" in node:
        return f" from {node['minimum']:g} to {node['maximum']:g}"
    bounds = []
    for key, sign in (("exclusiveMinimum", ">"), ("minimum", "≥"), ("maximum", "≤")):
        if key in node:
            bounds.append(f" {sign} {node[key]:g}")
    return " and".join(bounds)


def _list(node: Mapping[str, Any]) -> str:
    if "prefixItems" not in node:
        entry = _value(node["items"])
        if entry == ONE_OR_SEVERAL:
            return "list of numbers, or of lists of numbers"
        return f"list of {_plural(entry)}"
    entries = node["prefixItems"]
    entry = _value(entries[0])
    if entry == COMPONENT:
        return f"{len(entries)} components"
    return f"{len(entries)} {_plural(entry)}"


def _plural(words: str) -> str:
    """Several of what the words mean one of."""
    if words[0].isdigit():
        return f"lists of {words}"
    return re.sub(r"^(number|whole number|name|text)\b", r"\1s", words)


# Markdown


def _heading(level: int, text: str) -> str:
    return f"{'#' * level} {text}\n"


def _example(record: type[Record]) -> str:
    return f"```toml\n{record.example}```\n"


def _sentence(words: str | None) -> str:
    """Words as a sentence."""
    text = words or ""
    return f"{text[:1].upper()}{text[1:]}."


def _unit_word(unit: str) -> str:
    if unit == "1":
        return "without unit"
    return unit


def _block(lines: Sequence[str]) -> str:
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    COMMITTED.write_text(reference_text(), encoding="utf-8")
