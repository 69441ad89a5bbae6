"""Annotations of the fields of records: the unit of the numbers, and whether they vary along a rod."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Annotated, Any, get_args, get_origin

from pydantic.fields import FieldInfo

from cosserat_casadi.scene.values import Varying

UNITS = (
    "without unit",
    "A m²",
    "A/m",
    "T/m",
    "T",
    "N m s/rad",
    "N m/rad",
    "N m/m",
    "N m² s",
    "N m²",
    "N m",
    "N/m²",
    "N/m",
    "N s/m",
    "N s",
    "N",
    "kg/m³",
    "kg/m",
    "kg m²",
    "kg m",
    "kg",
    "m/s²",
    "m/s",
    "m²",
    "m",
    "1/(m s)",
    "1/m",
    "Pa s",
    "Pa",
    "1/s",
    "rad/s",
    "rad",
    "Hz",
    "s/m",
    "s",
)
"""Units as descriptions of keys give them, longest first where one begins another."""

_UNIT = re.compile(rf", ({'|'.join(map(re.escape, UNITS))})(?=[;,]|$)")


def unit_of(field: FieldInfo) -> str:
    """The unit in the description of a field, "1" for a dimensionless one, "–" if it names none."""
    unit, _ = unit_and_meaning(field.description or "")
    return unit


def unit_and_meaning(description: str) -> tuple[str, str]:
    """The unit in a description, "–" if there is none, and the rest of the description."""
    match = _UNIT.search(description)
    if match is None:
        return "–", description
    meaning = description[: match.start()] + description[match.end() :]
    if match[1] == "without unit":
        return "1", meaning
    return match[1], meaning


def varying_mark(field: FieldInfo) -> Varying | None:
    """The mark of a field that may vary along X, or with components that may."""
    marks = (entry for annotation in _annotations(field) for entry in _metadata(annotation))
    return next((mark for mark in marks if isinstance(mark, Varying)), None)


def varies_by_component(field: FieldInfo) -> bool:
    """Whether the components of a field vary: the mark is inside a list."""
    for annotation in _annotations(field):
        if any(isinstance(entry, Varying) for entry in _metadata(annotation)):
            return False
        if get_origin(annotation) is tuple:
            return True
    return False


def _annotations(field: FieldInfo) -> Iterator[Any]:
    """The annotation of a field and its parts, from outside to inside."""
    pending: list[Any] = [Annotated[(field.annotation, *field.metadata, None)]]
    while pending:
        annotation = pending.pop(0)
        yield annotation
        pending += get_args(annotation)


def _metadata(annotation: Any) -> tuple[Any, ...]:
    return tuple(annotation.__metadata__) if get_origin(annotation) is Annotated else ()
