"""From TOML to a scene: file, text or tables ↦ overrides ↦ `Scene`, or one `SceneError` with every fault.

Whatever the bytes of a file are, the outcome is one of the two.
"""

from __future__ import annotations

import difflib
import json
import math
import os
import re
import tomllib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ValidationError
from pydantic.fields import FieldInfo

from cosserat_casadi.errors import Problem, SceneError
from cosserat_casadi.scene import schema, targets
from cosserat_casadi.scene.faults import Fault, shown
from cosserat_casadi.scene.faults import Path as FaultPath
from cosserat_casadi.scene.schema import Scene

LARGEST = 1_000_000
"""Bytes of the largest scene that is read."""

_DEEPEST = 64
"""Dots in one key of the deepest table that is read; the parser needs memory with the square of it."""

_RECORDS: dict[str | int, type[BaseModel]] = {
    "accuracy": schema.Accuracy,
    "rods": schema.Rod,
    "material": schema.Material,
    "stiffness": schema.Stiffness,
    "intrinsic": schema.Intrinsic,
    "base": schema.Base,
    "⟨circle⟩": schema.Circle,
    "⟨annulus⟩": schema.Annulus,
    "⟨rectangle⟩": schema.Rectangle,
    "⟨gravity⟩": schema.Gravity,
    "⟨tip_wrench⟩": schema.TipWrench,
    "⟨point_wrench⟩": schema.PointWrench,
    "⟨distributed_wrench⟩": schema.DistributedWrench,
    "⟨body_wrench⟩": schema.BodyWrench,
    "bodies": schema.Body,
    "⟨fixed⟩": schema.FixedJoint,
    "⟨spherical⟩": schema.SphericalJoint,
    "⟨clamped⟩": schema.ClampedSupport,
    "⟨pinned⟩": schema.PinnedSupport,
    "⟨tendon⟩": schema.Tendon,
    "⟨chamber⟩": schema.Chamber,
    "helix": schema.Helix,
    "⟨pose⟩": targets.PoseTarget,
    "⟨position⟩": targets.PositionTarget,
    "⟨curve⟩": targets.CurveTarget,
    "bounds": targets.Bound,
}
"""The record that a segment of pydantic's path leads to; the schema marks its choices with ⟨ ⟩."""


# Public


def read_scene(path: str | os.PathLike[str], overrides: Sequence[str] = ()) -> Scene:
    """Read a scene from a TOML file.

    Args:
        path: the file.
        overrides: assignments such as ``push.force=[0.2, 0, 0]``, ``finger.length=0.3`` or
            ``accuracy.tolerance=1e-9``: a load, rod, support or table, a dotted path in it, and a TOML value.

    Returns:
        the scene, validated.

    Raises:
        SceneError: with every fault of the file and the overrides.
    """
    return parse_scene(_text(Path(path)), overrides)


def parse_scene(text: str, overrides: Sequence[str] = ()) -> Scene:
    """Read a scene from TOML text.

    Args:
        text: the scene.
        overrides: as in `read_scene`.

    Raises:
        SceneError: with every fault.
    """
    return scene_from_dict(_toml(text), overrides)


def scene_from_dict(mapping: Mapping[str, Any], overrides: Sequence[str] = ()) -> Scene:
    """Read a scene from the tables of a TOML file; they are left as they are.

    Args:
        mapping: tables as dictionaries, arrays as lists.
        overrides: as in `read_scene`.

    Raises:
        SceneError: with every fault.
    """
    try:
        return _validated(_copy(mapping), overrides)
    except RecursionError:
        raise SceneError(Problem("", "is nested too deeply for a scene")) from None


def place_of(mapping: Mapping[str, Any], key: str) -> FaultPath:
    """Path of what an override with this key sets: two keys of one path set the same.

    Args:
        mapping: tables of a scene.
        key: left side of an override, such as ``push.force`` or ``loads[0].force``.

    Raises:
        SceneError: there is nothing of that name to set.
    """
    try:
        return _assign(_copy(mapping), key, 0.0).leaf
    except _Refused as error:
        raise SceneError(Problem(key, *error.args)) from None


