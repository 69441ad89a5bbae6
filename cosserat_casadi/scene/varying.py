"""Values that vary along a rod, in the notation of the scene file: to check how lists were read."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from cosserat_casadi.scene.fields import unit_of, varies_by_component, varying_mark
from cosserat_casadi.scene.profiles import Profile, read_profile
from cosserat_casadi.scene.records import Record
from cosserat_casadi.scene.scene import Scene
from cosserat_casadi.scene.values import Varying


@dataclass(frozen=True)
class VaryingValue:
    """A value of a scene that varies along X.

    Attributes:
        key: its key, such as ``finger.section.radius`` or ``cable.offset[0]``.
        unit: unit of the numbers, "1" for dimensionless ones.
        profile: the profile in the notation of the file.
        plain: whether the file has a plain list, whose meaning depends on the key.
    """

    key: str
    unit: str
    profile: Profile
    plain: bool


def varying_values(scene: Scene, tables: Mapping[str, Any]) -> list[VaryingValue]:
    """All values of a scene with more than one number along X in its file, in the order of the format."""
    return list(_of_record(scene, tables, ""))


def _of_record(record: Record, table: Mapping[str, Any], owner: str) -> Iterator[VaryingValue]:
    """The varying values of a record and of records in it; keys that are left out do not vary."""
    for name, field in type(record).model_fields.items():
        key = field.alias or name
        if key not in table:
            continue
        written = table[key]
        where = f"{owner}.{key}" if owner else key
        mark = varying_mark(field)
        if mark is None:
            yield from _of_contents(getattr(record, name), written, where)
        elif "knots" in table and not varies_by_component(field):
            # Values at knots have one meaning.
            continue
        elif varies_by_component(field):
            for i, component in enumerate(written):
                yield from _of_value(component, mark, unit_of(field), f"{where}[{i}]")
        else:
            yield from _of_value(written, mark, unit_of(field), where)


def _of_contents(contents: Any, written: Any, where: str) -> Iterator[VaryingValue]:
    """The varying values of the record, or the list of records, under a key; nothing for other contents."""
    if isinstance(contents, Record):
        yield from _of_record(contents, written, where)
    elif isinstance(contents, tuple):
        for i, entry in enumerate(contents):
            if isinstance(entry, Record):
                # As in overrides, a key begins with the name of a named entry.
                yield from _of_record(entry, written[i], written[i].get("name", f"{where}[{i}]"))


def _of_value(written: Any, mark: Varying, unit: str, where: str) -> Iterator[VaryingValue]:
    if isinstance(written, Mapping):
        profile = read_profile(written)
    elif isinstance(written, list):
        profile = Profile(mark.notation, tuple(written))
    else:
        return
    # One number is a constant in every notation.
    if len(profile.numbers) > 1:
        yield VaryingValue(where, unit, profile, plain=isinstance(written, list))
