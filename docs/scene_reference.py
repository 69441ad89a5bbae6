"""The reference of the scene file, every key of every table: made from the records that read it.

Usage: ``python docs/scene_reference.py``, or ``make schema``: writes the committed copy, ``docs/scene.md``.
"""

from __future__ import annotations

import inspect
import json
import re
from collections.abc import Container, Iterator, Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any, TypeAlias

from cosserat_casadi.scene.families import Family, contents_of
from cosserat_casadi.scene.fields import unit_and_meaning
from cosserat_casadi.scene.records import Entry, Record, keys_of
from cosserat_casadi.scene.scene import Scene

COMMITTED = Path(__file__).parent / "scene.md"
"""The page in the documentation."""

INTRODUCTION = """\
# The scene file

A scene is a TOML file. This page lists every table and every key of it; `make schema` makes the page from the schema.
The [guide](guide.md) builds a scene step by step. Editors that know JSON Schema complete and check the keys with
[`scene.schema.json`](../cosserat_casadi/scene/scene.schema.json).

* An effect that a scene leaves out does not exist, and adds no instruction to the model.
* A key that this page does not list is refused, and so is a value out of its range. All faults are reported at once,
  with the place, the fault and the remedy.
* Units are SI. `world` axes are right-handed. The local z axis of a section is the tangent of the rod.
* X is the abscissa along a rod over its length: 0 at the base, 1 at the tip.
* A quaternion is w, x, y, z, of norm 1. It turns local coordinates into the axes in which it is given.
* **3 components**: each is a number, or varies along the rod by itself.
* **Inputs** may stay free at run time: they are arguments of the model's functions and of the exported C. The key
  `inputs` names them as `name.key`. Without this key, all inputs of loads and actuators that the scene gives are
  free.
"""

VARIATION = """\
## Along a rod

A quantity that may vary along a rod is a number if it is constant, or a table. The table means the same under every
key. `cosserat check` prints all values at base and tip.

| table | meaning |
|---|---|
| `{ base = 8e-3, tip = 4e-3 }` | values at X = 0 and X = 1, linear between them |
| `{ powers = [8e-3, -4e-3] }` | 8e-3 − 4e-3 X: coefficients of 1, X, X², … |
| `{ legendre = [6e-3, -2e-3] }` | 6e-3 − 2e-3 (2X − 1): coefficients of the Legendre polynomials in 2X − 1 |

These three tables have the same meaning. Sizes and stiffnesses are linear: they take at most two coefficients. All
other quantities take more.

**A plain list** stands for one of the three tables, depending on the key:

| key | a list contains |
|---|---|
| size | the values at base and tip |
| offset | coefficients of powers of X: `[8e-3, 4e-3]` is 8e-3 + 4e-3 X, 12 mm at the tip |
| strain, spread load | Legendre coefficients |

When a table is read, it becomes the list of its key, with up to ten coefficients if the notation changes. An input
that varies has Legendre coefficients, however the scene writes it.
"""

LEAST_SHARED = 3
"""Number of keys that all kinds of a family have, from which on one table lists them for all kinds."""

Contents: TypeAlias = Family[Any] | type[Record]
"""Inner tables: kinds of a family, or one record."""

Places: TypeAlias = dict[Contents, str]
"""Inner tables that have a section on the page, each with the anchor of its heading."""


def reference_text() -> str:
    """The page as it is committed."""
    places: Places = {}
    keys = [key for key, contents in contents_by_key(Scene).items() if contents is None]
    sections = [
        INTRODUCTION,
        _contents(),
        VARIATION,
        _heading(2, "Top level"),
        _example(Scene),
        _key_table(Scene, "", keys, places),
    ]
    # Sections follow the order of the schema, so that a new table is in the page without further ado.
    for key, contents in contents_by_key(Scene).items():
        if contents is not None:
            sections += _list_or_table(key, contents, places)
    return "\n".join(sections)


def _contents() -> str:
    """The tables of a scene, each with a link to its section."""
    lines = ["| table | what it holds |", "|---|---|"]
    for key, field in Scene.model_fields.items():
        if contents_of(field) is not None:
            lines.append(f"| [`{_title(key)}`](#{key}) | {field.description} |")
    return _block(lines)


def _list_or_table(key: str, contents: Contents, places: Places) -> Iterator[str]:
    """The section of one table of the scene, or of one list of tables."""
    yield _heading(2, f"`{_title(key)}`")
    if isinstance(contents, Family):
        yield f"{_sentence(Scene.model_fields[key].description)}\n"
        yield from _kinds(contents, anchor=key, level=3, places=places)
    else:
        yield from _record(contents, path=key, level=2, places=places)


def _title(key: str) -> str:
    """A table of a scene as its file heads it."""
    if key in ("accuracy", "simulation", "identification", "estimation"):
        return f"[{key}]"
    return f"[[{key}]]"