def _validated(tables: Any, overrides: Sequence[str]) -> Scene:
    if not isinstance(tables, dict):
        raise SceneError(Problem("", f"must be a table, got {shown(tables)}"))
    applied, refused = _override(tables, overrides)
    try:
        scene = Scene.model_validate(tables)
    except ValidationError as error:
        faults = sorted(map(_fault, error.errors(include_url=False)), key=_place_in(tables))
        refused += [_problem(fault, applied) for fault in faults]
    if refused:
        raise SceneError(*refused)
    return scene


def _copy(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {key: _copy(entry) for key, entry in value.items()}
    return [_copy(entry) for entry in value] if isinstance(value, list | tuple) else value


# The file


def _text(path: Path) -> str:
    try:
        if path.is_dir():
            raise SceneError(Problem(str(path), "is a directory", "a scene is a TOML file"))
        with path.open("rb") as file:
            content, size = file.read(LARGEST + 1), os.fstat(file.fileno()).st_size
    except FileNotFoundError:
        raise SceneError(Problem(str(path), "no such file")) from None
    except (OSError, ValueError) as error:
        raise SceneError(Problem(str(path), f"cannot be read: {getattr(error, 'strerror', error)}")) from None
    if len(content) > LARGEST:
        raise SceneError(_too_large(str(path), max(size, len(content))))
    return _decoded(path, content)


def _decoded(path: Path, content: bytes) -> str:
    if not content.strip():
        raise SceneError(Problem(str(path), "is empty", "a scene has schema = 1 and at least one [[rods]]"))
    try:
        if b"\0" in content:
            raise ValueError
        return content.decode("utf-8-sig")
    except ValueError:
        raise SceneError(Problem(str(path), "is not text in UTF-8", "a scene is a TOML file")) from None


def _too_large(where: str, size: int) -> Problem:
    return Problem(where, f"is {math.ceil(size / 1e5) / 10:.1f} MB; a scene is at most 1 MB")


def _toml(text: str) -> dict[str, Any]:
    if len(text) > LARGEST:
        raise SceneError(_too_large("", len(text)))
    if not text.strip():
        raise SceneError(Problem("", "is empty", "a scene has schema = 1 and at least one [[rods]]"))
    if _keys_are_too_deep(text):
        raise SceneError(Problem("", "is nested too deeply for a scene"))
    try:
        return tomllib.loads(text)
    except RecursionError:
        raise SceneError(Problem("", "is nested too deeply for a scene")) from None
    except ValueError as error:
        raise SceneError(_syntax_problem(str(error))) from None


def _keys_are_too_deep(text: str) -> bool:
    """Whether a dotted key is so deep that parsing it would take all memory; keys cannot span lines."""
    bare = (len(re.findall(r"[^.\s]\s*\.", part)) for part in re.split(r"[=,{}\[\]#\n]", text))
    quoted = (len(re.findall(r"[\"']\s*\.", line)) for line in text.split("\n"))
    return max(bare) > _DEEPEST or max(quoted) > _DEEPEST


def _syntax_problem(message: str) -> Problem:
    found = re.fullmatch(r"(.*) \(at (.*)\)", message, re.DOTALL)
    if found is None:
        return Problem("", "is not TOML: a number in it is beyond all range")
    return Problem(found[2], f"is not TOML: {found[1]}")


# Overrides


@dataclass(frozen=True)
class _Assignment:
    """An override that was applied.

    Attributes:
        key: its left side, as written.
        leaf: path of what it sets.
        created: path of the outermost table that exists only because of it; otherwise the leaf.
    """

    key: str
    leaf: FaultPath
    created: FaultPath


def _override(tables: dict[str, Any], overrides: Sequence[str]) -> tuple[list[_Assignment], list[Problem]]:
    """Apply assignments in their order to the tables; a later one wins."""
    applied: list[_Assignment] = []
    refused: list[Problem] = []
    for text in overrides:
        key, equals, right = (part.strip() for part in text.partition("="))
        try:
            if not equals or not key:
                raise _Refused("must read name.field=value", "such as push.force=[0.2,0,0]")
            applied.insert(0, _assign(tables, key, _value(right)))
        except _Refused as error:
            refused.append(Problem(f"--set {key or text}", *error.args))
    return applied, refused


class _Refused(Exception):  # noqa: N818 - it never leaves this module
    """An override that cannot be applied: problem and remedy."""


def _value(text: str) -> Any:
    try:
        parsed = {} if _keys_are_too_deep(text) else tomllib.loads(f"value = {text}")
    except (ValueError, RecursionError):
        parsed = {}
    if list(parsed) != ["value"]:
        raise _Refused(f"{shown(text)} is not a TOML value", 'text stands in quotes: "body"; a list in brackets')
    return parsed["value"]


def _assign(tables: dict[str, Any], key: str, value: Any) -> _Assignment:
    container: Any = tables
    path: list[str | int] = []
    created: FaultPath | None = None
    segments = _start(tables, key)
    for segment in segments[:-1]:
        index = _index(container, segment)
        path.append(index)
        if isinstance(container, dict) and index not in container:
            container[index] = {}
            created = created or tuple(path)
        container = container[index]
    path.append(_index(container, segments[-1]))
    container[path[-1]] = value
    return _Assignment(key, tuple(path), created or tuple(path))


def _start(tables: Mapping[str, Any], key: str) -> list[str]:
    """The segments of a key from the root: a load, actuator, rod or support may stand for itself."""
    segments = re.sub(r"\[(\d+)\]", r".\1", key).split(".")
    names = {}
    for array in ("supports", "joints", "bodies", "rods", "actuators", "loads"):
        entries = tables.get(array)
        for entry in entries if isinstance(entries, list) else []:
            if isinstance(entry, dict) and isinstance(entry.get("name"), str):
                names[entry["name"]] = array
    if segments[0] in names and len(segments) > 1:
        return [names[segments[0]], *segments]
    known = _keys(Scene)
    if segments[0] not in known:
        what = f"no load, actuator, rod, support or table is named {shown(segments[0])}"
        raise _Refused(what, _closest(segments[0], [*names, *known]))
    return segments


def _index(container: Any, segment: str) -> Any:
    """The key or index that a segment means; entries of arrays go by name or number."""
    if isinstance(container, dict) and segment:
        return segment
    if isinstance(container, list):
        named = [i for i, entry in enumerate(container) if isinstance(entry, dict) and entry.get("name") == segment]
        if named:
            return named[0]
        if re.fullmatch(r"[0-9]{1,9}", segment) and int(segment) < len(container):
            return int(segment)
    raise _Refused(f"there is no {shown(segment)} to set")


# Faults


def _fault(error: Any) -> Fault:
    """One of pydantic's errors in the words of the format."""
    location: tuple[str | int, ...] = error["loc"]
    kind, last = error["type"], location[-1:]
    body = tuple(part for part in location[:-1] if not _is_mark(part))
    path = body + (last if kind == "extra_forbidden" or not any(map(_is_mark, last)) else ())
    if kind == "refused":
        return Fault(path, error["ctx"]["problem"], error["ctx"]["remedy"])
    record = _record(location[:-1])
    if kind in ("extra_forbidden", "invalid_key"):
        return Fault(path, "unknown key", _closest(str(last[0]), _keys(record)))
    return Fault(path, _sentence(kind, error), _remedy(kind, path, record, error))


def _is_mark(part: str | int) -> bool:
    return isinstance(part, str) and part.startswith("⟨") and part.endswith("⟩")


def _record(location: tuple[str | int, ...]) -> type[BaseModel]:
    """The record that a path ends in."""
    return next((_RECORDS[part] for part in reversed(location) if part in _RECORDS), Scene)


def _keys(record: type[BaseModel]) -> dict[str, FieldInfo]:
    return {field.alias or name: field for name, field in record.model_fields.items()}


def _closest(word: str, known: Sequence[str] | Mapping[str, Any]) -> str:
    close = difflib.get_close_matches(word[:40], list(known), n=1)
    return f"did you mean '{close[0]}'?" if close else f"known: {', '.join(list(known)[:30])}"


_WANTED = {
    "finite_number": "finite",
    "float_type": "a number",
    "int_type": "a whole number",
    "bool_type": "true or false",
    "string_type": "text",
    "string_unicode": "text",
    "tuple_type": "a list",
    "model_type": "a table",
    "string_pattern_mismatch": "a letter, then letters, digits and underscores",
}
_BOUNDS = {
    "greater_than": (">", "gt"),
    "greater_than_equal": (">=", "ge"),
    "less_than": ("<", "lt"),
    "less_than_equal": ("<=", "le"),
}


def _sentence(kind: str, error: Any) -> str:
    context, got = error.get("ctx", {}), shown(error["input"])
    if kind == "missing":
        return "missing"
    if kind == "literal_error":
        return f"must be one of {context['expected'].replace(' or ', ', ')}, got {got}"
    if kind in _BOUNDS:
        sign, bound = _BOUNDS[kind]
        return f"must be {sign} {context[bound]:g}, got {got}"
    return f"must be {_WANTED.get(kind, 'something else')}, got {got}"


def _remedy(kind: str, path: FaultPath, record: type[BaseModel], error: Any) -> str:
    """The closest word, or what the field is, where the problem alone does not say it."""
    if kind in _BOUNDS or kind == "finite_number":
        return ""
    if kind == "literal_error" and isinstance(error["input"], str):
        words = re.findall(r"'([^']*)'", error["ctx"]["expected"])
        if close := difflib.get_close_matches(error["input"][:40], words, n=1):
            return f"did you mean '{close[0]}'?"
    names = [part for part in path if isinstance(part, str)]
    field = _keys(record).get(names[-1]) if names else None
    return (field.description or "") if field else ""


def _place_in(tables: Mapping[str, Any]) -> Callable[[Fault], tuple[int, ...]]:
    """A sorting key: where a fault stands in the file; what is missing stands at the end of its table."""
    orders: dict[int, dict[Any, int]] = {}

    def place(fault: Fault) -> tuple[int, ...]:
        found: list[int] = []
        container: Any = tables
        for part in fault.path:
            if isinstance(container, dict):
                if id(container) not in orders:
                    orders[id(container)] = {key: i for i, key in enumerate(container)}
                found.append(orders[id(container)].get(part, len(container)))
                container = container.get(part)
            else:
                found.append(part if isinstance(part, int) else 0)
                inside = isinstance(container, list) and isinstance(part, int) and part < len(container)
                container = container[part] if inside else None
        return tuple(found)

    return place


def _problem(fault: Fault, applied: Sequence[_Assignment]) -> Problem:
    """A fault as it is told; one that an override brought in is told of the override."""
    for assignment in applied:
        if fault.path[: len(assignment.created)] == assignment.created:
            beyond = fault.path[len(assignment.leaf) :]
            return Problem(f"--set {assignment.key}{_suffix(beyond)}", fault.problem, fault.remedy)
    return Problem(_path(fault.path), fault.problem, fault.remedy)


def _path(parts: FaultPath) -> str:
    return _suffix(parts).removeprefix(".")


def _suffix(parts: FaultPath) -> str:
    return "".join(f"[{part}]" if isinstance(part, int) else f".{_key(part)}" for part in parts)


def _key(key: str) -> str:
    """A key as TOML writes it, shortened."""
    short = key if len(key) <= 60 else key[:57] + "..."
    return short if re.fullmatch(r"[\w-]+", short) else json.dumps(short)