def _kinds(family: Family[Any], anchor: str, level: int, places: Places) -> Iterator[str]:
    """The keys that all kinds of a family share, then one section for each kind.

    Args:
        family: the kinds.
        anchor: of the heading of the family.
        level: of the headings of the kinds.
        places: inner tables that have a section; tables that get one here are added.
    """
    shared = shared_keys(family)
    if shared:
        yield f"Every {family.key} has these keys:\n"
        yield from _keys(next(iter(family.records.values())), family.table, shared, level, places)
    for word, record in family.records.items():
        yield _heading(level, f'`{family.key} = "{word}"`')
        # The word stands in the heading, and needs no line in the table.
        told = {family.key, *shared}
        link = f"[keys of every {family.key}](#{anchor})" if shared else ""
        yield from _record(record, family.table, level, places, told, link)


def shared_keys(family: Family[Any]) -> list[str]:
    """Keys that all kinds of a family have with one meaning; none where they are few."""
    lines = [
        {key: _key_line(record, family.table, key, {}) for key in contents_by_key(record) if key != family.key}
        for record in family.records.values()
    ]
    shared = [key for key, line in lines[0].items() if all(others.get(key) == line for others in lines[1:])]
    return shared if len(lines) > 1 and len(shared) >= LEAST_SHARED else []


def _record(
    record: type[Record],
    path: str,
    level: int,
    places: Places,
    told: Container[str] = (),
    link: str = "",
) -> Iterator[str]:
    """The section of one record below its heading, then those of the tables in it.

    Args:
        record: the record.
        path: of its table in the scene.
        level: of its heading.
        places: inner tables that have a section; tables that get one here are added.
        told: keys that stand elsewhere: in the heading, or in the table of all kinds.
        link: to the table of all kinds; empty where there is none.
    """
    yield f"{inspect.getdoc(record)}\n"
    if record.example:
        yield _example(record)
    own = [key for key in contents_by_key(record) if key not in told]
    if link:
        yield f"In addition to the {link}, it has:\n" if own else f"It has only the {link}.\n"
    inputs = _inputs(record)
    if own:
        yield from _keys(record, path, own, level + 1, places, inputs)
    else:
        yield from inputs


def _keys(
    record: type[Record], path: str, keys: Sequence[str], level: int, places: Places, below: Sequence[str] = ()
) -> Iterator[str]:
    """A table of keys of a record, then sections of the inner tables that have none yet.

    Args:
        record: the record.
        path: of its table in the scene.
        keys: some of its keys.
        level: of the headings of the inner tables.
        places: inner tables that have a section; tables that get one here are added.
        below: lines below the table.
    """
    contents = contents_by_key(record)
    first = []
    for key in keys:
        inner = contents[key]
        if inner is not None and inner not in places:
            places[inner] = _anchor(path, key)
            first.append((key, inner))
    yield _key_table(record, path, keys, places)
    yield from below
    for key, inner in first:
        yield _heading(level, f"`{path}.{key}`")
        if isinstance(inner, Family):
            yield f"{_sentence(record.model_fields[key].description)}\n"
            yield from _kinds(inner, _anchor(path, key), level + 1, places)
        else:
            yield from _record(inner, f"{path}.{key}", level, places)


def _inputs(record: type[Record]) -> list[str]:
    """A line with the inputs of a record; none where it has none."""
    if not (issubclass(record, Entry) and record.inputs):
        return []
    inputs = ", ".join(f"`{field}` ({_unit_word(declared.unit)})" for field, declared in record.inputs.items())
    return [f"Inputs: {inputs}.\n"]


def contents_by_key(record: type[Record]) -> dict[str, Contents | None]:
    """The keys of a record, each with the tables that it holds, or None for a value."""
    keys = keys_of(record)
    return {key: contents_of(field) for key, field in keys.items()}


# Keys


def _key_table(record: type[Record], path: str, keys: Sequence[str], places: Places) -> str:
    """A line for each of some keys of a record that stands under a path of the scene."""
    lines = ["| key | value | unit | default | meaning |", "|---|---|---|---|---|"]
    return _block([*lines, *(_key_line(record, path, key, places) for key in keys)])


def _key_line(record: type[Record], path: str, key: str, places: Places) -> str:
    """The line of a key, with links to the sections of inner tables."""
    schema = _schema_of(record)
    node = schema["properties"][key]
    unit, meaning = unit_and_meaning(node["description"])
    value = _value(node)
    # References are texts to JSON Schema, names of tables to the reader.
    if meaning.startswith("name"):
        value = value.replace("text", "name")
    if value == TABLE:
        unit = "–"
    contents = contents_by_key(record)[key]
    if contents is not None:
        anchor = places.get(contents, _anchor(path, key))
        value = re.sub(r"\btables?\b(?! by name)", lambda match: f"[{match[0]}](#{anchor})", value)
    default = "required"
    if key not in schema.get("required", []):
        default = _default(node)
    return f"| `{key}` | {value} | {unit} | {default} | {meaning} |"


@cache
def _schema_of(record: type[Record]) -> dict[str, Any]:
    return record.model_json_schema(by_alias=True)


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
    return re.sub(r"^(number|whole number|name|text|table)\b", r"\1s", words)


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
